//! What a node shows of its insides.

use crate::stages::depth_layers;
use ash::vk;

/// What a host's own pipeline must fit to draw into a depth layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerPass {
    /// The render pass: one depth attachment of [`depth_layers::FORMAT`], no color, one sample. It
    /// stays compatible over every resize and reconfiguration.
    pub render_pass: vk::RenderPass,
    /// The layer's size: viewport and scissor.
    pub extent: vk::Extent2D,
    /// Culling, clear value and depth test; depth is tested and written.
    pub raster: depth_layers::Raster,
}

/// The image that holds the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibilityImage {
    /// R32_SFLOAT, or R32G32B32A32_SFLOAT where the description asks for color; usage STORAGE | SAMPLED |
    /// TRANSFER_SRC.
    pub image: vk::Image,
    /// A view of it: 2D with one light, with several a 2D array of a layer a light, whose own view
    /// [`crate::ShadowNode::visibility_layer`] gives.
    pub view: vk::ImageView,
    /// Width and height, those of the G-buffer.
    pub extent: [u32; 2],
    /// How many layers it has: the description's lights.
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
    /// `room.thing`.
    pub name: &'static str,
    /// The image.
    pub image: vk::Image,
    /// Its format.
    pub format: vk::Format,
    /// Width and height in texels.
    pub extent: [u32; 2],
    /// The layout it is in behind the plan.
    pub layout: vk::ImageLayout,
}

/// The Vulkan object behind a resource of a plan, which stays the node's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanObject {
    /// An image and a view of all of it.
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
        /// Its size in bytes.
        bytes: u64,
    },
}
