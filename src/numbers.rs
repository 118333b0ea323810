//! Small functions of numbers; the twin of `glsl/common/numbers.glsl`.

use num_traits::Float;

/// The length of [a, b] ∩ [0, 1]; negative where b < a.
///
/// The summed-area trick of Atty 2006 §4.2: a box filter over the unit interval is a difference of
/// two clamped ends, without a case for each way the intervals can lie.
pub fn interval_overlap_unit<F: Float>(a: F, b: F) -> F {
    clamp_unit(b) - clamp_unit(a)
}

/// `x` within [0, 1].
pub fn clamp_unit<F: Float>(x: F) -> F {
    x.max(F::zero()).min(F::one())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_overlaps_the_unit_interval_by_what_they_share() {
        assert_eq!(interval_overlap_unit(-1.0, 2.0), 1.0);
        assert_eq!(interval_overlap_unit(0.25, 0.75), 0.5);
        assert_eq!(interval_overlap_unit(-1.0, 0.25), 0.25);
        assert_eq!(interval_overlap_unit(1.5, 2.5), 0.0);
        assert_eq!(interval_overlap_unit(0.75, 0.25), -0.5);
    }
}
