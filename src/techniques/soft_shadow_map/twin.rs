//! The CPU twins of the sums over micro-patches, in any float type.
//!
//! A twin computes what the shader does, line by line, and shares no code with it.

use crate::techniques::common::twin::{clamp, half, patch_occlusion};
use num_traits::Float;

/// A square occluder map of w, 0 where there is no occluder, and the light's size in its texels.
#[derive(Clone, Copy, Debug)]
pub struct OccluderMap<'a> {
    /// w of each texel, row by row.
    pub w: &'a [f32],
    /// The number of texels in a row.
    pub side: usize,
    /// (Δu/Lx, Δv/Ly), 1/m.
    pub scale: [f32; 2],
}

/// The occlusion of a receiver by every micro-patch of a map, added up in f64: the sum that blending and gathering both
/// approximate.
pub fn occlusion(map: &OccluderMap, t: [f32; 2], w_r: f32) -> f64 {
    let wide = |a: [f32; 2]| a.map(f64::from);
    map.w
        .iter()
        .enumerate()
        .filter(|(_, w)| **w > 0.0)
        .map(|(i, &w)| {
            let lo = [(i % map.side) as f64, (i / map.side) as f64];
            let hi = [lo[0] + 1.0, lo[1] + 1.0];
            patch_occlusion(lo, hi, w.into(), wide(t), w_r.into(), wide(map.scale))
        })
        .sum()
}

/// The change of w at each texel of a map, a texel along x and along y: along each axis the lesser of the steps to both
/// neighbours, 0 where there is none. As the device keeps them, rounded to the upper half of a float.
pub fn slopes(w: &[f32], side: usize) -> Vec<[f32; 2]> {
    let kept = |x: f32| f32::from_bits((x.to_bits().wrapping_add(0x8000)) & 0xffff_0000);
    let lesser = |steps: [Option<f32>; 2]| {
        let steps = steps.into_iter().flatten();
        kept(steps.reduce(|a, b| if b.abs() < a.abs() { b } else { a }).unwrap_or(0.0))
    };
    let of = |at: usize| {
        let (x, y) = (at % side, at / side);
        let before = |inside: bool, by: usize| {
            inside.then(|| w[at - by]).filter(|&w| w > 0.0).map(|other| w[at] - other)
        };
        let after = |inside: bool, by: usize| {
            inside.then(|| w[at + by]).filter(|&w| w > 0.0).map(|other| other - w[at])
        };
        [
            lesser([before(x > 0, 1), after(x + 1 < side, 1)]),
            lesser([before(y > 0, side), after(y + 1 < side, side)]),
        ]
    };
    (0..w.len()).map(|at| if w[at] > 0.0 { of(at) } else { [0.0; 2] }).collect()
}

/// The occlusion of a receiver by every micro-patch of a map, whose `slopes` are those of [`slopes`], added up in f64:
/// the projected area of each counts k²(1 − k (c − t)·g), with c its centre and g its slope, where that of a patch
/// parallel to the light counts k².
pub fn sloped_occlusion(map: &OccluderMap, slopes: &[[f32; 2]], t: [f32; 2], w_r: f32) -> f64 {
    let wide = |a: [f32; 2]| a.map(f64::from);
    let (t, w_r, scale) = (wide(t), f64::from(w_r), wide(map.scale));
    let of = |(i, (&w, &slope)): (usize, (&f32, &[f32; 2]))| {
        let w = f64::from(w);
        if w <= w_r {
            return 0.0;
        }
        let lo = [(i % map.side) as f64, (i / map.side) as f64];
        let flat = patch_occlusion(lo, lo.map(|x| x + 1.0), w, t, w_r, scale);
        let g = wide(slope);
        flat * (1.0 - ((lo[0] + 0.5 - t[0]) * g[0] + (lo[1] + 0.5 - t[1]) * g[1]) / (w - w_r))
    };
    map.w.iter().zip(slopes).enumerate().map(of).sum()
}

