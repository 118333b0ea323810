//! Command buffers that are recorded once and submitted.

use crate::HeadlessDevice;
use antumbra::Error;
use ash::vk;
use std::time::{Duration, Instant};

/// Commands that were submitted. Dropping it waits until they are done, as [`Self::wait`] does.
#[must_use = "dropping it waits"]
pub struct Submitted {
    objects: OneShot,
    at: Instant,
}

impl Submitted {
    /// Waits until the commands are done; how long that took from the submit on. All they have written is visible to
    /// the host and to later submits then.
    ///
    /// # Errors
    /// [`Error::Vulkan`] or [`Error::DeviceLost`] if the driver says so.
    pub fn wait(mut self) -> Result<Duration, Error> {
        self.objects.wait()?;
        Ok(self.at.elapsed())
    }
}

impl Drop for Submitted {
    fn drop(&mut self) {
        // A lost device leaves nothing to wait for.
        let _ = self.objects.wait();
    }
}

impl HeadlessDevice {
    /// Records a command buffer, submits it and waits until it is done. For set-up and read-back;
    /// a frame loop wants [`Self::submit`], or command buffers of its own.
    ///
    /// All writes are visible to the host and to later submits afterwards.
    ///
    /// # Errors
    /// The error that `record` returns, and then nothing is submitted; [`Error::Vulkan`] if the driver
    /// refuses.
    pub fn submit_and_wait<T>(
        &self,
        record: impl FnOnce(vk::CommandBuffer) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.submit_timed(record).map(|(value, _)| value)
    }

    /// Submits commands, waits, and returns the time from the submit to the fence too; see [`Self::submit_and_wait`].
    ///
    /// # Errors
    /// See [`Self::submit_and_wait`].
    pub fn submit_timed<T>(
        &self,
        record: impl FnOnce(vk::CommandBuffer) -> Result<T, Error>,
    ) -> Result<(T, Duration), Error> {
        let (value, submitted) = self.submit(record)?;
        Ok((value, submitted.wait()?))
    }

    /// Records a command buffer and submits it without waiting: a frame in flight.
    ///
    /// # Errors
    /// See [`Self::submit_and_wait`].
    pub fn submit<T>(
        &self,
        record: impl FnOnce(vk::CommandBuffer) -> Result<T, Error>,
    ) -> Result<(T, Submitted), Error> {
        let device = self.device();
        let mut objects = OneShot::new(self)?;
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the command buffer is new, and no other thread knows its pool.
        unsafe { device.begin_command_buffer(objects.cmd, &begin) }
            .map_err(Error::vulkan("beginning a command buffer"))?;
        let value = record(objects.cmd)?;
        let to_host = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ | vk::AccessFlags::HOST_WRITE)];
        // SAFETY: the command buffer is recording, outside a render pass.
        unsafe {
            device.cmd_pipeline_barrier(
                objects.cmd,
                vk::PipelineStageFlags::ALL_COMMANDS,
                vk::PipelineStageFlags::HOST,
                vk::DependencyFlags::empty(),
                &to_host,
                &[],
                &[],
            );
        }
        // SAFETY: recording was begun above.
        unsafe { device.end_command_buffer(objects.cmd) }
            .map_err(Error::vulkan("ending a command buffer"))?;
        let at = Instant::now();
        self.submit_to_queue(&[objects.cmd], objects.fence)?;
        objects.submitted = true;
        Ok((value, Submitted { objects, at }))
    }
}

/// A command pool with one command buffer, and a fence.
struct OneShot {
    device: HeadlessDevice,
    pool: vk::CommandPool,
    cmd: vk::CommandBuffer,
    fence: vk::Fence,
    submitted: bool,
}

impl OneShot {
    fn new(device: &HeadlessDevice) -> Result<Self, Error> {
        let mut new = Self {
            device: device.clone(),
            pool: vk::CommandPool::null(),
            cmd: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            submitted: false,
        };
        let raw = device.device();
        let info = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::TRANSIENT)
            .queue_family_index(device.queue_family());
        // SAFETY: the family is one that the device was created with.
        new.pool = unsafe { raw.create_command_pool(&info, None) }
            .map_err(Error::vulkan("creating a command pool"))?;
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(new.pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(1);
        // SAFETY: the pool is new, and no other thread knows it.
        let cmds = unsafe { raw.allocate_command_buffers(&info) }
            .map_err(Error::vulkan("allocating a command buffer"))?;
        new.cmd = cmds[0];
        // SAFETY: the device lives.
        new.fence = unsafe { raw.create_fence(&vk::FenceCreateInfo::default(), None) }
            .map_err(Error::vulkan("creating a fence"))?;
        Ok(new)
    }

    /// Waits for the fence, where it was submitted and has not been waited for.
    fn wait(&mut self) -> Result<(), Error> {
        if !self.submitted {
            return Ok(());
        }
        // SAFETY: the fence was submitted.
        unsafe { self.device.device().wait_for_fences(&[self.fence], true, u64::MAX) }
            .map_err(Error::vulkan("waiting for a command buffer"))?;
        self.submitted = false;
        Ok(())
    }
}

impl Drop for OneShot {
    fn drop(&mut self) {
        let raw = self.device.device();
        // SAFETY: not submitted, or waited for, or the device is lost; null handles are allowed.
        unsafe { raw.destroy_fence(self.fence, None) };
        // SAFETY: as above; the pool frees its command buffer.
        unsafe { raw.destroy_command_pool(self.pool, None) };
    }
}
