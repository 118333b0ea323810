//! Memory comes from the host's allocator, through one small trait.

use crate::Error;
use ash::vk;
use std::any::Any;

/// What the node asks an allocator for: device-local memory for one image or buffer.
#[derive(Clone, Copy, Debug)]
pub struct MemoryRequest<'a> {
    /// The resource's name, for the allocator's own reports.
    pub name: &'a str,
    /// Size, alignment and memory types.
    pub requirements: vk::MemoryRequirements,
    /// A buffer (linear) or an image with optimal tiling.
    pub linear: bool,
}

/// A piece of device memory.
pub struct MemoryBlock {
    /// The memory object.
    pub memory: vk::DeviceMemory,
    /// Where the piece starts, in bytes.
    pub offset: u64,
    /// Whatever the allocator needs to take it back.
    pub token: Box<dyn Any + Send + Sync>,
}

/// The host's allocator.
pub trait Allocator {
    /// Finds device-local memory.
    ///
    /// # Errors
    /// [`Error::Memory`] where there is none.
    fn allocate(&mut self, request: &MemoryRequest) -> Result<MemoryBlock, Error>;

    /// Takes a piece back.
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
            // It only fails for an allocation that is not this allocator's; that memory stays with
            // whoever it belongs to.
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
