//! The errors of an image of visible fractions against the truth.

use crate::Error;

/// Visible fractions this near to 0 or 1 count as umbra or fully lit.
///
/// A quarter of the step of an 8-bit image, so no display shows the difference; a hundred times
/// the rounding of a technique's sum, so a technique's lit pixels do not count as shadow and
/// dilute its mean error.
pub const FULL_TOLERANCE: f32 = 1e-3;

/// The least difference from the truth for which a pixel that is umbra or light in the image counts as false umbra or
/// false light.
///
/// Six times the standard error that one straight shadow edge can give a truth traced with 256 rays
/// (0.0085, [`super::trace::Sampling`]; measured 0.007 in the penumbra of scanned models), so noise
/// in the truth does not count.
pub const FALSE_MARGIN: f32 = 0.05;

/// The error of an image, image − truth, in visible fractions (0..1; times 100 for percent).
///
/// A pixel is counted where the truth *or* the image puts it in penumbra or umbra (v below
/// 1 − [`FULL_TOLERANCE`]): Atty 2006 section 5.2.1 divides the summed error by those pixels, since
/// all others of an image would only flatter it. A mean over no pixels is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ErrorSummary {
    /// The number of counted pixels.
    pub pixels: usize,
    /// Mean |error| over the counted pixels: the metric of Atty 2006 section 5.2.1.
    pub mean_abs_error: f64,
    /// Root of the mean square error over the counted pixels.
    pub rmse: f64,
    /// The 99th percentile of |error| over the counted pixels (nearest rank: 99 % of them are at
    /// or below it).
    pub p99: f64,
    /// The largest |error| over the counted pixels.
    pub worst: f64,
    /// Mean error over the counted pixels, signed: above 0 the image is too bright.
    pub bias: f64,
    /// The number of pixels that the truth puts in the penumbra ([`FULL_TOLERANCE`] from both ends).
    pub penumbra_pixels: usize,
    /// Mean |error| over the pixels in the penumbra.
    pub penumbra_mean: f64,
    /// The share of counted pixels that the image puts in the umbra while the truth is above
    /// [`FALSE_MARGIN`].
    pub false_umbra: f64,
    /// The share of counted pixels that the image puts in full light while the truth is below
    /// 1 − [`FALSE_MARGIN`]: leaks.
    pub false_light: f64,
    /// The number of pixels that the truth puts in full light.
    pub lit_pixels: usize,
    /// Mean |error| over the pixels in full light, counted above or not: acne, and shadows cast where none belong.
    pub lit_error: f64,
}

impl ErrorSummary {
    /// Compares an image with the truth, pixel by pixel, where `mask` (if given) is true.
    ///
    /// The image may lie outside 0..1: that is an error like any other.
    ///
    /// # Errors
    /// [`Error::Frame`] where lengths differ, or a value under the mask is not finite, or a truth
    /// under the mask is outside 0..1.
    pub fn between(truth: &[f32], image: &[f32], mask: Option<&[bool]>) -> Result<Self, Error> {
        let mut tally = Tally::default();
        each(truth, image, mask, |_, truth, image| tally.add(truth, image))?;
        Ok(tally.summary())
    }
}

/// The mean |error| of an image as an eye sees it: each pixel weighs as much as the light would brighten it with nothing
/// in between, Σ E · |image − truth| / Σ E.
///
/// The mean is over the pixels that [`ErrorSummary::mean_abs_error`] counts, those that the truth or the image puts in
/// penumbra or umbra, where `mask` (if given) is true. `irradiance` is the unshadowed irradiance E of each pixel by this
/// one light, in any unit: what its visible fraction is multiplied by. So an error counts little where the light
/// grazes a surface or is far away, and not at all on a surface that is turned away from it. Where no light reaches a
/// counted pixel the mean is 0.
///
/// # Errors
/// [`Error::Frame`] as [`ErrorSummary::between`], and where an irradiance under the mask is below 0 or not finite.
pub fn seen_error(
    truth: &[f32],
    image: &[f32],
    irradiance: &[f64],
    mask: Option<&[bool]>,
) -> Result<f64, Error> {
    same_length("the irradiance", irradiance.len(), truth.len())?;
    let (mut errors, mut all) = (0.0, 0.0);
    let mut wrong = None;
    each(truth, image, mask, |i, truth, image| {
        let weight = irradiance[i];
        if !(weight.is_finite() && weight >= 0.0) {
            wrong.get_or_insert(i);
        }
        if !(is_lit(truth) && is_lit(image)) {
            errors += weight * (f64::from(image) - f64::from(truth)).abs();
            all += weight;
        }
    })?;
    match wrong {
        Some(i) => Err(Error::Frame(format!(
            "the irradiance at pixel {i} must be a finite number from 0 (it is {})",
            irradiance[i]
        ))),
        None if all > 0.0 => Ok(errors / all),
        None => Ok(0.0),
    }
}

