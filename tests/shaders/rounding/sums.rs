//! Sums as they are rounded, on the processor: in the order and with the steps that the device has.

use antumbra::techniques::common::twin::patch_occlusion;

/// Steps a unit that blended contributions are rounded to, as `patch.frag` has them.
const STEPS: f32 = 16_777_216.0;

/// Texels a side of a block and of a superblock, as in `node.glsl`.
const BLOCK: usize = 8;
const SUPERBLOCK: usize = 32;

/// One receiver before an occluder map.
pub struct Receiver<'a> {
    pub w: &'a [f32],
    pub side: usize,
    pub scale: [f32; 2],
    pub t: [f32; 2],
    pub w_r: f32,
}

impl Receiver<'_> {
    /// What each texel hides, as `patch.frag` has it before it rounds, and the threshold that it rounds by; in
    /// the order of `patch_emit.comp`.
    pub fn patches(&self) -> impl Iterator<Item = (f32, f32)> {
        let row = self.side.div_ceil(SUPERBLOCK) * SUPERBLOCK / BLOCK;
        let texels = (0..row * row).flat_map(move |block| {
            (0..BLOCK * BLOCK)
                .map(move |n| [block % row * BLOCK + n % BLOCK, block / row * BLOCK + n / BLOCK])
        });
        let there = texels.filter(|[x, y]| *x < self.side && *y < self.side);
        there.filter_map(|[x, y]| {
            let w = self.w[y * self.side + x];
            let lo = [x as f32, y as f32];
            let hi = lo.map(|a| a + 1.0);
            let hidden = || patch_occlusion(lo, hi, w, self.t, self.w_r, self.scale);
            (w > 0.0).then(|| (hidden(), threshold(x, y)))
        })
    }

    /// The sum that blending into 32 bits arrives at.
    pub fn blended(&self) -> f32 {
        self.patches().fold(0.0, |sum, (hidden, threshold)| sum + rounded(hidden, threshold))
    }
}

/// Where `patch.vert` rounds a texel's contribution up, 0 to 1.
pub fn threshold(x: usize, y: usize) -> f32 {
    let spread =
        (x as u32).wrapping_mul(3_242_174_889).wrapping_add((y as u32).wrapping_mul(2_447_445_414));
    (spread >> 16) as f32 / 65536.0
}

/// The partial quotients of the step of that sequence along a row, up to denominators of `most`.
pub fn quotients(most: u32) -> Vec<u64> {
    let (mut above, mut below) = (1_u64 << 32, 3_242_174_889_u64);
    let (mut before, mut denominator) = (0, 1);
    let mut found = Vec::new();
    while denominator <= u64::from(most) && below > 0 {
        found.push(above / below);
        (before, denominator) = (denominator, above / below * denominator + before);
        (above, below) = (below, above % below);
    }
    found
}

/// A contribution as it is blended.
pub fn rounded(hidden: f32, threshold: f32) -> f32 {
    (hidden * STEPS + threshold).floor() / STEPS
}

/// How a device rounds what it blends into 16 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    Truncates,
    ToNearest,
}

/// To 11 significant bits, of numbers from 2⁻¹⁴ to 1; smaller ones to multiples of 2⁻²⁴, the least of FP16.
pub fn half(x: f32, rounding: Rounding) -> f32 {
    let exponent = ((x.to_bits() >> 23) as i32 - 127).max(-14);
    let steps = 2.0_f32.powi(10 - exponent);
    // Exact: a power of two more, and fewer bits than a float has.
    let scaled = x * steps;
    match rounding {
        Rounding::Truncates => scaled.floor() / steps,
        Rounding::ToNearest => scaled.round_ties_even() / steps,
    }
}

/// Where a sum of equal terms stops in 16 bits, by eq. 4's reasoning: at 2^e, from where on a step of
/// 2^(e − 10) is more than the term, or half of it no less than the term.
pub fn stall(term: f32, rounding: Rounding) -> f32 {
    let passes = |step: f32| match rounding {
        Rounding::Truncates => term >= step,
        Rounding::ToNearest => term > 0.5 * step,
    };
    let first = (-14..=0).find(|&e| !passes(2.0_f32.powi(e - 10)));
    first.map_or(f32::INFINITY, |e| 2.0_f32.powi(e))
}
