//! The knobs of the sketch.

use crate::knob::{Field, Knobs};

/// The knobs of the sketch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The side of a map that nothing is drawn into, texels.
    pub map: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { map: 64 }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "half";
    const FIELDS: &'static [Field<Self>] = &[Field::map(|s| s.map, |s, map| s.map = map)];
}
