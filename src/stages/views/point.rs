//! A point on a light, and its view of the occluders.

use crate::stages::depth_layers::{Eye, MapView};
use glam::{DMat4, DVec3, DVec4};

/// A point on the light with a view of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// The point's place, metres from the light's centre along its x and y. Of parallel light, which the view's eye at
    /// infinity tells, it is a direction: how far x and y go towards the point for each metre towards the light.
    pub at: [f64; 2],
    /// The view of the point's map.
    pub view: MapView,
}

impl LightPoint {
    /// The matrix from light space to the space of the point's map: its origin is the point, or where light is parallel
    /// its x and y are the same all along a ray to the point.
    pub fn point_from_light(&self) -> DMat4 {
        let [x, y] = self.at;
        match self.view.eye {
            Eye::Behind(_) => DMat4::from_translation(DVec3::new(-x, -y, 0.0)),
            Eye::Infinity => {
                DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(x, y, 1.0, 0.0), DVec4::W)
            }
        }
    }

    /// The matrix from light space to the map's clip space.
    pub fn clip_from_light(&self) -> DMat4 {
        self.view.clip_from_light() * self.point_from_light()
    }
}
