//! What a frame's numbers and meshes must be, each refusal a sentence in the host's words.

use super::boxes::Boxes;
use super::{Description, Frame};
use crate::Error;
use crate::stages::depth_layers::LightBox;
use crate::techniques::room::{HostDraws, Room, Takes};

/// Lengths in metres whose squares, and those over each other, single precision holds with room to spare.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-15..=1e15;

pub(super) fn bad<T>(what: impl Into<String>) -> Result<T, Error> {
    Err(Error::Frame(what.into()))
}

impl Frame<'_> {
    /// Whether everything but its meshes suits a node of this description, with its first technique.
    pub(super) fn check(&self, description: &Description, room: &dyn Room) -> Result<(), Error> {
        self.check_numbers(description, room.name(), &room.takes())?;
        self.check_images(description, &room.maps())
    }

    /// The same of all but its images.
    pub(super) fn check_numbers(
        &self,
        description: &Description,
        technique: &str,
        takes: &Takes,
    ) -> Result<(), Error> {
        if self.slot.0 >= description.frames_in_flight {
            return bad(format!(
                "frame slot {} does not exist; the description has {} frames in flight",
                self.slot.0, description.frames_in_flight
            ));
        }
        if self.light_index.0 >= description.lights {
            return bad(format!(
                "light {} does not exist; the description has {}, counted from 0",
                self.light_index.0, description.lights
            ));
        }
        if self.light.rectangle().is_line() && !takes.line {
            return bad(format!(
                "the light is a line, and {technique} needs an area; choose linear-light, many-lights or \
                 hard, or give the light a height"
            ));
        }
        let [width, height] = self.light.rectangle().half_extents().map(|half| 2.0 * half);
        if !LENGTHS.contains(&width) || !(height == 0.0 || LENGTHS.contains(&height)) {
            return bad(format!(
                "the light is {width:e} by {height:e} m; a side must be from 1e-15 to 1e15 m, so scale the scene"
            ));
        }
        if self.light.outline().is_some() && !takes.outline {
            return bad(format!(
                "the light is a polygon, and {technique} knows rectangles alone; choose linear-light or \
                 many-lights, or give its rectangle"
            ));
        }
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

    /// Whether the meshes of the frame, whose boxes are placed, suit a technique that takes this.
    pub(super) fn check_meshes(&self, boxes: &Boxes, takes: &Takes) -> Result<(), Error> {
        if let Some(index) = boxes.not_finite {
            return bad(format!("mesh {index}: its transform and bounds must be finite numbers"));
        }
        if let Some((index, problem)) = boxes.unsound {
            return bad(format!("mesh {index}: {problem}"));
        }
        let refused = match takes.host_draws {
            HostDraws::Any => None,
            HostDraws::Receivers(why) => boxes.host_drawn_blocker.zip(Some(why)),
            HostDraws::None(why) => boxes.host_drawn.zip(Some(why)),
        };
        match refused {
            Some((index, why)) => bad(format!(
                "mesh {index} is drawn by the host, which {why}; give its buffers, or choose another technique"
            )),
            None => Ok(()),
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
}
