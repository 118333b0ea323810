//! The knobs of shadows from the triangles themselves.

use crate::knob::{Field, Knobs, choice, choices};

/// How many samples the light has where triangles are tested one by one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Samples {
    /// 8 × 8 samples.
    #[default]
    Few,
    /// 16 × 16 samples: half the error for half as much again in time.
    Many,
    /// 32 × 32 samples, for references.
    Most,
}

choices! { Samples: "64" => Few, "256" => Many, "1024" => Most }

impl Samples {
    /// The samples along a side of the light.
    pub fn side(self) -> u32 {
        match self {
            Self::Few => 8,
            Self::Many => 16,
            Self::Most => 32,
        }
    }
}

/// The knobs of shadows from the triangles themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The samples of the light; 64 by default.
    pub samples: Samples,
    /// The most leaves of the hierarchy in a tile's shaft, beyond which its pixels send rays, 1 to 4096; 2048 by
    /// default, where rays cost as much as triangles or more on a processor (1.1 times less to twice as much, by the
    /// scene).
    pub leaves: u32,
    /// The most rays of each pixel of a denser tile, 4 to 1024; 64 by default.
    pub rays: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { samples: Samples::default(), leaves: 2048, rays: 64 }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "traced";
    const FIELDS: &'static [Field<Self>] = &[
        choice!(
            "samples",
            Samples,
            "how many samples of the light are tested against each triangle at once",
            samples
        ),
        Field::whole(
            "leaves",
            "leaves of two triangles",
            [1, 4096],
            "the most that a tile's shaft may hold to be tested triangle by triangle; denser tiles send rays",
            |s| s.leaves,
            |s, leaves| s.leaves = leaves,
        ),
        Field::whole(
            "rays",
            "rays a pixel",
            [4, 1024],
            "how many rays each pixel of a denser tile sends, at most one to each sample of the light",
            |s| s.rays,
            |s, rays| s.rays = rays,
        ),
    ];
}
