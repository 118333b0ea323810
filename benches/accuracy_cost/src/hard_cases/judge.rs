//! An image beside what it must be.

use super::cases::{HardCase, Limit, Noise};
use super::pixels::{Range, SIDE};
use super::techniques::Held;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The table of each device, by its name.
pub type Tables = BTreeMap<String, Vec<Row>>;

/// What came of a row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Verdict {
    /// Within its bound.
    Held,
    /// Beyond it, as is known, and why.
    Known(String),
    /// Beyond it.
    Broken,
    /// Said to be beyond it, and within.
    Mended(String),
}

/// One row of the table.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    pub limit: Limit,
    pub case: String,
    pub technique: String,
    /// Least and largest truth.
    pub expected: [f64; 2],
    /// What the mean error may be.
    pub mean_bound: f64,
    /// What the error of the worst pixel may be.
    pub worst_bound: f64,
    pub why: String,
    /// The mean error over the pixels in shadow or penumbra.
    pub mean: f64,
    /// The same, weighed by the light's unshadowed irradiance.
    #[serde(default)]
    pub seen: f64,
    /// The worst pixel's error.
    pub worst: f64,
    /// How far the worst pixel is out of what it may be; not above 0 where none is.
    pub outside: f64,
    /// Pixels that are no number between 0 and 1.
    pub not_fractions: usize,
    pub verdict: Verdict,
}

impl Row {
    /// Whether it is within its bound, or as it is known to be.
    pub fn is_good(&self) -> bool {
        matches!(self.verdict, Verdict::Held | Verdict::Known(_))
    }
}

/// Whether a pixel is neither lit nor in umbra for sure.
fn is_between(range: &Range) -> bool {
    range.least < 1.0 && range.most > 0.0
}

/// Which pixels have one between lit and umbra no further away than `spread`.
fn near_penumbra(ranges: &[Range], spread: usize) -> Vec<bool> {
    let side = SIDE as usize;
    let around = |i: usize| (i.saturating_sub(spread))..=(i + spread).min(side - 1);
    let near = |i: usize| {
        let (x, y) = (i % side, i / side);
        around(y).any(|y| around(x).any(|x| is_between(&ranges[y * side + x])))
    };
    (0..ranges.len()).map(near).collect()
}

