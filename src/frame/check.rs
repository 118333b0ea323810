//! What a frame's numbers and meshes must be, each refusal a sentence in the host's words.

use super::boxes::Boxes;
use super::{Description, Frame};
use crate::Error;
use crate::light::outline;
use crate::settings::{Settings, Technique};
use crate::stages::depth_layers::LightBox;

/// Lengths in metres whose squares, and those over each other, single precision holds with room to spare.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-15..=1e15;

pub(super) fn bad<T>(what: impl Into<String>) -> Result<T, Error> {
    Err(Error::Frame(what.into()))
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
        // Of numbers so large or small that it is none, a determinant is not known either.
        if !self.world_from_ndc.is_finite() || !self.world_from_ndc.determinant().is_normal() {
            return bad("world_from_ndc must be finite and invertible");
        }
        self.check_background()?;
        if let Some([min, max]) = self.window {
            // Which the shaders divide by, in 32 bits.
            let is_width = |i: usize| ((max[i] - min[i]) as f32).is_normal() && min[i] < max[i];
            if !(0..2).all(is_width) {
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
        if let Some((index, problem)) = boxes.unsound {
            return bad(format!("mesh {index}: {problem}"));
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
}
