//! The views of a light that share its receivers, and which of them serves a receiver.
//!
//! ```text
//!        ══╤══  light                 every view's region begins at the light's rim and opens
//!      ╱  ╱ ╲  ╲                      as widely as the view's window: a ray from a receiver in it
//!    ╱   ╱   ╲   ╲                    to any point of the light stays inside, and the view's map
//!  ╱  1 ╱  0  ╲ 1  ╲                  has all that the ray meets. The finest view whose region
//!      ╱       ╲                      holds a receiver serves it, and the last one all others.
//! ```
//! That holds from behind the light, where each view has an eye of its own. From the light's centre a view lacks what is
//! near to the light and far aside, and its region is narrower by that (`inner`).
//!
//! A map's texels are equally large in u and v, tangents at the light. Where walls reach up to the light's plane, a
//! map that shows them all has few texels for what lies below the light, where most of the light falls. Far aside, the
//! same tangents cover less of the light's surroundings, and less light arrives. So the windows of nested views grow
//! by a constant factor, and each map has texels as fine, over its distance from the axis, as the others.

use crate::graph::Why;
use crate::stages::depth_layers::{
    Eye, LightBox, MapView, Projection, fit_boxes_within, tangents_within, view_from,
};
use glam::DVec4;

/// The widest window of several views (89°).
const WIDEST: f64 = 64.0;

/// The tangents up to which one view is enough.
const NARROW: f64 = 2.0;

/// The window of the finest of several views.
const FINEST: f64 = 1.0;

/// The least factor by which the windows of views grow.
const LEAST_RATIO: f64 = 2.0;

/// A view of the occluders, and the receivers that it may serve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Served {
    /// The view of its maps.
    pub map: MapView,
    /// Where receivers lie whose rays the map holds.
    pub region: Region,
    /// The furthest distance at which an occluder may shadow one of them, metres, counted as `near` and `far` of the map.
    pub deepest: f64,
}

/// The points p of light space for which p.xy lies between `at.xy + slope.xy p.z` and `at.zw + slope.zw p.z`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Region {
    /// The least x and y in the light's plane, then the largest.
    pub at: [f32; 4],
    /// How these change with the distance from that plane.
    pub slope: [f32; 4],
}

impl Region {
    /// Everything before the light.
    pub const ALL: Self = Self {
        at: [f32::NEG_INFINITY, f32::NEG_INFINITY, f32::INFINITY, f32::INFINITY],
        slope: [0.0; 4],
    };

    /// Nothing.
    pub(crate) const NONE: Self = Self {
        at: [f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY],
        slope: [0.0; 4],
    };

    /// The largest tangent to which it opens.
    pub(crate) fn tangent(&self) -> f64 {
        f64::from(self.slope[2])
    }

    /// The points under `tangent` or less beyond the rim of a light of these half-extents.
    fn opening(half: [f64; 2], tangent: f64) -> Self {
        let [x, y] = half.map(|h| h as f32);
        let t = tangent as f32;
        Self { at: [-x, -y, x, y], slope: [-t, -t, t, t] }
    }
}

/// Finds the views through which a light of these half-extents sees boxes of occluders, the finest first: one where
/// that is enough, or up to `most` nested ones; none where nothing lies before the light. Maps have as many texels a side
/// as the first of `sides` says for one view, and the second for several. Returns why.
pub(crate) fn fit_served(
    half: [f64; 2],
    [occluders, receivers]: [&[LightBox]; 2],
    projection: Projection,
    [side, several]: [u32; 2],
    most: u32,
    views: &mut Vec<Served>,
) -> Why {
    views.clear();
    let widest = match tangents_within(occluders, WIDEST) {
        Some((min, max)) => min.iter().chain(&max).fold(0.0f64, |most, t| most.max(t.abs())),
        None => return Why::default(),
    };
    if most > 1 && widest > NARROW && projection != Projection::Orthographic {
        let more = (widest / FINEST).ln() / LEAST_RATIO.ln();
        let count = (1 + more.ceil() as u32).min(most);
        nested(half, [occluders, receivers], projection, several, widest, count, views);
    }
    if views.is_empty() {
        let one = view_from(half, occluders, projection, side);
        views.extend(one.map(|map| Served { map, region: Region::ALL, deepest: map.far }));
    }
    let why = Why::from("occluders lie up to tangents of ").number(widest, 2);
    let why = why.and(" from the light's axis");
    match (views.len(), most) {
        (1, 1) => why.and(", and no more are allowed"),
        (1, _) if widest <= NARROW => {
            why.and(", and one shows ").number(NARROW, 0).and(" finely enough")
        }
        (1, _) => why.and(", seen from infinitely far"),
        _ => why.and(", and each shows a part of that as finely as it is far aside"),
    }
}

/// Finds several views whose windows reach up to `widest`.
fn nested(
    half: [f64; 2],
    [occluders, receivers]: [&[LightBox]; 2],
    projection: Projection,
    side: u32,
    widest: f64,
    count: u32,
    views: &mut Vec<Served>,
) {
    let ratio = (widest / FINEST).powf(1.0 / f64::from(count - 1));
    for nth in 0..count {
        let tangent = FINEST * ratio.powi(nth as i32);
        let behind = match projection {
            Projection::Centre => 0.0,
            _ => half.iter().fold(0.0f64, |most, h| most.max(h / tangent)),
        };
        let Some(map) = fit_boxes_within(Eye::Behind(behind), occluders, tangent, side) else {
            views.clear();
            return;
        };
        let is_last = nth + 1 == count;
        // The part of a box that lies outside the region has no receiver for the view.
        let planes = opening(half, tangent);
        let furthest = |b: &LightBox| if is_last { b.max.z } else { b.z_within(&planes)[1] };
        let furthest = receivers.iter().map(furthest).fold(map.near - behind, f64::max);
        let deepest = furthest.min(map.far - behind);
        let region = if is_last { Region::ALL } else { Region::opening(half, tangent) };
        views.push(Served { map, region, deepest: deepest + behind });
    }
}

/// The planes around the points under `tangent` or less beyond the rim of a light of these half-extents.
fn opening([x, y]: [f64; 2], tangent: f64) -> [DVec4; 4] {
    [
        DVec4::new(1.0, 0.0, tangent, x),
        DVec4::new(0.0, 1.0, tangent, y),
        DVec4::new(-1.0, 0.0, tangent, x),
        DVec4::new(0.0, -1.0, tangent, y),
    ]
}

#[cfg(test)]
#[path = "served_tests.rs"]
mod tests;
