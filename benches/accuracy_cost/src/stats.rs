//! Medians, quartiles, and lines through points.

/// The value at a share (0..1) of the sorted values, between neighbours in proportion; NaN of none.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = share.clamp(0.0, 1.0) * last as f64;
    let low = at.floor() as usize;
    let high = (low + 1).min(last);
    sorted[low] + (sorted[high] - sorted[low]) * (at - low as f64)
}

/// The median; NaN of none.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// First quartile, median, third quartile.
pub fn quartiles(values: &[f64]) -> [f64; 3] {
    [0.25, 0.5, 0.75].map(|share| quantile(values, share))
}

/// The least and the largest of the finite values.
pub fn range(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.into_iter().filter(|v| v.is_finite());
    finite.map(|v| [v; 2]).reduce(|[low, high], [v, _]| [low.min(v), high.max(v)])
}

/// A line y = base + slope · x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// y at x = 0.
    pub base: f64,
    /// y for one more x.
    pub slope: f64,
    /// The share of the variance of y that the line explains.
    pub r2: f64,
}

/// Least squares through at least two points of different x.
pub fn line(points: &[(f64, f64)]) -> Option<Line> {
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>();
    let sxx = sum(&|p| (p.0 - x).powi(2));
    let sxy = sum(&|p| (p.0 - x) * (p.1 - y));
    let syy = sum(&|p| (p.1 - y).powi(2));
    if points.len() < 2 || sxx <= 0.0 {
        return None;
    }
    let slope = sxy / sxx;
    // Points on a level line are explained wholly.
    let r2 = if syy > 0.0 { sxy * sxy / (sxx * syy) } else { 1.0 };
    Some(Line { base: y - slope * x, slope, r2 })
}

/// The exponent e of y ∝ x^e, by least squares on logarithms; points must be above 0.
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<_> = points.iter().map(|p| (p.0.ln(), p.1.ln())).collect();
    logs.iter().all(|p| p.0.is_finite() && p.1.is_finite()).then(|| line(&logs))?.map(|l| l.slope)
}

/// How alike the order of y is to the order of x: 1 where y only rises, −1 where it only falls
/// (Kendall's τ). None of fewer than two points.
pub fn rising(points: &[(f64, f64)]) -> Option<f64> {
    let mut pairs = 0.0;
    let mut sum = 0.0;
    for (i, a) in points.iter().enumerate() {
        for b in &points[..i] {
            pairs += 1.0;
            let order = (a.0 - b.0) * (a.1 - b.1);
            sum += if order == 0.0 { 0.0 } else { order.signum() };
        }
    }
    (pairs > 0.0).then_some(sum / pairs)
}

/// How jagged a curve is: the mean |second difference| of evenly spaced y over their mean. A
/// straight line has 0, whatever its slope. None of fewer than three points.
pub fn jaggedness(y: &[f64]) -> Option<f64> {
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    let bends: Vec<f64> = y.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).collect();
    (!bends.is_empty() && mean > 0.0).then(|| bends.iter().sum::<f64>() / bends.len() as f64 / mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_those_of_the_textbook() {
        assert_eq!(quartiles(&[4.0, 1.0, 3.0, 2.0, 5.0]), [2.0, 3.0, 4.0]);
        assert_eq!(median(&[1.0, 2.0]), 1.5);
        assert_eq!(quartiles(&[7.0]), [7.0; 3]);
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn a_line_is_found_and_a_bend_shows_in_r2() {
        let points: Vec<_> = (0..5).map(|x| (f64::from(x), 3.0 + 2.0 * f64::from(x))).collect();
        let Line { base, slope, r2 } = line(&points).unwrap();
        assert!((base - 3.0).abs() < 1e-12 && (slope - 2.0).abs() < 1e-12 && r2 > 1.0 - 1e-12);
        let bent: Vec<_> = (0..5).map(|x| (f64::from(x), f64::from((x - 2) * (x - 2)))).collect();
        assert!(line(&bent).unwrap().r2 < 0.01);
        assert_eq!(line(&points[..1]), None);
        assert_eq!(line(&[(1.0, 1.0), (1.0, 2.0)]), None);
    }

    #[test]
    fn a_power_is_found() {
        let points = [(1.0, 3.0), (2.0, 12.0), (4.0, 48.0)];
        assert!((exponent(&points).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(exponent(&[(1.0, 0.0), (2.0, 1.0)]), None);
    }

    #[test]
    fn order_and_jaggedness() {
        assert_eq!(rising(&[(1.0, 1.0), (2.0, 5.0), (3.0, 6.0)]), Some(1.0));
        assert_eq!(rising(&[(1.0, 3.0), (2.0, 2.0), (3.0, 1.0)]), Some(-1.0));
        assert_eq!(rising(&[(1.0, 1.0)]), None);
        assert_eq!(jaggedness(&[1.0, 2.0, 3.0, 4.0]), Some(0.0));
        assert!(jaggedness(&[1.0, 3.0, 1.0, 3.0]).unwrap() > 1.0);
        assert_eq!(jaggedness(&[1.0, 2.0]), None);
    }
}
