//! Two frames in flight: while the device works on one, the processor records the next.

use crate::Outcome;
use crate::device::Gpu;
use crate::resources::Buffer;
use ash::vk;
use gpu_allocator::MemoryLocation;
use std::time::Duration;

/// The number of frames that are recorded before the device must have completed the first of them.
pub const FRAMES_IN_FLIGHT: usize = 2;

/// The notes on a frame that are printed once it is complete.
#[derive(Clone, Copy)]
pub struct FrameNotes {
    pub number: u64,
    pub extent: [u32; 2],
    /// The processor's time for planning.
    pub plan: Duration,
    pub record: Duration,
    /// Passes that the node recorded.
    pub passes: usize,
}

/// A command buffer, the fence behind it, and what it copies its picture into.
struct Slot {
    pool: vk::CommandPool,
    cmd: vk::CommandBuffer,
    done: vk::Fence,
    pixels: Option<Buffer>,
    running: Option<FrameNotes>,
}

/// Bytes of an image of a size, 4 a pixel.
pub fn bytes_of([width, height]: [u32; 2]) -> usize {
    width as usize * height as usize * 4
}

/// The frames in flight.
pub struct Frames(Vec<Slot>);

impl Frames {
    pub fn new(gpu: &Gpu) -> Outcome<Self> {
        let slot = |_| {
            let create = vk::CommandPoolCreateInfo::default()
                .flags(vk::CommandPoolCreateFlags::TRANSIENT)
                .queue_family_index(gpu.queue_family);
            // SAFETY: the family is the device's.
            let pool = unsafe { gpu.device.create_command_pool(&create, None) }?;
            let allocate = vk::CommandBufferAllocateInfo::default()
                .command_pool(pool)
                .level(vk::CommandBufferLevel::PRIMARY)
                .command_buffer_count(1);
            // SAFETY: the pool is new, and this is the only thread.
            let (cmd, done) = unsafe {
                let cmd = gpu.device.allocate_command_buffers(&allocate)?[0];
                (cmd, gpu.device.create_fence(&vk::FenceCreateInfo::default(), None)?)
            };
            Ok(Slot { pool, cmd, done, pixels: None, running: None })
        };
        (0..FRAMES_IN_FLIGHT).map(slot).collect::<Outcome<_>>().map(Self)
    }

    /// Waits until the frame that last had this slot is done, and gives it back; none at the start.
    /// All frames before it are done then too: a fence waits for everything submitted earlier.
    pub fn wait(&mut self, gpu: &Gpu, slot: usize) -> Outcome<Option<FrameNotes>> {
        let slot = &mut self.0[slot];
        let Some(notes) = slot.running.take() else { return Ok(None) };
        // SAFETY: the fence was submitted, and nobody else waits for it.
        unsafe {
            gpu.device.wait_for_fences(&[slot.done], true, u64::MAX)?;
            gpu.device.reset_fences(&[slot.done])?;
        }
        Ok(Some(notes))
    }

    /// A copy of the frame that [`Self::wait`] gave back last for this slot: the picture first.
    pub fn copy(&self, slot: usize, notes: &FrameNotes, number: usize) -> Outcome<&[u8]> {
        let all = self.0[slot].pixels.as_ref().ok_or("the slot has no picture yet")?.read()?;
        let bytes = bytes_of(notes.extent);
        Ok(&all[number * bytes..(number + 1) * bytes])
    }

    /// Begins a command buffer for `copies` images of a size to be copied out; the slot must have
    /// been waited for.
    pub fn begin(
        &mut self,
        gpu: &mut Gpu,
        slot: usize,
        extent: [u32; 2],
        copies: usize,
    ) -> Outcome<vk::CommandBuffer> {
        let slot = &mut self.0[slot];
        let bytes = bytes_of(extent) * copies;
        let fits = slot.pixels.as_ref().is_some_and(|b| b.read().is_ok_and(|p| p.len() >= bytes));
        if !fits {
            if let Some(old) = slot.pixels.take() {
                old.destroy(gpu);
            }
            let usage = vk::BufferUsageFlags::TRANSFER_DST;
            let location = MemoryLocation::GpuToCpu;
            slot.pixels = Some(Buffer::new(gpu, "pixels", bytes as u64, usage, location)?);
        }
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the slot's last commands are done.
        unsafe {
            gpu.device.reset_command_pool(slot.pool, vk::CommandPoolResetFlags::empty())?;
            gpu.device.begin_command_buffer(slot.cmd, &begin)?;
        }
        Ok(slot.cmd)
    }

    /// Copies images out for the processor, 4 bytes a pixel, and submits; nothing waits.
    pub fn submit(
        &mut self,
        gpu: &Gpu,
        slot: usize,
        images: &[(vk::Image, vk::ImageAspectFlags)],
        notes: FrameNotes,
    ) -> Outcome<()> {
        let slot = &mut self.0[slot];
        let pixels = slot.pixels.as_ref().ok_or("the slot was not begun")?;
        let [width, height] = notes.extent;
        let copy = |number: usize, aspect_mask| {
            [vk::BufferImageCopy::default()
                .buffer_offset((number * bytes_of(notes.extent)) as u64)
                .image_subresource(vk::ImageSubresourceLayers {
                    aspect_mask,
                    layer_count: 1,
                    ..Default::default()
                })
                .image_extent(vk::Extent3D { width, height, depth: 1 })]
        };
        let to_host = [vk::BufferMemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .buffer(pixels.raw)
            .size(vk::WHOLE_SIZE)];
        let cmds = [slot.cmd];
        let submit = [vk::SubmitInfo::default().command_buffers(&cmds)];
        let none = vk::DependencyFlags::empty();
        use vk::PipelineStageFlags as Stage;
        for (number, &(image, aspect)) in images.iter().enumerate() {
            let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
            let copy = copy(number, aspect);
            // SAFETY: the images are in the layout to be copied from and the buffer holds all of
            // them.
            unsafe {
                gpu.device.cmd_copy_image_to_buffer(slot.cmd, image, layout, pixels.raw, &copy);
            }
        }
        // SAFETY: `cmd` is recording; the fence is not signalled; this is the only thread that
        // submits.
        unsafe {
            gpu.device.cmd_pipeline_barrier(
                slot.cmd,
                Stage::TRANSFER,
                Stage::HOST,
                none,
                &[],
                &to_host,
                &[],
            );
            gpu.device.end_command_buffer(slot.cmd)?;
            gpu.device.queue_submit(gpu.queue, &submit, slot.done)?;
        }
        slot.running = Some(notes);
        Ok(())
    }

    /// Destroys it; every slot must have been waited for.
    pub fn destroy(self, gpu: &mut Gpu) {
        for slot in self.0 {
            // SAFETY: the slot's commands are done.
            unsafe {
                gpu.device.destroy_fence(slot.done, None);
                gpu.device.destroy_command_pool(slot.pool, None);
            }
            if let Some(pixels) = slot.pixels {
                pixels.destroy(gpu);
            }
        }
    }
}
