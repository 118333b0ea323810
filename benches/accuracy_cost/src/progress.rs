//! How far a run is and how long it will still take: a bar on a terminal, lines where output goes to a file.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// The progress of a run, counted in rows: they take about as long as each other, few pixels or many, since what a
/// row takes beside its frames (stage, pipelines, compilation, comparison) is most of it.
pub struct Progress {
    bar: ProgressBar,
    plain: bool,
}

impl Progress {
    /// The progress of a run of so many rows.
    pub fn new(rows: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(rows as u64), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{bar:24} {pos}/{len}  {prefix}  {wide_msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let plain = bar.is_hidden();
        Self { bar, plain }
    }

    /// What is being done.
    pub fn doing(&self, what: &str) {
        self.bar.set_message(what.to_string());
    }

    /// A group of so many rows is done.
    pub fn done(&self, group: &str, rows: usize, took: Duration) {
        self.bar.inc(rows as u64);
        let (done, all) = (self.bar.position(), self.bar.length().unwrap_or_default());
        let left = HumanDuration(self.expected(all.saturating_sub(done) as usize));
        self.bar.set_prefix(format!("{left} left"));
        if self.plain {
            eprintln!("{done}/{all}  {group}: {:.1} s; {left} left", took.as_secs_f64());
        }
    }

    /// What so many rows should take, by the mean of all that were measured so far.
    ///
    /// [`ProgressBar::eta`] is of the last 15 seconds, which are often one group, and groups differ.
    pub fn expected(&self, rows: usize) -> Duration {
        self.elapsed().mul_f64(rows as f64 / self.bar.position().max(1) as f64)
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
        self.bar.elapsed()
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_expected_to_take_what_was_measured_a_row() {
        let progress = Progress::new(8);
        progress.bar.set_elapsed(Duration::from_secs(60));
        progress.done("a group", 2, Duration::from_secs(60));
        let left = progress.expected(6).as_secs_f64();
        assert!((180.0..190.0).contains(&left), "{left}");
    }
}
