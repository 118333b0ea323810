//! The knobs of shadows from the triangles themselves.

use crate::knob::{Field, Knobs};

/// The knobs of shadows from the triangles themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The most leaves of the hierarchy in a tile's shaft, beyond which its pixels send rays, 1 to 16384; 1024 by default.
    pub leaves: u32,
    /// The rays of each pixel of a denser tile, 4 to 64; 64 by default.
    pub rays: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { leaves: 1024, rays: 64 }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "traced";
    const FIELDS: &'static [Field<Self>] = &[
        Field::whole(
            "leaves",
            "leaves of two triangles",
            [1, 16384],
            "the most that a tile's shaft may hold to be tested triangle by triangle; denser tiles send rays",
            |s| s.leaves,
            |s, leaves| s.leaves = leaves,
        ),
        Field::whole(
            "rays",
            "rays a pixel",
            [4, 64],
            "how many rays each pixel of a denser tile sends to samples of the light",
            |s| s.rays,
            |s, rays| s.rays = rays,
        ),
    ];
}
