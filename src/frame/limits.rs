//! What a plan depends on of the device.

/// The device's limits that a plan depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The step of the grid that the rasterizer rounds vertices to, in texels: 2^−(sub-pixel bits), above 0.
    pub subpixel_step: f32,
    /// Whether the device is a processor, on which a few invocations with much work each are faster than many that wait for
    /// each other: some passes have a shader for either, and both write the same.
    pub processor: bool,
}

impl Default for Limits {
    /// A GPU with the least that Vulkan guarantees: 4 sub-pixel bits.
    fn default() -> Self {
        Self { subpixel_step: 1.0 / 16.0, processor: false }
    }
}
