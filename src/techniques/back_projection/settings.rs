//! The knobs of back-projection.

use crate::knob::{Field, Knobs, MAP_OF_256};

/// The knobs of back-projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The maps' side, texels, 1 to 4096; 0, the default, for 256 where one view serves a light and 512 where several do.
    pub map: u32,
    /// The most views of a light, 1 to 8; 6 by default.
    pub views: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { map: 0, views: 6 }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "back-projection";
    const FIELDS: &'static [Field<Self>] = &[
        Field::map_of_views(MAP_OF_256, |s| s.map, |s, map| s.map = map),
        Field::views(|s| s.views, |s, views| s.views = views),
    ];
}
