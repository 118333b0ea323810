//! How images are compared.

use super::promises::ONE_TEXEL;

fn pairs<'a>(a: &'a [f32], b: &'a [f32]) -> impl Iterator<Item = [f64; 2]> + 'a {
    a.iter().zip(b).map(|(a, b)| [f64::from(*a), f64::from(*b)])
}

/// The first visible fraction that is none: not finite, below 0 or above 1.
pub fn out_of_bounds(image: &[f32]) -> Option<f32> {
    image.iter().copied().find(|v| !(0.0..=1.0).contains(v))
}

/// How many pixels are not lit to the last bit.
pub fn not_lit(image: &[f32]) -> usize {
    image.iter().filter(|v| v.to_bits() != 1f32.to_bits()).count()
}

/// The share of pixels that differ by more than `smooth`.
pub fn changed(a: &[f32], b: &[f32], smooth: f64) -> f64 {
    let changed = pairs(a, b).filter(|[a, b]| (a - b).abs() > smooth || a.is_nan() || b.is_nan());
    changed.count() as f64 / a.len() as f64
}

/// Whether two images are the same but for rounding.
pub fn alike(a: &[f32], b: &[f32], smooth: f64) -> bool {
    changed(a, b, smooth) <= ONE_TEXEL
}

/// The most that differences which are rounding come to.
pub fn rounding(a: &[f32], b: &[f32], smooth: f64) -> f64 {
    pairs(a, b).map(|[a, b]| (a - b).abs()).filter(|d| *d <= smooth).fold(0.0, f64::max)
}

/// The sum of |differences|, that of signed ones, and how many pixels are not lit in both.
pub fn differences(a: &[f32], b: &[f32]) -> [f64; 3] {
    pairs(a, b).fold([0.0; 3], |[absolute, signed, touched], [a, b]| {
        let t = if a < 1.0 || b < 1.0 { 1.0 } else { 0.0 };
        [absolute + (a - b).abs(), signed + a - b, touched + t]
    })
}

/// The mean |difference| over pixels that are not lit in both; 0 without such pixels.
pub fn difference(a: &[f32], b: &[f32]) -> f64 {
    let [absolute, _, touched] = differences(a, b);
    absolute / touched.max(1.0)
}

/// The most that any pixel is higher in the second image, and the mean of that over all.
pub fn rise(from: &[f32], to: &[f32]) -> [f64; 2] {
    let rises = pairs(from, to).map(|[a, b]| (b - a).max(0.0));
    let [most, sum] = rises.fold([0.0, 0.0], |[most, sum], r| [f64::max(most, r), sum + r]);
    [most, sum / from.len() as f64]
}

/// The mean of two images.
pub fn mean_of(a: &[f32], b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()
}

/// Of the pixels that a filtered hard shadow has as 0 or 1, and so beyond a texel of its edges, the share that
/// differ by more than one of an image's 256 steps.
pub fn beyond_edges(hard: &[f32], image: &[f32]) -> f64 {
    let sure = pairs(hard, image).filter(|[hard, _]| *hard == 0.0 || *hard == 1.0);
    let (differ, all) = sure.fold((0, 0), |(differ, all), [hard, v]| {
        (differ + u32::from((hard - v).abs() > 1.0 / 256.0), all + 1)
    });
    f64::from(differ) / f64::from(all.max(1))
}
