//! The one owner of Vulkan objects: it destroys what it keeps in the reverse order of creation.

use super::host::Host;
use super::memory::{Allocator, MemoryBlock, MemoryRequest};
use crate::Error;
use ash::vk;

/// Declares [`Made`]: each kind of handle that an owner keeps, with the call that destroys it.
macro_rules! made {
    ($($kind:ident => $destroy:ident,)*) => {
        /// The handle of an object that an owner keeps.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Made {
            $($kind(vk::$kind),)*
        }

        $(impl From<vk::$kind> for Made {
            fn from(handle: vk::$kind) -> Self {
                Self::$kind(handle)
            }
        })*

        impl Made {
            fn destroy(self, device: &ash::Device) {
                match self {
                    // SAFETY: this device made the object, what was made of it later is destroyed
                    // already, and no command uses it any more (Host::borrow's promise).
                    $(Self::$kind(handle) => unsafe { device.$destroy(handle, None) },)*
                }
            }
        }
    };
}

made! {
    Buffer => destroy_buffer,
    DescriptorPool => destroy_descriptor_pool,
    DescriptorSetLayout => destroy_descriptor_set_layout,
    Framebuffer => destroy_framebuffer,
    Image => destroy_image,
    ImageView => destroy_image_view,
    Pipeline => destroy_pipeline,
    PipelineLayout => destroy_pipeline_layout,
    QueryPool => destroy_query_pool,
    RenderPass => destroy_render_pass,
    ShaderModule => destroy_shader_module,
}

/// An object, and the memory that is bound to it.
struct Kept {
    made: Made,
    block: Option<MemoryBlock>,
}

/// Vulkan objects and their memory, in order of creation.
///
/// An owner that is dropped leaks them: only [`Self::destroy`] knows the device and the allocator.
#[derive(Default)]
pub(crate) struct ObjectOwner(Vec<Kept>);

impl ObjectOwner {
    /// Keeps an object that has no memory of its own.
    pub fn keep<T: Copy + Into<Made>>(&mut self, handle: T) -> T {
        self.0.push(Kept { made: handle.into(), block: None });
        handle
    }

    /// The number of objects, memory apart.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Adopts `new` in place of the objects in `replaced`, and returns those.
    pub fn exchange(&mut self, replaced: &[Made], new: Self) -> Self {
        let old = self.0.extract_if(.., |kept| replaced.contains(&kept.made)).collect();
        self.0.extend(new.0);
        Self(old)
    }

    /// Destroys every object, the latest first, and passes its memory to `free`; no command may use
    /// the objects any more.
    pub fn destroy(self, device: &ash::Device, mut free: impl FnMut(MemoryBlock)) {
        for kept in self.0.into_iter().rev() {
            kept.made.destroy(device);
            kept.block.into_iter().for_each(&mut free);
        }
    }
}

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
    /// and the offset in it.
    pub fn allocate(
        &mut self,
        handle: impl Into<Made>,
        request: &MemoryRequest,
    ) -> Result<(vk::DeviceMemory, u64), Error> {
        let (block, place) = match self.allocator.allocate(request) {
            Ok(block) => {
                let place = (block.memory, block.offset);
                (Some(block), Ok(place))
            }
            Err(e) => (None, Err(e)),
        };
        self.owner.0.push(Kept { made: handle.into(), block });
        place
    }
}
