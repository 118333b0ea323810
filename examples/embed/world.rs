//! The world of the example: a few objects under a light that goes round, or a scene from a file.

use crate::Outcome;
use crate::figure;
use crate::gbuffer::GBuffer;
use crate::geometry::Model;
use crate::posing::Skinned;
use crate::skin::Skin;
use antumbra::scene::{Camera, Lens, Mesh, Role, Scene, from_gltf, generate};
use antumbra::{Light, RectangleLight};
use glam::{DMat3, DMat4, DVec3};
use std::f64::consts::TAU;
use std::path::Path;

/// The inputs of a frame, and the images it is drawn into.
pub struct Seen<'a> {
    pub light: &'a Light,
    pub clip_from_world: &'a DMat4,
    pub models: &'a [Model],
    pub gbuffer: &'a GBuffer,
    pub seconds: f64,
    pub slot: usize,
    /// Another number wherever the light or a model has changed since the last frame; `None` where both may.
    pub revision: Option<u64>,
}

/// An object of the world.
pub struct Object {
    pub mesh: Mesh,
    /// The object's transform at rest; it turns with `turns` turns a second round its y axis.
    pub stand: DMat4,
    pub turns: f64,
    /// The distance, in metres, that a jelly swells and shrinks along its normals; `None` for a rigid object.
    pub jelly: Option<f32>,
    /// The skin of a mesh that is posed on the device; `None` where its vertices stay.
    pub skin: Option<Skin>,
    pub role: Role,
    pub albedo: [u8; 3],
}

impl Object {
    /// The object's transform at a time.
    pub fn world_from_mesh(&self, seconds: f64) -> DMat4 {
        self.stand * DMat4::from_rotation_y(self.turns * TAU * seconds)
    }
}

/// Objects, light and camera.
pub struct World {
    pub objects: Vec<Object>,
    /// A light that stays, and a camera; without, the light goes round and objects turn.
    fixed: Option<(Light, Camera)>,
}

impl World {
    /// The world that this example brings.
    pub fn built_in() -> Self {
        Self { objects: objects(), fixed: None }
    }

    /// A figure that walks between pillars under a lamp.
    pub fn walk() -> Outcome<Self> {
        let (mesh, skin) = figure::walking()?;
        let stand = DMat4::from_translation(DVec3::new(-2.0, 0.0, 0.1));
        let figure = Object {
            mesh,
            stand: stand * DMat4::from_rotation_y(0.25 * TAU),
            turns: 0.0,
            jelly: None,
            skin: Some(skin),
            role: Role::Both,
            albedo: [196, 150, 110],
        };
        let objects = vec![
            still(generate::ground(9.0), DVec3::ZERO, Role::Receiver, [205, 205, 200]),
            pillar(-0.9, -0.9, 1.9),
            pillar(1.1, -0.8, 1.3),
            pillar(0.5, 1.0, 0.8),
            figure,
        ];
        let (center, target) = (DVec3::new(2.4, 3.0, -0.2), DVec3::new(0.0, 0.5, 0.0));
        let lamp = RectangleLight::facing(center, target - center, DVec3::Y, [0.6, 0.4])?;
        let camera = camera(DVec3::new(-0.9, 2.2, 4.6), DVec3::new(-0.1, 0.7, 0.0));
        Ok(Self { objects, fixed: Some((lamp.into(), camera)) })
    }

    /// A glTF scene under its first area light, through its camera or one that frames it.
    pub fn from_file(path: &Path, [width, height]: [u32; 2]) -> Outcome<Self> {
        let scene = from_gltf(path)?;
        let light = scene.light(None)?.light;
        let aspect = f64::from(width) / f64::from(height);
        let camera = scene.camera.unwrap_or_else(|| Camera::framing(&scene, aspect));
        let Scene { meshes, instances, .. } = scene;
        let objects = instances.into_iter().map(|i| Object {
            mesh: meshes[i.mesh].clone(),
            stand: i.world_from_mesh,
            turns: 0.0,
            jelly: None,
            skin: None,
            role: i.role,
            albedo: [200, 196, 190],
        });
        let objects = objects.filter(|o| !o.mesh.indices.is_empty()).collect();
        Ok(Self { objects, fixed: Some((light, camera)) })
    }

