//! The images and buffers that passes read and write, and who owns them.

use ash::vk;

/// Identifies a resource of one [`Graph`](super::Graph), whose methods `image`, `image_array` and `buffer` return it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ResourceId(pub(super) u16);

impl ResourceId {
    /// The resource's index in [`Graph::resources`](super::Graph::resources).
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// Who owns a resource's memory, and how long its content lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// The node owns it; in every frame a pass writes it before another reads it.
    Transient,
    /// The node owns it; its content stays from frame to frame until a pass writes it again.
    Kept,
    /// The host owns it and writes it before the frame's first pass.
    Imported,
    /// The node owns it; the host reads it after the frame's last pass.
    Exported,
    /// The host owns it and reads it after the frame's last pass; the node overwrites all of it.
    Lent,
    /// The node owns it, a buffer in memory that the host sees for each light of each frame slot; the node reads it on
    /// the host once the device has completed the frame.
    HostRead,
}

impl Owner {
    /// Whether the resource is read after the node's last pass.
    pub fn is_result(self) -> bool {
        matches!(self, Self::Exported | Self::Lent | Self::HostRead)
    }

    /// Whether later frames or the node's host side read the resource.
    pub fn is_read_later(self) -> bool {
        matches!(self, Self::Kept | Self::HostRead)
    }

    /// Whether the host and the node both use the resource on the device, so that the host says how.
    pub fn is_shared(self) -> bool {
        matches!(self, Self::Imported | Self::Exported | Self::Lent)
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
        /// The number of array layers; `None` where shaders see a single image and no array.
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
    /// The name that plans, labels and errors show, as `room.thing`.
    pub name: &'static str,
    /// Whether it is an image or a buffer, and its size.
    pub shape: Shape,
    /// Who owns it.
    pub owner: Owner,
    /// How long its content is valid where it outlasts a frame, whatever the light does.
    pub until: Option<Until>,
}

/// How long the content of a resource that depends on the blocking meshes alone is valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Until {
    /// The content is valid until another list of triangles blocks.
    Listed,
    /// The content is valid until any of them moves.
    Moved,
}

impl Resource {
    /// Whether the resource is an image with a depth format.
    pub fn is_depth(&self) -> bool {
        matches!(self.shape, Shape::Image { format, .. } if is_depth_format(format))
    }
}

/// Whether a format has a depth component, with or without stencil.
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

/// Whether a format has color that shaders read as floats: neither integers nor depth nor stencil.
pub fn is_color_format(format: vk::Format) -> bool {
    use vk::Format as F;
    let whole = matches!(
        format,
        F::R8_UINT
            | F::R8_SINT
            | F::R8G8_UINT
            | F::R8G8_SINT
            | F::R8G8B8_UINT
            | F::R8G8B8_SINT
            | F::B8G8R8_UINT
            | F::B8G8R8_SINT
            | F::R8G8B8A8_UINT
            | F::R8G8B8A8_SINT
            | F::B8G8R8A8_UINT
            | F::B8G8R8A8_SINT
            | F::A8B8G8R8_UINT_PACK32
            | F::A8B8G8R8_SINT_PACK32
            | F::A2R10G10B10_UINT_PACK32
            | F::A2R10G10B10_SINT_PACK32
            | F::A2B10G10R10_UINT_PACK32
            | F::A2B10G10R10_SINT_PACK32
            | F::R16_UINT
            | F::R16_SINT
            | F::R16G16_UINT
            | F::R16G16_SINT
            | F::R16G16B16_UINT
            | F::R16G16B16_SINT
            | F::R16G16B16A16_UINT
            | F::R16G16B16A16_SINT
            | F::R32_UINT
            | F::R32_SINT
            | F::R32G32_UINT
            | F::R32G32_SINT
            | F::R32G32B32_UINT
            | F::R32G32B32_SINT
            | F::R32G32B32A32_UINT
            | F::R32G32B32A32_SINT
            | F::R64_UINT
            | F::R64_SINT
            | F::R64_SFLOAT
            | F::R64G64_UINT
            | F::R64G64_SINT
            | F::R64G64_SFLOAT
            | F::R64G64B64_UINT
            | F::R64G64B64_SINT
            | F::R64G64B64_SFLOAT
            | F::R64G64B64A64_UINT
            | F::R64G64B64A64_SINT
            | F::R64G64B64A64_SFLOAT
    );
    !(whole || is_depth_format(format) || matches!(format, F::UNDEFINED | F::S8_UINT))
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
