//! The CPU twins of `glsl/baseline/disc.glsl`, `compare.glsl`, `filled.glsl` and `levels.glsl`, in any
//! float type.

use crate::soft_shadow_map::twin::overlap;
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
/// receiver's own surface may rise over `reach` in u and v, in units of 1/w; rounding left out.
pub fn clearance<T: Float>(plane: &MapPlane<T>, at: [T; 2], w_o: T, reach: T) -> T {
    let MapPlane { position: p, normal: n, texels_per_uv, first } = plane;
    let half = T::one() / (T::one() + T::one());
    let uv = [0, 1].map(|i| (at[i] - first[i]) / texels_per_uv[i]);
    let texel = texels_per_uv.map(T::recip);
    let above =
        n[0] * uv[0] + n[1] * uv[1] + n[2] - (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) * w_o;
    let own_slope = T::from(0.3).unwrap_or_else(T::nan);
    above - own_slope * reach.max(half * texel[0].hypot(texel[1]))
}

/// What a texel with magnification `k` hides of the light from a receiver at `t`, reaching over the gaps
/// to the texels before it along x and y, whose magnifications are in `before`; 0 where there is none.
pub fn filled_occlusion<T: Float>(lo: [T; 2], t: [T; 2], k: T, before: [T; 2], scale: [T; 2]) -> T {
    if k <= T::zero() {
        return T::zero();
    }
    let along = |i: usize| {
        let edge = (lo[i] - t[i]) * scale[i];
        let own = edge * k;
        let first = if before[i] > T::zero() { own.min(edge * before[i]) } else { own };
        overlap(first, (lo[i] + T::one() - t[i]) * scale[i] * k)
    };
    along(0) * along(1)
}

/// Nodes a side of a level of a map.
pub fn level_side(map: u32, level: u32) -> u32 {
    map.div_ceil(1 << level)
}

/// Where a level's nodes start.
pub fn level_start(map: u32, level: u32) -> u32 {
    (1..level).map(|k| level_side(map, k).pow(2)).sum()
}

/// The level at which a rectangle of this many texels a side touches at most 3×3 nodes.
pub fn level_of(texels: u32) -> u32 {
    if texels <= 4 { 1 } else { (texels - 1).ilog2() }
}

/// The nodes of a map of `map` texels a side that hold texels from `lo` to `hi`, as in `nearest.glsl`: columns and
/// rows, first and last; the first behind the last where there are none.
pub fn nodes_around(map: u32, lo: [f32; 2], hi: [f32; 2]) -> [[i32; 2]; 2] {
    let side = map.div_ceil(32).max(8);
    let end = (map.div_ceil(side) - 1) as f32;
    let node = |t: f32| (t / side as f32).floor();
    [
        lo.map(|t| node(t).max(0.0).min(end + 1.0) as i32),
        hi.map(|t| node(t).max(-1.0).min(end) as i32),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_touches_three_nodes_a_side_at_most() {
        for texels in 1..=600_u32 {
            let size = 1 << level_of(texels);
            let most = (0..size).map(|first| (first + texels - 1) / size + 1).max();
            assert!(most <= Some(3), "{texels} texels touch {most:?} nodes of {size}");
        }
    }
}
