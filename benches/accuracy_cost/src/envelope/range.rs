//! Over what range of a variable an error stays near what it is at the range's centre: a pure function.

use antumbra::truth::metrics::FULL_TOLERANCE;

/// The most that an error within the envelope is, over the error at the centre.
pub const FACTOR: f64 = 1.5;

/// The least error that [`FACTOR`] applies to. The metric takes a pixel this near to lit or umbra for
/// that; of two errors below it none can be called the worse one, and 1.5 times an error of 0 is none.
pub const FLOOR: f64 = FULL_TOLERANCE as f64;

/// The error at one place of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Where, in the variable's unit.
    pub at: f64,
    /// The mean error; not a number where there is none.
    pub error: f64,
}

/// The widest range around the centre of a sweep at every step of which the error is within the bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope {
    /// The error at the centre.
    pub centre: f64,
    /// The most that it may be.
    pub bound: f64,
    /// The least and the greatest step that hold.
    pub range: [f64; 2],
    /// The step before the least one and the one after the greatest, which do not; none at the sweep's ends.
    pub beyond: [Option<Step>; 2],
}

impl Envelope {
    /// The envelope of a sweep's steps in rising order, around the one of this index. None where that is no step, or
    /// has no error that is a number.
    pub fn around(centre: usize, steps: &[Step]) -> Option<Self> {
        let error = Some(steps.get(centre)?.error).filter(|e| e.is_finite())?;
        let bound = FACTOR * error.max(FLOOR);
        // An error that is no number is not within.
        let holds = |step: &&Step| step.error <= bound;
        let below = steps[..centre].iter().rev().take_while(holds).count();
        let above = steps[centre + 1..].iter().take_while(holds).count();
        let [first, last] = [centre - below, centre + above];
        Some(Self {
            centre: error,
            bound,
            range: [steps[first].at, steps[last].at],
            beyond: [first.checked_sub(1), Some(last + 1)].map(|i| steps.get(i?).copied()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(errors: &[f64]) -> Vec<Step> {
        (1_u32..).zip(errors).map(|(at, &e)| Step { at: at.into(), error: e }).collect()
    }

    #[test]
    fn it_ends_at_the_first_step_beyond_the_bound_on_either_side() {
        // 4 is within again, and not counted: the range is contiguous.
        let sweep = steps(&[0.02, 0.031, 0.03, 0.02, 0.01, 0.029, 0.04, 0.02]);
        let found = Envelope::around(3, &sweep).unwrap();
        assert_eq!(found.centre, 0.02);
        assert_eq!(found.range, [3.0, 6.0]);
        assert_eq!(found.beyond, [Some(sweep[1]), Some(sweep[6])]);
    }

    #[test]
    fn what_holds_to_the_ends_has_nothing_beyond_and_the_bound_itself_holds() {
        let found = Envelope::around(1, &steps(&[0.03, 0.02, 0.03])).unwrap();
        assert_eq!((found.range, found.beyond), ([1.0, 3.0], [None, None]));
        let alone = Envelope::around(0, &steps(&[0.5])).unwrap();
        assert_eq!((alone.range, alone.beyond), ([1.0, 1.0], [None, None]));
        let narrow = Envelope::around(1, &steps(&[0.031, 0.02, 0.031])).unwrap();
        assert_eq!(narrow.range, [2.0, 2.0]);
    }

    #[test]
    fn a_centre_without_error_is_taken_for_the_least_that_counts() {
        let found = Envelope::around(1, &steps(&[1.4e-3, 0.0, 1.6e-3])).unwrap();
        assert!((found.bound - FACTOR * FLOOR).abs() < 1e-12);
        assert_eq!(found.range, [1.0, 2.0]);
    }

    #[test]
    fn what_is_no_number_ends_it() {
        let sweep = steps(&[0.01, f64::NAN, 0.01, 0.01]);
        let found = Envelope::around(2, &sweep).unwrap();
        assert_eq!(found.range, [3.0, 4.0]);
        assert!(found.beyond[0].is_some_and(|s| s.at == 2.0 && s.error.is_nan()));
        for centre in [1, 4] {
            assert_eq!(Envelope::around(centre, &sweep), None);
        }
    }
}
