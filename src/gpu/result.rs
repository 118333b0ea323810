//! The node's own visibility image: a layer for each light.

use super::host::Host;
use super::memory::Allocator;
use super::objects::{Object, Owned, layers, name};
use crate::Error;
use crate::frame::Description;
use crate::graph::{Owner, Resource, Shape};
use crate::stages::visibility;
use ash::vk;

/// The image, a view of all of it, and views of its layers.
pub(crate) struct ResultImage {
    owned: Owned,
    /// One a light; empty where there is one light, whose view is that of the whole.
    views: Vec<vk::ImageView>,
}

impl ResultImage {
    /// Makes it, unless the host lends it; nothing is left behind where that fails.
    pub fn new(
        host: &Host,
        allocator: &mut dyn Allocator,
        description: &Description,
    ) -> Result<Option<Self>, Error> {
        if description.lent_visibility {
            return Ok(None);
        }
        let [width, height] = description.extent;
        let format = visibility::format(description.has_color());
        let several = (description.lights > 1).then_some(description.lights);
        let resource = Resource {
            name: "visibility",
            shape: Shape::Image { format, width, height, layers: several },
            owner: Owner::Exported,
        };
        let owned = Owned::new(resource.name, host, allocator, |owned, host, allocator| {
            owned.image(host, allocator, &resource, visibility::USAGE)
        })?;
        let mut made = Self { owned, views: Vec::new() };
        match (0..several.unwrap_or(0)).try_for_each(|layer| made.add_view(host, format, layer)) {
            Ok(()) => Ok(Some(made)),
            Err(e) => {
                made.destroy(host, allocator);
                Err(e)
            }
        }
    }

    fn add_view(&mut self, host: &Host, format: vk::Format, layer: u32) -> Result<(), Error> {
        let create = vk::ImageViewCreateInfo::default()
            .image(self.image().0)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(format)
            .subresource_range(layers(vk::ImageAspectFlags::COLOR, layer, 1));
        // SAFETY: the image is bound and has that layer.
        let view = unsafe { host.device.create_image_view(&create, None) }
            .map_err(Error::vulkan("creating a layer of visibility"))?;
        name(host, view, self.owned.name);
        self.views.push(view);
        Ok(())
    }

    /// The image and the view of all of it.
    pub fn image(&self) -> (vk::Image, vk::ImageView) {
        match self.owned.object {
            Object::Image { image, view } => (image, view),
            Object::Buffer(_) | Object::None => (vk::Image::null(), vk::ImageView::null()),
        }
    }

    /// The image and the view of a light's layer.
    pub fn layer(&self, light: u32) -> Object {
        let (image, all) = self.image();
        let view = self.views.get(light as usize).copied().unwrap_or(all);
        Object::Image { image, view }
    }

    /// Its name and bytes.
    pub fn memory(&self) -> (&'static str, u64) {
        (self.owned.name, self.owned.bytes)
    }

    /// How many Vulkan objects there are.
    pub fn count(&self) -> usize {
        2 + self.views.len()
    }

    /// Destroys it; no command may use it any more.
    pub fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        for view in self.views {
            // SAFETY: made by this device; Host::borrow's promise: no command uses it any more.
            unsafe { host.device.destroy_image_view(view, None) };
        }
        self.owned.destroy(host, allocator);
    }
}
