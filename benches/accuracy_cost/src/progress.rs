//! How long it will take: from what the groups measured so far took.

use crate::groups::{Group, Scale};
use crate::store::Row;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Seconds that a row takes beside its frames: stage, pipelines, compilation, comparison.
const SETUP_S: f64 = 0.25;

/// What a frame is taken to cost before anything like it was measured, in ms.
const UNKNOWN_MS: f64 = 60.0;

/// What rows cost, learnt from those that were measured.
#[derive(Default)]
pub struct Estimate {
    /// ms a frame and pixels, by technique and settings, the last one told.
    known: HashMap<(String, String), (f64, f64)>,
    /// Seconds told beforehand and seconds taken, of groups measured in this process.
    told: f64,
    taken: f64,
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

    /// Learns how wrong it was on a group.
    pub fn correct(&mut self, told: f64, taken: f64) {
        self.told += told;
        self.taken += taken;
    }

    /// Seconds a group should take.
    pub fn seconds(&self, group: &Group, scale: &Scale) -> f64 {
        let pixels = f64::from(group.extent[0]) * f64::from(group.extent[1]);
        let frames = (scale.rounds + 1) as f64;
        let mut ms = 0.0;
        for entry in &group.entries {
            let there = crate::techniques::method(entry.technique, &entry.words);
            if matches!(there, Ok(None)) {
                continue;
            }
            let same = self.known.get(&(entry.technique.to_string(), entry.words.clone()));
            // Part of a frame is the light's view, whatever the number of pixels.
            let scaled = |&(ms, of): &(f64, f64)| ms * (0.3 + 0.7 * pixels / of);
            let frame =
                same.map_or_else(|| self.typical(entry.technique).unwrap_or(UNKNOWN_MS), scaled);
            ms += SETUP_S * 1e3 + frames * frame;
        }
        if group.against == crate::groups::Against::Traced {
            // A ray's time from the tracer's own rows, which send the same rays.
            let per_ray = self
                .known
                .iter()
                .filter(|((technique, _), _)| technique == crate::techniques::RAY_TRACER)
                .filter_map(|((_, words), (ms, of))| {
                    Some(ms / of / crate::techniques::value_of(words, "rays")?)
                })
                .fold(None, |least: Option<f64>, ms| Some(least.map_or(ms, |l| l.min(ms))));
            ms += per_ray.unwrap_or(5e-4) * pixels * f64::from(scale.rays);
        }
        ms * 1e-3
    }

    /// The mean of what is known of a technique.
    fn typical(&self, technique: &str) -> Option<f64> {
        let of: Vec<f64> =
            self.known.iter().filter(|((t, _), _)| t == technique).map(|(_, v)| v.0).collect();
        (!of.is_empty()).then(|| of.iter().sum::<f64>() / of.len() as f64)
    }

    /// Seconds that all of these should take, as wrong as it has been so far.
    pub fn total<'a>(&self, groups: impl Iterator<Item = &'a Group>, scale: &Scale) -> f64 {
        let sum: f64 = groups.map(|g| self.seconds(g, scale)).sum();
        let factor = if self.told > 0.0 { (self.taken / self.told).clamp(0.2, 5.0) } else { 1.0 };
        sum * factor
    }
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
    /// Of so many groups.
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
            eprintln!(
                "{}/{}  {group}: {took:.1} s; {} left",
                self.bar.position(),
                self.length(),
                duration(left)
            );
        }
    }

    fn length(&self) -> u64 {
        self.bar.length().unwrap_or(0)
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
    use crate::groups::{FULL, QUICK, all};

    #[test]
    fn durations_are_told_as_a_person_would() {
        let told = [3.2, 89.0, 100.0, 5000.0, 11_100.0].map(duration);
        assert_eq!(told, ["3 s", "89 s", "2 min", "83 min", "3 h 05 min"]);
    }

    #[test]
    fn an_estimate_follows_what_was_measured() {
        let groups = all(&QUICK, &[]);
        let mut estimate = Estimate::default();
        let before = estimate.seconds(&groups[0], &QUICK);
        assert!(
            estimate.total(groups.iter(), &QUICK) < estimate.total(all(&FULL, &[]).iter(), &FULL)
        );
        let mut slow = crate::store::tests::row("soft shadow map", 256.0, 5000.0, 0.1);
        slow.settings = "map=256".into();
        slow.extent = groups[0].extent;
        estimate.learn(&[slow]);
        assert!(estimate.seconds(&groups[0], &QUICK) > before + 15.0);
        estimate.correct(10.0, 20.0);
        let sum: f64 = groups.iter().map(|g| estimate.seconds(g, &QUICK)).sum();
        assert!((estimate.total(groups.iter(), &QUICK) - 2.0 * sum).abs() < 1e-9);
    }
}
