//! Where the samples are, and what each of them sees.

use super::Settings;
use crate::RectangleLight;
use crate::baseline::many_lights::LightPoint;
use crate::depth_layers::{Eye, MapView, MeshBounds, fit_occluders};
use glam::DMat4;

/// The windows of all samples. What bounds boxes' tangents from below is a concave function of the sample's place,
/// and from above a convex one, so between two ends a straight line holds them all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Windows {
    /// Least and largest u at the first end of a line and at its last.
    pub u: [[f64; 2]; 2],
    /// Least and largest v at the light's least y and at its largest.
    pub v: [[f64; 2]; 2],
}

/// A light that is as long along x as its longer side: lines run along x.
pub fn turned(light: &RectangleLight) -> RectangleLight {
    let [a, b] = light.half_extents();
    if b > a { light.quarter_turned() } else { *light }
}

/// A line has no width to be cut across.
pub fn for_light(settings: &Settings, light: &RectangleLight) -> Settings {
    let lines = if light.is_line() { 1 } else { settings.lines };
    Settings { lines, ..*settings }
}

/// What the samples see; none where no occluder is in front of the light. `w_far` is that of the furthest receiver.
pub fn windows(
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    settings: &Settings,
    side: u32,
    w_far: f64,
) -> Option<(Windows, MapView)> {
    let [a, b] = light.half_extents();
    let from = |x, y| fit_occluders(&light.moved([x, y]), occluders, None, side);
    let (first, last) = (from(-a, 0.0)?, from(a, 0.0)?);
    let (low, high) = (from(0.0, -b)?, from(0.0, b)?);
    // A skin is seen as far from its edge as its samples lie apart (section 3.2).
    let apart = 2.0 * a / f64::from(settings.samples - 1);
    let more = apart * (1.0 / first.near - w_far).max(0.0);
    let u = [first, last].map(|v| {
        let texel = (v.max[0] - v.min[0] + 2.0 * more) / f64::from(side);
        [v.min[0] - more - texel, v.max[0] + more + texel]
    });
    let v = [low, high].map(|v| [v.min[1], v.max[1]]);
    Some((Windows { u, v }, first))
}

/// The samples of all lines, line by line, with their maps.
pub fn samples(
    light: &RectangleLight,
    windows: &Windows,
    settings: &Settings,
    nominal: &MapView,
) -> Vec<LightPoint> {
    let half = light.half_extents();
    let mix = |ends: &[[f64; 2]; 2], t: f64, i: usize| ends[0][i] + t * (ends[1][i] - ends[0][i]);
    let lines = settings.lines;
    (0..lines)
        .flat_map(|line| (0..settings.samples).map(move |nth| (line, nth)))
        .map(|(line, nth)| {
            let along = f64::from(nth) / f64::from(settings.samples - 1);
            let across = (f64::from(line) + 0.5) / f64::from(lines);
            let [min, max] =
                [0, 1].map(|i| [mix(&windows.u, along, i), mix(&windows.v, across, i)]);
            LightPoint {
                at: [(2.0 * along - 1.0) * half[0], (2.0 * across - 1.0) * half[1]],
                view: MapView { eye: Eye::Behind(0.0), min, max, ..*nominal },
            }
        })
        .collect()
}
