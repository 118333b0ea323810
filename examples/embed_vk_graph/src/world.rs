//! The world of the example: a glTF scene, its first light and its camera.

use crate::Outcome;
use antumbra::scene::{AreaLight, Camera, Scene, from_gltf};
use glam::DMat4;
use std::path::Path;

/// A scene with a light.
pub struct World {
    pub scene: Scene,
    pub light: AreaLight,
}

impl World {
    /// Reads a glTF file.
    pub fn load(path: &Path) -> Outcome<Self> {
        let scene = from_gltf(path)?;
        let light = scene.light(None).map_err(|e| format!("{}: {e}", path.display()))?.clone();
        if scene.triangles() == 0 {
            let path = path.display();
            return Err(
                format!("{path}: the scene has no triangles; at least one is needed").into()
            );
        }
        Ok(Self { scene, light })
    }

    /// World space to clip space: the scene's camera, or one that sees all of it, as a perspective
    /// with reversed depth and no far plane.
    pub fn clip_from_world(&self, [width, height]: [u32; 2]) -> DMat4 {
        let aspect = f64::from(width) / f64::from(height);
        let camera = self.scene.camera.unwrap_or_else(|| Camera::framing(&self.scene, aspect));
        camera.clip_from_view(aspect) * camera.world_from_view.inverse()
    }

    /// The radiance at which white paper amid the occluders, facing the light, is just white.
    pub fn exposure(&self) -> f32 {
        let [a, b] = self.light.light.rectangle().half_extents();
        let center = self.scene.bounds(|i| i.role.blocks()).map(|b| b.center());
        let r2 = center.map_or(1.0, |c| c.distance_squared(self.light.light.center()));
        (r2 / (4.0 * a * b)) as f32
    }
}
