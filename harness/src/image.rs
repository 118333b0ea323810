//! Device-local images, their upload and their read-back.

use crate::buffer::{allocate, free};
use crate::{HeadlessDevice, HostBuffer};
use antumbra::graph::Scope;
use antumbra::{Error, HostImage};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocation;

/// An image that is read back: one mip level, one layer, one sample.
#[derive(Clone, Copy, Debug)]
pub struct ImageSource {
    /// The image; its usage must hold `TRANSFER_SRC` to be read and `TRANSFER_DST` to be written.
    pub image: vk::Image,
    /// The format of the image, one of those that [`bytes_per_texel`] knows.
    pub format: vk::Format,
    /// Width and height in texels.
    pub extent: [u32; 2],
    /// The array layer.
    pub layer: u32,
}

/// A 2D image with one mip level and one layer in device-local memory, and a view of all of it.
#[derive(Debug)]
pub struct OwnedImage {
    device: HeadlessDevice,
    source: ImageSource,
    usage: vk::ImageUsageFlags,
    view: vk::ImageView,
    /// `None` only until `new` is done and while it is dropped.
    allocation: Option<Allocation>,
}

impl OwnedImage {
    /// An image in layout `UNDEFINED`. `TRANSFER_SRC` and `TRANSFER_DST` are added to `usage`, so
    /// that it can be read and written here.
    ///
    /// # Errors
    /// [`Error::Frame`] if a side is 0, [`Error::Memory`] if there is no memory for it,
    /// [`Error::Vulkan`] if the driver refuses.
    pub fn new(
        device: &HeadlessDevice,
        name: &str,
        format: vk::Format,
        extent: [u32; 2],
        usage: vk::ImageUsageFlags,
    ) -> Result<Self, Error> {
        let limit = device.limits().max_image_dimension2_d;
        if extent.iter().any(|&side| side == 0 || side > limit) {
            let [w, h] = extent;
            return Err(Error::Frame(format!(
                "image {name} is {w}x{h} texels; each side must be 1 to {limit} on this device"
            )));
        }
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width: extent[0], height: extent[1], depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage | vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST);
        // SAFETY: the device lives; `info` names no extension structure.
        let image = unsafe { device.device().create_image(&info, None) }
            .map_err(Error::vulkan(format!("creating the image {name}")))?;
        // From here on, dropping `new` cleans up.
        let mut new = Self {
            device: device.clone(),
            source: ImageSource { image, format, extent, layer: 0 },
            usage: info.usage,
            view: vk::ImageView::null(),
            allocation: None,
        };
        // SAFETY: the image was made above.
        let requirements = unsafe { device.device().get_image_memory_requirements(image) };
        let allocation = allocate(device, name, requirements, MemoryLocation::GpuOnly, false)?;
        // SAFETY: offset and type come from the allocator for these requirements; bound once.
        let bound = unsafe {
            device.device().bind_image_memory(image, allocation.memory(), allocation.offset())
        };
        new.allocation = Some(allocation);
        bound.map_err(Error::vulkan(format!("binding memory to the image {name}")))?;
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(range(&new.source));
        // SAFETY: the image has memory and is of this format.
        new.view = unsafe { device.device().create_image_view(&info, None) }
            .map_err(Error::vulkan(format!("creating the view of {name}")))?;
        Ok(new)
    }

    /// The image.
    pub fn raw(&self) -> vk::Image {
        self.source.image
    }

    /// The view of all of it.
    pub fn view(&self) -> vk::ImageView {
        self.view
    }

    /// The format of the image.
    pub fn format(&self) -> vk::Format {
        self.source.format
    }

    /// Width and height in texels.
    pub fn extent(&self) -> [u32; 2] {
        self.source.extent
    }

    /// The image as the node takes it.
    pub fn lend(&self, before: Scope, after: Scope) -> HostImage {
        let ImageSource { image, format, extent, .. } = self.source;
        HostImage { image, view: self.view, format, extent, usage: self.usage, before, after }
    }

    /// Image, format and extent together.
    pub fn source(&self) -> ImageSource {
        self.source
    }

    /// Reads every texel, row by row; see [`read_image`].
    ///
    /// # Errors
    /// See [`read_image`].
    pub fn read<T: bytemuck::AnyBitPattern>(
        &self,
        layout: vk::ImageLayout,
    ) -> Result<Vec<T>, Error> {
        read_image(&self.device, &self.source, layout)
    }

    /// Writes every texel, row by row, and leaves the image in `layout`; what it held is gone.
    ///
    /// # Errors
    /// [`Error::Frame`] if `texels` is not exactly the image's size or the format is unknown to
    /// [`bytes_per_texel`]; otherwise as [`HeadlessDevice::submit_and_wait`].
    pub fn write<T: bytemuck::NoUninit>(
        &self,
        texels: &[T],
        layout: vk::ImageLayout,
    ) -> Result<(), Error> {
        let bytes = bytes_of(&self.source)?;
        if size_of_val(texels) as u64 != bytes {
            return Err(Error::Frame(format!(
                "the image holds {bytes} bytes, not the {} to be written",
                size_of_val(texels)
            )));
        }
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let staging = HostBuffer::with_data(&self.device, "image upload", texels, usage)?;
        let raw = self.device.device();
        self.device.submit_and_wait(|cmd| {
            let (undefined, copy) =
                (vk::ImageLayout::UNDEFINED, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
            change_layout(&self.device, cmd, &self.source, undefined, copy);
            // SAFETY: recording; image and buffer are of one size, and the layout was set above.
            unsafe {
                raw.cmd_copy_buffer_to_image(
                    cmd,
                    staging.raw(),
                    self.source.image,
                    copy,
                    &[region(&self.source)],
                );
            }
            change_layout(&self.device, cmd, &self.source, copy, layout);
            Ok(())
        })
    }
}

