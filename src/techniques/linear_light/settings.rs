//! The knobs.

use crate::Error;
use crate::graph::STORAGE_BYTES;

/// On a line.
pub(super) const MOST_SAMPLES: u32 = 16;

/// Of the samples' maps.
const MOST_BYTES: u64 = 1 << 28;

/// Of one side's skins: any texel may end an occluder.
pub(super) fn skin_bytes(map: u32) -> u64 {
    16 * u64::from(map).pow(2)
}

/// By which receiver a skin goes from hidden to seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transition {
    /// The one that lies beside the occluder's edge: it grows evenly, as published.
    Linear,
    /// The one that is behind the skin: exact on receivers of any slope (eq. 1).
    #[default]
    Rational,
}

impl Transition {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] = &[("linear", Self::Linear), ("rational", Self::Rational)];
}

/// Which lines a light with an area is taken for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Across {
    /// Lines side by side all over it.
    #[default]
    Stack,
    /// Its edges, as published for polygons (section 4).
    Edges,
}

impl Across {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] = &[("stack", Self::Stack), ("edges", Self::Edges)];
}

/// Every knob of linear lights but the maps' side, which all techniques share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The most samples on a line, 2 to 16; 8 by default.
    pub samples: u32,
    /// The most lines that a light with an area is taken for, 1 to 16; 4 by default. A line light is one.
    pub lines: u32,
    /// Which lines.
    pub across: Across,
    /// The error asked for, as a share of the light, 0 to 1; 0.01 by default. Samples are added where light is lost
    /// between others, and lines to a light with an area, until what is missed is no more. 0: as many of both as
    /// there may be, evenly.
    pub error: f32,
    /// How visibility goes from 0 to 1.
    pub transition: Transition,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            samples: 8,
            lines: 4,
            across: Across::default(),
            error: 0.01,
            transition: Transition::default(),
        }
    }
}

impl Settings {
    /// Whether the knob with this key is within its range; keys of other techniques pass.
    pub(crate) fn in_range(&self, key: &str) -> bool {
        match key {
            "samples" => (2..=MOST_SAMPLES).contains(&self.samples),
            "lines" => (1..=16).contains(&self.lines),
            "error" => (0.0..=1.0).contains(&self.error),
            _ => true,
        }
    }

    /// Whether samples are evenly spaced, whatever they see.
    pub fn is_even(&self) -> bool {
        self.error == 0.0 || self.samples == 2
    }

    /// The fewest samples that a line may have.
    pub(super) fn fewest(&self) -> u32 {
        if self.is_even() { self.samples } else { 2 }
    }

    /// Checks the knobs that must agree with the maps' side.
    pub(crate) fn check_agreement(&self, map: u32) -> Result<(), Error> {
        let layers = u64::from(self.lines * self.samples + 2);
        let fits = |map: u32| {
            16 * u64::from(map).pow(2) * layers <= MOST_BYTES && skin_bytes(map) <= STORAGE_BYTES
        };
        if fits(map) {
            return Ok(());
        }
        let most = (1..map).rev().find(|&m| fits(m)).unwrap_or(1);
        Err(Error::Setting {
            key: "map".into(),
            problem: format!(
                "{} lines of {} samples with maps of {map} texels a side take more than the 256 MiB that they \
                 may have, or one's skins more than the 128 MiB that every device can bind; set map={most}, \
                 fewer lines or fewer samples",
                self.lines, self.samples
            ),
        })
    }
}
