//! A hall with many lamps: two rows of columns, and what stands between them.

use super::{Builder, looking};
use crate::Problem;
use antumbra::scene::{Camera, Scene};
use glam::DVec3;

pub const COLONNADE: &str = "colonnade";

/// How many columns are in a row, and how far apart, m.
const COLUMNS: u32 = 7;
const APART: f64 = 2.4;

/// The height of the ceiling, m.
const HEIGHT: f64 = 4.0;

/// The hall, by somebody at its near end.
pub fn colonnade() -> Result<Scene, Problem> {
    let mut hall = Builder::new();
    let length = f64::from(COLUMNS) * APART + 2.0;
    let middle = -0.5 * f64::from(COLUMNS - 1) * APART;
    hall.stand("floor", [9.0, 0.2, length], [0.0, -0.2, middle]);
    hall.stand("ceiling", [9.0, 0.2, length], [0.0, HEIGHT, middle]);
    for (name, x) in [("left wall", -4.6), ("right wall", 4.6)] {
        hall.stand(name, [0.2, HEIGHT, length], [x, 0.0, middle]);
    }
    hall.stand("far wall", [9.0, HEIGHT, 0.2], [0.0, 0.0, middle - 0.5 * length]);
    for (side, x) in [("left", -2.2), ("right", 2.2)] {
        for i in 0..COLUMNS {
            let z = -APART * f64::from(i);
            hall.stand(&format!("{side} base {i}"), [0.75, 0.2, 0.75], [x, 0.0, z]);
            hall.column(&format!("{side} column {i}"), 0.26, HEIGHT - 0.4, [x, 0.2, z]);
            hall.stand(&format!("{side} capital {i}"), [0.75, 0.2, 0.75], [x, HEIGHT - 0.2, z]);
        }
        hall.stand(&format!("{side} rail"), [0.06, 0.05, length - 2.0], [1.2 * x, 0.95, middle]);
    }
    for i in 0..COLUMNS - 1 {
        let (z, nth) = (-APART * (f64::from(i) + 0.5), f64::from(i));
        let x = 0.9 * (2.1 * nth).sin();
        hall.turned(&format!("plinth {i}"), [0.5, 0.9, 0.5], [x, 0.0, z], 0.4 * nth);
        hall.ball(&format!("ball {i}"), 0.3, [x, 1.2, z]);
        hall.column(&format!("stool {i}"), 0.2, 0.45, [x + 0.8, 0.0, z + 0.5]);
    }
    for i in 0..4_u32 {
        let z = -APART * (2.0 * f64::from(i) - 0.5) - 0.6;
        for (side, sign) in [("left", -1.0), ("right", 1.0)] {
            let to = DVec3::new(-0.4 * sign, -1.0, 0.1);
            hall.lamp(&format!("{side} lamp {i}"), [1.3 * sign, 3.3, z], to, DVec3::Z, [0.5, 0.2])?;
        }
    }
    let mut scene = hall.0;
    scene.camera = Some(walk(0.0));
    Ok(scene)
}

/// From the near end along the middle, the head turning from one row to the other.
pub fn walk(at: f64) -> Camera {
    let eye = DVec3::new(0.6 - 1.0 * at, 1.65, 2.6 - 6.0 * at);
    let turn = -0.15 + 0.3 * (6.0 * at).sin();
    looking(eye, eye + DVec3::new(turn.sin(), -0.2, -turn.cos()), 0.95)
}