/// The back layer as the mean uses it: w of each back texel, 0 where there is none or where the front is
/// flatter than it by `FLATTER` and there is nothing to cancel.
pub fn backs_of_mean(front: &[f32], back: &[f32], side: usize) -> Vec<f32> {
    const FLATTER: f32 = 30.0;
    const ROUNDING: f32 = 1e-4;
    let steepness = |w: &[f32], at: usize| {
        let (x, y) = (at % side, at / side);
        let other = |inside: bool, i: usize| (inside && w[i] > 0.0).then(|| (w[i] - w[at]).abs());
        let lesser = |a: Option<f32>, b: Option<f32>| match (a, b) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        let along_x =
            lesser(other(x > 0, at.wrapping_sub(1)), other(x + 1 < side, at.wrapping_add(1)));
        let along_y =
            lesser(other(y > 0, at.wrapping_sub(side)), other(y + 1 < side, at.wrapping_add(side)));
        along_x.unwrap_or(0.0).max(along_y.unwrap_or(0.0))
    };
    (0..back.len())
        .map(|i| {
            let noise = back[i] > 0.0
                && steepness(back, i) > FLATTER * steepness(front, i) + ROUNDING * back[i];
            if noise { 0.0 } else { back[i] }
        })
        .collect()
}

/// The texels that a receiver is shadowed by in the mean of both sides: each back texel that lies before it, and the
/// front texel where the back does not.
pub fn back_or_front(front: &[f32], back: &[f32], w_r: f32) -> Vec<f32> {
    front.iter().zip(back).map(|(&f, &b)| if b > 0.0 && b > w_r { b } else { f }).collect()
}

/// The occlusion by both sides from the occlusion by either (`light_space.glsl`).
pub fn merged_sides<T: Float>(front: T, back: T) -> T {
    let tenth = T::one() / (half::<T>() * T::from(20.0).unwrap_or_else(T::nan));
    let larger = front.max(back);
    let umbra = clamp((larger - (T::one() - tenth)) / tenth, T::zero(), T::one());
    half::<T>() * (front + back) * (T::one() - umbra) + larger * umbra
}

/// The sum of k² over texels whose w is `mean` + d, with `s` = (count, Σd, Σd², Σd³), by the series of
/// the module's derivation.
pub fn series<T: Float>(s: [T; 4], mean: T, w_r: T) -> T {
    let two = T::one() + T::one();
    let k = T::one() / (mean - w_r);
    k * k * (s[0] + k * (k * ((two + T::one()) * s[2] - two * two * s[3] * k) - two * s[1]))
}

/// Where a node lies for a tile of receivers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The node hides nothing of the light from any of them.
    Outside,
    /// The series serves all of them.
    Inside,
    /// Neither is certain.
    Mixed,
}

/// A square node of an occluder map.
#[derive(Clone, Copy, Debug)]
pub struct Node<T> {
    /// The number of occupied texels.
    pub count: T,
    /// The mean, least and largest w of the occupied texels.
    pub w: [T; 3],
    /// The node's first texel.
    pub lo: [T; 2],
    /// The node's side in texels.
    pub side: T,
}

/// The bounds of receivers: t from `t_min` to `t_max`, w from `w[0]` to `w[1]`.
#[derive(Clone, Copy, Debug)]
pub struct Tile<T> {
    /// The least t, texels.
    pub t_min: [T; 2],
    /// The largest t, texels.
    pub t_max: [T; 2],
    /// The least and largest w, 1/m.
    pub w: [T; 2],
}

/// The twin of `may_shadow` in `node.glsl`: whether a node may hide any of the light from a tile.
pub fn may_shadow<T: Float>(node: &Node<T>, tile: &Tile<T>, scale: [T; 2]) -> bool {
    let w_max = node.w[2];
    let along = |i: usize| {
        let hi = node.lo[i] + node.side;
        let gap = (node.lo[i] - tile.t_max[i]).max(tile.t_min[i] - hi);
        gap < half::<T>() * (w_max - tile.w[0]) / scale[i]
    };
    node.count > T::zero() && w_max > tile.w[0] && along(0) && along(1)
}

