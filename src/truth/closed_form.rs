//! The exact visible fraction behind one convex polygon.
//!
//! The part of the polygon that blocks is the part inside the pyramid with its apex at the
//! receiver and the light as its base. Clipping to that pyramid comes first, projecting onto the
//! light second: a clipped point can only be at the projection's pole by being the receiver
//! itself, so no near distance has to be invented for polygons that pass by or behind the receiver.
//!
//! Clipping is that of Sutherland and Hodgman 1974 ("Reentrant polygon clipping"), against the
//! pyramid's four sides and the light's plane; the area is the shoelace sum. All in f64.

use crate::RectangleLight;
use glam::{DVec2, DVec3};

/// The share of the light's area, 0..1, that `receiver` sees past one convex planar quad.
///
/// As [`visible_fraction_of_polygon`].
pub fn visible_fraction_of_quad(light: &RectangleLight, quad: [DVec3; 4], receiver: DVec3) -> f64 {
    visible_fraction_of_polygon(light, &quad, receiver)
}

/// The share of the light's area, 0..1, that `receiver` sees past one convex planar polygon.
///
/// World space, metres, corners in either winding. The polygon may have any orientation and may
/// reach behind the light or the receiver; only what lies between them counts. One that passes
/// through the receiver is seen edge-on and blocks nothing, and so does one that lies in the light's
/// plane, to the last bit (the tracer allows for rounding there). Corners that are not in one plane or
/// not in convex position give the fraction of some other shape; fewer than three give 1.
/// The error is a few roundings of f64 relative to the light's area, as long as the distances
/// between polygon, receiver and light are not themselves lost to cancellation.
///
/// NaN where a corner or the receiver is not finite.
pub fn visible_fraction_of_polygon(
    light: &RectangleLight,
    polygon: &[DVec3],
    receiver: DVec3,
) -> f64 {
    if !(receiver.is_finite() && polygon.iter().all(|corner| corner.is_finite())) {
        return f64::NAN;
    }
    let frame = Frame::of(light);
    let receiver = frame.local(receiver);
    if receiver.z <= 0.0 {
        return 1.0;
    }
    let rays: Vec<Ray> =
        polygon.iter().map(|&corner| Ray::through(receiver, frame.local(corner))).collect();
    // A panel in the light's plane is not before it; the clip alone would keep it whole.
    if rays.iter().all(|ray| ray.z <= 0.0) {
        return 1.0;
    }
    // The sides x = ±w and y = ±w together imply w ≥ 0: nothing behind the receiver survives.
    let sides: [fn(&Ray) -> f64; 5] =
        [|r| r.z, |r| r.w - r.x, |r| r.w + r.x, |r| r.w - r.y, |r| r.w + r.y];
    let inside = sides.iter().fold(rays, |rays, side| clip(&rays, side));
    // w = 0 is the receiver itself, where an edge-on polygon passes through it.
    let shadow: Vec<DVec2> =
        inside.iter().filter(|r| r.w > 0.0).map(|r| DVec2::new(r.x, r.y) / r.w).collect();
    // The light is the square −1..1 here.
    (1.0 - area(&shadow) / 4.0).clamp(0.0, 1.0)
}

/// Light space with f64 dot products about the light's centre: no matrix that holds a far
/// translation, hence no cancellation 20 km from the world's origin.
struct Frame {
    center: DVec3,
    /// x and y are divided by the light's half-extents.
    rows: [DVec3; 3],
}

impl Frame {
    fn of(light: &RectangleLight) -> Self {
        let axes = light.world_from_light();
        let [width, height] = light.half_extents();
        let axis = |column: DVec3, unit: f64| axes.transform_vector3(column) / unit;
        Self {
            center: light.center(),
            rows: [axis(DVec3::X, width), axis(DVec3::Y, height), axis(DVec3::Z, 1.0)],
        }
    }

    fn local(&self, world: DVec3) -> DVec3 {
        let from_center = world - self.center;
        DVec3::from_array(self.rows.map(|row| row.dot(from_center)))
    }
}

/// A point of the polygon, its back-projection onto the light plane held as (x, y) / w.
#[derive(Clone, Copy)]
struct Ray {
    x: f64,
    y: f64,
    /// Above 0 nearer to the light plane than the receiver.
    w: f64,
    /// The point's distance in front of the light.
    z: f64,
}

impl Ray {
    /// From the receiver r through p: the line meets z = 0 at (p r_z − r p_z) / (r_z − p_z).
    fn through(r: DVec3, p: DVec3) -> Self {
        Self { x: p.x * r.z - r.x * p.z, y: p.y * r.z - r.y * p.z, w: r.z - p.z, z: p.z }
    }

    /// All four members are affine in the point, so they interpolate along an edge alike.
    fn between(a: &Self, b: &Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * t;
        Self { x: mix(a.x, b.x), y: mix(a.y, b.y), w: mix(a.w, b.w), z: mix(a.z, b.z) }
    }
}

/// One side of Sutherland and Hodgman: keeps where `distance` is not negative.
fn clip(polygon: &[Ray], distance: impl Fn(&Ray) -> f64) -> Vec<Ray> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
    for (from, to) in edges {
        let (d_from, d_to) = (distance(from), distance(to));
        if d_from >= 0.0 {
            kept.push(*from);
        }
        if (d_from >= 0.0) != (d_to >= 0.0) {
            kept.push(Ray::between(from, to, d_from / (d_from - d_to)));
        }
    }
    kept
}

/// The area of a polygon of either winding, by the shoelace sum about its first corner.
fn area(polygon: &[DVec2]) -> f64 {
    let Some(&first) = polygon.first() else { return 0.0 };
    let twice: f64 =
        polygon.windows(2).map(|edge| (edge[0] - first).perp_dot(edge[1] - first)).sum();
    (twice / 2.0).abs()
}

#[cfg(test)]
#[path = "closed_form_tests.rs"]
mod tests;
