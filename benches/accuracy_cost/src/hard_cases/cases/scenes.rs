//! Hard as scenes are that people have: many things at many distances, and surfaces that block what they receive.
//!
//! A street under a sun is none of them: the lights here are rectangles, and a rectangle as far away as a sun is another
//! light than a sun. `tests/techniques/views.rs` has one.

use super::{FLATTENED, HardCase, Limit, Noise, light, moved};
use crate::hard_cases::set::{Block, Floor, Pixels, Set, Shape};
use antumbra::scene::{Camera, Lens, Role};
use glam::{DMat3, DMat4, DVec3};
use std::f64::consts::FRAC_PI_2;

/// So many slices that the fault below is that of the model and not of a default.
const SIXTEEN: Noise = Noise {
    technique: "occlusion-textures",
    words: "technique=occlusion-textures slices=16",
    worst: 0.0,
    mean: 0.0,
    why: "half a texel's diagonal, and a texel, within which only the mean is known; sums 1e-4",
};

pub(super) fn all() -> Vec<HardCase> {
    let of = |name: &str, set: Set| HardCase {
        // What is thinner than a texel is known to nobody, and scenes have thin things.
        map: 256,
        ..HardCase::new(Limit::Scene, name, set)
    };
    let hall = of("columns round a lamp of a hall", hall());
    vec![
        of("a table in a corner of a room", room()),
        HardCase { noise: vec![SIXTEEN], ..hall }.known_for(&["occlusion-textures"], FLATTENED),
    ]
}

/// A box of a size with the middle of its bottom at a place, which no pixel sees.
fn stand(size: [f64; 3], [x, y, z]: [f64; 3]) -> Block {
    let at = moved(x, y + 0.5 * size[1], z);
    Block { shape: Shape::Box(size.into()), at, role: Role::Occluder }
}

/// A plane that blocks and receives.
fn wall(at: DMat4, size: [f64; 2]) -> Floor {
    Floor { at, size, role: Role::Both, tiles: 1 }
}

fn looking(eye: DVec3, target: DVec3) -> Pixels {
    let z = (eye - target).normalize();
    let x = DVec3::Y.cross(z).normalize();
    let axes = DMat4::from_mat3(DMat3::from_cols(x, z.cross(x), z));
    let world_from_view = DMat4::from_translation(eye) * axes;
    Pixels::Camera(Camera { world_from_view, lens: Lens::Perspective { yfov: 0.9 }, near: 0.05 })
}

/// Walls reach to 2.6 m, two thirds of the way to the lamp.
fn room() -> Set {
    let mut blocks = vec![stand([1.2, 0.04, 0.8], [0.0, 0.72, -0.3])];
    for [a, b] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        blocks.push(stand([0.06, 0.72, 0.06], [0.55 * a, 0.0, -0.3 + 0.35 * b]));
    }
    let back = moved(0.0, 1.3, -2.0) * DMat4::from_rotation_x(FRAC_PI_2);
    let left = moved(-2.0, 1.3, 0.0) * DMat4::from_rotation_z(-FRAC_PI_2);
    Set {
        light: light([0.6; 2], DVec3::new(0.2, 4.0, 0.1)),
        blocks,
        floors: vec![
            wall(DMat4::IDENTITY, [4.0; 2]),
            wall(back, [4.0, 2.6]),
            wall(left, [2.6, 4.0]),
        ],
        pixels: looking(DVec3::new(1.7, 1.9, 1.8), DVec3::new(-0.4, 0.6, -0.7)),
    }
}

fn hall() -> Set {
    let mut blocks = Vec::new();
    for (i, j) in (0..3).flat_map(|i| (0..2).map(move |j| (f64::from(i), f64::from(j)))) {
        let [x, z] = [-1.6 + 3.2 * j, 1.0 - 2.0 * i];
        blocks.push(stand([0.7, 0.15, 0.7], [x, 0.0, z]));
        blocks.push(stand([0.4, 2.2, 0.4], [x, 0.15, z]));
    }
    blocks.push(stand([0.5, 0.9, 0.5], [0.3, 0.0, -1.9]));
    Set {
        light: light([0.5, 0.2], DVec3::new(0.3, 4.2, -0.2)),
        blocks,
        floors: vec![wall(DMat4::IDENTITY, [8.0; 2])],
        pixels: looking(DVec3::new(0.9, 1.7, 3.6), DVec3::new(-0.2, 0.6, -1.5)),
    }
}
