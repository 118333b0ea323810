//! The exact visible fraction of a line light: its length less the union of what the blocking triangles
//! hide of it.
//!
//! ```text
//!     A ────▒▒▒▒▒▒▒▒────▒▒▒▒──── B   the light, −1..1: hidden is a union of intervals
//!       \     \     /  /   /
//!        \     \   /  ╱───╱          each triangle cuts the plane of A, B and the receiver in
//!         \     ╲─╱                  a straight piece, which hides an interval
//!           \       /
//!               r
//! ```
//!
//! Only one plane matters to a receiver, so this is two dimensions where [`super::exact`] has three. A
//! triangle that lies in that plane is seen edge-on and hides nothing, as with the tracer; one that
//! touches it with an edge hides what the edge does.
//!
//! No noise: what is left is rounding. An end of an interval is placed, in half-lengths h of the light,
//! within 16 · 2⁻⁵³ · D / h as a corner is there, D being the distance from the receiver, and what the
//! cut of an edge adds: the rounding of the edge's ends, over the sine of its angle with the plane. Where
//! an edge all but lies in the plane that is much; the true fraction itself then jumps as the receiver
//! crosses the edge's shadow, which no penumbra softens.
//!
//! The tree leaves a receiver the triangles that its plane cuts between it and the light, of the order of
//! the square root of a mesh's (14 µs a point in the penumbra of 5,650 triangles).

use super::blockers::{Blockers, Region};
use super::exact::{FURTHEST, check};
use super::pyramid::Frame;
use super::trace::{Receiver, check_position_error};
use crate::scene::Scene;
use crate::{Error, RectangleLight};
use glam::DVec3;
use rayon::prelude::*;

/// A hidden interval of the light, in half-lengths from its centre.
type Interval = [f64; 2];

/// The blocking triangles of a scene, for exact visible fractions of a line light.
pub struct ExactLine {
    blockers: Blockers<[DVec3; 3]>,
    position_error: f64,
}

