//! The pyramid with its apex at the receiver and the light as its base, and what of a polygon is
//! inside it.
//!
//! Clipping to the pyramid comes first, projecting onto the light second: a clipped point can only
//! be at the projection's pole by being the receiver itself, so no near distance has to be invented
//! for polygons that pass by or behind the receiver.

use crate::RectangleLight;
use glam::{DVec2, DVec3};

/// Light space with f64 dot products about the light's centre: no matrix that holds a far
/// translation, hence no cancellation 20 km from the world's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) center: DVec3,
    /// x and y are divided by the light's half-extents, so that the light fills the square −1..1.
    pub(super) rows: [DVec3; 3],
}

impl Frame {
    pub(super) fn of(light: &RectangleLight) -> Self {
        let axes = light.world_from_light();
        let [width, height] = light.half_extents();
        let axis = |column: DVec3, unit: f64| axes.transform_vector3(column) / unit;
        Self {
            center: light.center(),
            rows: [axis(DVec3::X, width), axis(DVec3::Y, height), axis(DVec3::Z, 1.0)],
        }
    }

    /// The frame for points that are given relative to `origin`.
    pub(super) fn relative_to(&self, origin: DVec3) -> Self {
        Self { center: self.center - origin, ..*self }
    }

    pub(super) fn local(&self, point: DVec3) -> DVec3 {
        self.turned(point - self.center)
    }

    pub(super) fn turned(&self, vector: DVec3) -> DVec3 {
        DVec3::from_array(self.rows.map(|row| row.dot(vector)))
    }
}

/// The point that rays start from.
#[derive(Clone, Copy)]
pub(super) struct Apex<'a> {
    frame: &'a Frame,
    point: DVec3,
    /// The point in light space.
    pub(super) local: DVec3,
}

impl<'a> Apex<'a> {
    pub(super) fn new(frame: &'a Frame, point: DVec3) -> Self {
        Self { frame, point, local: frame.local(point) }
    }

    /// The line from the receiver r through p = r + d meets z = 0 at r − d r_z / d_z. Both d and
    /// its z are differences of points that are near each other where p is near r, so that an
    /// occluder right before the receiver is projected as exactly as a far one.
    pub(super) fn ray_through(&self, point: DVec3) -> Ray {
        let (r, d) = (self.local, self.frame.turned(point - self.point));
        let w = -d.z;
        let z = self.frame.rows[2].dot(point - self.frame.center);
        Ray { x: r.x * w + d.x * r.z, y: r.y * w + d.y * r.z, w, z }
    }
}

/// A point of a polygon, its back-projection onto the light plane held as (x, y) / w.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) x: f64,
    pub(super) y: f64,
    /// Above 0 nearer to the light plane than the receiver.
    pub(super) w: f64,
    /// The point's distance in front of the light.
    pub(super) z: f64,
}

impl Ray {
    /// All four members are affine in the point, so they interpolate along an edge alike.
    fn between(a: &Self, b: &Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * t;
        Self { x: mix(a.x, b.x), y: mix(a.y, b.y), w: mix(a.w, b.w), z: mix(a.z, b.z) }
    }

    pub(super) fn projected(&self) -> DVec2 {
        DVec2::new(self.x, self.y) / self.w
    }

    /// Not negative before the light's plane, and inside each side of the pyramid over the square
    /// −half..half. The sides together imply w ≥ 0: nothing behind the receiver is inside.
    pub(super) fn sides(&self, half: f64) -> [f64; 5] {
        let w = half * self.w;
        [self.z, w - self.x, w + self.x, w - self.y, w + self.y]
    }
}

/// The part of a convex polygon inside the pyramid over the square −half..half and before the
/// light's plane (Sutherland and Hodgman 1974, "Reentrant polygon clipping").
///
/// An edge that two polygons share is cut at the same bits in both.
pub(super) fn clip(polygon: Vec<Ray>, half: f64) -> Vec<Ray> {
    (0..5).fold(polygon, |polygon, side| clip_side(&polygon, |ray| ray.sides(half)[side]))
}

/// Keeps where `distance` is not negative.
fn clip_side(polygon: &[Ray], distance: impl Fn(&Ray) -> f64) -> Vec<Ray> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
    for (from, to) in edges {
        let (d_from, d_to) = (distance(from), distance(to));
        // From the kept end, whichever way the edge is walked.
        let cut = |a, b, d_a: f64, d_b: f64| Ray::between(a, b, d_a / (d_a - d_b));
        match (d_from >= 0.0, d_to >= 0.0) {
            (true, true) => kept.push(*from),
            (true, false) => kept.extend([*from, cut(from, to, d_from, d_to)]),
            (false, true) => kept.push(cut(to, from, d_to, d_from)),
            (false, false) => {}
        }
    }
    kept
}
