//! The knobs of many lights.

use crate::knob::{Field, Knobs, MOST_VIEWS};

/// The knobs of many lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The side of each point's map, texels, 1 to 4096; 256 by default.
    pub map: u32,
    /// Points on the light, 1 to 4096; 256 by default.
    pub samples: u32,
    /// The seed of the points' random places; 0 puts the points into the middle of their cells.
    pub seed: u32,
    /// The most views of a sun, 1 to 8; 6 by default.
    pub views: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { map: 256, samples: 256, seed: 1, views: 6 }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "many-lights";
    const FIELDS: &'static [Field<Self>] = &[
        Field::map(|s| s.map, |s, map| s.map = map),
        Field::whole(
            "samples",
            "points",
            [1, 4096],
            "points on the light, each with a map of its own; any whole number",
            |s| s.samples,
            |s, samples| s.samples = samples,
        ),
        Field::whole(
            "seed",
            "whole number",
            [0, u32::MAX],
            "which random places of the light have points; 0 puts the points into the middle of their cells",
            |s| s.seed,
            |s, seed| s.seed = seed,
        ),
        Field::whole(
            "views",
            "views",
            [1, MOST_VIEWS],
            "most views of a sun, in each of which every point has a map; a lamp has one",
            |s| s.views,
            |s, views| s.views = views,
        ),
    ];
}