/// The twin of `superblocks_around` in `node.glsl`: columns and rows of the superblocks of 32 texels, first and last,
/// in which an occluder with a w up to `w_max` may shadow a tile.
pub fn superblocks_around<T: Float>(
    tile: &Tile<T>,
    row: T,
    w_max: T,
    scale: [T; 2],
) -> [[T; 2]; 2] {
    let side = T::from(32.0).unwrap_or_else(T::nan);
    let cell = |t: T| clamp((t / side).floor(), T::zero(), row - T::one());
    let widest = [0, 1].map(|i| half::<T>() * (w_max - tile.w[0]) / scale[i]);
    [
        [0, 1].map(|i| cell(tile.t_min[i] - widest[i])),
        [0, 1].map(|i| cell(tile.t_max[i] + widest[i])),
    ]
}

/// The twin of `classify` in `node.glsl`.
pub fn classify<T: Float>(node: &Node<T>, tile: &Tile<T>, scale: [T; 2], spread: T) -> Kind {
    let [mean, w_min, w_max] = node.w;
    if !may_shadow(node, tile, scale) {
        return Kind::Outside;
    }
    let h = half::<T>();
    let hi = [0, 1].map(|i| node.lo[i] + node.side);
    let within = |i: usize| {
        let reach = (hi[i] - tile.t_min[i]).max(tile.t_max[i] - node.lo[i]);
        reach <= h * (w_min - tile.w[1]) / scale[i]
    };
    let deviation = (w_max - mean).max(mean - w_min);
    if within(0) && within(1) && deviation <= spread * (mean - tile.w[1]) {
        Kind::Inside
    } else {
        Kind::Mixed
    }
}

