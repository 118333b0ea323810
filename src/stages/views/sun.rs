//! The views of a sun: parallel light, whose maps are in metres.
//!
//! ```text
//!     \  \  \   light, parallel but for an angle      eye ──┬────────┬──────────────┬───────────────
//!      \  \  \                                            0 │   1    │       2      │       3
//!   ────────────  what is highest                           └────────┴──────────────┴───────────────
//!        ┌─┐                                          a view for each part of what the eye sees, each
//!   _____│_│____  what is seen                        about as many times as deep as the one before
//! ```
//! A point is x and y across the light and its height above the furthest plane; nothing is far away. Near the eye a
//! pixel sees little and wants small texels, further off it sees much. A view's window holds the part of the receivers
//! that it is for, and around it what their rays pass on the way to the light.

use super::{Region, Served};
use crate::stages::depth_layers::{Eye, LightBox, MapView};
use glam::{DVec2, DVec3, DVec4};

/// The margin above the highest point and below the lowest, as a share of the range of heights.
const MARGIN: f64 = 1e-3;

/// The steps a doubling in which windows grow, so that texels stay where they are while the eye moves.
const STEPS: f64 = 8.0;

/// Least and largest coordinates.
pub(crate) type Extent = [DVec3; 2];

/// What a sun's views are fitted to; boxes are in the sun's space, metres.
#[derive(Clone, Copy)]
pub(crate) struct UnderSun<'a> {
    /// The tangent of half its angular size.
    pub half: f64,
    /// The occluders.
    pub occluders: &'a [LightBox],
    /// The receivers.
    pub receivers: &'a [LightBox],
    /// The extents of the parts of the receivers that are seen, from the nearest on; empty where one view shows all.
    pub parts: &'a [Extent],
    /// The side of the maps, texels.
    pub side: u32,
    /// The side of a map of the receivers, texels.
    pub receiver_side: u32,
}

/// A sun's views beside those that share the pixels.
pub(crate) struct SunViews {
    /// Where the views' space begins: the sun's x, y and z.
    pub origin: DVec3,
    /// The view of everything.
    pub alone: Served,
    /// The view of the receivers.
    pub receivers: MapView,
}

/// Fits a sun's views, the nearest part's first; `None` where there are no occluders or no receivers.
pub(crate) fn fit_sun(sun: &UnderSun, views: &mut Vec<Served>) -> Option<SunViews> {
    views.clear();
    let all = |boxes: &[LightBox]| {
        boxes.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], b| {
            [min.min(b.min), max.max(b.max)]
        })
    };
    let (occluders, receivers) = (all(sun.occluders), all(sun.receivers));
    if occluders[0].x > occluders[1].x || receivers[0].x > receivers[1].x {
        return None;
    }
    let far = occluders[1].z.max(receivers[1].z);
    let near = occluders[0].z.min(far);
    let far = far + MARGIN * (far - near).max(1e-9 * far.abs());
    let whole = [receivers];
    let parts = if sun.parts.is_empty() { &whole[..] } else { sun.parts };
    let first = parts[0];
    let middle = 0.5 * (first[0] + first[1]);
    let origin = DVec3::new(middle.x, middle.y, far);
    let fit = Fit { sun, origin, all: occluders, stepped: parts.len() > 1 };
    for (nth, part) in parts.iter().enumerate() {
        let mut served = fit.view(part, nth + 1 < parts.len());
        if nth + 1 == parts.len() {
            served.region = Region::ALL;
        }
        views.push(served);
    }
    let alone = match sun.parts {
        [] => views[0],
        _ => Fit { stepped: false, ..fit }.view(&receivers, false),
    };
    let [min, max] = receivers.map(|p| (p - origin).truncate().to_array());
    let top = (receivers[0].z - origin.z).min(-MARGIN * (far - near));
    let [min, max] = padded(min, max, sun.receiver_side);
    let receivers = MapView {
        eye: Eye::Infinity,
        min,
        max,
        near: top * (1.0 + MARGIN),
        far: 0.0,
        side: sun.receiver_side,
    };
    Some(SunViews { origin, alone: Served { region: Region::ALL, ..alone }, receivers })
}

#[derive(Clone, Copy)]
struct Fit<'a> {
    sun: &'a UnderSun<'a>,
    origin: DVec3,
    /// The extent of all occluders.
    all: Extent,
    /// Whether windows move and grow in steps.
    stepped: bool,
}