impl ExactLine {
    /// Builds the hierarchy over the instances that block light ([`crate::scene::Role::blocks`]).
    ///
    /// # Errors
    /// [`Error::Scene`] where an instance names a mesh or vertex that does not exist, or puts a
    /// vertex at a position that is not finite (or beyond 10¹⁸ m).
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        Ok(Self { blockers: Blockers::whole(scene)?, position_error: 0.0 })
    }

    /// Says how far, in metres, the receivers may lie off their surfaces: as
    /// [`super::Exact::with_position_error`].
    ///
    /// # Errors
    /// [`Error::Setting`] for an error that is negative or not finite.
    pub fn with_position_error(self, metres: f64) -> Result<Self, Error> {
        check_position_error(metres)?;
        Ok(Self { position_error: metres, ..self })
    }

    /// The distance that a receiver is moved off its surface along its normal, in metres: that of
    /// [`super::Tracer::offset`].
    pub fn offset(&self, light: &RectangleLight, position: DVec3) -> f64 {
        self.blockers.offset(light.center(), position, self.position_error)
    }

    /// The share of the light's length, 0..1, that a receiver on a surface sees: that of the point
    /// [`Self::offset`] above it, as [`super::Exact::visible_fraction`].
    ///
    /// # Errors
    /// [`Error::Light`] for a light with an area. [`Error::Frame`] where the position or normal is not
    /// finite, or the receiver further away than 10¹⁰⁰ lengths of the light.
    pub fn visible_fraction(
        &self,
        light: &RectangleLight,
        receiver: &Receiver,
    ) -> Result<f64, Error> {
        check(receiver, "the receiver")?;
        self.of_receiver(light, &self.frame(light)?, receiver, &mut Vec::new())
    }

    /// The share of the light's length, 0..1, that a point sees: the point itself, as
    /// [`super::Exact::visible_from`].
    ///
    /// # Errors
    /// See [`Self::visible_fraction`].
    pub fn visible_from(&self, light: &RectangleLight, point: DVec3) -> Result<f64, Error> {
        let (frame, panel) = (self.frame(light)?, self.offset(light, point));
        self.of_point(&frame, point - self.blockers.origin, panel, &mut Vec::new())
    }

    /// The visible fraction from each receiver, on all cores, in the order they were given.
    ///
    /// Equal inputs give equal bits, whatever the number of cores.
    ///
    /// # Errors
    /// See [`Self::visible_fraction`].
    pub fn visible_fractions(
        &self,
        light: &RectangleLight,
        receivers: &[Receiver],
    ) -> Result<Vec<f64>, Error> {
        for (i, receiver) in receivers.iter().enumerate() {
            check(receiver, format_args!("receiver {i}"))?;
        }
        let frame = self.frame(light)?;
        let of = |hidden: &mut _, receiver| self.of_receiver(light, &frame, receiver, hidden);
        receivers.par_iter().map_init(Vec::new, of).collect()
    }

    /// Light space about the blockers' origin, x in half-lengths.
    fn frame(&self, light: &RectangleLight) -> Result<Frame, Error> {
        if !light.is_line() {
            return Err(Error::Light("it has an area; ask truth::Exact about a rectangle".into()));
        }
        let axis = |column| light.world_from_light().transform_vector3(column);
        let rows = [axis(DVec3::X) / light.half_extents()[0], axis(DVec3::Y), axis(DVec3::Z)];
        Ok(Frame { center: light.center(), rows }.relative_to(self.blockers.origin))
    }

    fn of_receiver(
        &self,
        light: &RectangleLight,
        frame: &Frame,
        receiver: &Receiver,
        hidden: &mut Vec<Interval>,
    ) -> Result<f64, Error> {
        let Some(normal) = receiver.normal.try_normalize() else { return Ok(1.0) };
        let offset = self.offset(light, receiver.position);
        let from = receiver.position - self.blockers.origin + normal * offset;
        self.of_point(frame, from, offset, hidden)
    }

    /// The visible fraction from a point relative to the blockers' origin. What lies within `panel` of the light's
    /// plane, be it the point or a triangle, counts as in it.
    fn of_point(
        &self,
        frame: &Frame,
        point: DVec3,
        panel: f64,
        hidden: &mut Vec<Interval>,
    ) -> Result<f64, Error> {
        let eye = Eye::new(frame, point);
        if !eye.local.is_finite() || eye.local.abs().max_element() > FURTHEST {
            return Err(Error::Frame(format!(
                "a receiver must be finite and within {FURTHEST:e} lengths of the light (it is at {})",
                point + self.blockers.origin
            )));
        }
        // The light's own line lies in its plane, so a point beyond that is off the line.
        if eye.local.z <= panel {
            return Ok(1.0);
        }
        hidden.clear();
        self.blockers.for_each_in(&eye.region(), |triangle| {
            let marks = triangle.map(|corner| eye.mark(corner));
            if !marks.iter().all(|mark| mark.z <= panel) {
                hidden.extend(section(&marks).and_then(clip).and_then(shadow));
            }
        });
        Ok((1.0 - 0.5 * union(hidden)).clamp(0.0, 1.0))
    }
}

/// A receiver, and the plane through it and the light.
struct Eye<'a> {
    frame: &'a Frame,
    point: DVec3,
    /// The point in light space, x in half-lengths.
    local: DVec3,
    /// Distance from the light's line.
    distance: f64,
    /// The unit vector away from the line in light space's y and z.
    away: [f64; 2],
}

impl<'a> Eye<'a> {
    fn new(frame: &'a Frame, point: DVec3) -> Self {
        let local = frame.local(point);
        // Squares of a far point would overflow.
        let distance = local.y.hypot(local.z);
        let away = [local.y / distance, local.z / distance];
        Self { frame, point, local, distance, away }
    }

    /// The line from the receiver through p = r + d meets the light's at r_x + d_x ρ / w. Both d and what
    /// is made of it are differences of points that are near each other where p is near r, so that an
    /// occluder right before the receiver is placed as exactly as a far one.
    fn mark(&self, point: DVec3) -> Mark {
        let d = self.frame.turned(point - self.point);
        let [y, z] = self.away;
        let w = -(d.y * y + d.z * z);
        Mark {
            x: self.local.x * w + d.x * self.distance,
            w,
            z: self.frame.rows[2].dot(point - self.frame.center),
            side: d.z * y - d.y * z,
        }
    }