/// Judges the image of a technique, which `by` made for it; `irradiance` is that of each pixel without shadows.
pub fn judge(
    case: &HardCase,
    held: &'static Held,
    by: &Held,
    noise: Option<&Noise>,
    ranges: &[Range],
    irradiance: &[f64],
    image: &[f32],
) -> Row {
    let between = near_penumbra(ranges, by.spread);
    let [solid, mean_solid] = by.of_solids(&case.set.blocks);
    let [worst_noise, mean_noise] = noise.map_or([by.noise, by.mean_noise], |n| [n.worst, n.mean]);
    let mut row = Row {
        limit: case.limit,
        case: case.name.clone(),
        technique: held.name.into(),
        expected: [f64::INFINITY, f64::NEG_INFINITY],
        mean_bound: 0.0,
        worst_bound: 0.0,
        why: noise.map_or(by.why, |n| n.why).into(),
        mean: 0.0,
        seen: 0.0,
        worst: 0.0,
        outside: f64::NEG_INFINITY,
        not_fractions: 0,
        verdict: Verdict::Held,
    };
    let (mut counted, mut light) = (0.0, 0.0);
    for (((range, &v), &between), &e) in ranges.iter().zip(image).zip(&between).zip(irradiance) {
        let v = f64::from(v);
        row.expected = [row.expected[0].min(range.truth), row.expected[1].max(range.truth)];
        if !(0.0..=1.0).contains(&v) {
            row.not_fractions += 1;
            continue;
        }
        // Lit is exactly 1.
        let lit = range.least >= 1.0 && !between;
        let model = if lit { 0.0 } else { by.sums + solid };
        let slack = model + if between { worst_noise } else { 0.0 };
        let (least, most) = ((range.least - slack).max(0.0), (range.most + slack).min(1.0));
        row.outside = row.outside.max(least - v).max(v - most);
        row.worst_bound = row.worst_bound.max(range.truth - least).max(most - range.truth);
        let error = (v - range.truth).abs();
        row.worst = row.worst.max(error);
        if v < 1.0 || range.truth < 1.0 {
            counted += 1.0;
            row.mean += error;
            light += e;
            row.seen += e * error;
            let outline = (range.truth - range.least).max(range.most - range.truth);
            let noise = if between { mean_noise } else { 0.0 };
            row.mean_bound += (outline + by.sums + mean_solid + noise).min(1.0);
        }
    }
    if counted > 0.0 {
        row.mean /= counted;
        row.mean_bound /= counted;
    }
    if light > 0.0 {
        row.seen /= light;
    }
    // A row is held whole: no pixel out of its range, and the mean within its own bound.
    let good = row.not_fractions == 0 && row.outside <= 0.0 && row.mean <= row.mean_bound;
    row.verdict = match (good, case.known(held)) {
        (true, None) => Verdict::Held,
        (true, Some(why)) => Verdict::Mended(why.into()),
        (false, Some(why)) if row.not_fractions == 0 => Verdict::Known(why.into()),
        (false, _) => Verdict::Broken,
    };
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hard_cases::{cases, techniques};

    /// Half of the image is lit and half in umbra, with a column of penumbra between.
    fn ranges() -> Vec<Range> {
        let side = SIDE as usize;
        let range = |i: usize| match (i % side).cmp(&(side / 2)) {
            std::cmp::Ordering::Less => Range { truth: 0.0, least: 0.0, most: 0.0 },
            std::cmp::Ordering::Equal => Range { truth: 0.5, least: 0.4, most: 0.7 },
            std::cmp::Ordering::Greater => Range { truth: 1.0, least: 1.0, most: 1.0 },
        };
        (0..side * side).map(range).collect()
    }

    /// The left half is twice as bright.
    fn irradiance() -> Vec<f64> {
        let side = SIDE as usize;
        (0..side * side).map(|i| if i % side < side / 2 { 2.0 } else { 1.0 }).collect()
    }

    fn judged(of: usize, change: impl Fn(&mut [f32])) -> Row {
        let case = &cases::all()[0];
        let held = &techniques::ALL[of];
        let ranges = ranges();
        let mut image: Vec<f32> = ranges.iter().map(|range| range.truth as f32).collect();
        change(&mut image);
        judge(case, held, held, None, &ranges, &irradiance(), &image)
    }

    #[test]
    fn a_pixel_out_of_its_range_breaks_a_row() {
        let middle = SIDE as usize / 2;
        let put = |at: usize, v: f32| judged(0, move |image| image[at] = v).verdict;
        assert_eq!(judged(0, |_| {}).verdict, Verdict::Held);
        // In penumbra what outlines explain, and what adding up does.
        assert_eq!(put(middle, 0.7001), Verdict::Held);
        assert_eq!(put(middle, 0.71), Verdict::Broken);
        assert_eq!(put(middle, 0.39), Verdict::Broken);
        // Lit is lit to the last bit, and umbra but for rounding.
        assert_eq!(put(middle + 1, 1.0 - f32::EPSILON), Verdict::Broken);
        assert_eq!(put(0, 1e-4), Verdict::Held);
        assert_eq!(put(0, 1e-3), Verdict::Broken);
        for none in [f32::NAN, -1e-7, 1.0 + f32::EPSILON, f32::INFINITY] {
            let row = judged(0, move |image| image[0] = none);
            assert_eq!((row.not_fractions, row.verdict), (1, Verdict::Broken), "{none}");
        }
    }

    /// The left half and the column of penumbra count: side²/2 pixels of weight 2, and side of weight 1.
    #[test]
    fn errors_are_weighed_by_the_light() {
        let side = f64::from(SIDE);
        let [dark, between] = [0, SIDE as usize / 2].map(|at| judged(0, |image| image[at] += 0.25));
        let weight = side * side + side;
        assert!((dark.seen - 2.0 * 0.25 / weight).abs() < 1e-12, "{dark:?}");
        assert!((between.seen - 0.25 / weight).abs() < 1e-12, "{between:?}");
        assert!((dark.mean - between.mean).abs() < 1e-12);
    }

    /// Noise is spread by a filter, and no further; and each pixel may be noisy while all of them are not.
    #[test]
    fn noise_is_allowed_where_it_is_and_not_in_the_mean() {
        let rays = techniques::ALL.iter().position(|held| held.name == "ray-march").unwrap();
        let middle = SIDE as usize / 2;
        let put = |at: usize, v: f32| judged(rays, move |image| image[at] = v).verdict;
        assert_eq!(put(middle + 12, 0.8), Verdict::Held);
        assert_eq!(put(middle + 13, 0.99), Verdict::Broken);
        assert_eq!(put(middle - 12, 0.3), Verdict::Held);
        let all = judged(rays, |image| {
            for row in image.chunks_exact_mut(SIDE as usize) {
                row[middle - 12..=middle].iter_mut().for_each(|v| *v += 0.3);
            }
        });
        assert!(all.outside <= 0.0 && all.verdict == Verdict::Broken, "{all:?}");
    }
}
