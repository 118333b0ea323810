//! The error of a running frame, measured: a few of its pixels are traced exactly, and compared with what the technique
//! wrote.
//!
//! ```text
//!   a cell of the image a candidate        lit for sure    ──► left out, unless the technique shadows it
//!   ┌─┬─┬─┬─┐  a random pixel of each      (its shaft is empty)
//!   ├·┼─┼·┼─┤  cell, another one each  ──►                 ┌──► at most `audit` of the others, evenly spread:
//!   └─┴·┴─┴·┘  frame                       the others  ────┘    512 samples of the light; their error; figures
//! ```
//! [`Description::audit`](crate::Description::audit) is the number of pixels that are traced in a frame, for any
//! technique; [`ShadowNode::measured_error`](crate::ShadowNode::measured_error) has the figures once the device has
//! completed the frame, and [`ErrorWindow`] those of several frames together.
//!
//! The error is that of Atty 2006 section 5.2.1: the mean of |image − truth| over the pixels that either puts into shadow
//! or penumbra (`truth::metrics`). Which pixels those are is part of what is measured, so the mean is a ratio of two sums
//! over candidates, of which each pixel of the image is one with the same probability. A candidate in shadow counts 1
//! in the lower sum, so that the usual estimate of a ratio's variance (Cochran 1977, section 2.11) is that of a plain
//! mean. That candidates come from different cells makes the true variance smaller.
//!
//! A traced pixel is the tip of a pyramid over the light. The hierarchy of the blocking triangles
//! ([`crate::stages::hierarchy`]), which a technique that reads it shares, has those in the pyramid, and each is tested
//! against 32 by 16 samples of the light. No technique's map is involved, so an audit sees what a technique does not know of itself: leaks,
//! occluders outside of a map, bounds that are too small.
//!
//! **Limits.** Blocking meshes that the host draws itself have no triangles, and lent occluder maps and textured lights
//! none that count: with an audit they are refused. One frame's interval is too narrow where few of its pixels make most
//! of the error. `docs/audit.md` has the measurements.

pub(crate) mod passes;

/// The words that the last pass writes (`audit/figures.comp`).
const WORDS: usize = 16;

/// The bytes of a frame's figures.
pub(crate) const FIGURE_BYTES: u64 = 4 * WORDS as u64;

/// The error of one frame or of several, measured at some of the pixels in shadow or penumbra, in visible fractions (0
/// to 1; times 100 for percent).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeasuredError {
    /// The mean |error| over the pixels in shadow or penumbra (Atty 2006 section 5.2.1), as estimated from `pixels` of
    /// them; 0 without any.
    pub mean: f64,
    /// The lower end of the interval that holds the mean of all pixels with a probability of 95 %, from 0 up.
    pub low: f64,
    /// The upper end; fewer than two pixels tell nothing, and the interval is then 0 to 1.
    pub high: f64,
    /// How many traced pixels were in shadow or penumbra, by the image or by the truth.
    pub pixels: u64,
    /// The root of the mean square error over these pixels.
    pub rms: f64,
    /// The largest |error| among them.
    pub worst: f64,
    /// The mean error over them, signed: above 0 the image is too bright.
    pub bias: f64,
    /// How many pixels were candidates; `pixels` of them or more than that were in shadow.
    pub candidates: u64,
}

impl MeasuredError {
    /// The figures of some pixels by their sums.
    fn of(pixels: u64, candidates: u64, sums: Sums) -> Self {
        let Sums { abs, squares, signed, worst } = sums;
        let count = pixels as f64;
        let over = |sum: f64| if pixels > 0 { sum / count } else { 0.0 };
        let (mean, square) = (over(abs), over(squares));
        // The variance of the mean, by the pixels' own spread (Student 1908).
        let [low, high] = match pixels {
            0 | 1 => [0.0, 1.0],
            _ => {
                let variance = (square - mean * mean).max(0.0) / (count - 1.0);
                let half = student(pixels - 1) * variance.sqrt();
                [(mean - half).max(0.0), mean + half]
            }
        };
        let (rms, bias) = (square.sqrt(), over(signed));
        Self { mean, low, high, pixels, rms, worst, bias, candidates }
    }

    fn sums(&self) -> Sums {
        let count = self.pixels as f64;
        Sums {
            abs: self.mean * count,
            squares: self.rms * self.rms * count,
            signed: self.bias * count,
            worst: self.worst,
        }
    }
}

/// The sums over pixels in shadow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sums {
    abs: f64,
    squares: f64,
    signed: f64,
    worst: f64,
}

/// The measured errors of several frames, as one: each frame's pixels are chosen anew, so that the interval of n frames
/// is about √n times narrower than a frame's.
///
/// While the scene changes it is the error of all these frames together. A host that wants the last few alone clears it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorWindow {
    sums: Sums,
    pixels: u64,
    candidates: u64,
    frames: u64,
}

impl ErrorWindow {
    /// A window of no frames.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a frame. Frames with more pixels in shadow count for more.
    pub fn add(&mut self, frame: &MeasuredError) {
        let Sums { abs, squares, signed, worst } = frame.sums();
        self.sums.abs += abs;
        self.sums.squares += squares;
        self.sums.signed += signed;
        self.sums.worst = self.sums.worst.max(worst);
        self.pixels += frame.pixels;
        self.candidates += frame.candidates;
        self.frames += 1;
    }

    /// How many frames were added.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// The error of all frames together.
    pub fn error(&self) -> MeasuredError {
        MeasuredError::of(self.pixels, self.candidates, self.sums)
    }

