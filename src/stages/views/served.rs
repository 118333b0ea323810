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

use super::visible::{Visible, Window, opening};
use crate::graph::Why;
use crate::knob::MOST_VIEWS;
use crate::stages::depth_layers::{
    Eye, LightBox, MapView, Projection, fit_boxes_within, nearest_of, tangents_within, view_from,
};
use glam::{DMat4, DVec4};
use smallvec::SmallVec;

/// The widest window of several views (89°).
const WIDEST: f64 = 64.0;

/// The tangents up to which one view is enough.
const NARROW: f64 = 2.0;

/// The window of the finest of several views.
const FINEST: f64 = 1.0;

/// The least factor by which the windows of views grow.
const LEAST_RATIO: f64 = 2.0;

/// The least width of a window: behind a narrower one, the eye would be far off, and texels no smaller where occluders are.
const LEAST_WIDE: f64 = 0.5;

/// The share of the next wider window's area up to which a window has texels that are worth a view.
const LEAST_FINER: f64 = 0.6;

/// A view of the occluders, and the receivers that it may serve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Served {
    /// The view of its maps.
    pub map: MapView,
    /// Where receivers lie whose rays the map holds, in the view's space.
    pub region: Region,
    /// The middle of its window, tangents. The view's space is light space but for its x and y, which are less by this for
    /// each metre from the light's plane: the light is where it was, rays are straight, and the window is around the axis.
    pub aside: [f64; 2],
    /// The furthest distance at which an occluder may shadow one of them, metres, counted as `near` and `far` of the map.
    pub deepest: f64,
}

impl Served {
    /// A view that serves every receiver.
    pub const fn all(map: MapView) -> Self {
        Self { map, region: Region::ALL, aside: [0.0; 2], deepest: map.far }
    }

    /// The matrix from light space to the clip space of the view.
    pub fn clip_from_light(&self) -> DMat4 {
        self.map.clip_from_light() * self.view_from_light()
    }

    /// The matrix from light space to the view's space.
    pub fn view_from_light(&self) -> DMat4 {
        let [x, y] = self.aside;
        DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(-x, -y, 1.0, 0.0), DVec4::W)
    }

    /// The matrix from the view's space to light space.
    pub fn light_from_view(&self) -> DMat4 {
        let [x, y] = self.aside;
        DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(x, y, 1.0, 0.0), DVec4::W)
    }
}

/// The points p of a view's space for which p.xy lies between `at.xy + slope.xy p.z` and `at.zw + slope.zw p.z`.
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

    /// The tangents to which it opens along x and along y.
    pub(crate) fn tangents(&self) -> [f64; 2] {
        [self.slope[2], self.slope[3]].map(f64::from)
    }

    /// The points under these tangents or less beyond the rim of a light of these half-extents.
    fn opening(half: [f64; 2], tangents: [f64; 2]) -> Self {
        let [x, y] = half.map(|h| h as f32);
        let [s, t] = tangents.map(|t| t as f32);
        Self { at: [-x, -y, x, y], slope: [-s, -t, s, t] }
    }
}

/// What a lamp's views are fitted to.
pub(crate) struct Lamp<'a> {
    /// Half its width and height, m.
    pub half: [f64; 2],
    /// The occluders in light space.
    pub occluders: &'a [LightBox],
    /// The receivers in light space.
    pub receivers: &'a [LightBox],
    /// What the camera sees of them; `None` where that is not known, and all may be seen.
    pub visible: Option<Visible<'a>>,
    /// Where the occluders are seen from.
    pub projection: Projection,
    /// The sides of the maps of one view and of several, texels.
    pub sides: [u32; 2],
    /// The most views.
    pub most: u32,
}

