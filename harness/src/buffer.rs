//! Buffers that the host and the device both see.

use crate::HeadlessDevice;
use antumbra::Error;
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use std::sync::PoisonError;

/// A buffer in host-visible, host-coherent, cached memory.
///
/// The host must not read or write it while the device uses it; after
/// [`HeadlessDevice::submit_and_wait`] it may.
#[derive(Debug)]
pub struct HostBuffer {
    device: HeadlessDevice,
    name: String,
    buffer: vk::Buffer,
    bytes: u64,
    /// `None` only until `new` is done and while it is dropped.
    allocation: Option<Allocation>,
}

impl HostBuffer {
    /// A buffer of `bytes` bytes, their contents undefined. `name` is for errors and debuggers.
    ///
    /// # Errors
    /// [`Error::Memory`] if there is no memory for it or `bytes` is 0, [`Error::Vulkan`] if the
    /// driver refuses.
    pub fn new(
        device: &HeadlessDevice,
        name: &str,
        bytes: u64,
        usage: vk::BufferUsageFlags,
    ) -> Result<Self, Error> {
        if bytes == 0 {
            let problem = "a buffer has at least one byte".into();
            return Err(Error::Memory { resource: name.into(), bytes, problem });
        }
        let info = vk::BufferCreateInfo::default().size(bytes).usage(usage);
        // SAFETY: the device lives; `info` names no extension structure.
        let buffer = unsafe { device.device().create_buffer(&info, None) }
            .map_err(Error::vulkan(format!("creating the buffer {name}")))?;
        // From here on, dropping `new` cleans up.
        let mut new =
            Self { device: device.clone(), name: name.into(), buffer, bytes, allocation: None };
        // SAFETY: the buffer was made above.
        let requirements = unsafe { device.device().get_buffer_memory_requirements(buffer) };
        let allocation = allocate(device, name, requirements, MemoryLocation::GpuToCpu, true)?;
        // SAFETY: offset and type come from the allocator for these requirements; bound once.
        let bound = unsafe {
            device.device().bind_buffer_memory(buffer, allocation.memory(), allocation.offset())
        };
        new.allocation = Some(allocation);
        bound.map_err(Error::vulkan(format!("binding memory to the buffer {name}")))?;
        Ok(new)
    }

    /// A copy of all that a buffer holds which was made to be copied from and is not in use.
    pub(crate) fn copy_of(
        device: &HeadlessDevice,
        name: &str,
        source: vk::Buffer,
        bytes: u64,
    ) -> Result<Self, Error> {
        let staging = Self::new(device, name, bytes, vk::BufferUsageFlags::TRANSFER_DST)?;
        device.submit_and_wait(|cmd| {
            let region = vk::BufferCopy::default().size(bytes);
            let barrier = vk::MemoryBarrier::default()
                .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
                .dst_access_mask(vk::AccessFlags::TRANSFER_READ);
            let (all, copy) =
                (vk::PipelineStageFlags::ALL_COMMANDS, vk::PipelineStageFlags::TRANSFER);
            let none = vk::DependencyFlags::empty();
            let raw = device.device();
            // SAFETY: recording; the barrier names stages that every queue has.
            unsafe { raw.cmd_pipeline_barrier(cmd, all, copy, none, &[barrier], &[], &[]) };
            // SAFETY: recording; both buffers hold that many bytes.
            unsafe { raw.cmd_copy_buffer(cmd, source, staging.buffer, &[region]) };
            Ok(())
        })?;
        Ok(staging)
    }

    /// A buffer that holds `data`.
    ///
    /// # Errors
    /// See [`Self::new`].
    pub fn with_data<T: bytemuck::NoUninit>(
        device: &HeadlessDevice,
        name: &str,
        data: &[T],
        usage: vk::BufferUsageFlags,
    ) -> Result<Self, Error> {
        let mut buffer = Self::new(device, name, size_of_val(data) as u64, usage)?;
        buffer.write(data)?;
        Ok(buffer)
    }

    /// Copies `data` to the buffer's start.
    ///
    /// # Errors
    /// [`Error::Frame`] if the buffer is smaller.
    pub fn write<T: bytemuck::NoUninit>(&mut self, data: &[T]) -> Result<(), Error> {
        let source: &[u8] = bytemuck::cast_slice(data);
        let (name, bytes) = (&self.name, self.bytes);
        let mapped = self.allocation.as_mut().and_then(Allocation::mapped_slice_mut);
        match mapped.and_then(|mapped| mapped.get_mut(..source.len())) {
            // The allocation may be larger than the buffer.
            Some(mapped) if source.len() as u64 <= bytes => {
                mapped.copy_from_slice(source);
                Ok(())
            }
            _ => Err(Error::Frame(format!(
                "buffer {name} holds {bytes} bytes, not the {} to be written",
                source.len()
            ))),
        }
    }

    /// The whole contents. Bytes past the last whole `T` are left out.
    pub fn read<T: bytemuck::AnyBitPattern>(&self) -> Vec<T> {
        let mapped = self.allocation.as_ref().and_then(Allocation::mapped_slice);
        let whole = usize::try_from(self.bytes).unwrap_or(usize::MAX);
        let bytes = mapped.unwrap_or_default();
        let bytes = &bytes[..whole.min(bytes.len())];
        let size = size_of::<T>().max(1);
        let bytes = &bytes[..bytes.len() / size * size];
        // Copied whole where memory lies as `T` does, which it all but always does.
        match bytemuck::try_cast_slice(bytes) {
            Ok(values) => values.to_vec(),
            Err(_) => bytes.chunks_exact(size).map(bytemuck::pod_read_unaligned).collect(),
        }
    }

    /// The buffer.
    pub fn raw(&self) -> vk::Buffer {
        self.buffer
    }

    /// The buffer's size in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The buffer's name.
    pub fn name(&self) -> &str {
        &self.name
    }
}

impl Drop for HostBuffer {
    fn drop(&mut self) {
        // SAFETY: made from this device, destroyed once; the device is done with it by contract.
        unsafe { self.device.device().destroy_buffer(self.buffer, None) };
        free(&self.device, self.allocation.take());
    }
}

/// Memory for one resource.
pub(crate) fn allocate(
    device: &HeadlessDevice,
    name: &str,
    requirements: vk::MemoryRequirements,
    location: MemoryLocation,
    linear: bool,
) -> Result<Allocation, Error> {
    let mut allocator = device.allocator().lock().unwrap_or_else(PoisonError::into_inner);
    let allocation_scheme = AllocationScheme::GpuAllocatorManaged;
    let description =
        AllocationCreateDesc { name, requirements, location, linear, allocation_scheme };
    allocator.allocate(&description).map_err(|problem| Error::Memory {
        resource: name.into(),
        bytes: requirements.size,
        problem: problem.to_string(),
    })
}

/// Gives memory back.
pub(crate) fn free(device: &HeadlessDevice, allocation: Option<Allocation>) {
    if let Some(allocation) = allocation {
        let mut allocator = device.allocator().lock().unwrap_or_else(PoisonError::into_inner);
        // It fails only for an allocation of another allocator, which this is not.
        let _ = allocator.free(allocation);
    }
}
