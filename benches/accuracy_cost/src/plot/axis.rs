//! Axes: where a value lies, and which values are labelled.

use crate::stats::range;

/// One axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub label: String,
    pub log: bool,
    pub from: f64,
    pub to: f64,
}

impl Axis {
    /// A logarithmic axis around the values above 0, with a little room at both ends.
    pub fn log(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let [low, high] = range(values.into_iter().filter(|v| *v > 0.0)).unwrap_or([0.1, 10.0]);
        // Most of a decade at least: less would blow noise up to a slope.
        let grow = (6.0 / (high / low)).sqrt().max(1.25);
        Self { label: label.into(), log: true, from: low / grow, to: high * grow }
    }

    /// A linear axis around the values, from 0 where none is below.
    pub fn linear(label: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let [low, high] = range(values).unwrap_or([0.0, 1.0]);
        let room = 0.06 * (high - low).max(0.1 * high.abs()).max(1e-9);
        let from = if low >= 0.0 { 0.0 } else { low - room };
        Self { label: label.into(), log: false, from, to: high + room }
    }

    /// Where a value lies, 0 to 1; none off the axis.
    pub fn place(&self, value: f64) -> Option<f64> {
        let scale = |v: f64| if self.log { v.ln() } else { v };
        let at = (scale(value) - scale(self.from)) / (scale(self.to) - scale(self.from));
        (at.is_finite() && (-1e-9..=1.0 + 1e-9).contains(&at)).then_some(at)
    }

    /// The values that lines are drawn at, each with its label.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        if self.log { self.log_ticks() } else { self.linear_ticks() }
    }

    fn log_ticks(&self) -> Vec<(f64, String)> {
        let decades = (self.to / self.from).log10();
        // Labels stay apart: 1, 2, 5 where there is room, else 1 and 3 or whole decades.
        let digits: &[u32] = match decades {
            d if d < 2.2 => &[1, 2, 5],
            d if d < 3.5 => &[1, 3],
            _ => &[1],
        };
        let first = self.from.log10().floor() as i32;
        let last = self.to.log10().ceil() as i32;
        let all = (first..=last).flat_map(|e| digits.iter().map(move |&m| (e, m)));
        all.map(|(e, m)| (f64::from(m) * 10f64.powi(e), plain(f64::from(m), e)))
            .filter(|(value, _)| self.place(*value).is_some())
            .collect()
    }

    fn linear_ticks(&self) -> Vec<(f64, String)> {
        let span = self.to - self.from;
        // The step of 1, 2 or 5 times a power of ten that gives at most seven lines.
        let power = (span / 7.0).log10().floor() as i32;
        let steps = [1.0, 2.0, 5.0, 10.0].map(|m: f64| m * 10f64.powi(power));
        let step = steps.into_iter().find(|s| span / s <= 7.0).unwrap_or(steps[3]);
        let digits = usize::try_from(-step.log10().floor() as i64).unwrap_or(0);
        let first = (self.from / step).ceil() as i64;
        let last = (self.to / step).floor() as i64;
        (first..=last)
            .map(|i| i as f64 * step)
            .map(|v| (v, if step >= 1000.0 { thousands(v) } else { format!("{v:.digits$}") }))
            .collect()
    }
}

/// m · 10^e without an exponent where that is short.
fn plain(m: f64, e: i32) -> String {
    let digits = usize::try_from(-e).unwrap_or(0);
    let value = m * 10f64.powi(e);
    if value >= 10_000.0 { thousands(value) } else { format!("{value:.digits$}") }
}

fn thousands(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{}k", value / 1000.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().map(|t| t.1).collect()
    }

    #[test]
    fn a_log_axis_has_its_values_inside_and_labels_round_numbers() {
        let axis = Axis::log("ms", [3.0, 90.0, 0.0, f64::NAN]);
        assert!(axis.from < 3.0 && axis.to > 90.0);
        assert_eq!(labels(&axis), ["5", "10", "20", "50", "100"]);
        assert_eq!(axis.place(0.0), None);
        assert_eq!(
            labels(&Axis::log("ms", [0.1, 9000.0])),
            ["0.1", "1", "10", "100", "1000", "10k"]
        );
        assert!(labels(&Axis::log("%", [1.0, 1.0])).len() >= 2);
    }

    #[test]
    fn a_linear_axis_begins_at_0_and_labels_round_numbers() {
        assert_eq!(labels(&Axis::linear("m", [0.3, 1.96])), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(labels(&Axis::linear("m", [-1.2, 1.2])), ["-1.0", "-0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(&Axis::linear("n", [0.0, 98_000.0]))[1], "20k");
        assert!(!labels(&Axis::linear("none", [])).is_empty());
    }
}
