//! What laws measure, technique by technique.

use antumbra::Technique;
use std::collections::BTreeMap;

/// One measure of one technique.
#[derive(Debug, Default)]
struct Measured {
    images: u32,
    sum: f64,
    squares: f64,
    worst: f64,
    bounds: f64,
}

/// A law's numbers.
#[derive(Debug)]
pub struct Tally {
    law: &'static str,
    measured: BTreeMap<(&'static str, &'static str), Measured>,
    noticed: [u32; 2],
    images: usize,
}

impl Tally {
    pub fn new(law: &'static str) -> Self {
        Self { law, measured: BTreeMap::new(), noticed: [0; 2], images: 0 }
    }

    /// Adds what one image gave, that is to be at most `bound` in the mean of all images.
    pub fn add(&mut self, settings: &Technique, measure: &'static str, value: f64, bound: f64) {
        let m = self.measured.entry((measure, settings.name())).or_default();
        m.images += 1;
        m.sum += value;
        m.squares += value * value;
        m.worst = if value.abs() > m.worst.abs() { value } else { m.worst };
        m.bounds += bound;
    }

    /// Counts images: a scene, a light and settings each.
    pub fn judged(&mut self, images: usize) {
        self.images += images;
    }

    /// Whether an image that is wrong on purpose was told from a right one.
    pub fn notice(&mut self, noticed: bool) {
        self.noticed[0] += u32::from(noticed);
        self.noticed[1] += 1;
    }

    /// The mean of a measure over all techniques.
    pub fn mean(&self, measure: &str) -> f64 {
        let of = self.measured.iter().filter(|((name, _), _)| *name == measure);
        let (sum, images) = of.fold((0.0, 0), |(s, n), (_, m)| (s + m.sum, n + m.images));
        sum / f64::from(images.max(1))
    }

    /// Prints all of it and holds means against their bounds.
    pub fn check(&self) {
        let mut wrong = Vec::new();
        for ((measure, technique), m) in &self.measured {
            let images = f64::from(m.images);
            let (mean, bound) = (m.sum / images, m.bounds / images);
            let line = format!(
                "{}: {technique}, {} images, {measure}: mean {mean:.1e} of {bound:.1e}, worst {:.1e}",
                self.law, m.images, m.worst
            );
            println!("{line}");
            if mean > bound {
                wrong.push(line);
            }
        }
        let [noticed, of] = self.noticed;
        println!(
            "{}: {} images between 0 and 1, {noticed} of {of} wrong ones noticed",
            self.law, self.images
        );
        assert!(wrong.is_empty(), "beyond the bound:\n{}", wrong.join("\n"));
    }

    /// Holds a signed measure's mean against its own standard error: nothing drives it one way.
    pub fn check_bias(&self, measure: &str, most_sigmas: f64) {
        for ((_, technique), m) in self.measured.iter().filter(|((name, _), _)| *name == measure) {
            let n = f64::from(m.images);
            let mean = m.sum / n;
            let sigma = ((m.squares / n - mean * mean).max(0.0) / n).sqrt();
            println!("{}: {technique}, {measure} {mean:.1e} ± {sigma:.1e}", self.law);
            assert!(mean.abs() <= most_sigmas * sigma, "{technique}: {measure} {mean} ± {sigma}");
        }
    }

    /// Holds how many wrong images were noticed.
    pub fn check_noticed(&self, least: f64) {
        let [noticed, of] = self.noticed;
        assert!(
            of > 0 && f64::from(noticed) >= least * f64::from(of),
            "{}: only {noticed} of {of} wrong images were noticed",
            self.law
        );
    }
}
