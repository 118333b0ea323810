//! The error and time that each candidate is expected to have in a situation, and the choice for each light by them.

use super::budget::ValidBudget;
use super::table::{Table, View};
use super::{CANDIDATES, Costs, Features};

/// Views within `NEAR` + `FAR` × the nearest view's distance count as near a situation.
const NEAR: f64 = 0.1;
const FAR: f64 = 1.6;

/// The share that the promised error grows by for each unit of distance to the nearest view. This and [`FAR`] are
/// fitted by leaving out each scene and predicting it from the others (docs/planner.md).
const DOUBT: f64 = 0.7;

/// A factor on the promised error, for images of other sizes than the table's.
const MARGIN: f64 = 1.05;

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
    let doubt = MARGIN * (1.0 + DOUBT * nearest);
    let of = |candidate: usize| {
        let technique = CANDIDATES[candidate].technique;
        let mut error: f64 = 0.0;
        let mut ms = 0.0;
        for view in &views {
            let measured = &view.measured[candidate];
            error = error.max(measured.error);
            ms += costs.ms(technique, measured, pixels, triangles - view.triangles);
        }
        Expected { candidate, error: (error * doubt).min(1.0), ms: ms / views.len() as f64 }
    };
    (0..if views.is_empty() { 0 } else { CANDIDATES.len() }).map(of).collect()
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
