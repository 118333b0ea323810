//! The error and time that each candidate is expected to have in a situation, and the choice for each light by them.

use super::budget::ValidBudget;
use super::candidates::techniques;
use super::costs::tree_ms;
use super::shafts::shaft_work;
use super::table::{Measured, Table, View};
use super::{CANDIDATES, Costs, Features};

/// Views within `NEAR` + `FAR` × the nearest view's distance count as near a situation.
const NEAR: f64 = 0.1;
const FAR: f64 = 1.6;

/// The share that the promised error grows by for each unit of distance to the nearest view. This and [`FAR`] are
/// fitted by leaving out each scene and predicting it from the others (docs/planner.md).
const DOUBT: f64 = 0.7;

/// How fast the near views' times count for less by their distance, where [`shaft_work`] foretells a time.
const UNLIKE: f64 = 5.0;

/// A factor on the promised error, for images of other sizes than the table's.
const MARGIN: f64 = 1.05;

/// The most that a candidate's time may be over that of the fastest one that keeps the promise.
const TIMES_SLOWER: f64 = 10.0;

/// Errors up to so many times the least count as near to it: what [`TIMES_SLOWER`] times the samples would halve is no
/// bargain.
const NEARLY: f64 = 2.0;

/// The error and time that a candidate is expected to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Expected {
    /// The candidate's index in [`CANDIDATES`].
    pub candidate: usize,
    /// The mean error of the visible fraction, 0 to 1.
    pub error: f64,
    /// The time on the device, milliseconds.
    pub ms: f64,
}

/// The expected error and time of each candidate in a situation, for an image of `pixels` pixels and occluders of
/// `triangles` triangles; empty without a table.
pub(super) fn expect(
    table: &Table,
    costs: &Costs,
    features: &Features,
    pixels: f64,
    triangles: f64,
) -> Vec<Expected> {
    let (nearest, views) = nearest_views(table, features);
    let near = Near { table, costs, nearest, views, features, pixels, triangles };
    let of = |candidate: usize| match techniques()[candidate].room().reads_triangles() {
        true => near.of_triangles(candidate),
        false => near.of_maps(candidate),
    };
    (0..if near.views.is_empty() { 0 } else { CANDIDATES.len() }).map(of).collect()
}

/// A situation beside the table's views that are near it.
struct Near<'a> {
    table: &'a Table,
    costs: &'a Costs,
    /// The nearest view's distance.
    nearest: f64,
    views: Vec<&'a View>,
    features: &'a Features,
    pixels: f64,
    triangles: f64,
}

impl Near<'_> {
    fn measured(&self, candidate: usize) -> impl Iterator<Item = (&View, &Measured)> {
        self.views.iter().map(move |view| (*view, &view.measured[candidate]))
    }

    fn mean(&self, values: impl Iterator<Item = f64>) -> f64 {
        values.sum::<f64>() / self.views.len() as f64
    }

    /// The worst error of the near views, larger by their distance.
    fn worst(&self, candidate: usize) -> f64 {
        let worst = self.measured(candidate).map(|(_, m)| m.error).fold(0.0, f64::max);
        MARGIN * (1.0 + DOUBT * self.nearest) * worst
    }

    /// What is expected of a technique that sees the occluders in maps.
    fn of_maps(&self, candidate: usize) -> Expected {
        let technique = CANDIDATES[candidate].technique;
        let ms = |(view, measured): (&View, &Measured)| {
            self.costs.ms(technique, measured, self.pixels, self.triangles - view.triangles)
        };
        let ms = self.mean(self.measured(candidate).map(ms));
        Expected { candidate, error: self.worst(candidate).min(1.0), ms }
    }

    /// What is expected of a technique that tests the triangles themselves. It misses nothing and errs by the light's
    /// samples alone, which are the same in every scene, so that no unlikeness makes the error larger than the worst of
    /// the table. Its time at the pixels is [`shaft_work`]'s, times what the near views took over theirs, less
    /// the further they are.
    fn of_triangles(&self, candidate: usize) -> Expected {
        let over = &self.table.over[candidate];
        let maps = |(view, measured): (&View, &Measured)| {
            (measured.maps_ms + tree_ms(self.triangles - view.triangles)).max(0.0)
        };
        let maps_ms = self.mean(self.measured(candidate).map(maps));
        let log = |(view, measured): (&View, &Measured)| {
            (measured.pixels_ms / view.shaft_work() / over.pixels_ms).ln()
        };
        let alike = self.mean(self.measured(candidate).map(log)) / (1.0 + UNLIKE * self.nearest);
        let pixels_ms = over.pixels_ms * shaft_work(self.features) * alike.exp();
        let measured = Measured { maps_ms, pixels_ms, ..Measured::default() };
        let ms = self.costs.ms(CANDIDATES[candidate].technique, &measured, self.pixels, 0.0);
        let error = self.worst(candidate).min(MARGIN * over.worst).min(1.0);
        Expected { candidate, error, ms }
    }
}

