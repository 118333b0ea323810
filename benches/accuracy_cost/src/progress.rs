//! How long it will take: from what the groups measured so far took.

use crate::groups::{Against, Group, MATRIX};
use crate::options::Scale;
use crate::store::Row;
use crate::techniques::{RAY_TRACER, method, value_of};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Seconds that a row takes beside its frames: stage, pipelines, compilation, comparison.
const SETUP_S: f64 = 0.25;

/// What a frame is estimated to cost before anything like it was measured, in ms.
const UNKNOWN_MS: f64 = 60.0;

/// What rows cost, learnt from those that were measured.
#[derive(Default)]
pub struct Estimate {
    /// ms a frame and pixels, by technique and settings, of the last row.
    known: HashMap<(String, String), (f64, f64)>,
    /// Seconds that known costs add up to and seconds taken, of the groups measured in this process:
    /// of the views, and of the sweeps, whose rows are many and cheap.
    views: [f64; 2],
    sweeps: [f64; 2],
}

impl Estimate {
    /// Learns from rows.
    pub fn learn(&mut self, rows: &[Row]) {
        for row in rows {
            if let Some(ms) = row.ms() {
                let pixels = f64::from(row.extent[0]) * f64::from(row.extent[1]);
                self.known.insert((row.technique.clone(), row.settings.clone()), (ms, pixels));
            }
        }
    }

    /// Learns how wrong it is on a group whose rows it has learnt.
    pub fn correct(&mut self, group: &Group, scale: &Scale, taken: f64) {
        let estimated = self.seconds(group, scale);
        let sums = if group.study == MATRIX { &mut self.views } else { &mut self.sweeps };
        *sums = [sums[0] + estimated, sums[1] + taken];
    }

    /// A group's seconds, as wrong as such groups have been.
    fn corrected(&self, group: &Group, scale: &Scale) -> f64 {
        let [estimated, taken] = if group.study == MATRIX { self.views } else { self.sweeps };
        let factor = if estimated > 0.0 { (taken / estimated).clamp(0.2, 5.0) } else { 1.0 };
        factor * self.seconds(group, scale)
    }

    /// Seconds a group should take.
    pub fn seconds(&self, group: &Group, scale: &Scale) -> f64 {
        let pixels = f64::from(group.extent[0]) * f64::from(group.extent[1]);
        let frames = (scale.rounds + 1) as f64;
        let mut ms = 0.0;
        for entry in &group.entries {
            if matches!(method(entry.technique, &entry.words), Ok(None)) {
                continue;
            }
            let same = self.known.get(&(entry.technique.to_string(), entry.words.clone()));
            let known = same.map(|cost| at(cost, pixels));
            let frame =
                known.or_else(|| self.typical(entry.technique, pixels)).unwrap_or(UNKNOWN_MS);
            ms += SETUP_S * 1e3 + frames * frame;
        }
        if group.against == Against::Traced {
            // A ray's time from the tracer's own rows, which send the same rays.
            let per_ray = self
                .known
                .iter()
                .filter(|((technique, _), _)| technique == RAY_TRACER)
                .filter_map(|((_, words), (ms, of))| Some(ms / of / value_of(words, "rays")?))
                .reduce(f64::min);
            ms += per_ray.unwrap_or(5e-4) * pixels * f64::from(scale.rays);
        }
        ms * 1e-3
    }

    /// The mean of what is known of a technique, at so many pixels.
    fn typical(&self, technique: &str, pixels: f64) -> Option<f64> {
        let of = self.known.iter().filter(|((t, _), _)| t == technique);
        let of: Vec<f64> = of.map(|(_, cost)| at(cost, pixels)).collect();
        (!of.is_empty()).then(|| of.iter().sum::<f64>() / of.len() as f64)
    }

    /// Seconds that all of these should take, as wrong as it has been so far.
    pub fn total<'a>(&self, groups: impl Iterator<Item = &'a Group>, scale: &Scale) -> f64 {
        groups.map(|g| self.corrected(g, scale)).sum()
    }
}

/// The ms of a frame at another number of pixels: part of it is the light's view, whatever that is.
fn at(&(ms, of): &(f64, f64), pixels: f64) -> f64 {
    ms * (0.3 + 0.7 * pixels / of)
}

/// "3 h 05 min", "12 min", "40 s".
pub fn duration(seconds: f64) -> String {
    let s = seconds.max(0.0).round() as u64;
    match s {
        0..=89 => format!("{s} s"),
        90..=5399 => format!("{} min", (s + 30) / 60),
        _ => format!("{} h {:02} min", s / 3600, s % 3600 / 60),
    }
}

/// The terminal: a bar where there is one, lines where output goes to a file.
pub struct Progress {
    bar: ProgressBar,
    started: Instant,
    plain: bool,
}

impl Progress {
    /// The progress of a run of so many groups.
    pub fn new(groups: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(groups as u64), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{bar:24} {pos}/{len}  {prefix}  {wide_msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let plain = bar.is_hidden();
        Self { bar, started: Instant::now(), plain }
    }

    /// What is being done.
    pub fn doing(&self, what: &str) {
        self.bar.set_message(what.to_string());
    }

    /// A group is done; so many seconds are left.
    pub fn done(&self, group: &str, took: f64, left: f64) {
        self.bar.inc(1);
        self.bar.set_prefix(format!("{} left", duration(left)));
        if self.plain {
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
            eprintln!("{done}/{all}  {group}: {took:.1} s; {} left", duration(left));
        }
    }

    /// A line that stays.
    pub fn say(&self, line: &str) {
        if self.plain {
            eprintln!("{line}");
        } else {
            self.bar.println(line);
        }
    }

    /// Since the beginning.
    pub fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{FULL, QUICK};
    use crate::studies::all;

    #[test]
    fn durations_are_as_a_person_would_say() {
        let texts = [3.2, 89.0, 100.0, 5000.0, 11_100.0].map(duration);
        assert_eq!(texts, ["3 s", "89 s", "2 min", "83 min", "3 h 05 min"]);
    }

    #[test]
    fn an_estimate_follows_what_was_measured() {
        let groups = all(&QUICK, &[]);
        let mut estimate = Estimate::default();
        let before = estimate.seconds(&groups[1], &QUICK);
        assert!(
            estimate.total(groups.iter(), &QUICK) < estimate.total(all(&FULL, &[]).iter(), &FULL)
        );
        let mut slow = crate::store::tests::row("soft shadow map", 256.0, 5000.0, 0.1);
        slow.settings = "map=256".into();
        slow.extent = groups[1].extent;
        estimate.learn(&[slow]);
        assert!(estimate.seconds(&groups[1], &QUICK) > before + 15.0);
        // Views and sweeps are wrong by factors of their own.
        let (sweep, view) = (&groups[0], &groups[1]);
        let of = |estimate: &Estimate, g| estimate.total(std::iter::once(g), &QUICK);
        let [sweep_s, view_s] = [sweep, view].map(|g| of(&estimate, g));
        estimate.correct(view, &QUICK, 2.0 * view_s);
        assert!((of(&estimate, view) - 2.0 * view_s).abs() < 1e-9);
        assert!((of(&estimate, sweep) - sweep_s).abs() < 1e-9);
    }
}
