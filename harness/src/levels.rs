//! The cost of each kind of N-buffer levels, for reports.

use antumbra::stages::nbuffer::twin::Values;
use antumbra::stages::nbuffer::{Kind, Levels};

/// The passes that make the levels.
pub const BUILD: [&str; 1] = ["level"];

/// Milliseconds of passes by their names' ends.
pub fn ms<'a>(passes: impl IntoIterator<Item = (&'a str, f64)>, names: &[&str]) -> f64 {
    let of = |name: &str| names.iter().any(|n| name == format!("ray_march.{n}"));
    passes.into_iter().filter(|(name, _)| of(name)).fold(0.0, |sum, (_, ms)| sum + ms)
}

/// Bytes of the levels, the columns among them, four floats a texel.
pub fn bytes(levels: Levels) -> u64 {
    16 * levels.texels()
}

/// The texels of the windows that a look-up reads over the texels of the square window it is for:
/// the mean over all windows of 1 to 24 texels a side in a map of 64.
pub fn tightness(kind: Kind) -> f64 {
    const MAP: u32 = 64;
    const MOST: u32 = 24;
    // What a window holds is the box around it: the least x and y, the largest x and y.
    let around = |boxes: &[[u32; 4]]| {
        let least = |i: usize| boxes.iter().map(|b| b[i]).min().unwrap_or(0);
        let largest = |i: usize| boxes.iter().map(|b| b[i]).max().unwrap_or(0);
        [least(0), least(1), largest(2), largest(3)]
    };
    let map = (0..MAP * MAP).map(|i| [i % MAP, i / MAP, i % MAP, i / MAP]).collect();
    let values = Values::new(Levels { map: MAP, kind }, map, around);
    let mut sum = 0.0;
    let mut windows = 0.0;
    for side in 1..=MOST {
        for (x, y) in (0..=MAP - side).flat_map(|y| (0..=MAP - side).map(move |x| (x, y))) {
            let [x0, y0, x1, y1] = around(&values.covering([x as i32, y as i32], side));
            sum += f64::from((x1 + 1 - x0) * (y1 + 1 - y0)) / f64::from(side * side);
            windows += 1.0;
        }
    }
    sum / windows
}
