//! The CPU twins of `glsl/back_projection`: filled gaps and levels, in any float type.

use crate::techniques::common::twin::overlap;
use num_traits::Float;

/// The fraction of the light that a texel with magnification `k` hides from a receiver at `t`, extended over the gaps
/// to the texels before it along x and y, whose magnifications are in `before`; a magnification of 0 is no texel.
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

/// The number of nodes along a side of a level of a map.
pub fn level_side(map: u32, level: u32) -> u32 {
    map.div_ceil(1 << level)
}

/// The index of a level's first node.
pub fn level_start(map: u32, level: u32) -> u32 {
    (1..level).map(|k| level_side(map, k).pow(2)).sum()
}

/// The level at which a rectangle of this many texels a side touches at most 3×3 nodes.
pub fn level_of(texels: u32) -> u32 {
    if texels <= 4 { 1 } else { (texels - 1).ilog2() }
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
