//! A furnished room in code: everything in it blocks and receives, as in the rooms that people have.

use antumbra::RectangleLight;
use antumbra::scene::{AreaLight, Camera, Lens, Role, Scene, generate};
use glam::{DMat3, DMat4, DVec3};

/// A room of 4 by 4 by 2.6 metres with a table, chairs, shelves and a ball, under a panel at its ceiling.
///
/// # Panics
/// Never: the numbers are legal.
pub fn room() -> Scene {
    let mut scene = Scene::default();
    let mut block = |name: &str, size: [f64; 3], at: [f64; 3]| {
        let place = DMat4::from_translation(DVec3::from_array(at));
        scene.add(name, generate::cuboid(DVec3::from_array(size)), place, Role::Both);
    };
    block("floor", [4.0, 0.1, 4.0], [0.0, -0.05, 0.0]);
    block("back", [4.0, 2.6, 0.1], [0.0, 1.3, -2.05]);
    block("left", [0.1, 2.6, 4.0], [-2.05, 1.3, 0.0]);
    block("table", [1.4, 0.05, 0.8], [0.2, 0.75, 0.1]);
    for (i, (x, z)) in [(-0.4, -0.2), (0.8, -0.2), (-0.4, 0.4), (0.8, 0.4)].into_iter().enumerate()
    {
        block(&format!("leg {i}"), [0.06, 0.73, 0.06], [x, 0.365, z]);
    }
    for (i, x) in [-0.9, 1.3].into_iter().enumerate() {
        block(&format!("seat {i}"), [0.4, 0.04, 0.4], [x, 0.45, 0.1]);
        block(&format!("rest {i}"), [0.04, 0.5, 0.4], [x + 0.2 * f64::signum(x), 0.7, 0.1]);
        block(&format!("foot {i}"), [0.08, 0.43, 0.08], [x, 0.215, 0.1]);
    }
    for (i, y) in [0.4, 0.9, 1.4, 1.9].into_iter().enumerate() {
        block(&format!("shelf {i}"), [1.6, 0.03, 0.3], [-1.0, y, -1.83]);
        block(&format!("book {i}"), [0.3, 0.25, 0.2], [-1.4 + 0.25 * i as f64, y + 0.14, -1.83]);
    }
    let ball = DMat4::from_translation(DVec3::new(0.0, 0.9, 0.1));
    scene.add("ball", generate::uv_sphere(0.12, 32, 16), ball, Role::Both);
    let panel =
        RectangleLight::facing(DVec3::new(0.4, 2.55, 0.2), DVec3::NEG_Y, DVec3::NEG_Z, [0.9, 0.4]);
    scene.lights.push(AreaLight {
        name: "panel".into(),
        light: panel.unwrap().into(),
        color: [1.0; 3],
        intensity: 1.0,
    });
    scene
}

/// The way a visitor sees the room.
pub fn camera() -> Camera {
    let (eye, target) = (DVec3::new(1.9, 1.7, 2.6), DVec3::new(-0.2, 0.6, -0.4));
    let z = (eye - target).normalize();
    let x = DVec3::Y.cross(z).normalize();
    let world_from_view =
        DMat4::from_translation(eye) * DMat4::from_mat3(DMat3::from_cols(x, z.cross(x), z));
    Camera { world_from_view, lens: Lens::Perspective { yfov: 0.9 }, near: 0.05 }
}
