//! What a node shows of its Vulkan objects.

use crate::stages::depth_layers;
use ash::vk;

/// The render pass and raster state that a host's own pipeline needs to draw into a depth layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerPass {
    /// The render pass: one depth attachment of [`depth_layers::FORMAT`], no color, one sample. It
    /// stays compatible over every resize and reconfiguration.
    pub render_pass: vk::RenderPass,
    /// The layer's size in texels: use it as viewport and scissor. Where a frame uses a corner of the layer,
    /// `HostDraw::clip_from_mesh` leads there.
    pub extent: vk::Extent2D,
    /// The cull mode, clear value and depth comparison; the pipeline tests and writes depth.
    pub raster: depth_layers::Raster,
}

/// The image that holds the visible fraction of each pixel, 0 to 1, in a layer for each light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibilityImage {
    /// R32_SFLOAT, or R32G32B32A32_SFLOAT where the description asks for color; usage STORAGE | SAMPLED |
    /// TRANSFER_SRC.
    pub image: vk::Image,
    /// A view of the whole image: 2D with one light, a 2D array with several. [`crate::ShadowNode::visibility_layer`]
    /// has a view of each layer.
    pub view: vk::ImageView,
    /// The image's width and height in pixels: those of the G-buffer.
    pub extent: [u32; 2],
    /// The number of array layers: that of the description's lights.
    pub layers: u32,
}

/// The time that a pass took on the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassTime {
    /// The pass's name.
    pub name: &'static str,
    /// Milliseconds, summed over all passes of this name.
    pub ms: f64,
}

/// One of the node's own images, for tests and debuggers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inspected {
    /// The image's name, as `room.thing`.
    pub name: &'static str,
    /// The image.
    pub image: vk::Image,
    /// The format of the image.
    pub format: vk::Format,
    /// The image's width and height in texels.
    pub extent: [u32; 2],
    /// The layout that the image is in after the plan.
    pub layout: vk::ImageLayout,
}

/// The Vulkan object of a resource of a plan. The node still owns it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanObject {
    /// An image with a view of the whole of it.
    Image {
        /// The image.
        image: vk::Image,
        /// The view.
        view: vk::ImageView,
    },
    /// A buffer.
    Buffer {
        /// The buffer.
        buffer: vk::Buffer,
        /// The size of the resource in bytes.
        bytes: u64,
    },
}
