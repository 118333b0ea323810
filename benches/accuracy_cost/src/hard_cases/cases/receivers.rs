//! Hard by who looks.

use super::{
    ASIDE, CARD, HardCase, LIGHT, Limit, Noise, ONE_RECEIVER, SKINS, base, card, ground, moved,
    sheet,
};
use crate::hard_cases::set::{Floor, Pixels, Set};
use antumbra::scene::{Camera, Lens, Role};
use glam::{DMat4, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

fn of(name: impl Into<String>, set: Set) -> HardCase {
    HardCase::new(Limit::Receiver, name, set)
}

pub(super) fn all() -> Vec<HardCase> {
    let angles = [45.0, 80.0, 89.0, 89.9];
    let roles = [Role::Receiver, Role::Both];
    let grazed = angles.into_iter().flat_map(|angle| roles.map(|role| grazed(angle, role)));
    grazed.chain(distances()).chain([striped()]).collect()
}

/// A wall through the origin that the light's centre sees at an angle, degrees from its normal.
fn grazed(degrees: f64, role: Role) -> HardCase {
    let at = DMat4::from_rotation_x(degrees.to_radians());
    let set = Set {
        blocks: vec![sheet([0.4; 2], card(CARD).at)],
        floors: vec![Floor { at, size: [6.0; 2], role, tiles: 1 }],
        pixels: Pixels::Above { at, half: 1.6, top: 8.0 },
        ..base()
    };
    let what = if role.blocks() { "a surface that blocks" } else { "a surface" };
    let case = of(format!("{what} at {degrees}°"), set);
    match (role.blocks(), degrees) {
        (true, 89.0) => case
            .known_for(&["soft-shadow-map, blended"], ONE_RECEIVER)
            .known_for(&["occlusion-textures"], OWN_SLICE),
        (true, 89.9) => case.known_for(&["soft-shadow-map, blended"], ONE_RECEIVER),
        (false, 89.0) => case.known_for(&["linear-light"], SKINS),
        _ => case,
    }
}

/// Why slices are coarse where a surface runs along the light's rays.
const OWN_SLICE: &str =
    "a surface that the light grazes is in every slice, and only its own fades in";

/// What a camera's raster makes of a floor that it looks along.
const SNAPPED: [Noise; 1] = [Noise {
    technique: "soft-shadow-map",
    words: "technique=soft-shadow-map",
    worst: 0.06,
    mean: 0.06,
    why: "half a texel's diagonal, 1.2e-4, and vertices of the floor that a raster of 4 sub-pixel bits moves by a 32nd of \
          a pixel: 3 cm of what the camera sees, of a penumbra of 50 cm",
}];

fn distances() -> Vec<HardCase> {
    let near = Floor { at: moved(0.0, 3.0, 0.0), ..ground() };
    let camera = Camera {
        world_from_view: moved(0.0, 1.0, 6.0) * DMat4::from_rotation_x(-0.2),
        lens: Lens::Perspective { yfov: FRAC_PI_3 },
        near: 0.01,
    };
    let wide = Floor { size: [500.0; 2], tiles: 128, ..ground() };
    let close = Floor { at: moved(0.0, LIGHT - 1e-2, 0.0), ..ground() };
    let between = sheet([0.1; 2], moved(0.0371, LIGHT - 5e-3, -0.0193));
    let at_near = Camera {
        world_from_view: moved(0.6, 0.0101, 0.1) * DMat4::from_rotation_x(-FRAC_PI_2),
        ..camera
    };
    let maps = ["soft-shadow-map", "soft-shadow-map, blended"];
    let aside = [&maps[..], &["linear-light", "many-lights", "back-projection"]].concat();
    vec![
        of("nearer than every occluder", Set { floors: vec![near], ..base() }),
        HardCase {
            noise: SNAPPED.into(),
            ..of(
                "to the horizon",
                Set { floors: vec![wide], pixels: Pixels::Camera(camera), ..base() },
            )
        },
        of("at the camera's near plane", Set { pixels: Pixels::Camera(at_near), ..base() }),
        of(
            "a hundredth of a metre from the light",
            Set { floors: vec![close], blocks: vec![between], ..base() },
        )
        .known_for(&aside, ASIDE),
    ]
}

/// Stripes at two heights, as a stair's edges are.
fn striped() -> HardCase {
    let stripe = |i: i32| {
        let height = if i % 2 == 0 { 0.0 } else { 1.9 };
        let at = DMat4::from_translation(DVec3::new(0.5 * f64::from(i) - 1.75, height, 0.0));
        Floor { at, size: [0.5, 20.0], role: Role::Receiver, tiles: 1 }
    };
    of("stripes at two heights", Set { floors: (0..8).map(stripe).collect(), ..base() })
        .known_for(&["soft-shadow-map, blended"], ONE_RECEIVER)
        .known_for(&["linear-light"], SKINS)
}
