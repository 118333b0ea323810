//! A furnished room: what lies on what, thin boards, and lights near what they shine on.

use super::{Builder, looking};
use crate::Problem;
use antumbra::scene::{Camera, Scene};
use glam::DVec3;

pub const ROOM: &str = "room";

/// Width, height and depth within the walls, m.
const SIZE: [f64; 3] = [5.0, 2.6, 4.2];

/// The thickness of walls, m.
const WALL: f64 = 0.2;

/// The room, by somebody in its near left corner.
pub fn room() -> Result<Scene, Problem> {
    let mut room = Builder::new();
    walls(&mut room);
    table(&mut room);
    shelves(&mut room);
    sofa(&mut room);
    let down = DVec3::NEG_Y;
    room.lamp("ceiling panel", [0.2, SIZE[1] - 0.02, 0.1], down, DVec3::Z, [0.6, 0.6])?;
    // Outside, so that the reveal of the window shadows too.
    room.lamp(
        "window",
        [0.5 * SIZE[0] + WALL + 0.02, 1.5, -0.3],
        DVec3::NEG_X,
        DVec3::Y,
        [1.5, 1.1],
    )?;
    room.lamp("tube", [-1.2, 1.53, -1.92], DVec3::new(0.0, -1.0, 0.2), DVec3::Z, [1.4, 0.03])?;
    let mut scene = room.0;
    scene.camera = Some(walk(0.0));
    Ok(scene)
}

/// From the near left corner along the near wall, the head turning from the shelves to the window and back.
pub fn walk(at: f64) -> Camera {
    let eye = DVec3::new(-2.1 + 2.2 * at, 1.6 + 0.05 * (9.0 * at).sin(), 1.85 - 0.5 * at);
    let turn = 0.75 + 0.35 * (5.0 * at).sin() - 0.55 * at;
    looking(eye, eye + DVec3::new(turn.sin(), -0.3, -turn.cos()), 1.0)
}

/// Slabs: a floor, a ceiling, four walls, a hole in the right one for the window.
fn walls(room: &mut Builder) {
    let [w, h, d] = SIZE;
    let wide = [w + 2.0 * WALL, WALL, d + 2.0 * WALL];
    room.stand("floor", wide, [0.0, -WALL, 0.0]);
    room.stand("ceiling", wide, [0.0, h, 0.0]);
    for (name, z) in [("back wall", -1.0), ("near wall", 1.0)] {
        room.stand(name, [w + 2.0 * WALL, h, WALL], [0.0, 0.0, z * 0.5 * (d + WALL)]);
    }
    room.stand("left wall", [WALL, h, d], [-0.5 * (w + WALL), 0.0, 0.0]);
    let x = 0.5 * (w + WALL);
    // Beneath the window, above it, and to both sides: z from −1.1 to 0.5, y from 0.9 to 2.1.
    room.stand("parapet", [WALL, 0.9, d], [x, 0.0, 0.0]);
    room.stand("lintel", [WALL, h - 2.1, d], [x, 2.1, 0.0]);
    room.stand("pier", [WALL, 1.2, 0.5 * d - 1.1], [x, 0.9, -0.5 * (0.5 * d + 1.1)]);
    room.stand("other pier", [WALL, 1.2, 0.5 * d - 0.5], [x, 0.9, 0.5 * (0.5 * d + 0.5)]);
    // A cross of bars within the hole.
    room.stand("mullion", [0.05, 1.2, 0.05], [x, 0.9, -0.3]);
    room.stand("transom", [0.05, 0.05, 1.6], [x, 1.6, -0.3]);
    room.stand("skirting", [w, 0.08, 0.015], [0.0, 0.0, -0.5 * d + 0.0075]);
}

