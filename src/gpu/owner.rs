//! The owner of all Vulkan objects, which destroys them in the reverse order of creation.

use super::memory::MemoryBlock;
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

    /// Keeps an object with the memory that is bound to it.
    pub fn keep_bound(&mut self, handle: impl Into<Made>, block: Option<MemoryBlock>) {
        self.0.push(Kept { made: handle.into(), block });
    }

    /// The number of objects, without memory objects.
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

#[cfg(test)]
mod tests {
    use super::super::host::Host;
    use super::super::maker::Maker;
    use super::super::memory::{Allocator, MemoryRequest};
    use super::*;
    use crate::Error;
    use ash::vk::Handle;
    use std::any::Any;
    use std::cell::RefCell;
    use std::ffi::{CStr, c_void};
    use std::ptr;

    thread_local! {
        /// The objects that were destroyed and the memory that was freed, in order.
        static GONE: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
    }

    fn gone() -> Vec<String> {
        GONE.take()
    }

    extern "system" fn image(_: vk::Device, handle: vk::Image, _: *const c_void) {
        GONE.with_borrow_mut(|gone| gone.push(format!("image {}", handle.as_raw())));
    }

    extern "system" fn view(_: vk::Device, handle: vk::ImageView, _: *const c_void) {
        GONE.with_borrow_mut(|gone| gone.push(format!("view {}", handle.as_raw())));
    }

    /// A host whose device can destroy images and views, and nothing else.
    fn host() -> Host {
        let load = |name: &CStr| match name.to_bytes() {
            b"vkDestroyImage" => image as *const c_void,
            b"vkDestroyImageView" => view as *const c_void,
            _ => ptr::null(),
        };
        // SAFETY: both functions have the signatures of their names; ash calls no other one here.
        let device = unsafe { ash::Device::load_with(load, vk::Device::null()) };
        // SAFETY: nothing calls the instance.
        let instance = unsafe { ash::Instance::load_with(|_| ptr::null(), vk::Instance::null()) };
        // SAFETY: only the two functions above are called, and they accept every handle.
        unsafe { Host::borrow(instance, vk::PhysicalDevice::null(), device, 0) }
    }

    /// An allocator that numbers its pieces, and refuses the one of a given number.
    struct Numbered {
        next: u64,
        refused: u64,
    }

    impl Allocator for Numbered {
        fn allocate(&mut self, request: &MemoryRequest) -> Result<MemoryBlock, Error> {
            self.next += 1;
            if self.next == self.refused {
                let (resource, problem) = (request.name.into(), "refused".into());
                return Err(Error::Memory { resource, bytes: 0, problem });
            }
            let token: Box<dyn Any + Send + Sync> = Box::new(self.next);
            let memory = vk::DeviceMemory::from_raw(self.next);
            Ok(MemoryBlock { memory, offset: 0, mapped: None, token })
        }

        fn free(&mut self, block: MemoryBlock) {
            let number = block.token.downcast::<u64>().unwrap();
            GONE.with_borrow_mut(|gone| gone.push(format!("memory {number}")));
        }
    }

    /// Creates images with these numbers as handles, with memory and a view each.
    fn images(maker: &mut Maker, numbers: &[u64]) -> Result<(), Error> {
        for &number in numbers {
            let requirements = vk::MemoryRequirements::default();
            let request =
                MemoryRequest { name: "an image", requirements, linear: false, mapped: false };
            maker.allocate(vk::Image::from_raw(number), &request)?;
            maker.keep(vk::ImageView::from_raw(number));
        }
        Ok(())
    }

    #[test]
    fn the_latest_goes_first_and_memory_behind_its_image() {
        let (host, mut memory) = (host(), Numbered { next: 0, refused: 0 });
        let ((), owner) = Maker::run(&host, &mut memory, |m| images(m, &[1, 2])).unwrap();
        assert_eq!((owner.count(), gone().len()), (4, 0));
        owner.destroy(&host.device, |block| memory.free(block));
        assert_eq!(gone(), ["view 2", "image 2", "memory 2", "view 1", "image 1", "memory 1"]);
    }

    #[test]
    fn what_fails_leaves_nothing() {
        let (host, mut memory) = (host(), Numbered { next: 0, refused: 2 });
        assert!(Maker::run(&host, &mut memory, |m| images(m, &[1, 2])).is_err());
        assert_eq!(gone(), ["image 2", "view 1", "image 1", "memory 1"]);
    }

    #[test]
    fn what_is_replaced_keeps_its_order_and_its_memory() {
        let (host, mut memory) = (host(), Numbered { next: 0, refused: 0 });
        let ((), mut owner) = Maker::run(&host, &mut memory, |m| images(m, &[1, 2, 3])).unwrap();
        let ((), new) = Maker::run(&host, &mut memory, |m| images(m, &[4])).unwrap();
        let replaced =
            [3, 1].map(|n| [vk::Image::from_raw(n).into(), vk::ImageView::from_raw(n).into()]);
        let old = owner.exchange(replaced.as_flattened(), new);
        assert_eq!((old.count(), owner.count()), (4, 4));
        old.destroy(&host.device, |block| memory.free(block));
        assert_eq!(gone(), ["view 3", "image 3", "memory 3", "view 1", "image 1", "memory 1"]);
        owner.destroy(&host.device, |block| memory.free(block));
        assert_eq!(gone(), ["view 4", "image 4", "memory 4", "view 2", "image 2", "memory 2"]);
    }

    /// An object that another file destroyed would be destroyed twice, or need an undo of its own.
    #[test]
    fn no_other_file_destroys_an_object() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/gpu");
        let mut files = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("owner.rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                assert!(!text.contains(".destroy_"), "{}", path.display());
                files += 1;
            }
        }
        assert!(files > 9, "{files} files");
    }
}
