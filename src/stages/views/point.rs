//! A point on a light, and what it sees.

use crate::stages::depth_layers::MapView;
use glam::{DMat4, DVec3};

/// A point on the light and how it sees the occluders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// Metres from the light's centre along its x and y.
    pub at: [f64; 2],
    /// Its map.
    pub view: MapView,
}

impl LightPoint {
    /// Light space to the map's clip space.
    pub fn clip_from_light(&self) -> DMat4 {
        let [x, y] = self.at;
        self.view.clip_from_light() * DMat4::from_translation(DVec3::new(-x, -y, 0.0))
    }
}
