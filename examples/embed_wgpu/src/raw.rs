//! wgpu's textures and buffers as Vulkan knows them, for whatever else speaks Vulkan.
//!
//! The handles are wgpu's still: nothing here destroys them, and they are good for as long as the
//! textures and buffers that they come from.

use crate::Outcome;
use ash::vk;
use wgpu::hal::api::Vulkan;
use wgpu::{TextureFormat, TextureUsages};

/// A texture and its view.
#[derive(Clone, Copy)]
pub struct RawImage {
    pub image: vk::Image,
    pub view: vk::ImageView,
    pub format: vk::Format,
    /// The usage that it was created with, as far as shaders see it.
    pub usage: vk::ImageUsageFlags,
}

const NOT_VULKAN: &str = "wgpu made this without Vulkan";

/// A texture and its view.
pub fn image(texture: &wgpu::Texture, view: &wgpu::TextureView) -> Outcome<RawImage> {
    let usages = [
        (TextureUsages::TEXTURE_BINDING, vk::ImageUsageFlags::SAMPLED),
        (TextureUsages::STORAGE_BINDING, vk::ImageUsageFlags::STORAGE),
    ];
    let usages = usages.into_iter().filter(|(wgpu, _)| texture.usage().contains(*wgpu));
    Ok(RawImage {
        // One after the other: what `as_hal` gives holds a lock of wgpu's.
        // SAFETY: the handle is only lent; see above.
        image: unsafe { texture.as_hal::<Vulkan>().ok_or(NOT_VULKAN)?.raw_handle() },
        // SAFETY: as above.
        view: unsafe { view.as_hal::<Vulkan>().ok_or(NOT_VULKAN)?.raw_handle() },
        format: match texture.format() {
            TextureFormat::Depth32Float => vk::Format::D32_SFLOAT,
            TextureFormat::R32Float => vk::Format::R32_SFLOAT,
            TextureFormat::R8Unorm => vk::Format::R8_UNORM,
            TextureFormat::Rgba16Float => vk::Format::R16G16B16A16_SFLOAT,
            _ => vk::Format::UNDEFINED, // nobody else sees those
        },
        usage: usages.fold(vk::ImageUsageFlags::empty(), |all, (_, usage)| all | usage),
    })
}

/// A buffer.
pub fn buffer(buffer: &wgpu::Buffer) -> Outcome<vk::Buffer> {
    // SAFETY: the handle is only lent; see above.
    Ok(unsafe { buffer.as_hal::<Vulkan>().ok_or(NOT_VULKAN)?.raw_handle() })
}
