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

/// Factors from times on the table's device to times on the device at hand; 1 where nothing was measured.
///
/// The factors hold for one device and driver: a host stores [`Self::to_text`] under the device's name and restores it
/// with [`Self::from_text`] at the next start.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// The costs of a device on which passes in light space and passes over the pixels take `maps` and `pixels` times as
    /// long as on the table's. A factor that is not finite or not above 0 counts as 1.
    pub fn new(maps: f64, pixels: f64) -> Self {
        let sound = |x: f64| if x.is_finite() && x > 0.0 { x } else { 1.0 };
        Self { maps: sound(maps), pixels: sound(pixels), ..Self::default() }
    }

    /// The expected milliseconds of a technique that took `table`'s times, for `pixels` pixels and `more_triangles` more
    /// triangles than in the table.
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

    /// The factors as text, one to a line.
    pub fn to_text(&self) -> String {
        let mut text = format!("maps {}\npixels {}\n", self.maps, self.pixels);
        for (name, (factor, frames)) in
            Technique::NAMES.iter().zip(self.by_technique.iter().zip(&self.frames))
        {
            text.push_str(&format!("{name} {factor} {frames}\n"));
        }
        text
    }

    /// Reads the text of [`Self::to_text`]; factors that are missing or invalid are 1.
    pub fn from_text(text: &str) -> Self {
        let mut costs = Self::default();
        for line in text.lines() {
            let mut words = line.split_whitespace();
            let (Some(name), Some(Ok(factor))) =
                (words.next(), words.next().map(str::parse::<f64>))
            else {
                continue;
            };
            if !(factor.is_finite() && factor > 0.0) {
                continue;
            }
            match name {
                "maps" => costs.maps = factor,
                "pixels" => costs.pixels = factor,
                _ => {
                    if let Some(i) = place(name) {
                        costs.by_technique[i] = factor.clamp(1.0 / MOST, MOST);
                        costs.frames[i] = words.next().and_then(|n| n.parse().ok()).unwrap_or(0);
                    }
                }
            }
        }
        costs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_correct_what_was_guessed_and_text_keeps_it() {
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
        assert_eq!(Costs::from_text(&costs.to_text()), costs);
        for bad in ["", "maps", "maps x", "pixels -1\nmaps NaN", "unknown 3"] {
            assert_eq!(Costs::from_text(bad), Costs::default(), "{bad}");
        }
        assert_eq!(Costs::new(f64::NAN, 0.0), Costs::default());
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