/// Takes out of a light's candidates those that are expected to take more than [`TIMES_SLOWER`] times as long as the
/// fastest one that keeps the promise: in no frame, for no reason, and however long it has been the light's own.
///
/// Where none keeps it, those count that come near to the least error. Where a time alone is allowed, all of it may be
/// spent.
pub(super) fn drop_the_slow(expected: &mut Vec<Expected>, budget: &ValidBudget) {
    if budget.max_error == 0.0 && budget.max_ms.is_finite() {
        return;
    }
    let least = expected.iter().map(|e| e.error).fold(f64::INFINITY, f64::min);
    let error = budget.max_error.max(NEARLY * least);
    let good = expected.iter().filter(|e| e.error <= error);
    let most = TIMES_SLOWER * good.map(|e| e.ms).fold(f64::INFINITY, f64::min);
    expected.retain(|e| e.ms <= most);
}

/// The distance of the table's view that is nearest to a situation, and the near views, nearest first.
pub(super) fn nearest_views<'a>(table: &'a Table, features: &Features) -> (f64, Vec<&'a View>) {
    let mut all: Vec<(f64, &View)> =
        table.views.iter().map(|v| (v.features.distance(features), v)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = all.first().map_or(0.0, |v| v.0);
    all.retain(|v| v.0 <= NEAR + FAR * nearest);
    (nearest, all.into_iter().map(|v| v.1).collect())
}

/// Picks a candidate for each light: the fastest whose error is allowed. Where the time does not suffice, it starts
/// from the fastest and takes the steps that reduce errors most for their time.
pub(super) fn share(expected: &[Vec<Expected>], budget: &ValidBudget) -> Vec<Option<Expected>> {
    let good = |e: &Expected| e.error <= budget.max_error;
    let fastest = |all: &[Expected], which: &dyn Fn(&Expected) -> bool| {
        all.iter().filter(|e| which(e)).min_by(|a, b| a.ms.total_cmp(&b.ms)).copied()
    };
    let best = |all: &[Expected]| all.iter().min_by(|a, b| a.error.total_cmp(&b.error)).copied();
    let wanted: Vec<_> =
        expected.iter().map(|all| fastest(all, &good).or_else(|| best(all))).collect();
    let sum = |picked: &[Option<Expected>]| picked.iter().flatten().map(|e| e.ms).sum::<f64>();
    if sum(&wanted) <= budget.max_ms {
        return wanted;
    }
    let mut picked: Vec<_> = expected.iter().map(|all| fastest(all, &|_| true)).collect();
    loop {
        let left = budget.max_ms - sum(&picked);
        // The step within the time left that reduces the error most for its time.
        let steps = picked.iter().enumerate().flat_map(|(light, now)| {
            let now = *now;
            expected[light].iter().filter_map(move |e| {
                let now = now?;
                let fits =
                    e.ms - now.ms <= left && e.error < now.error && now.error > budget.max_error;
                let gain = (now.error - e.error) / (e.ms - now.ms).max(1e-6);
                fits.then_some((gain, light, *e))
            })
        });
        let Some((_, light, step)) = steps.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            return picked;
        };
        picked[light] = Some(step);
    }
}

/// A sentence that says how a chosen candidate misses the budget; `None` where it meets it.
pub(super) fn unmet(
    chosen: &Expected,
    expected: &[Expected],
    budget: &ValidBudget,
) -> Option<String> {
    if chosen.ms > budget.max_ms {
        let (least, most) = (chosen.ms, budget.max_ms);
        return Some(format!(
            "nothing takes less than {least:.1} ms here, and max_ms is {most}; the fastest is chosen"
        ));
    }
    if chosen.error <= budget.max_error || budget.max_error == 0.0 {
        return None;
    }
    let error = chosen.error;
    let could = expected.iter().any(|e| e.error <= budget.max_error);
    Some(if could {
        format!(
            "an error of {} takes more than {} ms; {error:.4} is what the time buys",
            budget.max_error, budget.max_ms
        )
    } else {
        format!("no error below {error:.4} can be promised here; that is chosen")
    })
}
