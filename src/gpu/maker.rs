//! Creates Vulkan objects for an owner, and undoes the creation where it fails.

use super::host::Host;
use super::memory::{Allocator, Mapped, MemoryRequest};
use super::owner::{Made, ObjectOwner};
use crate::Error;
use ash::vk;

/// Creates objects on a host's device, in its allocator's memory, for an owner.
pub(crate) struct Maker<'a> {
    pub host: &'a Host,
    allocator: &'a mut dyn Allocator,
    pub owner: ObjectOwner,
}

impl<'a> Maker<'a> {
    /// Runs `make`, and returns its value and the owner of every object that it created. Where `make`
    /// fails, those objects are destroyed: this is the only place that undoes a creation.
    pub fn run<T>(
        host: &'a Host,
        allocator: &'a mut dyn Allocator,
        make: impl FnOnce(&mut Self) -> Result<T, Error>,
    ) -> Result<(T, ObjectOwner), Error> {
        let mut maker = Self { host, allocator, owner: ObjectOwner::default() };
        match make(&mut maker) {
            Ok(value) => Ok((value, maker.owner)),
            Err(e) => {
                maker.owner.destroy(&host.device, |block| maker.allocator.free(block));
                Err(e)
            }
        }
    }

    /// Keeps an object that has no memory of its own.
    pub fn keep<T: Copy + Into<Made>>(&mut self, handle: T) -> T {
        self.owner.keep(handle)
    }

    /// Keeps an image or a buffer, and allocates its memory, which the caller binds: the memory object,
    /// the offset in it, and the address where it is mapped.
    pub fn allocate(
        &mut self,
        handle: impl Into<Made>,
        request: &MemoryRequest,
    ) -> Result<(vk::DeviceMemory, u64, Option<Mapped>), Error> {
        let (block, place) = match self.allocator.allocate(request) {
            Ok(block) => {
                let place = (block.memory, block.offset, block.mapped);
                (Some(block), Ok(place))
            }
            Err(e) => (None, Err(e)),
        };
        self.owner.keep_bound(handle, block);
        place
    }
}
