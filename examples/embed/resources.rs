//! Images, buffers, and how the engine says what it last did with them.

use crate::Outcome;
use crate::device::Gpu;
use antumbra::frame::ImageBarrier;
use antumbra::graph::Scope;
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};

/// The scope of the G-buffer's render pass on depth.
pub const DEPTH_DRAWN: Scope = Scope::DEPTH_DRAWN;
/// The scope of the G-buffer's render pass on colors.
pub const COLOR_DRAWN: Scope = Scope::COLOR_DRAWN;
/// The scope of the compose pass on its inputs.
pub const COMPOSE_READS: Scope = Scope::COMPUTE_SAMPLED;
/// The scope of the compose pass on the picture.
pub const COMPOSE_WRITES: Scope = Scope::COMPUTE_WRITTEN;
/// The scope of the copy that reads the picture.
pub const COPY_READS: Scope = Scope::COPIED_FROM;

/// Moves an image on from one use to the next.
pub fn barrier(gpu: &Gpu, cmd: vk::CommandBuffer, image: &Image, before: Scope, after: Scope) {
    let aspect = aspect_of(image.format);
    gpu.place(cmd, &ImageBarrier { image: image.raw, layer: 0, aspect, before, after });
}

fn aspect_of(format: vk::Format) -> vk::ImageAspectFlags {
    if format == vk::Format::D32_SFLOAT {
        vk::ImageAspectFlags::DEPTH
    } else {
        vk::ImageAspectFlags::COLOR
    }
}

fn whole(aspect: vk::ImageAspectFlags) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange {
        aspect_mask: aspect,
        level_count: 1,
        layer_count: 1,
        ..Default::default()
    }
}

/// A 2D image of one level, its view and its memory.
pub struct Image {
    pub raw: vk::Image,
    pub view: vk::ImageView,
    pub format: vk::Format,
    pub extent: [u32; 2],
    pub usage: vk::ImageUsageFlags,
    allocation: Allocation,
}

impl Image {
    /// An image in device memory, its content undefined.
    pub fn new(
        gpu: &mut Gpu,
        name: &str,
        format: vk::Format,
        extent: [u32; 2],
        usage: vk::ImageUsageFlags,
    ) -> Outcome<Self> {
        let [width, height] = extent;
        let create = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage);
        // SAFETY: the formats and usages in this engine are ones that every device has.
        let raw = unsafe { gpu.device.create_image(&create, None) }?;
        // SAFETY: the image was just made.
        let requirements = unsafe { gpu.device.get_image_memory_requirements(raw) };
        let allocation = allocate(gpu, name, requirements, MemoryLocation::GpuOnly, false)?;
        let aspect = aspect_of(format);
        let view = vk::ImageViewCreateInfo::default()
            .image(raw)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(whole(aspect));
        // SAFETY: the memory was allocated for this image and is kept beside it.
        let view = unsafe {
            gpu.device.bind_image_memory(raw, allocation.memory(), allocation.offset())?;
            gpu.device.create_image_view(&view, None)
        }?;
        Ok(Self { raw, view, format, extent, usage, allocation })
    }

    /// Destroys it; no frame may use it any more.
    pub fn destroy(self, gpu: &mut Gpu) {
        // SAFETY: the caller waited for every frame that uses it.
        unsafe {
            gpu.device.destroy_image_view(self.view, None);
            gpu.device.destroy_image(self.raw, None);
        }
        free(gpu, self.allocation);
    }
}

/// A buffer that the processor can see. (An engine would stage its geometry into device memory;
/// the node does not mind either way.)
pub struct Buffer {
    pub raw: vk::Buffer,
    allocation: Allocation,
}

impl Buffer {
    /// A buffer of `bytes` bytes.
    pub fn new(
        gpu: &mut Gpu,
        name: &str,
        bytes: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Outcome<Self> {
        let create = vk::BufferCreateInfo::default().size(bytes).usage(usage);
        // SAFETY: the device lives, and no buffer here is empty.
        let raw = unsafe { gpu.device.create_buffer(&create, None) }?;
        // SAFETY: the buffer was just made.
        let requirements = unsafe { gpu.device.get_buffer_memory_requirements(raw) };
        let allocation = allocate(gpu, name, requirements, location, true)?;
        // SAFETY: the memory was allocated for this buffer and is kept beside it.
        unsafe { gpu.device.bind_buffer_memory(raw, allocation.memory(), allocation.offset()) }?;
        Ok(Self { raw, allocation })
    }

    /// A buffer that holds `data`.
    pub fn with<T: bytemuck::NoUninit>(
        gpu: &mut Gpu,
        name: &str,
        data: &[T],
        usage: vk::BufferUsageFlags,
    ) -> Outcome<Self> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let mut new = Self::new(gpu, name, bytes.len() as u64, usage, MemoryLocation::CpuToGpu)?;
        new.write(&[bytes])?;
        Ok(new)
    }

    /// Writes these bytes, one behind the other, to the buffer's start; no running frame may read it.
    pub fn write(&mut self, parts: &[&[u8]]) -> Outcome<()> {
        let mut left = self.allocation.mapped_slice_mut().ok_or("the buffer is not mapped")?;
        for part in parts {
            let (first, rest) =
                left.split_at_mut_checked(part.len()).ok_or("the buffer is full")?;
            first.copy_from_slice(part);
            left = rest;
        }
        Ok(())
    }

    /// The buffer's content; no running frame may write it.
    pub fn read(&self) -> Outcome<&[u8]> {
        Ok(self.allocation.mapped_slice().ok_or("the buffer is not mapped")?)
    }

    /// Destroys it; no frame may use it any more.
    pub fn destroy(self, gpu: &mut Gpu) {
        // SAFETY: the caller waited for every frame that uses it.
        unsafe { gpu.device.destroy_buffer(self.raw, None) };
        free(gpu, self.allocation);
    }
}

fn allocate(
    gpu: &mut Gpu,
    name: &str,
    requirements: vk::MemoryRequirements,
    location: MemoryLocation,
    linear: bool,
) -> Outcome<Allocation> {
    Ok(gpu.allocator.allocate(&AllocationCreateDesc {
        name,
        requirements,
        location,
        linear,
        allocation_scheme: AllocationScheme::GpuAllocatorManaged,
    })?)
}

fn free(gpu: &mut Gpu, allocation: Allocation) {
    if let Err(problem) = gpu.allocator.free(allocation) {
        eprintln!("freeing memory: {problem}");
    }
}
