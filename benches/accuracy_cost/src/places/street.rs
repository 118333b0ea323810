//! A street under a sun: thin things before a wide ground, near ones and far ones.

use super::{Builder, looking};
use crate::Problem;
use antumbra::Light;
use antumbra::scene::{Camera, Scene, generate};
use glam::{DMat4, DVec3};

pub const STREET: &str = "street";

/// The name of its sun.
pub const SUN: &str = "sun";

/// The sun's angle as seen from the Earth, radians.
const ANGLE: f64 = 0.0093;

/// Half the width and depth of the ground, m.
const GROUND: [f64; 2] = [60.0, 120.0];

/// The street, by somebody on its left pavement.
pub fn street() -> Result<Scene, Problem> {
    let mut street = Builder::new();
    let ground = generate::quad(2.0 * GROUND[0], 2.0 * GROUND[1]);
    street.add("ground", ground, DMat4::from_translation(DVec3::NEG_Z * (GROUND[1] - 20.0)));
    for (name, x) in [("left pavement", -4.75), ("right pavement", 4.75)] {
        street.stand(name, [2.5, 0.12, 140.0], [x, 0.0, -60.0]);
    }
    houses(&mut street);
    fence(&mut street);
    car(&mut street, 0, [2.3, -4.0], 0.05);
    car(&mut street, 1, [2.4, -11.5], -0.03);
    for (i, z) in [-6.0, -15.0, -27.0].into_iter().enumerate() {
        tree(&mut street, i as u32, [-4.2, z])?;
    }
    for (i, z) in [-2.0, -22.0, -42.0, -62.0].into_iter().enumerate() {
        street.column(&format!("post {i}"), 0.06, 4.6, [3.8, 0.12, z]);
        street.stand(&format!("arm {i}"), [1.3, 0.06, 0.06], [3.2, 4.6, z]);
    }
    street.stand("bin", [0.5, 0.9, 0.5], [-3.9, 0.12, -3.0]);
    street.stand("bench seat", [0.45, 0.05, 1.6], [-5.4, 0.55, -8.5]);
    for (i, z) in [-9.1, -7.9].into_iter().enumerate() {
        street.stand(&format!("bench leg {i}"), [0.4, 0.43, 0.06], [-5.4, 0.12, z]);
    }
    let emission = DVec3::new(-0.35, -0.8, -0.3);
    street.light(SUN, Light::sun(emission, ANGLE, DVec3::NEG_Z * 50.0, 140.0)?);
    let down = DVec3::NEG_Y;
    street.lamp("street lamp", [2.65, 4.56, -2.0], down, DVec3::Z, [0.5, 0.2])?;
    street.lamp("shop window", [-6.45, 1.4, -4.0], DVec3::X, DVec3::Y, [2.2, 1.2])?;
    let mut scene = street.0;
    scene.camera = Some(walk(0.0));
    Ok(scene)
}

/// Along the left pavement for 12 m, the head turning from the fence to the cars and back.
pub fn walk(at: f64) -> Camera {
    let eye =
        DVec3::new(-2.6 + 0.4 * (4.0 * at).sin(), 1.75 + 0.03 * (40.0 * at).sin(), 3.0 - 12.0 * at);
    let turn = 0.12 + 0.3 * (6.0 * at).sin();
    looking(eye, eye + DVec3::new(turn.sin(), -0.22, -turn.cos()), 0.9)
}

/// Two rows of houses with doors set back, balconies and eaves.
fn houses(street: &mut Builder) {
    for i in 0..9_u32 {
        let (z, nth) = (-12.0 * f64::from(i) - 1.0, f64::from(i));
        let height = 6.0 + 2.0 * (2.3 * nth).sin();
        for (side, name) in [(-1.0, "left"), (1.0, "right")] {
            let x = side * 10.5;
            street.stand(&format!("{name} house {i}"), [8.0, height, 10.0], [x, 0.0, z - 3.0]);
            let face = x - side * 4.0;
            street.stand(&format!("{name} eaves {i}"), [0.9, 0.15, 10.4], [face, height, z - 3.0]);
            let balcony = face - side * 0.45;
            street.stand(&format!("{name} balcony {i}"), [0.9, 0.12, 3.0], [balcony, 3.0, z - 5.0]);
            street.stand(
                &format!("{name} rail {i}"),
                [0.04, 0.06, 3.0],
                [face - side * 0.88, 4.0, z - 5.0],
            );
            for k in 0..9 {
                let at = [face - side * 0.88, 3.12, z - 6.45 + 0.3625 * f64::from(k)];
                street.stand(&format!("{name} bar {i} {k}"), [0.025, 0.88, 0.025], at);
            }
        }
    }
}

/// Pickets and two rails along the left pavement.
fn fence(street: &mut Builder) {
    let x = -3.55;
    for i in 0..36_u32 {
        let z = 1.2 - 0.18 * f64::from(i);
        street.stand(&format!("picket {i}"), [0.02, 0.95, 0.07], [x, 0.12, z]);
    }
    for (i, y) in [0.4, 0.85].into_iter().enumerate() {
        street.stand(&format!("fence rail {i}"), [0.03, 0.05, 6.6], [x - 0.03, y, -1.95]);
    }
}

/// A car: a body over four wheels, and a cabin.
fn car(street: &mut Builder, nth: u32, [x, z]: [f64; 2], turn: f64) {
    street.turned(&format!("car {nth} body"), [1.7, 0.55, 4.2], [x, 0.28, z], turn);
    street.turned(&format!("car {nth} cabin"), [1.5, 0.55, 2.0], [x, 0.83, z + 0.2], turn);
    for (i, [a, b]) in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].iter().enumerate() {
        let at = [x + 0.75 * a, 0.0, z + 1.35 * b];
        street.turned(&format!("car {nth} wheel {i}"), [0.2, 0.6, 0.6], at, turn);
    }
}

/// A trunk under a crown of loose leaves.
fn tree(street: &mut Builder, nth: u32, [x, z]: [f64; 2]) -> Result<(), Problem> {
    street.column(&format!("trunk {nth}"), 0.13, 2.6, [x, 0.0, z]);
    let plant = generate::foliage(generate::square_light(1.0)?, 500, 7 + nth);
    let leaves = plant.instances.iter().find(|i| i.role.blocks()).ok_or("a plant has leaves")?;
    // A plant is a metre across and its middle 2 m above the ground.
    let crown = DMat4::from_translation(DVec3::new(x, 3.6, z))
        * DMat4::from_scale(DVec3::splat(3.0))
        * DMat4::from_translation(DVec3::NEG_Y * 2.0);
    street.add(
        &format!("crown {nth}"),
        plant.meshes[leaves.mesh].clone(),
        crown * leaves.world_from_mesh,
    );
    Ok(())
}
