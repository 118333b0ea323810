//! The images and buffers of a graph that the node owns.

use super::host::Host;
use super::maker::Maker;
use super::memory::{Mapped, MemoryRequest, ResourceBytes};
use super::owner::Made;
use crate::Error;
use crate::graph::{Graph, Owner, Resource, ResourceId, Shape};
use ash::vk::{self, Handle};
use std::ffi::CString;

/// The Vulkan object of a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Object {
    /// An image that the node owns.
    Image { image: vk::Image, view: vk::ImageView },
    /// A buffer that the node owns.
    Buffer(vk::Buffer),
    /// No object: the host lends it each frame, it is the visibility image, or no pass uses it.
    None,
}

impl Object {
    /// The image and its view; null handles for an object that is no image.
    pub fn image(self) -> (vk::Image, vk::ImageView) {
        match self {
            Self::Image { image, view } => (image, view),
            Self::Buffer(_) | Self::None => Default::default(),
        }
    }

    /// The handles that an owner keeps for the object.
    pub(super) fn handles(self) -> Vec<Made> {
        match self {
            Self::Image { image, view } => vec![image.into(), view.into()],
            Self::Buffer(buffer) => vec![buffer.into()],
            Self::None => Vec::new(),
        }
    }
}

/// The object that was created for a resource, and the bytes of its memory.
#[derive(Clone, Copy)]
pub(super) struct Backed {
    pub object: Object,
    pub name: &'static str,
    pub bytes: u64,
    shape: Shape,
}

/// The objects for a graph without its visibility image, in the order of the graph's resources.
#[derive(Default)]
pub(crate) struct Objects(Vec<Backed>);

impl Objects {
    /// Creates every resource that the node owns and a pass uses. With `inspect` all of them can be copied from.
    pub fn new(maker: &mut Maker, graph: &Graph, inspect: bool) -> Result<Self, Error> {
        Self::default().resized(maker, graph, inspect)
    }

    /// The objects for `graph`, which has the same resources: those of unchanged shape are shared with `self`, the
    /// others are created.
    pub fn resized(&self, maker: &mut Maker, graph: &Graph, inspect: bool) -> Result<Self, Error> {
        let ids = (0..graph.resources().len()).map(|index| graph.id(index));
        let backed = ids.map(|id| match self.0.get(id.index()) {
            Some(backed) if !self.changes(graph, id) => Ok(*backed),
            _ => Backed::new(maker, graph, id, inspect),
        });
        backed.collect::<Result<_, _>>().map(Self)
    }

    /// Whether a resource has another shape in `graph`.
    pub fn changes(&self, graph: &Graph, id: ResourceId) -> bool {
        self.0[id.index()].shape != graph.resource(id).shape
    }

    /// The handles of the objects that `next`, the resized table of the same resources, does not share.
    pub fn replaced_by<'a>(&'a self, next: &'a Self) -> impl Iterator<Item = Made> + 'a {
        let pairs = self.0.iter().zip(&next.0).map(|(old, new)| (old.object, new.object));
        pairs.filter(|(old, new)| old != new).flat_map(|(old, _)| old.handles())
    }

    /// The object of a resource.
    pub fn get(&self, id: ResourceId) -> Object {
        self.0.get(id.index()).map_or(Object::None, |b| b.object)
    }

    /// Name and bytes of each object that has memory.
    pub fn memory(&self) -> impl Iterator<Item = ResourceBytes> + '_ {
        let bound = self.0.iter().filter(|b| b.bytes > 0);
        bound.map(|b| ResourceBytes { name: b.name, bytes: b.bytes })
    }
}

impl Backed {
    fn new(maker: &mut Maker, graph: &Graph, id: ResourceId, inspect: bool) -> Result<Self, Error> {
        let resource = graph.resource(id);
        let uses = || graph.uses_of(id);
        if !matches!(resource.owner, Owner::Transient | Owner::Kept) || uses().next().is_none() {
            let Resource { name, shape, .. } = *resource;
            return Ok(Self { object: Object::None, name, bytes: 0, shape });
        }
        match resource.shape {
            Shape::Image { .. } => {
                let mut usage =
                    uses().fold(vk::ImageUsageFlags::empty(), |u, a| u | a.image_usage());
                if inspect {
                    usage |= vk::ImageUsageFlags::TRANSFER_SRC;
                }
                Self::image(maker, resource, usage)
            }
            Shape::Buffer { bytes } => {
                let mut usage =
                    uses().fold(vk::BufferUsageFlags::empty(), |u, a| u | a.buffer_usage());
                if inspect {
                    usage |= vk::BufferUsageFlags::TRANSFER_SRC;
                }
                Self::buffer(maker, resource, bytes, usage)
            }
        }
    }

