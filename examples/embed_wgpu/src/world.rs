//! The world of the example, from a glTF file, and the camera as a matrix.

use crate::Outcome;
use antumbra::RectangleLight;
use antumbra::scene::{AreaLight, Camera, Scene, from_gltf};
use glam::{DMat4, DVec3, Vec3};
use std::f64::consts::PI;
use std::path::Path;

/// A scene with at least one triangle and one light.
pub struct World {
    pub scene: Scene,
    pub light: AreaLight,
}

impl World {
    /// Loads a file.
    pub fn load(path: &Path) -> Outcome<Self> {
        let scene = from_gltf(path)?;
        if scene.triangles() == 0 {
            return Err(format!("{}: the scene has no triangles", path.display()).into());
        }
        let light = scene.light(None).map_err(|e| format!("{}: {e}", path.display()))?.clone();
        Ok(Self { scene, light })
    }

    /// The light's rectangle, which stands for it in the picture.
    pub fn rectangle(&self) -> &RectangleLight {
        self.light.light.rectangle()
    }

    /// The light's radiance in red, green and blue, chosen so that white paper in the middle of the occluders would be
    /// white in the picture.
    pub fn radiance(&self) -> DVec3 {
        let light = self.rectangle();
        let middle = self.scene.bounds(|i| i.role.blocks()).map_or(DVec3::ZERO, |b| b.center());
        let [a, b] = light.half_extents();
        let share = 4.0 * a * b / middle.distance_squared(light.center());
        let color = Vec3::from(self.light.color);
        (color / color.max_element().max(1e-6)).as_dvec3() * PI / share
    }

    /// The file's camera, or one that frames what casts shadows.
    pub fn view(&self, [width, height]: [u32; 2]) -> View {
        let aspect = f64::from(width) / f64::from(height);
        let camera = self.scene.camera.unwrap_or_else(|| Camera::framing(&self.scene, aspect));
        // wgpu's y runs up the image, and Vulkan's down.
        let clip_from_view =
            DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0)) * camera.clip_from_view(aspect);
        View { clip_from_world: clip_from_view * camera.world_from_view.inverse() }
    }
}

/// The camera, as wgpu wants it: in clip space y runs up the image.
#[derive(Clone, Copy)]
pub struct View {
    pub clip_from_world: DMat4,
}

impl View {
    /// The matrix from pixels and depth to the world, with y as in Vulkan and so in the node: y runs down, and row 0 of
    /// the image lies at −1.
    pub fn world_from_ndc(&self) -> DMat4 {
        (down_from_up() * self.clip_from_world).inverse()
    }
}

/// wgpu's clip space (y up) to Vulkan's (y down), and back.
pub fn down_from_up() -> DMat4 {
    DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0))
}