/// A mask of the texels of an 8×8 block with lo ≤ (x, y) < hi; bit 8y + x.
pub fn rectangle_mask(lo: [u32; 2], hi: [u32; 2]) -> u64 {
    (0..64)
        .filter(|i| {
            let at = [i % 8, i / 8];
            (0..2).all(|axis| (lo[axis]..hi[axis]).contains(&at[axis]))
        })
        .fold(0, |mask, i| mask | 1 << i)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::techniques::common::twin::magnification;

    #[test]
    fn a_patch_hides_what_back_projection_says() {
        // Light 1 m wide, patch 0.25 m wide at half the distance to the receiver on the axis at 2 m:
        // it covers 0.5 m of the light.
        let (w_o, w_r) = (1.0_f64, 0.5);
        let texel = 0.25;
        let seen = patch_occlusion([-0.5; 2], [0.5; 2], w_o, [0.0; 2], w_r, [texel; 2]);
        assert!((seen - 0.25).abs() < 1e-15);
        // Moved aside until half of it misses the light.
        let aside = patch_occlusion([0.5, -0.5], [1.5, 0.5], w_o, [0.0; 2], w_r, [texel; 2]);
        assert!((aside - 0.125).abs() < 1e-15);
        assert_eq!(patch_occlusion([-0.5; 2], [0.5; 2], w_r, [0.0; 2], w_o, [texel; 2]), 0.0);
    }

    /// A node that may not shadow a tile hides nothing from any of its receivers, in 32-bit floats too.
    #[test]
    fn what_may_not_shadow_hides_nothing() {
        let mut seed = 1_u32;
        let mut random = move |low: f32, high: f32| {
            seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            low + (high - low) * (seed >> 8) as f32 / 16_777_216.0
        };
        let (mut apart, mut shadowing) = (0, 0);
        for _ in 0..20_000 {
            let corner = [random(0.0, 248.0).floor(), random(0.0, 248.0).floor()];
            let w = [0.0, random(0.3, 1.0), random(1.0, 2.0)];
            let node = Node { count: 3.0, w, lo: corner, side: 8.0 };
            let t_min = corner.map(|c| c + random(-40.0, 40.0));
            let t_max = [0, 1].map(|i| t_min[i] + random(0.0, 9.0));
            let w_near = random(0.1, 2.1);
            let tile = Tile { t_min, t_max, w: [w_near, w_near + random(0.0, 0.2)] };
            let scale = [random(0.002, 0.05), random(0.002, 0.05)];
            if may_shadow(&node, &tile, scale) {
                shadowing += 1;
                continue;
            }
            apart += 1;
            for _ in 0..8 {
                let within = |i: usize, share: f32| t_min[i] + (t_max[i] - t_min[i]) * share;
                let t = [within(0, random(0.0, 1.0)), within(1, random(0.0, 1.0))];
                let lo = [0, 1].map(|i| node.lo[i] + random(0.0, 8.0).floor());
                let hi = lo.map(|x| x + 1.0);
                let (w_o, w_r) = (random(w[1], w[2]), random(tile.w[0], tile.w[1]));
                let hidden = patch_occlusion(lo, hi, w_o, t, w_r, scale);
                assert_eq!(hidden, 0.0, "{node:?} {tile:?} {t:?} {w_r} {lo:?} {w_o}");
            }
        }
        assert!(apart > 2000 && shadowing > 1000, "{apart} apart, {shadowing} shadowing");
    }

    #[test]
    fn a_flat_map_that_fills_the_light_sums_to_one() {
        let w = vec![1.0_f32; 64 * 64];
        let map = OccluderMap { w: &w, side: 64, scale: [1.0 / 40.0; 2] };
        let sum = occlusion(&map, [32.25, 31.5], 0.5);
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }

    /// A plane that fills the light's window hides all of it, whichever way it leans.
    #[test]
    fn a_leaning_map_that_fills_the_light_sums_to_one() {
        let side = 256;
        let plane = |i: usize| 1.0 + 2e-3 * (i % side) as f32 - 1e-3 * (i / side) as f32;
        let w: Vec<f32> = (0..side * side).map(plane).collect();
        let map = OccluderMap { w: &w, side, scale: [1.0 / 40.0; 2] };
        let (t, w_r) = ([128.3, 127.6], 0.3);
        let (flat, sloped) =
            (occlusion(&map, t, w_r), sloped_occlusion(&map, &slopes(&w, side), t, w_r));
        assert!((flat - 1.0).abs() > 5e-4, "{flat}");
        assert!((sloped - 1.0).abs() < 0.2 * (flat - 1.0).abs(), "{sloped}, {flat}");
    }

    #[test]
    fn slopes_stop_at_edges_and_gaps() {
        let w = [1.0, 1.5, 9.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0];
        let of = slopes(&w, 3);
        // The lesser step, then the only one, then none.
        assert_eq!([of[0][0], of[1][0], of[2][0]], [0.5, 0.5, 7.5]);
        assert_eq!((of[4], of[8], of[3]), ([0.0, 0.5], [0.0, 0.0], [0.0, 0.0]));
    }

    #[test]
    fn the_series_is_the_sum_for_small_spreads() {
        let w_r = 0.3_f64;
        let ws: Vec<f64> = (0..64).map(|i| 0.8 + 0.02 * f64::from(i * 37 % 64) / 64.0).collect();
        let n = ws.len() as f64;
        let mean = ws.iter().sum::<f64>() / n;
        let moment = |p: i32| ws.iter().map(|w| (w - mean).powi(p)).sum::<f64>();
        let exact: f64 = ws.iter().map(|&w| magnification(w, w_r).powi(2)).sum();
        let series = series([n, moment(1), moment(2), moment(3)], mean, w_r);
        let q = 0.01 / (mean - w_r) * 1.02;
        assert!((series / exact - 1.0).abs() < 5.0 * q.powi(4) * 1.1);
    }
}