impl Drop for OwnedImage {
    fn drop(&mut self) {
        // SAFETY: made from this device, destroyed once; null is allowed.
        unsafe { self.device.device().destroy_image_view(self.view, None) };
        // SAFETY: as above; the device is done with it by contract.
        unsafe { self.device.device().destroy_image(self.source.image, None) };
        free(&self.device, self.allocation.take());
    }
}

/// Reads every texel of an image's layer that is in `layout`, row by row from the top, as `T`: a texel's
/// own type (`f32` or `[f32; 4]`) or a part of it (`f32` of an RGBA image, `u8` of anything). The
/// image is in `layout` again afterwards, and earlier submits to the queue are waited for.
///
/// # Errors
/// [`Error::Frame`] if the format is unknown to [`bytes_per_texel`] or a texel is not a whole
/// number of `T`; otherwise as [`HeadlessDevice::submit_and_wait`].
pub fn read_image<T: bytemuck::AnyBitPattern>(
    device: &HeadlessDevice,
    source: &ImageSource,
    layout: vk::ImageLayout,
) -> Result<Vec<T>, Error> {
    let bytes = bytes_of(source)?;
    let texel = bytes_per_texel(source.format).unwrap_or(0) as usize;
    if size_of::<T>() == 0 || !texel.is_multiple_of(size_of::<T>()) {
        return Err(Error::Frame(format!(
            "a texel of {:?} has {texel} bytes, which is not a whole number of the {} asked for",
            source.format,
            size_of::<T>()
        )));
    }
    let usage = vk::BufferUsageFlags::TRANSFER_DST;
    let staging = HostBuffer::new(device, "image read-back", bytes, usage)?;
    device.submit_and_wait(|cmd| {
        let copy = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        change_layout(device, cmd, source, layout, copy);
        // SAFETY: recording; the buffer holds the whole image, and the layout was set above.
        unsafe {
            device.device().cmd_copy_image_to_buffer(
                cmd,
                source.image,
                copy,
                staging.raw(),
                &[region(source)],
            );
        }
        change_layout(device, cmd, source, copy, layout);
        Ok(())
    })?;
    Ok(staging.read())
}

/// Bytes a texel takes in a buffer, for the formats that can be read and written here.
pub fn bytes_per_texel(format: vk::Format) -> Option<u32> {
    match format {
        vk::Format::R8_UNORM | vk::Format::R8_UINT => Some(1),
        vk::Format::R16_SFLOAT | vk::Format::D16_UNORM => Some(2),
        vk::Format::R8G8B8A8_UNORM
        | vk::Format::R8G8B8A8_SNORM
        | vk::Format::R8G8B8A8_SRGB
        | vk::Format::R16G16_UNORM
        | vk::Format::R16G16_SNORM
        | vk::Format::R16G16_SFLOAT
        | vk::Format::R32_UINT
        | vk::Format::R32_SFLOAT
        | vk::Format::D32_SFLOAT => Some(4),
        vk::Format::R32G32_SFLOAT | vk::Format::R16G16B16A16_SFLOAT => Some(8),
        vk::Format::R32G32B32A32_SFLOAT | vk::Format::R32G32B32A32_UINT => Some(16),
        _ => None,
    }
}

fn bytes_of(source: &ImageSource) -> Result<u64, Error> {
    let texel = bytes_per_texel(source.format).ok_or_else(|| {
        Error::Frame(format!("images of format {:?} cannot be copied here", source.format))
    })?;
    let [width, height] = source.extent.map(u64::from);
    Ok(width * height * u64::from(texel))
}

fn range(source: &ImageSource) -> vk::ImageSubresourceRange {
    let aspect = match source.format {
        vk::Format::D32_SFLOAT | vk::Format::D16_UNORM => vk::ImageAspectFlags::DEPTH,
        _ => vk::ImageAspectFlags::COLOR,
    };
    vk::ImageSubresourceRange::default()
        .aspect_mask(aspect)
        .level_count(1)
        .base_array_layer(source.layer)
        .layer_count(1)
}

fn region(source: &ImageSource) -> vk::BufferImageCopy {
    let layers = vk::ImageSubresourceLayers::default()
        .aspect_mask(range(source).aspect_mask)
        .base_array_layer(source.layer)
        .layer_count(1);
    vk::BufferImageCopy::default().image_subresource(layers).image_extent(vk::Extent3D {
        width: source.extent[0],
        height: source.extent[1],
        depth: 1,
    })
}

/// A full barrier on the layer. `UNDEFINED` as the target leaves the layout as it is.
fn change_layout(
    device: &HeadlessDevice,
    cmd: vk::CommandBuffer,
    source: &ImageSource,
    from: vk::ImageLayout,
    to: vk::ImageLayout,
) {
    let both = vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
    let barrier = [vk::ImageMemoryBarrier::default()
        .src_access_mask(both)
        .dst_access_mask(both)
        .old_layout(from)
        .new_layout(if to == vk::ImageLayout::UNDEFINED { from } else { to })
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .image(source.image)
        .subresource_range(range(source))];
    // SAFETY: recording outside a render pass; the image lives and is in layout `from`.
    unsafe {
        device.device().cmd_pipeline_barrier(
            cmd,
            vk::PipelineStageFlags::ALL_COMMANDS,
            vk::PipelineStageFlags::ALL_COMMANDS,
            vk::DependencyFlags::empty(),
            &[],
            &[],
            &barrier,
        );
    }
}
