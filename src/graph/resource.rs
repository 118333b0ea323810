//! What passes read and write: images and buffers, and who owns them.

use ash::vk;

/// Names a resource of one [`Graph`](super::Graph); made by its `image` and `buffer`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ResourceId(pub(super) u16);

impl ResourceId {
    /// The resource's place in [`Graph::resources`](super::Graph::resources).
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// Whose the memory is, and how long its content lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// The node's; written before it is read in every frame.
    Transient,
    /// The node's; what a frame wrote stays until one writes it again.
    Kept,
    /// The host's; written before the frame's first pass.
    Imported,
    /// The node's; read by the host after the frame's last pass.
    Exported,
    /// The host's; written whole by the node, read by the host after the frame's last pass.
    Lent,
}

impl Owner {
    /// Whether the host reads it behind the node.
    pub fn is_result(self) -> bool {
        matches!(self, Self::Exported | Self::Lent)
    }
}

/// The shape of a resource's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A 2D image with one mip level.
    Image {
        /// The texel format.
        format: vk::Format,
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
        /// How many layers shaders see as an array of images; none where they see one image.
        layers: Option<u32>,
    },
    /// A buffer.
    Buffer {
        /// Size in bytes.
        bytes: u64,
    },
}

/// One image or buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resource {
    /// `room.thing`, as shown in plans, labels and errors.
    pub name: &'static str,
    /// Image or buffer, and its size.
    pub shape: Shape,
    /// Whose it is.
    pub owner: Owner,
}

impl Resource {
    /// Whether it is an image with a depth format.
    pub fn is_depth(&self) -> bool {
        matches!(self.shape, Shape::Image { format, .. } if is_depth_format(format))
    }
}

/// Whether a format holds depth (with or without stencil).
pub fn is_depth_format(format: vk::Format) -> bool {
    matches!(
        format,
        vk::Format::D16_UNORM
            | vk::Format::X8_D24_UNORM_PACK32
            | vk::Format::D32_SFLOAT
            | vk::Format::D16_UNORM_S8_UINT
            | vk::Format::D24_UNORM_S8_UINT
            | vk::Format::D32_SFLOAT_S8_UINT
    )
}

/// The aspects that a barrier on an image must name.
pub(crate) fn aspects(shape: Shape) -> vk::ImageAspectFlags {
    match shape {
        Shape::Image { format, .. } if is_depth_format(format) => {
            let stencil = matches!(
                format,
                vk::Format::D16_UNORM_S8_UINT
                    | vk::Format::D24_UNORM_S8_UINT
                    | vk::Format::D32_SFLOAT_S8_UINT
            );
            if stencil {
                vk::ImageAspectFlags::DEPTH | vk::ImageAspectFlags::STENCIL
            } else {
                vk::ImageAspectFlags::DEPTH
            }
        }
        _ => vk::ImageAspectFlags::COLOR,
    }
}
