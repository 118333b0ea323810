//! A point on a light, and its view of the occluders.

use crate::stages::depth_layers::MapView;
use glam::{DMat4, DVec3};

/// A point on the light with a view of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// The point's place, metres from the light's centre along its x and y.
    pub at: [f64; 2],
    /// The view of the point's map.
    pub view: MapView,
}

impl LightPoint {
    /// The matrix from light space to the map's clip space.
    pub fn clip_from_light(&self) -> DMat4 {
        let [x, y] = self.at;
        self.view.clip_from_light() * DMat4::from_translation(DVec3::new(-x, -y, 0.0))
    }
}
