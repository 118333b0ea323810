//! The knobs of back-projection.

use crate::knob::{Field, Knobs};

/// The knobs of back-projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The map's side, texels, 1 to 4096; 256 by default.
    pub map: u32,
    /// The most views of a light, 1 to 8; 6 by default.
    pub views: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { map: 256, views: 6 }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "back-projection";
    const FIELDS: &'static [Field<Self>] = &[
        Field::map(|s| s.map, |s, map| s.map = map),
        Field::views(|s| s.views, |s, views| s.views = views),
    ];
}
