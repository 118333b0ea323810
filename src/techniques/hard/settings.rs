//! The knobs of a hard shadow map.

use crate::knob::{Field, Knobs};

/// The knobs of hard shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The map's side, texels, 1 to 4096; 256 by default.
    pub map: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { map: 256 }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "hard";
    const FIELDS: &'static [Field<Self>] = &[Field::map(|s| s.map, |s, map| s.map = map)];
}
