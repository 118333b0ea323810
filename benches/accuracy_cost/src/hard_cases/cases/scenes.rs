//! Hard as scenes are that people have: many things at many distances, and surfaces that block what they receive.
//!
//! A street under a sun is none of them: the lights here are rectangles, and a rectangle as far away as a sun is another
//! light than a sun. `tests/techniques/views.rs` has one.

use super::{FLATTENED, HardCase, Limit, Noise, light, moved};
use crate::hard_cases::set::{Block, Floor, Pixels, Set, Shape};
use antumbra::scene::Role;
use glam::{DMat4, DVec3};
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
        of("boards at three heights in a corner of a room", room()),
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

/// Pixels look down on the floor: by a camera a raster of few sub-pixel bits moves a plane that it does not face, by
/// millimetres where pixels are as large as here, and what blocks itself is then shadowed by itself.
fn above(half: f64) -> Pixels {
    Pixels::Above { at: DMat4::IDENTITY, half, top: 8.0 }
}

/// Walls reach to 2.6 m, two thirds of the way to the lamp.
fn room() -> Set {
    // Nothing touches the floor: what blocks and receives is told from what rests on it by a texel alone.
    let blocks = vec![
        stand([1.2, 0.04, 0.8], [0.0, 0.72, -0.3]),
        stand([0.35, 0.05, 0.35], [0.45, 0.45, 0.5]),
        stand([1.4, 0.03, 0.25], [-0.6, 1.5, -0.9]),
    ];
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
        pixels: above(1.9),
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
        pixels: above(3.5),
    }
}