/// A table with things on it, and four chairs.
fn table(room: &mut Builder) {
    let (x, z) = (0.5, -0.2);
    room.stand("table top", [1.5, 0.03, 0.85], [x, 0.72, z]);
    for (i, [a, b]) in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].iter().enumerate() {
        let leg = [x + 0.69 * a, 0.0, z + 0.37 * b];
        room.stand(&format!("table leg {i}"), [0.05, 0.72, 0.05], leg);
    }
    room.stand("rug", [2.4, 0.008, 1.7], [x, 0.0, z]);
    room.column("cup", 0.04, 0.09, [x + 0.3, 0.75, z + 0.15]);
    room.column("plate", 0.12, 0.012, [x - 0.35, 0.75, z + 0.1]);
    room.ball("apple", 0.045, [x - 0.35, 0.807, z + 0.1]);
    room.turned("book", [0.21, 0.03, 0.15], [x + 0.05, 0.75, z - 0.2], 0.4);
    for (i, (cx, cz, turn)) in
        [(-0.4, 0.75, 0.1), (0.4, 0.8, -0.2), (-0.35, -0.8, 3.0), (1.15, 0.05, 1.7)]
            .iter()
            .enumerate()
    {
        chair(room, i, [x + cx, z + cz], *turn);
    }
}

/// A chair whose back is on its +z.
fn chair(room: &mut Builder, nth: usize, [x, z]: [f64; 2], turn: f64) {
    let at = |dx: f64, y: f64, dz: f64| {
        let (sin, cos) = turn.sin_cos();
        [x + cos * dx + sin * dz, y, z - sin * dx + cos * dz]
    };
    let mut part = |name: &str, size, place| {
        room.turned(&format!("chair {nth} {name}"), size, place, turn);
    };
    part("seat", [0.4, 0.03, 0.4], at(0.0, 0.44, 0.0));
    for (name, a, b) in [("a", -1.0, -1.0), ("b", 1.0, -1.0), ("c", 1.0, 1.0), ("d", -1.0, 1.0)] {
        part(&format!("leg {name}"), [0.035, 0.44, 0.035], at(0.17 * a, 0.0, 0.17 * b));
    }
    for (name, a) in [("left", -1.0), ("right", 1.0)] {
        part(&format!("{name} post"), [0.03, 0.42, 0.03], at(0.17 * a, 0.47, 0.18));
    }
    for i in 0..3 {
        part(&format!("slat {i}"), [0.31, 0.05, 0.015], at(0.0, 0.56 + 0.12 * f64::from(i), 0.18));
    }
}

/// A sideboard under two shelves with books and a vase; the lower shelf has the tube under it.
fn shelves(room: &mut Builder) {
    let (x, z) = (-1.2, -0.5 * SIZE[2]);
    room.stand("sideboard", [1.8, 0.85, 0.45], [x, 0.0, z + 0.225]);
    for (i, y) in [1.55, 1.95].into_iter().enumerate() {
        room.stand(&format!("shelf {i}"), [1.7, 0.025, 0.24], [x, y, z + 0.12]);
        for k in 0..9 {
            let k = f64::from(k);
            let tall = 0.2 + 0.06 * (3.7 * k + 2.0 * i as f64).sin();
            let place = [x - 0.75 + 0.13 * k, y + 0.025, z + 0.1];
            room.stand(&format!("book {i} {k}"), [0.03 + 0.01 * (k % 3.0), tall, 0.16], place);
        }
    }
    room.column("vase", 0.07, 0.28, [x + 0.5, 0.85, z + 0.22]);
    room.ball("bowl", 0.11, [x - 0.2, 0.96, z + 0.25]);
    room.stand("box", [0.25, 0.18, 0.2], [x - 0.6, 0.85, z + 0.2]);
}

/// A sofa along the left wall and a standing lamp, which is dark.
fn sofa(room: &mut Builder) {
    let x = -0.5 * SIZE[0];
    room.stand("sofa seat", [0.85, 0.42, 1.7], [x + 0.45, 0.05, 0.1]);
    room.stand("sofa back", [0.2, 0.45, 1.7], [x + 0.12, 0.47, 0.1]);
    for (name, z) in [("near arm", 0.87), ("far arm", -0.67)] {
        room.stand(name, [0.85, 0.2, 0.16], [x + 0.45, 0.47, z]);
    }
    room.turned("cushion", [0.12, 0.36, 0.38], [x + 0.33, 0.47, -0.25], 0.3);
    room.column("lamp foot", 0.14, 0.02, [x + 0.3, 0.0, -1.3]);
    room.column("lamp rod", 0.012, 1.4, [x + 0.3, 0.02, -1.3]);
    room.ball("lamp shade", 0.16, [x + 0.3, 1.55, -1.3]);
}
