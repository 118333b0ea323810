//! The exact visible fraction: the light's area less the union of the blocking triangles, as they
//! are projected from the receiver onto the light's plane.
//!
//! ```text
//!     ▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔  the light's polygon, its bounding rectangle the square −1..1
//!      \ ··▒▒▒▒▒▒▒▒▒······ /   covered: a union, each part counted once however many cover it
//!       \  ◣   ◢◣         /
//!        \  \ /|         /     triangles of the boxes that meet the pyramid
//!         \  ◥◤         /
//!           \        /
//!             \   /
//!               r
//! ```
//!
//! No noise: what is left is rounding. A corner is placed on the light, in half-extents h of it,
//! within η = 16 · 2⁻⁵³ · D / h, where D is the distance from the receiver to that place: three
//! products and sums in each of the two light-space vectors, one product, sum and quotient more.
//! The area is then off by at most η / 4 times the length of the uncovered part's outline in
//! half-extents, ℓ (of 4, the square's area). The grid of the union (2⁻⁶⁰) is finer. For h = D / 20
//! and ℓ = 100 that is 9 · 10⁻¹³; it passes 10⁻⁹ where ℓ · D / h is above 2 · 10⁶.
//! The corners themselves are as exact as f64 holds them relative to the scene's centre, which
//! counts for more the nearer an occluder is to the receiver: 2⁻⁵³ of the scene's extent over the
//! distance between them, times D / h.
//!
//! Time goes with the triangles in the pyramid: of a mesh, where neighbours share corners, the edges
//! between them cancel and only outlines meet (0.3 ms a point in the penumbra of 5,650 triangles,
//! 11 ms of 360,000); loose triangles that all overlap cross each other, and time goes with the
//! crossings, hence with the square (14 ms for 1,000, 120 ms for 3,000).

use super::blockers::{Blockers, Region};
use super::polygon_light::PolygonLight;
use super::pyramid::{Apex, Frame, clip};
use super::trace::{Receiver, check_position_error};
use super::union::{MARGIN, Union, to_grid};
use crate::Error;
use crate::scene::Scene;
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;

/// Receivers further from the light than this many half-extents of it are refused: products of
/// coordinates would overflow.
pub(super) const FURTHEST: f64 = 1e100;

/// The blocking triangles of a scene, for exact visible fractions of a light with an area.
///
/// A line ([`crate::RectangleLight::line`]) has none and is refused: use
/// [`super::ExactLine`].
pub struct Exact {
    blockers: Blockers<[DVec3; 3]>,
    position_error: f64,
}