    /// Creates an image and a view of the whole of it.
    pub fn image(
        maker: &mut Maker,
        resource: &Resource,
        usage: vk::ImageUsageFlags,
    ) -> Result<Self, Error> {
        let host = maker.host;
        let Resource { name: text, shape, .. } = *resource;
        let doing = || format!("creating {text}");
        let Shape::Image { format, width, height, layers } = shape else {
            return Err(Error::Frame(format!("{text} is no image")));
        };
        let create = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(layers.unwrap_or(1))
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage);
        // SAFETY: the device is valid (Host::borrow); the size and usage are within what
        // Description::check and Requirements::check allow.
        let image =
            unsafe { host.device.create_image(&create, None) }.map_err(Error::vulkan(doing()))?;
        // SAFETY: the image was just made by this device.
        let requirements = unsafe { host.device.get_image_memory_requirements(image) };
        let request = MemoryRequest { name: text, requirements, linear: false, mapped: false };
        let (memory, offset, _) = maker.allocate(image, &request)?;
        // SAFETY: the image is unbound, and the memory was allocated for its requirements.
        unsafe { host.device.bind_image_memory(image, memory, offset) }
            .map_err(Error::vulkan(doing()))?;
        let aspect = match resource.is_depth() {
            true => vk::ImageAspectFlags::DEPTH,
            false => vk::ImageAspectFlags::COLOR,
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
        maker.keep(view);
        name(host, image, text);
        name(host, view, text);
        let object = Object::Image { image, view };
        Ok(Self { object, name: text, bytes: requirements.size, shape })
    }

    fn buffer(
        maker: &mut Maker,
        resource: &Resource,
        bytes: u64,
        usage: vk::BufferUsageFlags,
    ) -> Result<Self, Error> {
        let Resource { name, shape, .. } = *resource;
        let (buffer, bytes, _) = new_buffer(maker, name, bytes, usage, false)?;
        Ok(Self { object: Object::Buffer(buffer), name, bytes, shape })
    }
}

/// Creates a buffer in device memory, or in mapped memory: the buffer, the bytes of its memory, and its address.
pub(super) fn new_buffer(
    maker: &mut Maker,
    text: &'static str,
    bytes: u64,
    usage: vk::BufferUsageFlags,
    mapped: bool,
) -> Result<(vk::Buffer, u64, Option<Mapped>), Error> {
    let host = maker.host;
    let doing = || format!("creating {text}");
    let create = vk::BufferCreateInfo::default().size(bytes).usage(usage);
    // SAFETY: the device is valid (Host::borrow), and no pass uses a buffer of no bytes.
    let buffer =
        unsafe { host.device.create_buffer(&create, None) }.map_err(Error::vulkan(doing()))?;
    // SAFETY: the buffer was just made by this device.
    let requirements = unsafe { host.device.get_buffer_memory_requirements(buffer) };
    let request = MemoryRequest { name: text, requirements, linear: true, mapped };
    let (memory, offset, address) = maker.allocate(buffer, &request)?;
    // SAFETY: the buffer is unbound, and the memory was allocated for its requirements.
    unsafe { host.device.bind_buffer_memory(buffer, memory, offset) }
        .map_err(Error::vulkan(doing()))?;
    name(host, buffer, text);
    Ok((buffer, requirements.size, address))
}

/// The range of an image's only mip level and all of its layers.
pub(crate) fn whole(aspect: vk::ImageAspectFlags) -> vk::ImageSubresourceRange {
    layers(aspect, 0, vk::REMAINING_ARRAY_LAYERS)
}

/// The range of an image's only mip level and some of its layers.
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
