//! The CPU twins of the bounds and the words of tiles (`common/lists.glsl`), in any float type.

use num_traits::Float;

/// The bounds of a tile's receivers: least and largest t and w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<T> {
    /// The least t, texels.
    pub t_min: [T; 2],
    /// The largest t, texels.
    pub t_max: [T; 2],
    /// The least and largest w, 1/m.
    pub w: [T; 2],
}

/// Bounds that hold under any rounding of another shader: 2⁻²⁰ of t and w, and 2⁻¹⁰ of a texel more.
pub fn rounded_tile<T: Float>(tile: &Bounds<T>) -> Bounds<T> {
    let power = |n: i32| (T::one() + T::one()).powi(n);
    let slack =
        [0, 1].map(|i| tile.t_min[i].abs().max(tile.t_max[i].abs()) * power(-20) + power(-10));
    Bounds {
        t_min: [0, 1].map(|i| tile.t_min[i] - slack[i]),
        t_max: [0, 1].map(|i| tile.t_max[i] + slack[i]),
        w: [tile.w[0] * (T::one() - power(-20)), tile.w[1] * (T::one() + power(-20))],
    }
}

/// The first pixel of a listed tile, and whether an occluder may shadow the tile.
pub fn listed_tile(word: u32) -> ([u32; 2], bool) {
    let tile = [word & 0x7fff, word >> 15 & 0x7fff];
    (tile.map(|i| i * super::TILE), word & 1 << 30 != 0)
}