impl Fit<'_> {
    /// The view that holds every ray from the receivers in a part to the light; its window is `whole`, or no larger
    /// than the occluders in it.
    fn view(&self, part: &Extent, whole: bool) -> Served {
        let Self { sun, origin, all, .. } = *self;
        // What is highest of all bounds how far rays go aside, and what is highest within that is the bound.
        let reach = |top: f64| sun.half * (part[1].z - top).max(0.0);
        let window = |top: f64| {
            let reach = DVec2::splat(reach(top));
            [part[0].truncate() - reach, part[1].truncate() + reach]
        };
        let within = |[min, max]: [DVec2; 2]| {
            let meets = move |b: &&LightBox| {
                b.min.truncate().cmple(max).all()
                    && b.max.truncate().cmpge(min).all()
                    && b.min.z <= part[1].z
            };
            sun.occluders.iter().filter(meets)
        };
        let widest = window(all[0].z);
        let least = |b: &LightBox| z_within(b, widest)[0];
        let top = within(widest).map(least).fold(part[1].z, f64::min);
        let [mut min, mut max] = window(top);
        // Receivers of other parts lie in the window, too.
        let lowest = |b: &LightBox| z_within(b, [min, max])[1];
        let lowest = sun.receivers.iter().filter(|b| b.max.z > part[1].z).map(lowest);
        let lowest = lowest.fold(part[1].z, f64::max);
        let region = {
            let (a, b) = (min - origin.truncate(), max - origin.truncate());
            let rise = sun.half * (origin.z - top);
            let (a, b, s) = ((a + rise).as_vec2(), (b - rise).as_vec2(), sun.half as f32);
            Region { at: [a.x, a.y, b.x, b.y], slope: [s, s, -s, -s] }
        };
        if !whole {
            let none = [DVec2::INFINITY, DVec2::NEG_INFINITY];
            let [least, most] = within([min, max])
                .fold(none, |[a, b], of| [a.min(of.min.truncate()), b.max(of.max.truncate())]);
            if least.x <= most.x {
                (min, max) = (min.max(least), max.min(most));
            }
        }
        let [min, max] = [min, max].map(|p| (p - origin.truncate()).to_array());
        let [min, max] = if self.stepped {
            stepped(min, max, origin.truncate().to_array(), sun.side)
        } else {
            padded(min, max, sun.side)
        };
        let near = top - origin.z;
        let near = near + MARGIN * near.min(-1e-9 * origin.z.abs());
        let near = near.min(-f64::MIN_POSITIVE);
        Served {
            deepest: (lowest - origin.z).max(near),
            map: MapView { eye: Eye::Infinity, min, max, near, far: 0.0, side: sun.side },
            region,
            aside: [0.0; 2],
        }
    }
}

/// The least and largest z of the part of a box whose x and y lie in a window.
fn z_within(b: &LightBox, [min, max]: [DVec2; 2]) -> [f64; 2] {
    if b.min.truncate().cmpge(min).all() && b.max.truncate().cmple(max).all() {
        return [b.min.z, b.max.z];
    }
    b.z_within(&[
        DVec4::new(1.0, 0.0, 0.0, -min.x),
        DVec4::new(0.0, 1.0, 0.0, -min.y),
        DVec4::new(-1.0, 0.0, 0.0, max.x),
        DVec4::new(0.0, -1.0, 0.0, max.y),
    ])
}

/// A window with a texel more on each side.
fn padded(mut min: [f64; 2], mut max: [f64; 2], side: u32) -> [[f64; 2]; 2] {
    crate::stages::depth_layers::pad(&mut min, &mut max, side);
    [min, max]
}

/// A window that is larger by up to an eighth of a doubling, and begins at a whole number of its texels, counted from
/// the sun's own origin, which lies `origin` before the view's.
fn stepped(min: [f64; 2], max: [f64; 2], origin: [f64; 2], side: u32) -> [[f64; 2]; 2] {
    let mut window = [min, max];
    let texels = f64::from(side.max(4) - 3);
    for i in 0..2 {
        let wide = (max[i] - min[i]).max(f64::MIN_POSITIVE);
        let texel = ((wide / texels).log2() * STEPS).ceil() / STEPS;
        let texel = texel.exp2();
        let spare = 0.5 * (f64::from(side) * texel - wide);
        let first = ((min[i] - spare + origin[i]) / texel).round() * texel - origin[i];
        window[0][i] = first;
        window[1][i] = first + f64::from(side) * texel;
    }
    window
}
