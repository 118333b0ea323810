//! The exact visible fraction behind one convex polygon.
//!
//! The part of the polygon that blocks is the part inside the pyramid from the receiver to the
//! light, clipped in homogeneous form; its area on the light is the shoelace sum. All in f64.

use super::pyramid::{Apex, Frame, clip};
use crate::RectangleLight;
use glam::{DVec2, DVec3};

/// The share of the light's area, 0..1, that `receiver` sees past one convex planar quad.
///
/// See [`visible_fraction_of_polygon`] for degenerate cases.
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
/// NaN where a corner or the receiver is not finite, and for a line or a point, which have no area.
pub fn visible_fraction_of_polygon(
    light: &RectangleLight,
    polygon: &[DVec3],
    receiver: DVec3,
) -> f64 {
    let finite = receiver.is_finite() && polygon.iter().all(|corner| corner.is_finite());
    if !finite || light.half_extents()[1] == 0.0 {
        return f64::NAN;
    }
    let frame = Frame::of(light);
    let apex = Apex::new(&frame, receiver);
    if apex.local.z <= 0.0 {
        return 1.0;
    }
    let rays: Vec<_> = polygon.iter().map(|&corner| apex.ray_through(corner)).collect();
    // A panel in the light's plane is not before it; the clip alone would keep it whole.
    if rays.iter().all(|ray| ray.z <= 0.0) {
        return 1.0;
    }
    // w = 0 is the receiver itself, where an edge-on polygon passes through it.
    let inside = clip(rays, 1.0).into_iter().filter(|ray| ray.w > 0.0);
    let shadow: Vec<DVec2> = inside.map(|ray| ray.projected()).collect();
    // The light is the square −1..1 here.
    (1.0 - area(&shadow) / 4.0).clamp(0.0, 1.0)
}

/// The area of a polygon of either winding, by the shoelace sum about its first corner.
fn area(polygon: &[DVec2]) -> f64 {
    let Some(&first) = polygon.first() else { return 0.0 };
    let twice: f64 =
        polygon.windows(2).map(|edge| (edge[0] - first).perp_dot(edge[1] - first)).sum();
    (twice / 2.0).abs()
}
