//! Checks of a frame's numbers and meshes, and of what an audit needs; each error is a sentence that names the host's own
//! field.

use super::boxes::Boxes;
use super::{Description, Frame};
use crate::light::{LENGTHS, Light, Shape};
use crate::stages::depth_layers::LightBox;
use crate::techniques::room::{HostDraws, Room, Shapes, Takes};
use crate::{Error, Technique};
use glam::DMat3;

/// The pixels that an audit may trace in a frame.
const AUDITED: std::ops::RangeInclusive<u32> = 16..=65_536;

pub(super) fn bad<T>(what: impl Into<String>) -> Result<T, Error> {
    Err(Error::Frame(what.into()))
}

/// Checks that a technique accepts a light's shape. The sentence names those that do.
///
/// # Errors
/// [`Error::Frame`] for a light that it does not accept.
fn check_shape(light: &Light, technique: &str, takes: &Takes) -> Result<(), Error> {
    if takes.shapes.hold(light) {
        return Ok(());
    }
    let takes_some = |shapes: Shapes| shapes != Shapes::ALL && shapes.hold(light);
    let all = Technique::all();
    let others = all.iter().filter(|other| takes_some(other.room().takes().shapes));
    let mut others: String = others.map(|other| format!("{}, ", other.name())).collect();
    if !others.is_empty() {
        others.push_str("or ");
    }
    let (shape, these) = match light.shape() {
        // Only those that shine to all sides are refused.
        Shape::Point => ("point that shines to all sides", "such points".into()),
        shape => (shape.name(), format!("{}s", shape.name())),
    };
    bad(format!(
        "the light is a {shape}, and {technique} takes no {these}; choose {others}traced, which takes every shape"
    ))
}

/// Checks that a texture can lie on a light: it covers the rectangle around a flat one.
///
/// # Errors
/// [`Error::Frame`] for a light that is not flat.
fn check_textured(light: &Light) -> Result<(), Error> {
    match light.shape() {
        Shape::Rectangle | Shape::Polygon(_) | Shape::Disc { .. } | Shape::Sun { .. } => Ok(()),
        shape => bad(format!(
            "the light is a {}, which is not flat, and a light texture lies on flat ones; leave light_texture out",
            shape.name()
        )),
    }
}

impl Description {
    /// Checks the number of audited pixels, and that their exact fraction can be traced.
    ///
    /// # Errors
    /// See [`Self::check`].
    pub(super) fn check_audit(&self) -> Result<(), Error> {
        let refuse = |what: &str| Err(Error::Frame(format!("{what}; set audit to 0")));
        match self.audit {
            0 => Ok(()),
            _ if self.occluder_maps.is_some() => refuse(
                "an audit traces triangles, and where the host lends occluder maps the node has none",
            ),
            _ if self.light_texture.is_some() => {
                refuse("an audit traces lights of uniform emission, and the light has a texture")
            }
            pixels if AUDITED.contains(&pixels) => Ok(()),
            pixels => Err(Error::Frame(format!(
                "an audit of {pixels} pixels a frame is outside 16 to 65,536, and is 0 for none"
            ))),
        }
    }
}

impl Frame<'_> {
    /// Checks everything but the frame's meshes against a description and its first technique.
    ///
    /// # Errors
    /// [`Error::Frame`] for the first thing that does not fit.
    pub(super) fn check(&self, description: &Description, room: &dyn Room) -> Result<(), Error> {
        self.check_numbers(description, room.name(), &room.takes())?;
        self.check_images(description, &room.maps())
    }

    /// Checks the frame's indices, light, camera, window and reach: everything but images and meshes.
    ///
    /// # Errors
    /// [`Error::Frame`] for the first thing that does not fit.
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
        check_shape(&self.light, technique, takes)?;
        if description.light_texture.is_some() {
            check_textured(&self.light)?;
        }
        let [width, height] = self.light.rectangle().half_extents().map(|half| 2.0 * half);
        let is_point = self.light.shape() == Shape::Point;
        let is_length = |side: f64| LENGTHS.contains(&side);
        if !is_point && (!is_length(width) || !(height == 0.0 || is_length(height))) {
            return bad(format!(
                "the light is {width:e} by {height:e} m; a side must be from 1e-15 to 1e15 m, so scale the scene"
            ));
        }
        // A determinant that overflows or underflows says nothing about the matrix, which is refused too.
        if !self.world_from_ndc.is_finite() || !self.world_from_ndc.determinant().is_normal() {
            return bad("world_from_ndc must be finite and invertible");
        }
        self.check_background()?;
        check_turn(&self.world_from_normal)?;
        if let Some([min, max]) = self.window {
            // The shaders divide by the width in 32 bits.
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

    /// Checks the frame's meshes, whose `boxes` are these, against what a technique takes.
    ///
    /// # Errors
    /// [`Error::Frame`] for the first mesh that does not fit.
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

    /// Checks that an occluder, mesh number `place` of the frame, is near enough to the light for single precision.
    ///
    /// # Errors
    /// [`Error::Frame`] for one further away than 1e15 m.
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

/// How far the products of the columns of [`Frame::world_from_normal`] may be from those of unit vectors at right angles.
const TURNED: f64 = 1e-3;

/// Checks that a matrix turns normals, or mirrors them, and does nothing else.
///
/// # Errors
/// [`Error::Frame`] where it scales or shears.
fn check_turn(world_from_normal: &DMat3) -> Result<(), Error> {
    let off = world_from_normal.transpose() * *world_from_normal - DMat3::IDENTITY;
    if off.to_cols_array().iter().all(|c| c.abs() <= TURNED) {
        return Ok(());
    }
    bad(
        "world_from_normal must turn normals and do nothing else: its columns are unit vectors at right angles; for \
         normals in view space give the rotation of world_from_view",
    )
}
