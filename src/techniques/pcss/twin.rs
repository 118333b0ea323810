//! The CPU twins of `glsl/pcss/disc.glsl`, in any float type.

use num_traits::Float;

/// Maps a disc's polar coordinates (radius, turn from 0 to 1) to the square [−1, 1]², equal areas to equal areas
/// (Shirley and Chiu 1997).
pub fn disc_to_square<T: Float>(radius: T, turn: T) -> [T; 2] {
    let number = |x: u32| T::from(x).unwrap_or_else(T::nan);
    let half = number(1) / number(2);
    let quarter = turn * number(4) + half;
    let along = ((quarter - quarter.floor()) * number(2) - number(1)) * radius;
    match quarter.floor().to_i64().unwrap_or(0).rem_euclid(4) {
        0 => [radius, along],
        1 => [-along, radius],
        2 => [-radius, -along],
        _ => [along, -radius],
    }
}

/// The turn of a pixel's disc, 0 to 1.
pub fn pixel_turn(x: u32, y: u32) -> f32 {
    let turn = x.wrapping_mul(3_242_174_889).wrapping_add(y.wrapping_mul(2_447_445_414));
    (turn >> 8) as f32 / 16_777_216.0
}
