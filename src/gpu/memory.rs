//! The trait through which the node gets device memory from the host's allocator.

use crate::Error;
use ash::vk;
use std::any::Any;
use std::ptr::NonNull;

/// A request for memory for one image or buffer.
#[derive(Clone, Copy, Debug)]
pub struct MemoryRequest<'a> {
    /// The resource's name, for the allocator's own reports.
    pub name: &'a str,
    /// The size in bytes, the alignment and the allowed memory types.
    pub requirements: vk::MemoryRequirements,
    /// Whether the memory is for a buffer; otherwise it is for an image with optimal tiling.
    pub linear: bool,
    /// Whether the host reads the memory: it is then HOST_VISIBLE and HOST_COHERENT, cached where such a type exists, and
    /// mapped for as long as the block lives ([`MemoryBlock::mapped`]). Every device has such a type for buffers, and
    /// only buffers are requested so, of some hundred bytes each; other requests are for device-local memory.
    pub mapped: bool,
}

/// The address at which the host sees a mapped range of device memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mapped(NonNull<u32>);

// SAFETY: the address is only read through, by volatile reads of whole words, which any thread may do while the memory
// stays mapped; `Mapped::new` has that promise.
unsafe impl Send for Mapped {}
// SAFETY: as above.
unsafe impl Sync for Mapped {}

impl Mapped {
    /// The address of a range's first byte; `None` where it is no multiple of 4.
    ///
    /// # Safety
    /// The whole range of a [`MemoryBlock`] is mapped there, in coherent memory, until the block is freed.
    pub unsafe fn new(address: NonNull<std::ffi::c_void>) -> Option<Self> {
        let words = address.cast::<u32>();
        words.is_aligned().then_some(Self(words))
    }

    /// Reads the first words of the range. The device may be writing them.
    pub(super) fn read<const WORDS: usize>(self) -> [u32; WORDS] {
        // SAFETY: the promise of `new`; the node's buffers hold as many words as it reads.
        std::array::from_fn(|nth| unsafe { self.0.add(nth).read_volatile() })
    }
}

/// An allocated range of device memory.
pub struct MemoryBlock {
    /// The memory object.
    pub memory: vk::DeviceMemory,
    /// The offset of the range in the memory object, in bytes.
    pub offset: u64,
    /// The address of the range where the request wants it mapped; `None` otherwise.
    pub mapped: Option<Mapped>,
    /// What the allocator needs to free the range.
    pub token: Box<dyn Any + Send + Sync>,
}

/// The host's allocator of device memory.
pub trait Allocator {
    /// Allocates memory: device-local, or mapped where [`MemoryRequest::mapped`] wants that.
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
                location: match request.mapped {
                    true => gpu_allocator::MemoryLocation::GpuToCpu,
                    false => gpu_allocator::MemoryLocation::GpuOnly,
                },
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
        let address = allocation.mapped_ptr().filter(|_| request.mapped);
        // SAFETY: GpuToCpu is coherent memory, which stays mapped while the allocation does.
        let mapped = address.and_then(|address| unsafe { Mapped::new(address) });
        let offset = allocation.offset();
        Ok(MemoryBlock { memory, offset, mapped, token: Box::new(allocation) })
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
