//! Hard by their light.

use super::{
    ASIDE, CARD, FLATTENED, HardCase, LIGHT, Limit, ONE_RECEIVER, SKINS, base, card, facing,
    ground, lamp, moved, sheet,
};
use crate::hard_cases::set::{Floor, Set};
use antumbra::scene::Role;
use glam::{DMat4, DVec3};
use std::f64::consts::FRAC_PI_2;

fn of(name: impl Into<String>, set: Set) -> HardCase {
    HardCase::new(Limit::Light, name, set)
}

pub(super) fn all() -> Vec<HardCase> {
    [sizes(), meets_occluder(), meets_receiver()].concat()
}

fn sizes() -> Vec<HardCase> {
    let side = |exponent: i32| {
        let side = 10.0_f64.powi(exponent);
        of(format!("1e{exponent} m wide"), Set { light: lamp([side; 2]), ..base() })
    };
    let narrow = |ratio: f64| {
        of(format!("1 m by 1/{ratio} m"), Set { light: lamp([1.0, 1.0 / ratio]), ..base() })
    };
    let sides = [-6, -4, -2, -1, 0, 1, 2, 3].map(side);
    let narrow = [1.0, 10.0, 100.0, 1000.0].map(narrow);
    sides.into_iter().chain(narrow).collect()
}

/// Touching, crossing and behind an occluder.
fn meets_occluder() -> Vec<HardCase> {
    let of = |name, block| of(name, Set { blocks: vec![block], ..base() });
    // Half of the light is within it.
    let in_plane = sheet([1.0; 2], moved(0.5, LIGHT, 0.0));
    let standing = |y| {
        let at = moved(0.03, y, 0.01) * DMat4::from_rotation_z(FRAC_PI_2);
        sheet([1.0; 2], at)
    };
    let edge_on =
        ["soft-shadow-map", "soft-shadow-map, blended", "occlusion-textures", "back-projection"];
    vec![
        of("a card in its plane, over half of it", in_plane),
        of("a card through it", standing(LIGHT))
            .known_for(&edge_on, FLATTENED)
            .known_for(&["hard"], ASIDE),
        // Occlusion textures see it from behind the light.
        of("a card that stands on it", standing(LIGHT - 0.5))
            .known_for(
                &["soft-shadow-map", "soft-shadow-map, blended", "back-projection"],
                FLATTENED,
            )
            .known_for(&["hard"], ASIDE),
        of("a card behind it", card(LIGHT + 0.5)),
    ]
}

/// Behind the receiver, and in its plane.
fn meets_receiver() -> Vec<HardCase> {
    let below = |role| {
        let light = facing(DVec3::new(0.0, -CARD, 0.0), DVec3::X * 0.25, DVec3::Z * 0.25);
        Set { light, floors: vec![Floor { role, ..ground() }], ..base() }
    };
    let lying = facing(DVec3::ZERO, DVec3::X * 0.25, DVec3::Z * 0.25);
    // Half of it is beneath the ground, and it shines along the ground.
    let wall = |role| {
        let light = facing(DVec3::new(-3.0, 0.0, 0.0), DVec3::Z * 0.25, DVec3::Y * 0.25);
        let at = moved(-1.5, 0.2, 0.1) * DMat4::from_rotation_z(FRAC_PI_2);
        let floors = vec![Floor { role, ..ground() }];
        Set { light, blocks: vec![sheet([1.0; 2], at)], floors, ..base() }
    };
    vec![
        of("behind the receiver", below(Role::Receiver)),
        of("behind a receiver that blocks", below(Role::Both)),
        of("lying in the receiver's plane", Set { light: lying, ..base() }),
        of("standing in the receiver's plane", wall(Role::Receiver))
            .known_for(&["soft-shadow-map, blended"], ONE_RECEIVER)
            .known_for(&["linear-light"], SKINS),
        of("standing in the plane of one that blocks", wall(Role::Both))
            .known_for(&["soft-shadow-map, blended"], ONE_RECEIVER)
            .known_for(
                &["hard"],
                "its one point lies in the surface's own plane, neither above nor beneath",
            ),
    ]
}
