//! The node's own visibility image: a layer for each light.

use super::maker::Maker;
use super::memory::ResourceBytes;
use super::objects::{Backed, Object, layers, name};
use super::owner::Made;
use crate::Error;
use crate::frame::Description;
use crate::graph::{Owner, Resource, Shape};
use crate::stages::visibility;
use ash::vk;

/// The visibility image, a view of the whole of it, and views of its layers.
pub(crate) struct ResultImage {
    backed: Backed,
    /// A view for each light; empty where there is one light, for which the whole image's view serves.
    views: Vec<vk::ImageView>,
}

impl ResultImage {
    /// Creates the image, unless the host lends it.
    pub fn new(maker: &mut Maker, description: &Description) -> Result<Option<Self>, Error> {
        if description.lent_visibility {
            return Ok(None);
        }
        let [width, height] = description.extent;
        let format = visibility::format(description.has_color());
        let several = (description.lights > 1).then_some(description.lights);
        let shape = Shape::Image { format, width, height, layers: several };
        let resource = Resource { name: "visibility", shape, owner: Owner::Exported, until: None };
        let backed = Backed::image(maker, &resource, visibility::USAGE)?;
        let (image, _) = backed.object.image();
        let view_of = |layer| {
            let create = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(format)
                .subresource_range(layers(vk::ImageAspectFlags::COLOR, layer, 1));
            // SAFETY: the image is bound and has that layer.
            let view = unsafe { maker.host.device.create_image_view(&create, None) }
                .map_err(Error::vulkan("creating a layer of visibility"))?;
            name(maker.host, view, resource.name);
            Ok(maker.keep(view))
        };
        let views = (0..several.unwrap_or(0)).map(view_of).collect::<Result<_, _>>()?;
        Ok(Some(Self { backed, views }))
    }

    /// The image and the view of the whole of it.
    pub fn image(&self) -> (vk::Image, vk::ImageView) {
        self.backed.object.image()
    }

    /// The image and the view of a light's layer.
    pub fn layer(&self, light: u32) -> Object {
        let (image, all) = self.image();
        let view = self.views.get(light as usize).copied().unwrap_or(all);
        Object::Image { image, view }
    }

    /// The image's name and the bytes of its memory.
    pub fn memory(&self) -> ResourceBytes {
        ResourceBytes { name: self.backed.name, bytes: self.backed.bytes }
    }

    /// The handles that an owner keeps for the image.
    pub fn handles(&self) -> impl Iterator<Item = Made> + '_ {
        self.backed.object.handles().into_iter().chain(self.views.iter().map(|&view| view.into()))
    }
}
