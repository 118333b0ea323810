//! How far a number may be from what was expected, and where it was furthest.

/// How far apart two numbers may be: whichever of the three allows more.
///
/// Two NaNs agree, and so do two infinities of one sign; a NaN agrees with nothing else. Numbers
/// under 2^-126 count as 0, which Vulkan lets a device take them for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tolerance {
    /// Steps between neighbouring 32-bit floats.
    pub ulps: u32,
    /// Difference.
    pub absolute: f64,
    /// Difference as a share of the expected number.
    pub relative: f64,
}

impl Tolerance {
    /// The same number; 0 and −0 are the same.
    pub fn exact() -> Self {
        Self::default()
    }

    /// `ulps` steps between neighbouring 32-bit floats.
    pub fn ulps(ulps: u32) -> Self {
        Self { ulps, ..Self::default() }
    }

    /// A difference of `absolute`.
    pub fn absolute(absolute: f64) -> Self {
        Self { absolute, ..Self::default() }
    }

    /// A difference of `relative` times the expected number.
    pub fn relative(relative: f64) -> Self {
        Self { relative, ..Self::default() }
    }

    /// This, or a difference of `absolute`.
    #[must_use]
    pub fn or_absolute(self, absolute: f64) -> Self {
        Self { absolute, ..self }
    }

    /// The difference as a multiple of what is allowed: up to 1 is allowed. Infinite where nothing
    /// is allowed, or where a NaN or an infinity meets something else.
    pub fn excess(&self, found: f64, expected: f64) -> f64 {
        let flushed = |x: f64| if x.abs() < f64::from(f32::MIN_POSITIVE) { 0.0 } else { x };
        let (found, expected) = (flushed(found), flushed(expected));
        if found == expected || (found.is_nan() && expected.is_nan()) {
            return 0.0;
        }
        let difference = (found - expected).abs();
        if !difference.is_finite() {
            return f64::INFINITY;
        }
        let in_ulps = f64::from(ulps_between(found as f32, expected as f32));
        let share = |by: f64, of: f64| if by == 0.0 { 0.0 } else { by / of };
        share(difference, self.absolute + self.relative * expected.abs())
            .min(share(in_ulps, f64::from(self.ulps)))
    }
}

/// Steps from one 32-bit float to the other, through 0 where their signs differ.
pub fn ulps_between(a: f32, b: f32) -> u32 {
    // Floats of one sign are ordered as their bits are; the other sign counts down from 0.
    let ordered = |x: f32| {
        let magnitude = i64::from(x.to_bits() & 0x7fff_ffff);
        if x.is_sign_negative() { -magnitude } else { magnitude }
    };
    u32::try_from((ordered(a) - ordered(b)).unsigned_abs()).unwrap_or(u32::MAX)
}

/// The comparison of many cases: the worst of them, and how many were not allowed.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// How many cases were compared.
    pub cases: usize,
    /// How many of them differed by more than is allowed.
    pub failures: usize,
    /// The worst, if any differed at all.
    pub worst: Option<Worst>,
}

/// The worst of many cases.
#[derive(Clone, Debug)]
pub struct Worst {
    /// The case's inputs.
    pub input: Vec<f64>,
    /// Everything that was found for it.
    pub found: Vec<f64>,
    /// Everything that was expected.
    pub expected: Vec<f64>,
    /// The difference as a multiple of what is allowed; see [`Tolerance::excess`].
    pub excess: f64,
    /// The difference of the worst component.
    pub difference: f64,
    /// The same in steps between neighbouring 32-bit floats.
    pub ulps: u32,
}

impl Report {
    /// Adds one case.
    ///
    /// # Panics
    /// If the two have different lengths: then they are not results of the same function.
    pub fn add(&mut self, input: &[f64], found: &[f64], expected: &[f64], tolerance: Tolerance) {
        let (f, e) = (found.len(), expected.len());
        assert_eq!(f, e, "the function has {f} results, its twin {e}");
        self.cases += 1;
        let mut failed = false;
        for (&f, &e) in found.iter().zip(expected) {
            let excess = tolerance.excess(f, e);
            failed |= excess > 1.0;
            let difference = (f - e).abs();
            // Among equally bad ones, such as infinitely bad ones, the larger difference.
            let key = (excess, difference);
            let worse = self.worst.as_ref().is_none_or(|w| key > (w.excess, w.difference));
            if excess > 0.0 && worse {
                self.worst = Some(Worst {
                    input: input.to_vec(),
                    found: found.to_vec(),
                    expected: expected.to_vec(),
                    excess,
                    difference,
                    ulps: ulps_between(f as f32, e as f32),
                });
            }
        }
        self.failures += usize::from(failed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ulps_count_steps_through_zero() {
        assert_eq!(ulps_between(1.0, 1.0_f32.next_up()), 1);
        assert_eq!(ulps_between(0.0_f32.next_up(), 0.0_f32.next_down()), 2);
        assert_eq!(ulps_between(0.0, -0.0), 0);
        assert_eq!(ulps_between(f32::MIN, f32::MAX), 2 * f32::MAX.to_bits());
    }

    #[test]
    fn whichever_allows_more_decides() {
        let next = f64::from(1.0_f32.next_up());
        assert!(Tolerance::exact().excess(next, 1.0) > 1.0);
        assert!(Tolerance::ulps(1).excess(next, 1.0) <= 1.0);
        assert!(Tolerance::ulps(1).excess(1.5, 1.0) > 1.0);
        assert!(Tolerance::ulps(1).or_absolute(0.5).excess(1.5, 1.0) <= 1.0);
        assert!(Tolerance::relative(0.1).excess(10.9, 10.0) <= 1.0);
        assert!(Tolerance::relative(0.1).excess(11.1, 10.0) > 1.0);
    }

    #[test]
    fn what_is_not_finite_agrees_only_with_itself() {
        let lax = Tolerance { ulps: 10, absolute: 1e9, relative: 1.0 };
        assert_eq!(lax.excess(f64::NAN, f64::NAN), 0.0);
        assert_eq!(lax.excess(f64::INFINITY, f64::INFINITY), 0.0);
        for (a, b) in [(f64::NAN, 0.0), (0.0, f64::NAN), (f64::INFINITY, 1.0)] {
            assert_eq!(lax.excess(a, b), f64::INFINITY);
        }
    }

    #[test]
    fn subnormal_numbers_count_as_zero() {
        assert_eq!(Tolerance::exact().excess(0.0, 1.1e-38), 0.0);
        assert!(Tolerance::exact().excess(0.0, 1.2e-38) > 1.0);
    }

    #[test]
    fn a_report_keeps_the_worst_case() {
        let mut report = Report::default();
        for (input, found) in [(1.0, 1.25), (2.0, 1.5), (3.0, f64::NAN), (4.0, 1.0)] {
            report.add(&[input], &[found], &[1.0], Tolerance::absolute(0.25));
        }
        assert_eq!((report.cases, report.failures), (4, 2));
        assert_eq!(report.worst.unwrap().input, [3.0]);
    }
}
