//! The knobs of linear lights, and their memory limits.

use crate::Error;
use crate::graph::STORAGE_BYTES;
use crate::knob::{Field, Knobs, choice, choices};

/// The most samples on a line.
pub(super) const MOST_SAMPLES: u32 = 16;

/// The memory limit of all sample maps, bytes.
const MOST_BYTES: u64 = 1 << 28;

/// The bytes of one side's skin buffer: in the worst case every texel ends an occluder.
pub(super) fn skin_bytes(map: u32) -> u64 {
    16 * u64::from(map).pow(2)
}

/// The receiver whose distance sets how visibility grows behind a skin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transition {
    /// The receiver beside the occluder's edge: visibility grows evenly, as published.
    Linear,
    /// The receiver behind the skin: exact on receivers of any slope (eq. 1).
    #[default]
    Rational,
}

choices! { Transition: "linear" => Linear, "rational" => Rational }

/// The lines that represent a light with an area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Across {
    /// Parallel lines side by side all over the light.
    #[default]
    Stack,
    /// The light's edges, as published for polygons (section 4).
    Edges,
}

choices! { Across: "stack" => Stack, "edges" => Edges }

/// The knobs of linear lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The side of each sample's maps, texels, 1 to 4096; 256 by default.
    pub map: u32,
    /// The most samples on a line, 2 to 16; 8 by default.
    pub samples: u32,
    /// The most lines that represent a light with an area, 1 to 16; 4 by default. A line light is one.
    pub lines: u32,
    /// Which lines represent a light with an area.
    pub across: Across,
    /// The requested error, as a share of the light, 0 to 1; 0.01 by default. Samples are added where light is lost
    /// between others, and lines to a light with an area, until the loss is no larger. 0 uses the most samples and
    /// lines, evenly spaced.
    pub error: f32,
    /// How visibility goes from 0 to 1 behind a skin.
    pub transition: Transition,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            map: 256,
            samples: 8,
            lines: 4,
            across: Across::default(),
            error: 0.01,
            transition: Transition::default(),
        }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "linear-light";
    const FIELDS: &'static [Field<Self>] = &[
        Field::map(|s| s.map, |s, map| s.map = map),
        Field::whole(
            "samples",
            "points",
            [2, MOST_SAMPLES],
            "most points on a line, each with maps of its own, between which skins are drawn; any whole number",
            |s| s.samples,
            |s, samples| s.samples = samples,
        ),
        Field::whole(
            "lines",
            "lines",
            [1, 16],
            "most lines that represent a light with an area; a line light is one. Any whole number",
            |s| s.lines,
            |s, lines| s.lines = lines,
        ),
        choice!(
            "across",
            Across,
            "which lines represent a light with an area: lines side by side all over it, or its edges, as published \
             for polygons, which is coarse",
            across
        ),
        Field::real(
            "error",
            "visible fraction",
            [0.0, 1.0],
            "mean error requested: points are added where light is lost between others, and lines to a light with an \
             area, until the loss is no larger; 0 uses the most points and lines, evenly spaced",
            |s| s.error,
            |s, error| s.error = error,
        ),
        choice!(
            "transition",
            Transition,
            "how visibility grows behind a skin: evenly up to the receiver beside the occluder's edge, as published, \
             or by the receiver's own distance, which is exact",
            transition
        ),
    ];
}

impl Settings {
    /// Checks the knobs that must agree with each other.
    pub(super) fn check_together(&self) -> Result<(), Error> {
        let layers = u64::from(self.lines * self.samples + 2);
        let fits = |map: u32| {
            16 * u64::from(map).pow(2) * layers <= MOST_BYTES && skin_bytes(map) <= STORAGE_BYTES
        };
        if fits(self.map) {
            return Ok(());
        }
        let most = (1..self.map).rev().find(|&m| fits(m)).unwrap_or(1);
        Err(Error::Setting {
            key: "map".into(),
            problem: format!(
                "{} lines of {} samples with maps of {} texels a side take more than the 256 MiB that they \
                 may have, or one's skins more than the 128 MiB that every device can bind; set map={most}, \
                 fewer lines or fewer samples",
                self.lines, self.samples, self.map
            ),
        })
    }

    /// Whether samples are evenly spaced, independent of the scene.
    pub fn is_even(&self) -> bool {
        self.error == 0.0 || self.samples == 2
    }

    /// The fewest samples that a line may have.
    pub(super) fn fewest(&self) -> u32 {
        if self.is_even() { self.samples } else { 2 }
    }
}
