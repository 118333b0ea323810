//! Checks of the images that a host lends for a frame; each error is a sentence that names the image.

use super::check::bad;
use super::{Description, Frame};
use crate::Error;
use crate::graph::{Scope, is_depth_format};
use crate::lent::{HostImage, Visibility};
use crate::stages::visibility;
use crate::techniques::room::Maps;
use ash::vk::{self, ImageLayout as Layout, ImageUsageFlags as Usage};

/// The properties that one of the host's images must have.
struct Wanted {
    name: &'static str,
    format: vk::Format,
    extent: [u32; 2],
    usage: Usage,
    /// Whether the node reads the image's content.
    read: bool,
}

impl Frame<'_> {
    /// Checks the frame's images against the description and the maps of its technique.
    ///
    /// # Errors
    /// [`Error::Frame`] for the first image that does not fit.
    pub(super) fn check_images(
        &self,
        description: &Description,
        drawn: &Maps,
    ) -> Result<(), Error> {
        let Description { extent, depth_format, mask_format, .. } = *description;
        let read = |name, format, extent| Wanted {
            name,
            format,
            extent,
            usage: Usage::SAMPLED,
            read: true,
        };
        check_image(&self.depth, &read("gbuffer.depth", depth_format, extent))?;
        match (&self.mask, mask_format) {
            (Some(mask), Some(format)) => check_image(mask, &read("gbuffer.mask", format, extent))?,
            (None, None) => {}
            _ => {
                return bad(
                    "a mask must be given each frame exactly where the description has one",
                );
            }
        }
        match (&self.normals, description.normals) {
            (Some(image), Some(normals)) => {
                check_image(image, &read("gbuffer.normal", normals.format, extent))?;
            }
            (None, None) => {}
            _ => {
                return bad(
                    "normals must be given each frame exactly where the description has them",
                );
            }
        }
        let written = Wanted {
            name: "visibility",
            format: visibility::format(description.has_color()),
            extent,
            usage: Usage::STORAGE,
            read: false,
        };
        match (&self.visibility, description.lent_visibility) {
            (Visibility::Lent(image), true) => {
                check_image(image, &written)?;
                self.check_alone(image)?;
            }
            (Visibility::Own { before, after }, false) => {
                check_scopes(written.name, [before, after], visibility::USAGE, false)?;
            }
            _ => {
                return bad(
                    "a visibility image must be lent each frame exactly where the description says \
                     lent_visibility",
                );
            }
        }
        match (&self.light_texture, description.light_texture) {
            (Some(image), Some(texture)) => {
                check_image(image, &read("light.texture", texture.format, image.extent))?;
            }
            (None, None) => {}
            _ => {
                return bad(
                    "a light texture must be lent each frame exactly where the description has one",
                );
            }
        }
        let (maps, format) = match (&self.occluder_maps, description.occluder_maps) {
            (Some(maps), Some(format)) => (maps, format),
            (None, None) => return Ok(()),
            _ => {
                return bad(
                    "occluder maps must be lent each frame exactly where the description has a \
                     format for them",
                );
            }
        };
        if self.window.is_some() {
            return bad("the occluder maps have a window of their own; give no other");
        }
        let sides = [drawn.side; 2];
        check_image(&maps.front, &read("occluder_maps.front", format, sides))?;
        match &maps.back {
            Some(back) => check_image(back, &read("occluder_maps.back", format, sides)),
            None if !drawn.layers.back => Ok(()),
            None => bad("occluder_maps.back is missing; lend it, or set sides=one"),
        }
    }

    /// Checks that the image that the node writes is none of those that it reads.
    fn check_alone(&self, written: &HostImage) -> Result<(), Error> {
        let maps = self.occluder_maps.as_ref();
        let read = [
            ("gbuffer.depth", Some(&self.depth)),
            ("gbuffer.mask", self.mask.as_ref()),
            ("gbuffer.normal", self.normals.as_ref()),
            ("light.texture", self.light_texture.as_ref()),
            ("occluder_maps.front", maps.map(|m| &m.front)),
            ("occluder_maps.back", maps.and_then(|m| m.back.as_ref())),
        ];
        let same =
            |(_, read): &(_, Option<&HostImage>)| read.is_some_and(|r| r.image == written.image);
        match read.into_iter().find(same) {
            Some((name, _)) => bad(format!(
                "visibility is the image that is lent as {name}; what is written needs one of its own"
            )),
            None => Ok(()),
        }
    }
}

