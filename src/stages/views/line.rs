//! A line of a light, and what the samples on it see.

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
    pub(crate) fn u_window(&self) -> [f32; 4] {
        let [[a, b], [c, d]] = self.u;
        [a, b, c, d].map(|x| x as f32)
    }

    /// Whether an occluder may come nearer to it than a tenth of its length: what ends there may be further aside than
    /// any map looks, and the line's middle does not tell what its other parts see.
    pub(crate) fn is_touched(&self) -> bool {
        self.near < 0.2 * self.half
    }

    /// Its length in metres.
    pub(crate) fn length(&self) -> f32 {
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
