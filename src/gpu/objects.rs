//! The images and buffers of a graph that are the node's own.

use super::host::Host;
use super::memory::{Allocator, MemoryBlock, MemoryRequest};
use crate::Error;
use crate::graph::{Graph, Owner, Resource, ResourceId, Shape};
use ash::vk::{self, Handle};
use std::ffi::CString;

/// The Vulkan object behind a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Object {
    /// An image of the node's.
    Image { image: vk::Image, view: vk::ImageView },
    /// A buffer of the node's.
    Buffer(vk::Buffer),
    /// The host gives it frame by frame, it is the result, or no row touches it.
    None,
}

/// One object and its memory.
pub(super) struct Owned {
    pub object: Object,
    block: Option<MemoryBlock>,
    pub name: &'static str,
    pub bytes: u64,
}

/// Everything the node owns of a graph but its result, in the order of the graph's resources.
pub(crate) struct Objects(Vec<Owned>);

/// Those of [`Objects`] that have another shape, made anew beside them; then those that were replaced.
pub(crate) struct Remade {
    places: Vec<usize>,
    made: Objects,
}

impl Remade {
    /// Destroys them; no command may use them any more.
    pub fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        self.made.destroy(host, allocator);
    }
}

impl Objects {
    /// Makes every transient resource that a row touches.
    /// With `inspect` every one of them can be copied from.
    pub fn new(
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        inspect: bool,
    ) -> Result<Self, Error> {
        let mut made = Self(Vec::with_capacity(graph.resources().len()));
        for index in 0..graph.resources().len() {
            match Self::make(host, allocator, graph, index, inspect) {
                Ok(owned) => made.0.push(owned),
                Err(e) => {
                    made.destroy(host, allocator);
                    return Err(e);
                }
            }
        }
        Ok(made)
    }

    fn make(
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        index: usize,
        inspect: bool,
    ) -> Result<Owned, Error> {
        let id = graph.id(index);
        let resource = graph.resource(id);
        let touched = graph.uses_of(id).next().is_some();
        if !matches!(resource.owner, Owner::Transient | Owner::Kept) || !touched {
            return Ok(Owned::none(resource.name));
        }
        match resource.shape {
            Shape::Image { .. } => {
                let uses = graph.uses_of(id);
                let mut usage =
                    uses.fold(vk::ImageUsageFlags::empty(), |usage, a| usage | a.image_usage());
                if inspect {
                    usage |= vk::ImageUsageFlags::TRANSFER_SRC;
                }
                Owned::new(resource.name, host, allocator, |owned, host, allocator| {
                    owned.image(host, allocator, resource, usage)
                })
            }
            Shape::Buffer { bytes } => {
                Owned::new(resource.name, host, allocator, |owned, host, allocator| {
                    owned.buffer(host, allocator, graph, id, (bytes, inspect))
                })
            }
        }
    }

    /// Makes anew what has another shape in `graph`, to be exchanged; nothing is left behind where that
    /// fails.
    pub fn remake(
        &self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        changed: impl Fn(ResourceId) -> bool,
        inspect: bool,
    ) -> Result<Remade, Error> {
        let mut made = Self(Vec::new());
        let places: Vec<_> = (0..self.0.len()).filter(|&i| changed(graph.id(i))).collect();
        for &index in &places {
            match Self::make(host, allocator, graph, index, inspect) {
                Ok(owned) => made.0.push(owned),
                Err(e) => {
                    made.destroy(host, allocator);
                    return Err(e);
                }
            }
        }
        Ok(Remade { places, made })
    }

    /// Takes what was made anew, and leaves there what that replaces.
    pub fn exchange(&mut self, remade: &mut Remade) {
        for (&index, new) in remade.places.iter().zip(&mut remade.made.0) {
            std::mem::swap(&mut self.0[index], new);
        }
    }

    /// The object of a resource.
    pub fn get(&self, id: ResourceId) -> Object {
        self.0.get(id.index()).map_or(Object::None, |o| o.object)
    }

    /// Name and bytes of everything that has memory.
    pub fn memory(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        self.0.iter().filter(|o| o.bytes > 0).map(|o| (o.name, o.bytes))
    }

    /// How many images, views and buffers there are.
    pub fn count(&self) -> usize {
        let of = |o: &Owned| match o.object {
            Object::Image { .. } => 2,
            Object::Buffer(_) => 1,
            Object::None => 0,
        };
        self.0.iter().map(of).sum()
    }

    /// Destroys everything; no command may use it any more.
    pub fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        for owned in self.0 {
            owned.destroy(host, allocator);
        }
    }
}

impl Owned {
    fn none(name: &'static str) -> Self {
        Self { object: Object::None, block: None, name, bytes: 0 }
    }

    /// What `make` makes; nothing is left behind where that fails.
    pub fn new(
        name: &'static str,
        host: &Host,
        allocator: &mut dyn Allocator,
        make: impl FnOnce(&mut Self, &Host, &mut dyn Allocator) -> Result<(), Error>,
    ) -> Result<Self, Error> {
        let mut owned = Self::none(name);
        match make(&mut owned, host, allocator) {
            Ok(()) => Ok(owned),
            Err(e) => {
                owned.destroy(host, allocator);
                Err(e)
            }
        }
    }

