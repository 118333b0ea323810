//! The knobs of what users would pick instead.

/// Every knob of the room but the maps' side, which all techniques share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// PCSS: taps of the blocker search, and as many again of the filter, 1 to 64; 16 by default.
    pub taps: u32,
    /// Many lights: points on the light, 1 to 4096; 256 by default.
    pub samples: u32,
    /// Many lights: which random places the points take; 0 puts them into the middle of their cells.
    pub seed: u32,
    /// PCSS: whether tiles of pixels before which no occluder lies are told at once; on by default.
    pub classify: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { taps: 16, samples: 256, seed: 1, classify: true }
    }
}

impl Settings {
    /// Whether the knob with this key is within its range; keys of other techniques pass.
    pub(crate) fn in_range(&self, key: &str) -> bool {
        match key {
            "taps" => (1..=64).contains(&self.taps),
            "samples" => (1..=4096).contains(&self.samples),
            _ => true,
        }
    }
}
