//! The times of passes on the device at hand, relative to the device that the table was measured on.

use super::table::{Measured, PIXELS};
use crate::technique::Technique;

/// The number of techniques.
const TECHNIQUES: usize = Technique::NAMES.len();

/// The weight of one frame's time, once several frames have been learnt from: the exponent on its correction.
const BELIEF: f64 = 0.2;

/// The largest correction: a factor beyond it is an outlier and no property of the device.
const MOST: f64 = 16.0;

/// The time that a triangle takes in a depth layer on the table's device, milliseconds.
const DRAW_MS: f64 = 0.35e-3;

/// The time that a triangle takes in a hierarchy whose boxes are made anew, on the table's device, milliseconds. The order
/// of the triangles is kept while the list of meshes stays.
const TREE_MS: f64 = 0.42e-3;

/// The milliseconds that `more_triangles` more triangles take in a hierarchy on the table's device; below 0 for fewer.
pub(super) fn tree_ms(more_triangles: f64) -> f64 {
    TREE_MS * more_triangles
}

/// Factors from times on the table's device to times on the device at hand; 1 where nothing was measured.
///
/// The factors hold for one device and driver: with the feature `serde` a host keeps them under the device's name, in
/// any format of serde's, until the next start. Factors that are missing, not finite or not above 0 are then read as 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "kept::Kept", into = "kept::Kept"))]
pub struct Costs {
    /// The factor of passes in light space.
    pub maps: f64,
    /// The factor of passes over the pixels.
    pub pixels: f64,
    /// A further factor for each technique, learnt from the times of its frames.
    by_technique: [f64; TECHNIQUES],
    /// The number of frames that each factor was learnt from.
    frames: [u32; TECHNIQUES],
}

impl Default for Costs {
    fn default() -> Self {
        Self { maps: 1.0, pixels: 1.0, by_technique: [1.0; TECHNIQUES], frames: [0; TECHNIQUES] }
    }
}

/// The index of a technique in [`Technique::NAMES`]; `None` for an unknown name.
fn place(technique: &str) -> Option<usize> {
    Technique::NAMES.iter().position(|name| *name == technique)
}

impl Costs {
    /// The costs of a device on which passes in light space and passes over the pixels take `maps` and `pixels` times
    /// as long as on the table's. A factor that is not finite or not above 0 counts as 1.
    pub fn new(maps: f64, pixels: f64) -> Self {
        let sound = |x: f64| if x.is_finite() && x > 0.0 { x } else { 1.0 };
        Self { maps: sound(maps), pixels: sound(pixels), ..Self::default() }
    }

    /// The expected milliseconds of a technique that took `table`'s times, for `pixels` pixels and `more_triangles`
    /// more triangles than in the table.
    pub(crate) fn ms(
        &self,
        technique: &str,
        table: &Measured,
        pixels: f64,
        more_triangles: f64,
    ) -> f64 {
        let draws = DRAW_MS * more_triangles.max(0.0);
        let ms =
            self.maps * (table.maps_ms + draws) + self.pixels * table.pixels_ms * pixels / PIXELS;
        ms * place(technique).map_or(1.0, |i| self.by_technique[i])
    }

    /// Learns from a frame that was expected to take `expected` milliseconds and took `measured`.
    pub(crate) fn learn(&mut self, technique: &str, expected: f64, measured: f64) {
        let Some(i) = place(technique) else { return };
        let factor = measured / expected;
        if !(factor.is_finite() && factor > 0.0) {
            return;
        }
        // The first frames count most: they replace a guess.
        let belief = BELIEF.max(1.0 / (1.0 + f64::from(self.frames[i])));
        let by = factor.clamp(1.0 / MOST, MOST).powf(belief);
        self.by_technique[i] = (self.by_technique[i] * by).clamp(1.0 / MOST, MOST);
        self.frames[i] = self.frames[i].saturating_add(1);
    }
}

/// The form in which costs are kept: techniques by name, so that it outlives a release that adds one.
#[cfg(feature = "serde")]
mod kept {
    use super::{Costs, MOST, place};
    use crate::technique::Technique;
    use serde::{Deserialize, Serialize};
    use std::collections::BTreeMap;

    #[derive(Serialize, Deserialize)]
    #[serde(default)]
    pub(super) struct Kept {
        maps: f64,
        pixels: f64,
        /// A technique's factor and the number of frames that it was learnt from.
        techniques: BTreeMap<String, (f64, u32)>,
    }

    impl Default for Kept {
        fn default() -> Self {
            Costs::default().into()
        }
    }

    impl From<Costs> for Kept {
        fn from(costs: Costs) -> Self {
            let learnt = costs.by_technique.into_iter().zip(costs.frames);
            let techniques = Technique::NAMES.iter().map(|name| (*name).into()).zip(learnt);
            Self { maps: costs.maps, pixels: costs.pixels, techniques: techniques.collect() }
        }
    }

    impl From<Kept> for Costs {
        fn from(kept: Kept) -> Self {
            let mut costs = Self::new(kept.maps, kept.pixels);
            for (name, (factor, frames)) in kept.techniques {
                if let Some(i) = place(&name).filter(|_| factor.is_finite() && factor > 0.0) {
                    costs.by_technique[i] = factor.clamp(1.0 / MOST, MOST);
                    costs.frames[i] = frames;
                }
            }
            costs
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_correct_what_was_guessed() {
        let mut costs = Costs::new(2.0, 3.0);
        let table = Measured { error: 0.0, maps_ms: 1.0, pixels_ms: 4.0 };
        let ms = |c: &Costs, t| c.ms(t, &table, PIXELS, 0.0);
        assert_eq!(ms(&costs, "pcss"), 2.0 + 12.0);
        for _ in 0..20 {
            let expected = ms(&costs, "pcss");
            costs.learn("pcss", expected, 28.0);
        }
        assert!((ms(&costs, "pcss") - 28.0).abs() < 0.5);
        assert_eq!(ms(&costs, "hard"), 14.0, "another technique's frames say nothing of it");
        assert_eq!(Costs::new(f64::NAN, 0.0), Costs::default());
    }

    #[test]
    #[cfg(feature = "serde")]
    fn costs_that_were_kept_are_read_again_and_invalid_factors_are_1() {
        let mut costs = Costs::new(2.0, 3.0);
        costs.learn("pcss", 10.0, 25.0);
        let text = serde_json::to_string(&costs).unwrap();
        assert_eq!(serde_json::from_str::<Costs>(&text).unwrap(), costs);
        let invalid = [
            "{}",
            r#"{"pixels": -1, "maps": 0}"#,
            r#"{"techniques": {"unknown": [3, 1], "pcss": [-2, 1], "hard": [0, 9]}}"#,
        ];
        for text in invalid {
            assert_eq!(serde_json::from_str::<Costs>(text).unwrap(), Costs::default(), "{text}");
        }
        for text in ["", "maps 2", r#"{"maps": "x"}"#, r#"{"maps": null}"#] {
            assert!(serde_json::from_str::<Costs>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn one_slow_frame_changes_little() {
        let mut costs = Costs::default();
        (0..9).for_each(|_| costs.learn("pcss", 10.0, 10.0));
        let before = costs;
        costs.learn("pcss", 10.0, 10_000.0);
        let table = Measured { error: 0.0, maps_ms: 0.0, pixels_ms: 1.0 };
        let ms = |c: &Costs| c.ms("pcss", &table, PIXELS, 0.0);
        assert!(ms(&costs) < 2.0 * ms(&before));
    }
}
