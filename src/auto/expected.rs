//! What each candidate is expected to do in a situation, and which of them lights take.

use super::budget::Sound;
use super::table::{Table, View};
use super::{CANDIDATES, Costs, Likeness};

/// Views no further than this from a situation count, and the further the nearest one is the more others do.
const AS_NEAR: f64 = 0.1;
const AS_FAR: f64 = 1.6;

/// What a unit of distance to the nearest view adds to the error that is promised, as a share of it. Chosen with
/// [`AS_FAR`] by leaving each scene out and asking the others (docs/planner.md).
const DOUBT: f64 = 0.7;

/// What images of other sizes err by more than the table's, as a share.
const MARGIN: f64 = 1.05;

/// What a candidate is expected to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Expected {
    /// Its place among [`CANDIDATES`].
    pub candidate: usize,
    /// Mean error, a visible fraction.
    pub error: f64,
    /// Milliseconds.
    pub ms: f64,
}

/// What each candidate would do in a situation like this.
pub(super) fn expect(
    table: &Table,
    costs: &Costs,
    likeness: &Likeness,
    pixels: f64,
    triangles: f64,
) -> Vec<Expected> {
    let (nearest, like) = alike(table, likeness);
    let doubt = MARGIN * (1.0 + DOUBT * nearest);
    let of = |candidate: usize| {
        let technique = CANDIDATES[candidate].technique;
        let mut error: f64 = 0.0;
        let mut ms = 0.0;
        for view in &like {
            let measured = &view.measured[candidate];
            error = error.max(measured.error);
            ms += costs.ms(technique, measured, pixels, triangles - view.triangles);
        }
        Expected { candidate, error: (error * doubt).min(1.0), ms: ms / like.len() as f64 }
    };
    // Without a table nothing is known.
    (0..if like.is_empty() { 0 } else { CANDIDATES.len() }).map(of).collect()
}

/// The views that are most like a situation, the nearest first, and how far away that one is.
pub(super) fn alike<'a>(table: &'a Table, likeness: &Likeness) -> (f64, Vec<&'a View>) {
    let mut all: Vec<(f64, &View)> =
        table.views.iter().map(|v| (v.likeness.distance(likeness), v)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = all.first().map_or(0.0, |v| v.0);
    all.retain(|v| v.0 <= AS_NEAR + AS_FAR * nearest);
    (nearest, all.into_iter().map(|v| v.1).collect())
}

/// A candidate for each light: the fastest that is good enough, or, where the time does not reach, what most betters the
/// lights' errors for it.
pub(super) fn share(expected: &[Vec<Expected>], sound: &Sound) -> Vec<Option<Expected>> {
    let good = |e: &Expected| e.error <= sound.max_error;
    let fastest = |all: &[Expected], which: &dyn Fn(&Expected) -> bool| {
        all.iter().filter(|e| which(e)).min_by(|a, b| a.ms.total_cmp(&b.ms)).copied()
    };
    let best = |all: &[Expected]| all.iter().min_by(|a, b| a.error.total_cmp(&b.error)).copied();
    let wanted: Vec<_> =
        expected.iter().map(|all| fastest(all, &good).or_else(|| best(all))).collect();
    let sum = |picked: &[Option<Expected>]| picked.iter().flatten().map(|e| e.ms).sum::<f64>();
    if sum(&wanted) <= sound.max_ms {
        return wanted;
    }
    let mut picked: Vec<_> = expected.iter().map(|all| fastest(all, &|_| true)).collect();
    loop {
        let left = sound.max_ms - sum(&picked);
        // Of every step that fits, the one that takes most error away for its time.
        let steps = picked.iter().enumerate().flat_map(|(light, now)| {
            let now = *now;
            expected[light].iter().filter_map(move |e| {
                let now = now?;
                let fits =
                    e.ms - now.ms <= left && e.error < now.error && now.error > sound.max_error;
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

/// A sentence where a choice is not what was asked for.
pub(super) fn unmet(taken: &Expected, expected: &[Expected], sound: &Sound) -> Option<String> {
    if taken.ms > sound.max_ms {
        let (least, most) = (taken.ms, sound.max_ms);
        return Some(format!(
            "nothing takes less than {least:.1} ms here, and max_ms is {most}; the fastest is chosen"
        ));
    }
    if taken.error <= sound.max_error || sound.max_error == 0.0 {
        return None;
    }
    let error = taken.error;
    let could = expected.iter().any(|e| e.error <= sound.max_error);
    Some(if could {
        format!(
            "an error of {} takes more than {} ms; {error:.4} is what the time buys",
            sound.max_error, sound.max_ms
        )
    } else {
        format!("no error below {error:.4} can be promised here; that is chosen")
    })
}