fn check_image(image: &HostImage, wanted: &Wanted) -> Result<(), Error> {
    let Wanted { name, format, extent: [w, h], usage, read } = *wanted;
    if image.image == vk::Image::null() || image.view == vk::ImageView::null() {
        return bad(format!("{name}: its image or view is a null handle"));
    }
    if image.extent.contains(&0) {
        let [iw, ih] = image.extent;
        return bad(format!(
            "{name} is {iw}×{ih}, which is no image; say the size it was created with"
        ));
    }
    if image.extent != [w, h] {
        let [iw, ih] = image.extent;
        return bad(format!(
            "{name} is {iw}×{ih}, where this node is made for {w}×{h}; resize the node, or lend an \
             image of its size"
        ));
    }
    if image.format != format {
        return bad(format!(
            "{name} has the format {:?}, where {format:?} was described",
            image.format
        ));
    }
    if !image.usage.contains(usage) {
        return bad(format!(
            "{name} was created without {usage:?} usage ({:?}), which the node needs of it",
            image.usage
        ));
    }
    let before = image.before.layout;
    if read && matches!(before, Layout::UNDEFINED | Layout::PREINITIALIZED) {
        return bad(format!(
            "{name}: nothing is in an image whose layout before the node is {before:?}; say in `before` which layout \
             the host's last pass leaves it in (behind handed_back() that is the layout of `after`, which must then \
             name one)"
        ));
    }
    check_scopes(name, [&image.before, &image.after], image.usage, is_depth_format(format))
}

/// Checks the host's scopes before and after the node: an image of this usage must be able to be in their layouts, and
/// each must name a stage.
fn check_scopes(
    name: &str,
    [before, after]: [&Scope; 2],
    usage: Usage,
    depth: bool,
) -> Result<(), Error> {
    if after.layout == Layout::PREINITIALIZED {
        return bad(format!("{name}: no image can be brought into the layout PREINITIALIZED"));
    }
    for (scope, when) in [(before, "before"), (after, "after")] {
        let layout = scope.layout;
        if let Some(other) = foreign(layout, depth) {
            return bad(format!("{name}: {layout:?} is a layout of {other}, which it is not"));
        }
        let any = usages_of(layout);
        if !any.is_empty() && !usage.intersects(any) {
            return bad(format!(
                "{name}: only an image with {any:?} usage can be in {layout:?}, as it is said to be {when} the \
                 node; it was created with {usage:?}"
            ));
        }
        if scope.stage.is_empty() {
            return bad(format!(
                "{name}: its use {when} the node names no pipeline stage; TOP_OF_PIPE is for what has none"
            ));
        }
    }
    Ok(())
}

/// The usages of which an image needs at least one to be in a layout; empty where any usage will do.
fn usages_of(layout: Layout) -> Usage {
    match layout {
        Layout::COLOR_ATTACHMENT_OPTIMAL => Usage::COLOR_ATTACHMENT,
        Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL
        | Layout::DEPTH_ATTACHMENT_OPTIMAL
        | Layout::DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL
        | Layout::DEPTH_ATTACHMENT_STENCIL_READ_ONLY_OPTIMAL => Usage::DEPTH_STENCIL_ATTACHMENT,
        Layout::DEPTH_STENCIL_READ_ONLY_OPTIMAL | Layout::DEPTH_READ_ONLY_OPTIMAL => {
            Usage::DEPTH_STENCIL_ATTACHMENT | Usage::SAMPLED | Usage::INPUT_ATTACHMENT
        }
        Layout::SHADER_READ_ONLY_OPTIMAL => Usage::SAMPLED | Usage::INPUT_ATTACHMENT,
        Layout::TRANSFER_SRC_OPTIMAL => Usage::TRANSFER_SRC,
        Layout::TRANSFER_DST_OPTIMAL => Usage::TRANSFER_DST,
        _ => Usage::empty(),
    }
}

/// The kind of image that a layout is for, where this image is of another kind.
fn foreign(layout: Layout, depth: bool) -> Option<&'static str> {
    match layout {
        Layout::COLOR_ATTACHMENT_OPTIMAL if depth => Some("color attachments"),
        Layout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL
        | Layout::DEPTH_STENCIL_READ_ONLY_OPTIMAL
        | Layout::DEPTH_ATTACHMENT_OPTIMAL
        | Layout::DEPTH_READ_ONLY_OPTIMAL
        | Layout::DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL
        | Layout::DEPTH_ATTACHMENT_STENCIL_READ_ONLY_OPTIMAL
            if !depth =>
        {
            Some("depth images")
        }
        _ => None,
    }
}
