//! A line of a light, and the windows of the maps of the samples on it.

use glam::{DMat4, DVec3, DVec4};

/// A line of a light. In its own space the line's middle is the origin, and light space is turned about the light's
/// axis.
///
/// The least tangent of a box is a concave function of a sample's place, and the largest a convex one, so windows that
/// are interpolated between the line's two ends hold the boxes for every sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The line's x along the light's x and y: a unit vector.
    pub along: [f64; 2],
    /// The line's middle, metres from the light's centre.
    pub middle: [f64; 2],
    /// Half the line's length, metres.
    pub half: f64,
    /// The line's share of the light, 0 to 1.
    pub weight: f64,
    /// The least and largest u at its first end and at its last, tangents.
    pub u: [[f64; 2]; 2],
    /// The least and largest v, tangents.
    pub v: [f64; 2],
    /// The distance of its maps' near plane from the light, metres.
    pub near: f64,
}

impl Line {
    /// The line that a frame without lines declares its passes with.
    pub const NONE: Self = Self {
        along: [1.0, 0.0],
        middle: [0.0; 2],
        half: 0.5,
        weight: 1.0,
        u: [[-1.0, 1.0]; 2],
        v: [-1.0, 1.0],
        near: 1.0,
    };

    /// The least and largest u at its first end, then at its last.
    pub(crate) fn u_window(&self) -> [f32; 4] {
        let [[a, b], [c, d]] = self.u;
        [a, b, c, d].map(|x| x as f32)
    }

    /// Whether an occluder may come nearer to the line than a tenth of its length. Such an occluder's edges may lie
    /// further aside than any map shows, and the middle's map is no guide to what other samples see.
    pub(crate) fn is_touched(&self) -> bool {
        self.near < 0.2 * self.half
    }

    /// The line's length, metres.
    pub(crate) fn length(&self) -> f32 {
        (2.0 * self.half) as f32
    }

    /// The matrix from light space to the input of `view.glsl`: x in metres from the line's middle, and y, z and w of
    /// the clip space that all maps of the line share.
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
