//! Which lines a light is, and what their samples see.

use super::Settings;
use crate::RectangleLight;
use crate::depth_layers::{MapView, MeshBounds, fit_occluders};
use glam::{DMat4, DVec3, DVec4};

/// A line of a light. Its own space is light space turned about the light's axis, its middle the origin.
///
/// What bounds boxes' tangents from below is a concave function of a sample's place, and from above a convex one, so
/// between two ends a straight line holds them all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Its x along the light's x and y: a unit vector.
    pub along: [f64; 2],
    /// Its middle, metres from the light's centre.
    pub middle: [f64; 2],
    /// Half its length, metres.
    pub half: f64,
    /// Its share of the light, 0 to 1.
    pub weight: f64,
    /// Least and largest u at its first end and at its last.
    pub u: [[f64; 2]; 2],
    /// Least and largest v.
    pub v: [f64; 2],
    /// Distance of its maps' near plane, metres.
    pub near: f64,
}

impl Line {
    /// What stands where a frame has no line.
    pub const NONE: Self = Self {
        along: [1.0, 0.0],
        middle: [0.0; 2],
        half: 0.5,
        weight: 1.0,
        u: [[-1.0, 1.0]; 2],
        v: [-1.0, 1.0],
        near: 1.0,
    };

    /// Least and largest u at its first end, at its last.
    pub(super) fn u_window(&self) -> [f32; 4] {
        let [[a, b], [c, d]] = self.u;
        [a, b, c, d].map(|x| x as f32)
    }

    /// Its length in metres.
    pub(super) fn length(&self) -> f32 {
        (2.0 * self.half) as f32
    }

    /// Light space to what `view.glsl` takes: x in metres from the line's middle, and y, z and w of the clip space that
    /// all maps of the line share.
    pub fn line_from_light(&self) -> DMat4 {
        let [c, s] = self.along;
        let [x, y] = self.middle;
        let height = self.v[1] - self.v[0];
        let tall = 2.0 / height;
        let project = DMat4::from_cols(
            DVec4::X,
            DVec4::Y * tall,
            DVec4::new(0.0, -(self.v[1] + self.v[0]) / height, 0.0, 1.0),
            DVec4::new(0.0, 0.0, self.near, 0.0),
        );
        project
            * DMat4::from_rotation_z(-s.atan2(c))
            * DMat4::from_translation(DVec3::new(-x, -y, 0.0))
    }
}

/// A light that is as long along x as its longer side: lines run along x.
pub fn turned(light: &RectangleLight) -> RectangleLight {
    let [a, b] = light.half_extents();
    if b > a { light.quarter_turned() } else { *light }
}

/// The lines of a light and what their samples see; empty where no occluder is in front of it. `w_far` is that of the
/// furthest receiver.
pub fn lines(
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    settings: &Settings,
    side: u32,
    w_far: f64,
) -> Vec<Line> {
    let [a, b] = light.half_extents();
    let count = settings.lines_of(light);
    stacked(light, occluders, settings, side, w_far, [a, b], count).unwrap_or_default()
}

/// Lines side by side along x.
fn stacked(
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    settings: &Settings,
    side: u32,
    w_far: f64,
    [a, b]: [f64; 2],
    count: u32,
) -> Option<Vec<Line>> {
    let from = |x, y| fit_occluders(&light.moved([x, y]), occluders, None, side);
    let ends = [from(-a, 0.0)?, from(a, 0.0)?];
    let (low, high) = (from(0.0, -b)?, from(0.0, b)?);
    let u = widened(&ends, a, settings, side, w_far);
    let mix = |t: f64, [a, b]: [f64; 2]| a + t * (b - a);
    let of = |line: u32| {
        let across = (f64::from(line) + 0.5) / f64::from(count);
        Line {
            along: [1.0, 0.0],
            middle: [0.0, (2.0 * across - 1.0) * b],
            half: a,
            weight: 1.0 / f64::from(count),
            u,
            v: [mix(across, [low.min[1], high.min[1]]), mix(across, [low.max[1], high.max[1]])],
            near: ends[0].near,
        }
    };
    Some((0..count).map(of).collect())
}

/// The tangents of a line's ends, and as far beside them as skins are seen: samples see each other's as far from
/// their edges as they lie apart (section 3.2).
fn widened(
    ends: &[MapView; 2],
    half: f64,
    settings: &Settings,
    side: u32,
    w_far: f64,
) -> [[f64; 2]; 2] {
    let apart = 2.0 * half / f64::from(settings.fewest() - 1);
    let more = apart * (1.0 / ends[0].near - w_far).max(0.0);
    [0, 1].map(|i| {
        let (min, max) = (ends[i].min[0], ends[i].max[0]);
        let texel = (max - min + 2.0 * more) / f64::from(side);
        [min - more - texel, max + more + texel]
    })
}
