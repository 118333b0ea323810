//! The knobs of percentage-closer soft shadows.

use crate::knob::{Field, Knobs, MAP_OF_256};

/// The knobs of percentage-closer soft shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The maps' side, texels, 1 to 4096; 0, the default, for 256 where one view serves a light and 512 where several do.
    pub map: u32,
    /// The most views of a light, 1 to 8; 6 by default.
    pub views: u32,
    /// The number of taps of the blocker search, and as many again of the filter, 1 to 64; 16 by default.
    pub taps: u32,
    /// Whether tiles of pixels that no occluder can shadow are skipped; on by default.
    pub classify: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { map: 0, views: 6, taps: 16, classify: true }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "pcss";
    const FIELDS: &'static [Field<Self>] = &[
        Field::map_of_views(MAP_OF_256, |s| s.map, |s, map| s.map = map),
        Field::views(|s| s.views, |s, views| s.views = views),
        Field::whole(
            "taps",
            "taps",
            [1, 64],
            "places of the map that a pixel looks at to find blockers, and as many again to filter",
            |s| s.taps,
            |s, taps| s.taps = taps,
        ),
        Field::classify(|s| s.classify, |s, on| s.classify = on),
    ];
}
