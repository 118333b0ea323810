//! The CPU twins of `glsl/baseline/disc.glsl` and `compare.glsl`, in any float type.

use num_traits::Float;

/// A disc's polar coordinates (radius, turn from 0 to 1) to the square [−1, 1]², equal areas to equal
/// areas (Shirley and Chiu 1997).
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

/// How far a pixel's disc is turned, 0 to 1.
pub fn pixel_turn(x: u32, y: u32) -> f32 {
    let turn = x.wrapping_mul(3_242_174_889).wrapping_add(y.wrapping_mul(2_447_445_414));
    (turn >> 8) as f32 / 16_777_216.0
}

/// A receiver's place, its unit normal, and the map it is compared with.
#[derive(Clone, Copy, Debug)]
pub struct MapPlane<T> {
    /// Light space, with the map's eye at the origin.
    pub position: [T; 3],
    /// Towards the side that light comes from.
    pub normal: [T; 3],
    /// Texels a unit of u and v.
    pub texels_per_uv: [T; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [T; 2],
}

/// How far a texel's surface, `w_o` at its centre `at`, lies above a receiver's plane beyond what the
/// receiver's own surface may, in units of 1/w; rounding left out.
pub fn clearance<T: Float>(plane: &MapPlane<T>, at: [T; 2], w_o: T) -> T {
    let MapPlane { position: p, normal: n, texels_per_uv, first } = plane;
    let half = T::one() / (T::one() + T::one());
    let uv = [0, 1].map(|i| (at[i] - first[i]) / texels_per_uv[i]);
    let texel = texels_per_uv.map(T::recip);
    let above =
        n[0] * uv[0] + n[1] * uv[1] + n[2] - (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) * w_o;
    let away = (uv[0] - p[0] / p[2]).hypot(uv[1] - p[1] / p[2]);
    let own_slope = T::from(0.3).unwrap_or_else(T::nan);
    above - own_slope * away.max(half * texel[0].hypot(texel[1]))
}
