//! What a frame's numbers and images must be, each refusal a sentence in the host's words.

use super::boxes::Boxes;
use super::rows::wanted;
use super::{Description, Frame, HostImage, Visibility};
use crate::depth_layers::LightBox;
use crate::graph::is_depth_format;
use crate::light::outline;
use crate::settings::{Settings, Technique};
use crate::{Error, visibility};
use ash::vk::{self, ImageLayout as Layout, ImageUsageFlags as Usage};

/// Lengths in metres whose squares, and those over each other, single precision holds with room to spare.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-15..=1e15;

fn bad<T>(what: impl Into<String>) -> Result<T, Error> {
    Err(Error::Frame(what.into()))
}

/// What one of the host's images must be.
struct Wanted {
    name: &'static str,
    format: vk::Format,
    extent: [u32; 2],
    usage: Usage,
    /// Its content is read.
    read: bool,
}

/// Whether a technique divides by the light's area or works in both of its half-extents, and so has no
/// meaning for a line.
fn needs_area(technique: Technique) -> bool {
    matches!(
        technique,
        Technique::Pcss
            | Technique::BackProjection
            | Technique::SoftShadowMap
            | Technique::RayMarch
            | Technique::OcclusionTextures
    )
}

/// Whether a technique looks at the light's outline, and not at its rectangle alone.
fn takes_outlines(technique: Technique) -> bool {
    matches!(technique, Technique::LinearLight | Technique::ManyLights)
}

impl Frame<'_> {
    /// Whether everything but its meshes suits a node of this description, with these settings.
    pub(super) fn check(
        &self,
        description: &Description,
        settings: &Settings,
    ) -> Result<(), Error> {
        self.check_numbers(description, settings)?;
        self.check_images(description, settings)
    }

    /// The same of all but its images.
    pub(super) fn check_numbers(
        &self,
        description: &Description,
        settings: &Settings,
    ) -> Result<(), Error> {
        if self.slot >= description.frames_in_flight {
            return bad(format!(
                "frame slot {} does not exist; the description has {} frames in flight",
                self.slot, description.frames_in_flight
            ));
        }
        if self.light_index >= description.lights {
            return bad(format!(
                "light {} does not exist; the description has {}, counted from 0",
                self.light_index, description.lights
            ));
        }
        let technique = settings.technique;
        if self.light.is_line() && needs_area(technique) {
            return bad(format!(
                "the light is a line, and {} needs an area; choose linear-light, many-lights or \
                 hard, or give the light a height",
                technique.name()
            ));
        }
        let [width, height] = self.light.half_extents().map(|half| 2.0 * half);
        if !LENGTHS.contains(&width) || !(height == 0.0 || LENGTHS.contains(&height)) {
            return bad(format!(
                "the light is {width:e} by {height:e} m; a side must be from 1e-15 to 1e15 m, so scale the scene"
            ));
        }
        self.check_outline(technique)?;
        if !self.world_from_ndc.is_finite() || self.world_from_ndc.determinant() == 0.0 {
            return bad("world_from_ndc must be finite and invertible");
        }
        if let Some([min, max]) = self.window {
            let good = (0..2).all(|i| min[i].is_finite() && max[i].is_finite() && min[i] < max[i]);
            if !good {
                return bad("the occluder map's window must have finite tangents, least first");
            }
        }
        if let Some(reach) = self.reach.filter(|reach| reach.is_nan() || *reach <= 0.0) {
            return bad(format!(
                "the light's reach is {reach}, and must be above 0 metres; leave it out for a light that \
                 reaches everything"
            ));
        }
        Ok(())
    }

    /// Whether the meshes of the frame, whose boxes are placed, suit a technique.
    pub(super) fn check_meshes(&self, boxes: &Boxes, settings: &Settings) -> Result<(), Error> {
        if let Some(index) = boxes.not_finite {
            return bad(format!("mesh {index}: its transform and bounds must be finite numbers"));
        }
        match settings.technique {
            // A sample's place on the line is known on the device alone.
            Technique::LinearLight => boxes.host_drawn.map_or(Ok(()), |index| {
                bad(format!(
                    "mesh {index} is drawn by the host, which does not know where linear-light puts its \
                     samples; give its buffers, or choose another technique"
                ))
            }),
            Technique::OcclusionTextures => boxes.host_drawn_blocker.map_or(Ok(()), |index| {
                bad(format!(
                    "mesh {index} is drawn by the host, which cannot sort it into the slices of \
                     occlusion-textures; give its buffers, or choose another technique"
                ))
            }),
            _ => Ok(()),
        }
    }

    /// Whether an occluder, the mesh at a place of the frame's list, is near enough to be told in single precision.
    pub(super) fn check_reach(place: u32, of: &LightBox) -> Result<(), Error> {
        let reach = of.min.abs().max(of.max.abs()).max_element();
        if reach <= *LENGTHS.end() {
            return Ok(());
        }
        bad(format!(
            "mesh {place} blocks up to {reach:e} m from the light, and must within 1e15 m; cut it, or scale the scene"
        ))
    }

    fn check_outline(&self, technique: Technique) -> Result<(), Error> {
        let Some(corners) = self.outline else { return Ok(()) };
        if !takes_outlines(technique) {
            return bad(format!(
                "the light is a polygon, and {} knows rectangles alone; choose linear-light or \
                 many-lights, or leave outline out",
                technique.name()
            ));
        }
        if self.light.is_line() {
            return bad("the light is a line, which has no outline; leave outline out");
        }
        match outline::problem(corners, self.light.half_extents()) {
            Some(problem) => bad(format!("the light's outline: {problem}")),
            None => Ok(()),
        }
    }

    fn check_images(&self, description: &Description, settings: &Settings) -> Result<(), Error> {
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
        let written = Wanted {
            name: "visibility",
            format: visibility::format(description.has_color()),
            extent,
            usage: Usage::STORAGE,
            read: false,
        };
        match (&self.visibility, description.lent_visibility) {
            (Visibility::Lent(image), true) => check_image(image, &written)?,
            (Visibility::Own { .. }, false) => {}
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
        let wanted = wanted(settings);
        let sides = [wanted.map; 2];
        check_image(&maps.front, &read("occluder_maps.front", format, sides))?;
        match &maps.back {
            Some(back) => check_image(back, &read("occluder_maps.back", format, sides)),
            None if !wanted.back => Ok(()),
            None => bad("occluder_maps.back is missing; lend it, or set sides=one"),
        }
    }
}

fn check_image(image: &HostImage, wanted: &Wanted) -> Result<(), Error> {
    let Wanted { name, format, extent: [w, h], usage, read } = *wanted;
    if image.image == vk::Image::null() || image.view == vk::ImageView::null() {
        return bad(format!("{name}: its image or view is a null handle"));
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
            "{name}: nothing is in an image whose layout before the node is {before:?}; say which \
             layout the host's last pass leaves it in"
        ));
    }
    for layout in [before, image.after.layout] {
        if let Some(other) = foreign(layout, is_depth_format(format)) {
            return bad(format!("{name}: {layout:?} is a layout of {other}, which it is not"));
        }
    }
    Ok(())
}

/// What kind of image a layout is for, where that is another than this one.
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
