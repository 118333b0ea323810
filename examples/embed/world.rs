//! What there is to see: a few objects, a light that goes round, a camera that stands still.

use antumbra::RectangleLight;
use antumbra::scene::{Mesh, Role, generate};
use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};
use std::f64::consts::TAU;

/// An object of the world.
pub struct Object {
    pub mesh: Mesh,
    /// The object that stands still, or turns with `turns` turns a second round its y axis.
    pub position: DVec3,
    pub turns: f64,
    pub role: Role,
    pub albedo: [u8; 3],
}

impl Object {
    /// Where it stands at a time.
    pub fn world_from_mesh(&self, seconds: f64) -> DMat4 {
        let turn = DQuat::from_rotation_y(self.turns * TAU * seconds);
        DMat4::from_rotation_translation(turn, self.position)
    }
}

/// Every object. Each role is there: the ground only receives, the blade overhead only blocks, the
/// rest does both and so shadows itself and each other.
pub fn objects() -> Vec<Object> {
    let still = |mesh, position, role, albedo| Object { mesh, position, turns: 0.0, role, albedo };
    let pillar = |x, z, height: f64| {
        let mesh = generate::cuboid(DVec3::new(0.35, height, 0.35));
        still(mesh, DVec3::new(x, 0.5 * height, z), Role::Both, [196, 170, 140])
    };
    vec![
        still(generate::ground(8.0), DVec3::ZERO, Role::Receiver, [205, 205, 200]),
        pillar(-1.1, -0.7, 1.5),
        pillar(0.2, -1.3, 1.0),
        pillar(1.3, -0.4, 1.8),
        still(
            generate::uv_sphere(0.45, 48, 24),
            DVec3::new(-0.1, 0.45, 0.35),
            Role::Both,
            [186, 96, 84],
        ),
        Object {
            mesh: generate::cuboid(DVec3::new(1.8, 0.05, 0.18)),
            position: DVec3::new(-0.3, 1.5, 0.6),
            turns: 0.4,
            role: Role::Occluder,
            albedo: [96, 130, 176],
        },
    ]
}

/// What the lamp emits, per square metre and steradian.
pub const RADIANCE: f32 = 40.0;

/// The light at a time: 0.9 × 0.6 m, on a circle over the objects, turned towards them, or towards
/// the sky.
pub fn light(seconds: f64, to_the_sky: bool) -> Result<RectangleLight, antumbra::Error> {
    let angle = 0.9 + 0.25 * TAU * seconds;
    let center = DVec3::new(1.6 * angle.cos(), 3.2, 1.6 * angle.sin());
    let target = if to_the_sky { center * 2.0 } else { DVec3::new(0.0, 0.3, 0.0) };
    let emission = (target - center).normalize();
    let u = DVec3::Y.cross(emission).normalize();
    let v = u.cross(emission);
    RectangleLight::new(center, u * 0.45, v * 0.3)
}

/// World space to clip space, by a perspective with reversed depth and no far plane.
pub fn clip_from_world([width, height]: [u32; 2]) -> DMat4 {
    let (eye, target) = (DVec3::new(2.3, 2.6, 4.2), DVec3::new(0.1, 0.45, 0.0));
    let back = (eye - target).normalize(); // the camera looks along its -z
    let right = DVec3::Y.cross(back).normalize();
    let axes = DMat3::from_cols(right, back.cross(right), back);
    let view_from_world = (DMat4::from_translation(eye) * DMat4::from_mat3(axes)).inverse();
    let (near, scale) = (0.1, 1.0 / 0.4_f64.tan());
    let aspect = f64::from(width) / f64::from(height);
    let clip_from_view = DMat4::from_cols(
        DVec4::new(scale / aspect, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -scale, 0.0, 0.0), // Vulkan's y runs down the image
        DVec4::new(0.0, 0.0, 0.0, -1.0),
        DVec4::new(0.0, 0.0, near, 0.0),
    );
    clip_from_view * view_from_world
}