    /// Makes an image and a view of all of it.
    pub fn image(
        &mut self,
        host: &Host,
        allocator: &mut dyn Allocator,
        resource: &Resource,
        usage: vk::ImageUsageFlags,
    ) -> Result<(), Error> {
        let Shape::Image { format, width, height, layers } = resource.shape else { return Ok(()) };
        let create = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(layers.unwrap_or(1))
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage);
        let doing = || format!("creating {}", resource.name);
        // SAFETY: the device is valid (Host::borrow); the size and usage are within what
        // Description::check and Requirements::check allow.
        let image =
            unsafe { host.device.create_image(&create, None) }.map_err(Error::vulkan(doing()))?;
        self.object = Object::Image { image, view: vk::ImageView::null() };
        // SAFETY: the image was just made by this device.
        let requirements = unsafe { host.device.get_image_memory_requirements(image) };
        let request = MemoryRequest { name: resource.name, requirements, linear: false };
        let block = self.block.insert(allocator.allocate(&request)?);
        self.bytes = requirements.size;
        // SAFETY: the image is unbound, and the block was allocated for its requirements.
        unsafe { host.device.bind_image_memory(image, block.memory, block.offset) }
            .map_err(Error::vulkan(doing()))?;
        let aspect = if resource.is_depth() {
            vk::ImageAspectFlags::DEPTH
        } else {
            vk::ImageAspectFlags::COLOR
        };
        let create = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(match layers {
                Some(_) => vk::ImageViewType::TYPE_2D_ARRAY,
                None => vk::ImageViewType::TYPE_2D,
            })
            .format(format)
            .subresource_range(whole(aspect));
        // SAFETY: the image is bound, and the view covers all that it has.
        let view = unsafe { host.device.create_image_view(&create, None) }
            .map_err(Error::vulkan(doing()))?;
        self.object = Object::Image { image, view };
        name(host, image, resource.name);
        name(host, view, resource.name);
        Ok(())
    }

    fn buffer(
        &mut self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        id: ResourceId,
        (bytes, inspect): (u64, bool),
    ) -> Result<(), Error> {
        let resource = graph.resource(id);
        let mut usage = graph
            .uses_of(id)
            .fold(vk::BufferUsageFlags::empty(), |usage, access| usage | access.buffer_usage());
        if inspect {
            usage |= vk::BufferUsageFlags::TRANSFER_SRC;
        }
        let create = vk::BufferCreateInfo::default().size(bytes).usage(usage);
        let doing = || format!("creating {}", resource.name);
        // SAFETY: the device is valid (Host::borrow), and no row asks for a buffer of no bytes.
        let buffer =
            unsafe { host.device.create_buffer(&create, None) }.map_err(Error::vulkan(doing()))?;
        self.object = Object::Buffer(buffer);
        // SAFETY: the buffer was just made by this device.
        let requirements = unsafe { host.device.get_buffer_memory_requirements(buffer) };
        let request = MemoryRequest { name: resource.name, requirements, linear: true };
        let block = self.block.insert(allocator.allocate(&request)?);
        self.bytes = requirements.size;
        // SAFETY: the buffer is unbound, and the block was allocated for its requirements.
        unsafe { host.device.bind_buffer_memory(buffer, block.memory, block.offset) }
            .map_err(Error::vulkan(doing()))?;
        name(host, buffer, resource.name);
        Ok(())
    }

    /// Destroys it; no command may use it any more.
    pub fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        match self.object {
            Object::Image { image, view } => {
                // SAFETY: made by this device; Host::borrow's promise: no command uses them any
                // more. A null view is legal to destroy.
                unsafe { host.device.destroy_image_view(view, None) };
                // SAFETY: as above; its views are gone.
                unsafe { host.device.destroy_image(image, None) };
            }
            // SAFETY: as above.
            Object::Buffer(buffer) => unsafe { host.device.destroy_buffer(buffer, None) },
            Object::None => {}
        }
        if let Some(block) = self.block {
            allocator.free(block);
        }
    }
}

/// The one level that every image here has, and all of its layers.
pub(crate) fn whole(aspect: vk::ImageAspectFlags) -> vk::ImageSubresourceRange {
    layers(aspect, 0, vk::REMAINING_ARRAY_LAYERS)
}

/// The same of some layers.
pub(crate) fn layers(
    aspect: vk::ImageAspectFlags,
    first: u32,
    count: u32,
) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default()
        .aspect_mask(aspect)
        .level_count(1)
        .base_array_layer(first)
        .layer_count(count)
}

/// Names an object `antumbra.<name>` for debuggers and the validation layer.
pub(crate) fn name<T: Handle>(host: &Host, object: T, name: &str) {
    let Some(debug_utils) = &host.debug_utils else { return };
    let Ok(text) = CString::new(format!("antumbra.{name}")) else { return };
    let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(object).object_name(&text);
    // SAFETY: the object was made by this device and is not used by another thread yet. A name that
    // cannot be set is no loss.
    let _ = unsafe { debug_utils.set_debug_utils_object_name(&info) };
}