/// Finds the views through which a lamp sees its occluders, the finest first: one where that is enough, or up to the most
/// that nest, cut to what the camera sees; none where nothing lies before the lamp. Returns why, and whether they follow
/// the camera.
pub(crate) fn fit_served(lamp: &Lamp, views: &mut Vec<Served>) -> (Why, bool) {
    let Lamp { occluders, projection, most, .. } = *lamp;
    views.clear();
    let widest = match tangents_within(occluders, WIDEST) {
        Some((min, max)) => min.iter().chain(&max).fold(0.0f64, |most, t| most.max(t.abs())),
        None => return (Why::default(), false),
    };
    let why = Why::from("occluders lie up to tangents of ").number(widest, 2);
    let why = why.and(" from the light's axis");
    let mut seen = None;
    let follows = most > 1 && widest > NARROW && projection != Projection::Orthographic;
    if follows {
        seen = nested(lamp, widest, views);
    }
    if views.is_empty() {
        let one = view_from(lamp.half, occluders, projection, lamp.sides[0]);
        views.extend(one.map(Served::all));
    }
    let why = match seen {
        Some(seen) if seen < widest => {
            why.and(", shadows that are seen need up to ").number(seen, 2)
        }
        _ => why,
    };
    let why = match (views.len(), most) {
        (1, 1) => why.and(", and no more are allowed"),
        (1, _) if widest <= NARROW => {
            why.and(", and one shows ").number(NARROW, 0).and(" finely enough")
        }
        (1, _) if seen.is_some() => why.and(", and one shows that finely enough"),
        (1, _) if follows => why.and(", and the camera sees no receiver"),
        (1, _) => why.and(", seen from infinitely far"),
        _ => why.and(", and each shows a part of that as finely as it is far aside"),
    };
    (why, follows)
}

/// The windows of nested views, the finest first.
type Windows = SmallVec<[(f64, Window); MOST_VIEWS as usize]>;

/// Finds several views of occluders that lie up to tangents of `widest`. Returns up to which tangents receivers are seen;
/// `None` where none is.
fn nested(lamp: &Lamp, widest: f64, views: &mut Vec<Served>) -> Option<f64> {
    let Lamp { half, occluders, projection, most, .. } = *lamp;
    // From the centre, what is nearest to the light may lie that far aside of a receiver's window.
    let margin = match projection {
        Projection::Centre => half.map(|h| h / nearest_of(occluders).unwrap_or(0.0)),
        _ => [0.0; 2],
    };
    let all = match &lamp.visible {
        Some(visible) => visible.within(half, widest)?.padded(margin),
        None => Window::around(widest),
    };
    let seen = all.furthest().clamp(0.5 * LEAST_WIDE, widest);
    let finest = FINEST.min((seen / LEAST_RATIO).max(0.5 * LEAST_WIDE));
    let count = 1 + ((seen / finest).ln() / LEAST_RATIO.ln()).ceil() as u32;
    let count = count.clamp(2, most);
    let ratio = (seen / finest).powf(1.0 / f64::from(count - 1));
    let mut windows = Windows::new();
    for nth in 0..count {
        let is_last = nth + 1 == count;
        let tangent = if is_last { seen } else { finest * ratio.powi(nth as i32) };
        if (0..2).any(|i| all.min[i] > tangent || all.max[i] < -tangent) {
            continue;
        }
        let window = all.within(tangent);
        // The regions lie within each other.
        let window = windows.last().map_or(window, |(_, finer)| window.with(finer));
        windows.push((tangent, window.stepped(LEAST_WIDE, tangent)));
    }
    // A view is worth its passes where it is finer than the next.
    for finer in (0..windows.len().saturating_sub(1)).rev() {
        let area = |nth: usize| windows[nth].1.half().iter().product::<f64>();
        if area(finer) > LEAST_FINER * area(finer + 1) {
            windows.remove(finer);
        }
    }
    let side = lamp.sides[1];
    for (nth, (tangent, window)) in windows.iter().enumerate() {
        let is_last = nth + 1 == windows.len();
        let Some(served) = lamp.through(window, *tangent, is_last, side) else {
            views.clear();
            break;
        };
        views.push(served);
    }
    Some(seen)
}

impl Lamp<'_> {
    /// The view through a window that reaches up to `tangent`; the last one serves all that others leave.
    fn through(&self, window: &Window, tangent: f64, is_last: bool, side: u32) -> Option<Served> {
        let Self { half, occluders, receivers, projection, .. } = *self;
        let [aside, wide] = [window.middle(), window.half()];
        let behind = match projection {
            Projection::Centre => 0.0,
            _ => (0..2).map(|i| half[i] / wide[i]).fold(0.0, f64::max),
        };
        let map = fit_boxes_within(Eye::Behind(behind), occluders, aside, wide, side)?;
        // The part of a box that lies outside the region has no receiver for the view.
        let planes = opening(half, tangent);
        let furthest = |b: &LightBox| if is_last { b.max.z } else { b.z_within(&planes)[1] };
        let furthest = receivers.iter().map(furthest).fold(map.near - behind, f64::max);
        let deepest = furthest.min(map.far - behind);
        let region = if is_last { Region::ALL } else { Region::opening(half, wide) };
        Some(Served { map, region, aside, deepest: deepest + behind })
    }
}

#[cfg(test)]
#[path = "served_tests.rs"]
mod tests;
