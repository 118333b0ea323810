//! The trait through which the node gets device memory from the host's allocator.

use crate::Error;
use ash::vk;
use std::any::Any;

/// A request for device-local memory for one image or buffer.
#[derive(Clone, Copy, Debug)]
pub struct MemoryRequest<'a> {
    /// The resource's name, for the allocator's own reports.
    pub name: &'a str,
    /// The size in bytes, the alignment and the allowed memory types.
    pub requirements: vk::MemoryRequirements,
    /// Whether the memory is for a buffer; otherwise it is for an image with optimal tiling.
    pub linear: bool,
}

/// An allocated range of device memory.
pub struct MemoryBlock {
    /// The memory object.
    pub memory: vk::DeviceMemory,
    /// The offset of the range in the memory object, in bytes.
    pub offset: u64,
    /// What the allocator needs to free the range.
    pub token: Box<dyn Any + Send + Sync>,
}

/// The host's allocator of device memory.
pub trait Allocator {
    /// Allocates device-local memory.
    ///
    /// # Errors
    /// [`Error::Memory`] where there is not enough.
    fn allocate(&mut self, request: &MemoryRequest) -> Result<MemoryBlock, Error>;

    /// Frees a range.
    fn free(&mut self, block: MemoryBlock);
}

#[cfg(feature = "gpu-allocator")]
impl Allocator for gpu_allocator::vulkan::Allocator {
    fn allocate(&mut self, request: &MemoryRequest) -> Result<MemoryBlock, Error> {
        use gpu_allocator::vulkan::{AllocationCreateDesc, AllocationScheme};
        let allocation = Self::allocate(
            self,
            &AllocationCreateDesc {
                name: request.name,
                requirements: request.requirements,
                location: gpu_allocator::MemoryLocation::GpuOnly,
                linear: request.linear,
                allocation_scheme: AllocationScheme::GpuAllocatorManaged,
            },
        )
        .map_err(|e| Error::Memory {
            resource: request.name.into(),
            bytes: request.requirements.size,
            problem: e.to_string(),
        })?;
        // SAFETY: the memory object is only bound to, and the allocation is kept in the token until
        // it is freed, so it outlives every binding.
        let memory = unsafe { allocation.memory() };
        Ok(MemoryBlock { memory, offset: allocation.offset(), token: Box::new(allocation) })
    }

    fn free(&mut self, block: MemoryBlock) {
        if let Ok(allocation) = block.token.downcast::<gpu_allocator::vulkan::Allocation>() {
            // Freeing fails only for another allocator's memory, which stays with that allocator.
            let _ = Self::free(self, *allocation);
        }
    }
}

/// The device memory that a resource of the node takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResourceBytes {
    /// The resource's name.
    pub name: &'static str,
    /// Bytes, alignment included.
    pub bytes: u64,
}