impl Exact {
    /// Builds the hierarchy over the instances that block light ([`crate::scene::Role::blocks`]).
    ///
    /// # Errors
    /// [`Error::Scene`] where an instance names a mesh or vertex that does not exist, or puts a
    /// vertex at a position that is not finite (or beyond 10¹⁸ m).
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        Ok(Self { blockers: Blockers::whole(scene)?, position_error: 0.0 })
    }

    /// Says how far, in metres, the receivers may lie off their surfaces beyond what f32
    /// arithmetic on scene-sized coordinates explains; not negative, 0 by default. As
    /// [`super::Sampling::with_position_error`], so that both compute from the same point.
    ///
    /// # Errors
    /// [`Error::Setting`] for an error that is negative or not finite.
    pub fn with_position_error(self, metres: f64) -> Result<Self, Error> {
        check_position_error(metres)?;
        Ok(Self { position_error: metres, ..self })
    }

    /// The distance that a receiver is moved off its surface along its normal, in metres: that of
    /// [`super::Tracer::offset`].
    pub fn offset(&self, light: &PolygonLight, position: DVec3) -> f64 {
        self.blockers.offset(light.frame().center, position, self.position_error)
    }

    /// The share of the light's area, 0..1, that a receiver on a surface sees: that of the point
    /// [`Self::offset`] above it. A surface that blocks then hides what of the light is under its
    /// horizon, and nothing else of it shadows the receiver.
    ///
    /// # Errors
    /// [`Error::Frame`] where the position or normal is not finite, or the receiver further away
    /// than 10¹⁰⁰ light sizes; [`Error::Light`] for a line.
    pub fn visible_fraction(
        &self,
        light: &PolygonLight,
        receiver: &Receiver,
    ) -> Result<f64, Error> {
        check(receiver, "the receiver")?;
        self.of_receiver(light, receiver, &mut Union::new())
    }

    /// The share of the light's area, 0..1, that a point sees.
    ///
    /// The point itself: a surface through it is seen edge-on and blocks nothing, so a point that
    /// rounding puts below its surface is in its shadow; [`Self::visible_fraction`] is the one
    /// that allows for it. A triangle wholly within [`Self::offset`] of the light's plane counts as
    /// one that lies in it, and does not block.
    ///
    /// # Errors
    /// [`Error::Frame`] where the point is not finite, or further away than 10¹⁰⁰ light sizes;
    /// [`Error::Light`] for a line.
    pub fn visible_from(&self, light: &PolygonLight, point: DVec3) -> Result<f64, Error> {
        let panel = self.offset(light, point);
        self.of_point(light, point - self.blockers.origin, panel, &mut Union::new())
    }

    /// The visible fraction from each receiver, on all cores, in the order they were given.
    ///
    /// Equal inputs give equal bits, whatever the number of cores.
    ///
    /// # Errors
    /// See [`Self::visible_fraction`].
    pub fn visible_fractions(
        &self,
        light: &PolygonLight,
        receivers: &[Receiver],
    ) -> Result<Vec<f64>, Error> {
        for (i, receiver) in receivers.iter().enumerate() {
            check(receiver, format_args!("receiver {i}"))?;
        }
        receivers
            .par_iter()
            .map_init(Union::new, |union, receiver| self.of_receiver(light, receiver, union))
            .collect()
    }

    fn of_receiver(
        &self,
        light: &PolygonLight,
        receiver: &Receiver,
        union: &mut Union,
    ) -> Result<f64, Error> {
        let Some(normal) = receiver.normal.try_normalize() else { return Ok(1.0) };
        let offset = self.offset(light, receiver.position);
        let from = receiver.position - self.blockers.origin + normal * offset;
        self.of_point(light, from, offset, union)
    }

    /// The visible fraction from a point relative to the blockers' origin. What lies within `panel` of the light's
    /// plane, be it the point or a triangle, counts as in it.
    fn of_point(
        &self,
        light: &PolygonLight,
        point: DVec3,
        panel: f64,
        union: &mut Union,
    ) -> Result<f64, Error> {
        let frame = light.frame().relative_to(self.blockers.origin);
        if !frame.rows.iter().all(|row| row.is_finite()) {
            return Err(Error::Light("it has no area; ask truth::ExactLine about a line, and truth::Tracer about a point".into()));
        }
        let apex = Apex::new(&frame, point);
        if !apex.local.is_finite() || apex.local.abs().max_element() > FURTHEST {
            return Err(Error::Frame(format!(
                "a receiver must be finite and within {FURTHEST:e} light sizes of the light \
                 (it is at {})",
                point + self.blockers.origin
            )));
        }
        if apex.local.z <= panel {
            return Ok(1.0);
        }
        union.clear();
        let mut corners = Vec::with_capacity(9);
        self.blockers.for_each_in(&pyramid(&frame, &apex, point), |triangle| {
            let rays = triangle.map(|corner| apex.ray_through(corner));
            if rays.iter().all(|ray| ray.z <= panel) {
                return;
            }
            let sides = rays.map(|ray| ray.sides(1.0));
            if (0..5).any(|side| sides.iter().all(|distances| distances[side] < 0.0)) {
                return;
            }
            // w = 0 is the point itself, where an edge-on triangle passes through it.
            let inside = clip(rays.to_vec(), MARGIN).into_iter().filter(|ray| ray.w > 0.0);
            corners.clear();
            corners.extend(inside.map(|ray| to_grid(ray.projected())));
            union.add(&mut corners);
        });
        Ok(union.uncovered(light.outline()))
    }
}

/// Refuses a receiver that is not finite.
pub(super) fn check(receiver: &Receiver, name: impl fmt::Display) -> Result<(), Error> {
    if receiver.position.is_finite() && receiver.normal.is_finite() {
        return Ok(());
    }
    Err(Error::Frame(format!(
        "{name} must have a finite position and normal (they are {} and {})",
        receiver.position, receiver.normal
    )))
}

/// The pyramid from a receiver to the light's bounding rectangle: its four sides, before the light's
/// plane, nearer to it than the receiver.
///
/// The normals are the gradients of [`super::pyramid::Ray::sides`], and of w.
fn pyramid(frame: &Frame, apex: &Apex, point: DVec3) -> Region<6> {
    let [x, y, z] = frame.rows;
    let r = apex.local;
    let (x, y, w) = (x * r.z - z * r.x, y * r.z - z * r.y, -z);
    let planes = [(w - x, 0.0), (w + x, 0.0), (w - y, 0.0), (w + y, 0.0), (z, r.z), (w, 0.0)];
    Region { apex: point, planes }
}

#[cfg(test)]
mod tests;