    /// Forgets all frames.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// The factor of a mean's standard error within which 95 % of means lie, for a number of degrees of freedom from 1 up:
/// the series of Fisher and Cornish 1960, within 1 % from 3 on.
fn student(degrees: u64) -> f64 {
    const Z: f64 = 1.959_963_985;
    let per = 1.0 / degrees as f64;
    match degrees {
        0 | 1 => 12.706_2,
        2 => 4.302_7,
        _ => {
            let [z3, z5, z7] = [3, 5, 7].map(|power| Z.powi(power));
            Z + per * (z3 + Z) / 4.0
                + per.powi(2) * (5.0 * z5 + 16.0 * z3 + 3.0 * Z) / 96.0
                + per.powi(3) * (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * Z) / 384.0
        }
    }
}

/// What the device wrote of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Figures {
    /// The frame's number.
    pub frame: u32,
    pixels: u32,
    candidates: u32,
    sums: Sums,
}

impl Figures {
    /// Reads the words of `audit/figures.comp`; `None` where their sum says that they are not all of one frame.
    pub fn of(words: &[u32; WORDS]) -> Option<Self> {
        let [frame, pixels, candidates, ..] = *words;
        let of = |place: usize| f64::from(f32::from_bits(words[place]));
        let sums = Sums { abs: of(3), squares: of(4), signed: of(5), worst: of(6) };
        let figures = Self { frame, pixels, candidates, sums };
        (words[WORDS - 1] == sum_of(&words[..WORDS - 1])).then_some(figures)
    }

    /// The frame's error; `None` where a sum is no number.
    pub fn error(&self) -> Option<MeasuredError> {
        let Sums { abs, squares, signed, worst } = self.sums;
        let error = MeasuredError::of(self.pixels.into(), self.candidates.into(), self.sums);
        [abs, squares, signed, worst].iter().all(|x| x.is_finite()).then_some(error)
    }
}

/// A sum over words in their order (Fowler, Noll and Vo 1991), as in `audit/figures.comp`.
fn sum_of(words: &[u32]) -> u32 {
    words.iter().fold(0x811c_9dc5, |sum, word| (sum ^ word).wrapping_mul(0x0100_0193))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(errors: &[f64]) -> MeasuredError {
        let sum = |f: fn(&f64) -> f64| errors.iter().map(f).sum::<f64>();
        let worst = errors.iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
        let sums =
            Sums { abs: sum(|e| e.abs()), squares: sum(|e| e * e), signed: sum(|e| *e), worst };
        MeasuredError::of(errors.len() as u64, 4 * errors.len() as u64, sums)
    }

    #[test]
    fn the_interval_is_students() {
        // The tables' quantiles of 97.5 %.
        for (degrees, table) in
            [(1, 12.706), (2, 4.303), (3, 3.182), (5, 2.571), (10, 2.228), (60, 2.000)]
        {
            assert!(
                (student(degrees) / table - 1.0).abs() < 0.01,
                "{degrees}: {}",
                student(degrees)
            );
        }
        let e = of(&[0.1, -0.3, 0.2, 0.0]);
        assert!((e.mean - 0.15).abs() < 1e-12 && (e.bias - 0.0).abs() < 1e-12, "{e:?}");
        assert_eq!((e.pixels, e.worst), (4, 0.3));
        // The spread of |e| is √(0.05 / 3), and that of the mean half of it.
        let half = student(3) * (0.05f64 / 3.0).sqrt() / 2.0;
        assert!((e.high - e.mean - half).abs() < 1e-12 && e.low == 0.0, "{e:?}");
        assert_eq!(
            [of(&[]).low, of(&[]).high, of(&[0.2]).low, of(&[0.2]).high],
            [0.0, 1.0, 0.0, 1.0]
        );
    }

    #[test]
    fn a_window_is_all_its_frames_pixels() {
        let frames: [&[f64]; 4] = [&[0.1, -0.3, 0.2], &[], &[0.05], &[0.0, 0.4, -0.1, 0.2]];
        let mut window = ErrorWindow::new();
        frames.iter().for_each(|errors| window.add(&of(errors)));
        let (one, all) = (window.error(), of(&frames.concat()));
        for (a, b) in [
            (one.mean, all.mean),
            (one.low, all.low),
            (one.high, all.high),
            (one.rms, all.rms),
            (one.bias, all.bias),
            (one.worst, all.worst),
        ] {
            assert!((a - b).abs() < 1e-12, "{one:?}, {all:?}");
        }
        assert_eq!((one.pixels, one.candidates, window.frames()), (8, 32, 4));
        window.clear();
        assert_eq!(window, ErrorWindow::new());
    }

    #[test]
    fn words_of_two_frames_are_noticed() {
        let mut words = [0u32; WORDS];
        (words[0], words[1], words[2]) = (7, 2, 9);
        for (place, value) in [(3, 0.5f32), (4, 0.125), (5, -0.25), (6, 0.3)] {
            words[place] = value.to_bits();
        }
        words[WORDS - 1] = sum_of(&words[..WORDS - 1]);
        let error = Figures::of(&words).unwrap().error().unwrap();
        assert_eq!((error.mean, error.bias, error.pixels, error.candidates), (0.25, -0.125, 2, 9));
        for place in 0..WORDS {
            let mut torn = words;
            torn[place] ^= 1;
            assert_eq!(Figures::of(&torn), None, "word {place}");
        }
        words[3] = f32::NAN.to_bits();
        words[WORDS - 1] = sum_of(&words[..WORDS - 1]);
        assert_eq!(Figures::of(&words).unwrap().error(), None);
    }
}