fn is_lit(v: f32) -> bool {
    v >= 1.0 - FULL_TOLERANCE
}

fn is_umbra(v: f32) -> bool {
    v <= FULL_TOLERANCE
}

fn same_length(what: &str, length: usize, truth: usize) -> Result<(), Error> {
    if length == truth {
        return Ok(());
    }
    Err(Error::Frame(format!(
        "{what} must have as many pixels as the truth ({length} against {truth})"
    )))
}

/// Gives `to` the index, truth and image of every pixel where the mask is true.
fn each(
    truth: &[f32],
    image: &[f32],
    mask: Option<&[bool]>,
    mut to: impl FnMut(usize, f32, f32),
) -> Result<(), Error> {
    same_length("the image", image.len(), truth.len())?;
    if let Some(mask) = mask {
        same_length("the mask", mask.len(), truth.len())?;
    }
    for (i, (&truth, &image)) in truth.iter().zip(image).enumerate() {
        if mask.is_some_and(|mask| !mask[i]) {
            continue;
        }
        if !(0.0..=1.0).contains(&truth) {
            return Err(Error::Frame(format!(
                "the truth at pixel {i} must be from 0 to 1 (it is {truth})"
            )));
        }
        if !image.is_finite() {
            return Err(Error::Frame(format!(
                "the image at pixel {i} must be finite (it is {image})"
            )));
        }
        to(i, truth, image);
    }
    Ok(())
}

/// Sums on the way to a summary.
#[derive(Default)]
struct Tally {
    /// Signed, one a counted pixel.
    errors: Vec<f64>,
    penumbra: Mean,
    lit: Mean,
    false_umbra: usize,
    false_light: usize,
}

impl Tally {
    fn add(&mut self, truth: f32, image: f32) {
        let error = f64::from(image) - f64::from(truth);
        if is_lit(truth) {
            self.lit.add(error.abs());
        } else if !is_umbra(truth) {
            self.penumbra.add(error.abs());
        }
        if is_lit(truth) && is_lit(image) {
            return;
        }
        self.errors.push(error);
        self.false_umbra += usize::from(is_umbra(image) && truth > FALSE_MARGIN);
        self.false_light += usize::from(is_lit(image) && truth < 1.0 - FALSE_MARGIN);
    }

    fn summary(&self) -> ErrorSummary {
        let pixels = self.errors.len();
        let share = |sum: f64| sum / pixels.max(1) as f64;
        let mut sizes: Vec<f64> = self.errors.iter().map(|e| e.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        // Nearest rank, in integers: 0.99 × 100 is not 99 in floating point on every count.
        let rank = (pixels * 99).div_ceil(100);
        let at_rank = |rank: usize| rank.checked_sub(1).map_or(0.0, |i| sizes[i]);
        ErrorSummary {
            pixels,
            mean_abs_error: share(sizes.iter().sum()),
            rmse: share(sizes.iter().map(|e| e * e).sum()).sqrt(),
            p99: at_rank(rank),
            worst: at_rank(pixels),
            bias: share(self.errors.iter().sum()),
            penumbra_pixels: self.penumbra.count,
            penumbra_mean: self.penumbra.value(),
            false_umbra: share(self.false_umbra as f64),
            false_light: share(self.false_light as f64),
            lit_pixels: self.lit.count,
            lit_error: self.lit.value(),
        }
    }
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn value(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}