    /// The triangle of receiver and light, flat. Its planes' normals are the gradients of the members of
    /// [`Mark`].
    fn region(&self) -> Region<6> {
        let [row_x, row_y, row_z] = self.frame.rows;
        let [y, z] = self.away;
        let (w, side) = (-(row_y * y + row_z * z), row_z * y - row_y * z);
        let x = w * self.local.x + row_x * self.distance;
        let through = [side, -side, w - x, w + x, w].map(|normal| (normal, 0.0));
        let [a, b, c, d, e] = through;
        Region { apex: self.point, planes: [a, b, c, d, e, (row_z, self.local.z)] }
    }
}

/// A point of a triangle as the receiver sees it, its back-projection onto the light held as x / w. All
/// members are affine in the point, so they interpolate along an edge alike.
#[derive(Clone, Copy)]
struct Mark {
    x: f64,
    /// Above 0 nearer to the light's line than the receiver.
    w: f64,
    /// The point's distance in front of the light's plane.
    z: f64,
    /// Distance from the plane of receiver and light, above 0 on one side.
    side: f64,
}

impl Mark {
    fn between(a: &Self, b: &Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * t;
        Self { x: mix(a.x, b.x), w: mix(a.w, b.w), z: mix(a.z, b.z), side: mix(a.side, b.side) }
    }

    /// The point where an edge crosses the plane of receiver and light, equal to the bit for both of its triangles.
    fn crossing(a: &Self, b: &Self) -> Option<Self> {
        let cut = |a: &Self, b: &Self| Self::between(a, b, a.side / (a.side - b.side));
        if a.side > 0.0 && b.side < 0.0 {
            Some(cut(a, b))
        } else if a.side < 0.0 && b.side > 0.0 {
            Some(cut(b, a))
        } else {
            None
        }
    }
}

/// The part of a triangle in the plane of receiver and light; `None` where it touches the plane with a corner alone, or
/// lies in it.
fn section(corners: &[Mark; 3]) -> Option<[Mark; 2]> {
    let [a, b, c] = corners;
    let touching = corners.iter().filter(|corner| corner.side == 0.0).copied();
    let crossing = [(a, b), (b, c), (c, a)].into_iter().filter_map(|(a, b)| Mark::crossing(a, b));
    let mut ends = touching.chain(crossing);
    let pair = [ends.next()?, ends.next()?];
    ends.next().is_none().then_some(pair)
}

/// The part of a piece that lies between receiver and light and before the light's plane.
fn clip(piece: [Mark; 2]) -> Option<[Mark; 2]> {
    // The first two imply w ≥ 0: nothing behind the receiver is inside.
    let sides: [fn(&Mark) -> f64; 3] = [|m| m.w - m.x, |m| m.w + m.x, |m| m.z];
    sides.into_iter().try_fold(piece, |[a, b], distance| {
        let (d_a, d_b) = (distance(&a), distance(&b));
        match (d_a >= 0.0, d_b >= 0.0) {
            (true, true) => Some([a, b]),
            (true, false) => Some([a, Mark::between(&a, &b, d_a / (d_a - d_b))]),
            (false, true) => Some([Mark::between(&b, &a, d_b / (d_b - d_a)), b]),
            (false, false) => None,
        }
    })
}

/// The interval that a clipped piece hides. w = 0 is the receiver itself, from where a piece that ends
/// there is seen end-on.
fn shadow([a, b]: [Mark; 2]) -> Option<Interval> {
    if !(a.w > 0.0 && b.w > 0.0) {
        return None;
    }
    let [a, b] = [a, b].map(|mark| (mark.x / mark.w).clamp(-1.0, 1.0));
    // Not for NaN either, which extreme sizes come to.
    (a != b && !a.is_nan() && !b.is_nan()).then(|| [a.min(b), a.max(b)])
}

/// The length of the union of intervals within −1..1.
fn union(intervals: &mut [Interval]) -> f64 {
    intervals.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut length, mut run) = (0.0, [-1.0; 2]);
    for &[from, to] in &*intervals {
        if from > run[1] {
            length += run[1] - run[0];
            run = [from, to];
        }
        run[1] = to.max(run[1]);
    }
    length + run[1] - run[0]
}

#[cfg(test)]
mod tests;
