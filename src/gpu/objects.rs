//! The images and buffers of a graph that are the node's own.

use super::host::Host;
use super::memory::{Allocator, MemoryBlock, MemoryRequest};
use crate::Error;
use crate::graph::{Graph, Owner, ResourceId, Shape};
use ash::vk::{self, Handle};
use std::ffi::CString;

/// The Vulkan object behind a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Object {
    /// An image of the node's.
    Image { image: vk::Image, view: vk::ImageView },
    /// A buffer of the node's.
    Buffer(vk::Buffer),
    /// The host gives it frame by frame, or no row touches it.
    None,
}

/// One object and its memory.
struct Owned {
    object: Object,
    block: Option<MemoryBlock>,
    name: &'static str,
    bytes: u64,
}

/// Everything the node owns of a graph, in the order of the graph's resources.
pub(crate) struct Objects(Vec<Owned>);

impl Objects {
    /// Makes every transient and exported resource that a row touches.
    /// With `inspect` every image can be copied from.
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
        let mut owned = Owned { object: Object::None, block: None, name: resource.name, bytes: 0 };
        if matches!(resource.owner, Owner::Imported | Owner::Lent) || !touched {
            return Ok(owned);
        }
        let result = match resource.shape {
            Shape::Image { .. } => owned.image(host, allocator, graph, id, inspect),
            Shape::Buffer { bytes } => owned.buffer(host, allocator, graph, id, bytes),
        };
        match result {
            Ok(()) => Ok(owned),
            Err(e) => {
                owned.destroy(host, allocator);
                Err(e)
            }
        }
    }

    /// Makes anew what has another shape in `graph`, and gives back what it replaced; nothing is
    /// changed where that fails.
    pub fn remake(
        &mut self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        changed: impl Fn(ResourceId) -> bool,
        inspect: bool,
    ) -> Result<Self, Error> {
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
        for (&index, new) in places.iter().zip(&mut made.0) {
            std::mem::swap(&mut self.0[index], new);
        }
        Ok(made)
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
    fn image(
        &mut self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        id: ResourceId,
        inspect: bool,
    ) -> Result<(), Error> {
        let resource = graph.resource(id);
        let Shape::Image { format, width, height, layers } = resource.shape else { return Ok(()) };
        let mut usage = graph
            .uses_of(id)
            .fold(vk::ImageUsageFlags::empty(), |usage, access| usage | access.image_usage());
        if resource.owner == Owner::Exported {
            // What hosts do with the result: sample it, or copy it out.
            usage |= vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_SRC;
        }
        if inspect {
            usage |= vk::ImageUsageFlags::TRANSFER_SRC;
        }
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
        bytes: u64,
    ) -> Result<(), Error> {
        let resource = graph.resource(id);
        let usage = graph
            .uses_of(id)
            .fold(vk::BufferUsageFlags::empty(), |usage, access| usage | access.buffer_usage());
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

    fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        match self.object {
            Object::Image { image, view } => {
                // SAFETY: made by this device; Host::borrow's promise: no command uses them any
                // more. A null view is legal to destroy.
                unsafe { host.device.destroy_image_view(view, None) };
                // SAFETY: as above; its only view is gone.
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
    vk::ImageSubresourceRange::default()
        .aspect_mask(aspect)
        .level_count(1)
        .layer_count(vk::REMAINING_ARRAY_LAYERS)
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