    /// The light at a time; with `to_the_sky` it shines at the sky, where it can move there.
    pub fn light(&self, seconds: f64, to_the_sky: bool) -> Outcome<Light> {
        match &self.fixed {
            Some((light, _)) => Ok(*light),
            None => Ok(light(seconds, to_the_sky)?.into()),
        }
    }

    /// A number that differs from the last frame's wherever the light or an object has changed; `None` where they move in
    /// every frame. Posed models alone move under a light that stays, and each counts its own poses.
    pub fn revision(&self, models: &[Model]) -> Option<u64> {
        let skinned = models.iter().filter_map(|model| model.skinned.as_ref());
        self.fixed.as_ref().map(|_| skinned.map(Skinned::revision).sum())
    }

    /// World space to clip space, by a perspective with reversed depth and no far plane.
    pub fn clip_from_world(&self, [width, height]: [u32; 2]) -> DMat4 {
        let camera = self.fixed.as_ref().map_or_else(overview, |(_, camera)| *camera);
        let aspect = f64::from(width) / f64::from(height);
        camera.clip_from_view(aspect) * camera.world_from_view.inverse()
    }
}

/// An object that stands still.
fn still(mesh: Mesh, at: DVec3, role: Role, albedo: [u8; 3]) -> Object {
    let stand = DMat4::from_translation(at);
    Object { mesh, stand, turns: 0.0, jelly: None, skin: None, role, albedo }
}

fn pillar(x: f64, z: f64, height: f64) -> Object {
    let mesh = generate::cuboid(DVec3::new(0.35, height, 0.35));
    still(mesh, DVec3::new(x, 0.5 * height, z), Role::Both, [196, 170, 140])
}

/// Every object. Each role is there: the ground only receives, the blade overhead only blocks, the
/// rest does both and so shadows itself and each other. The sphere is a jelly.
fn objects() -> Vec<Object> {
    let sphere = generate::uv_sphere(0.45, 96, 48);
    let sphere = still(sphere, DVec3::new(-0.1, 0.45, 0.35), Role::Both, [186, 96, 84]);
    let blade = generate::cuboid(DVec3::new(1.8, 0.05, 0.18));
    let blade = still(blade, DVec3::new(-0.3, 1.5, 0.6), Role::Occluder, [96, 130, 176]);
    vec![
        still(generate::ground(8.0), DVec3::ZERO, Role::Receiver, [205, 205, 200]),
        pillar(-1.1, -0.7, 1.5),
        pillar(0.2, -1.3, 1.0),
        pillar(1.3, -0.4, 1.8),
        Object { jelly: Some(0.07), ..sphere },
        Object { turns: 0.4, ..blade },
    ]
}

/// The lamp's radiance, per square metre and steradian.
pub const RADIANCE: f32 = 40.0;

/// The light at a time: 0.9 × 0.6 m, on a circle over the objects, turned towards them, or towards
/// the sky.
fn light(seconds: f64, to_the_sky: bool) -> Result<RectangleLight, antumbra::Error> {
    let angle = 0.9 + 0.25 * TAU * seconds;
    let center = DVec3::new(1.6 * angle.cos(), 3.2, 1.6 * angle.sin());
    let target = if to_the_sky { center * 2.0 } else { DVec3::new(0.0, 0.3, 0.0) };
    let emission = (target - center).normalize();
    let u = DVec3::Y.cross(emission).normalize();
    let v = u.cross(emission);
    RectangleLight::new(center, u * 0.45, v * 0.3)
}

/// The camera that sees all of the objects.
fn overview() -> Camera {
    camera(DVec3::new(2.3, 2.6, 4.2), DVec3::new(0.1, 0.45, 0.0))
}

/// A camera at a point that looks at another.
fn camera(eye: DVec3, target: DVec3) -> Camera {
    let back = (eye - target).normalize(); // the camera looks along its -z
    let right = DVec3::Y.cross(back).normalize();
    let axes = DMat3::from_cols(right, back.cross(right), back);
    let world_from_view = DMat4::from_translation(eye) * DMat4::from_mat3(axes);
    Camera { world_from_view, lens: Lens::Perspective { yfov: 0.8 }, near: 0.1 }
}
