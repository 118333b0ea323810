//! Who is beaten by nobody, and how long an accuracy takes.

/// One measurement: what it costs and how wrong it is. Less of both is better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub ms: f64,
    /// Mean |error|, 0..1.
    pub error: f64,
}

/// The indices of the points that no other point beats in both, fastest first.
///
/// Where several are equal in both, the first stands for all. Points that are not numbers are beaten by
/// every other and never appear.
pub fn front(points: &[Point]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len())
        .filter(|&i| points[i].ms.is_finite() && points[i].error.is_finite())
        .collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a.ms.total_cmp(&b.ms).then(a.error.total_cmp(&b.error))
    });
    let mut best = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].error < best;
        best = best.min(points[i].error);
        better
    });
    order
}

/// The least time among the measured settings that reach an error; `None` where none does.
///
/// Nothing is put between two settings: the time stands for settings that were run.
pub fn time_for(points: impl IntoIterator<Item = Point>, error: f64) -> Option<f64> {
    points.into_iter().filter(|p| p.error <= error).map(|p| p.ms).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(all: &[(f64, f64)]) -> Vec<Point> {
        all.iter().map(|&(ms, error)| Point { ms, error }).collect()
    }

    #[test]
    fn the_front_is_what_nobody_beats_in_both() {
        let all =
            points(&[(3.0, 0.1), (1.0, 0.5), (2.0, 0.6), (2.0, 0.2), (5.0, 0.1), (9.0, 0.01)]);
        assert_eq!(front(&all), [1, 3, 0, 5]);
    }

    #[test]
    fn equals_appear_once_and_nonsense_never() {
        let all = points(&[(1.0, 0.5), (1.0, 0.5), (f64::NAN, 0.0), (0.5, f64::NAN)]);
        assert_eq!(front(&all), [0]);
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn the_time_for_an_error_is_the_fastest_that_reaches_it() {
        let all = points(&[(1.0, 0.04), (8.0, 0.02), (4.0, 0.03)]);
        assert_eq!(time_for(all.clone(), 0.05), Some(1.0));
        assert_eq!(time_for(all.clone(), 0.03), Some(4.0));
        assert_eq!(time_for(all, 0.01), None);
    }
}
