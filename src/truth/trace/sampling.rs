//! The number of rays, and their random numbers.

use crate::Error;

/// The most rays a receiver may ask for.
const MAX_RAYS: u32 = 1 << 20;

/// The number of rays for each receiver, and their random numbers.
///
/// The light is cut into n×n equal strata with one uniformly random point in each (jittered
/// sampling, Cook 1986), twice over with independent numbers: the two grids' difference estimates the
/// noise without bias, which one grid cannot. Only strata that a shadow's edge crosses have any
/// noise, each at most ¼ in variance, and there are of the order n of them: n for one straight
/// edge along the strata, at most 4n for any convex outline. So the standard error is at most
/// n^(−3/2) / √8 and n^(−3/2) / √2 for those, and falls as rays^(−3/4). Other shapes are cut by a map of the square that
/// keeps areas, which bends edges: of the same order. A line is cut into n² parts, of which each end of a shadow crosses
/// one: n^(−2) / √8 for one end, √k times that for k. A point is one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    side: u32,
    grids: u32,
    seed: u64,
    position_error: f64,
}

impl Sampling {
    /// Sampling with at least `rays` rays for each receiver, 2..=2²⁰: two grids of the fewest strata that reach it.
    /// 256 gives 288 (two of 12×12), 512 gives 512 (two of 16×16). The same seed gives the same
    /// bits.
    ///
    /// # Errors
    /// [`Error::Setting`] for rays outside the range.
    pub fn new(rays: u32, seed: u64) -> Result<Self, Error> {
        if !(2..=MAX_RAYS).contains(&rays) {
            return Err(Error::Setting {
                key: "rays".into(),
                problem: format!("it must be from 2 to {MAX_RAYS} (it is {rays})"),
            });
        }
        let mut side = f64::from(rays.div_ceil(2)).sqrt() as u32;
        side += u32::from(2 * side * side < rays);
        Ok(Self { side, grids: 2, seed, position_error: 0.0 })
    }

    /// Sampling with one grid of `side` × `side` strata for each receiver, 1..=1024: 1, 4, 16, 64 rays are what a
    /// renderer would send. Its noise cannot be estimated ([`super::Estimate::half_difference`] is NaN).
    ///
    /// # Errors
    /// [`Error::Setting`] for a side outside the range.
    pub fn one_grid(side: u32, seed: u64) -> Result<Self, Error> {
        let most = MAX_RAYS.isqrt();
        if !(1..=most).contains(&side) {
            return Err(Error::Setting {
                key: "side".into(),
                problem: format!("it must be from 1 to {most} (it is {side})"),
            });
        }
        Ok(Self { side, grids: 1, seed, position_error: 0.0 })
    }

    /// Says how far, in metres, the receivers may lie off their surfaces beyond what f32
    /// arithmetic on scene-sized coordinates explains; not negative, 0 by default.
    ///
    /// World positions read from an f32 image need it: half a unit in the last place of the
    /// largest coordinate, 1 mm for a scene 20 km from the world's origin.
    ///
    /// # Errors
    /// [`Error::Setting`] for an error that is negative or not finite.
    pub fn with_position_error(self, metres: f64) -> Result<Self, Error> {
        check_position_error(metres)?;
        Ok(Self { position_error: metres, ..self })
    }

    /// Rays a receiver, all grids together.
    pub fn rays(&self) -> u64 {
        u64::from(self.grids) * u64::from(self.side).pow(2)
    }

    pub(super) fn grids(&self) -> u32 {
        self.grids
    }

    pub(super) fn side(&self) -> u32 {
        self.side
    }

    pub(super) fn seed(&self) -> u64 {
        self.seed
    }

    pub(super) fn position_error(&self) -> f64 {
        self.position_error
    }
}

/// Refuses a position error that is negative or not finite.
pub(in crate::truth) fn check_position_error(metres: f64) -> Result<(), Error> {
    if metres >= 0.0 && metres.is_finite() {
        return Ok(());
    }
    Err(Error::Setting {
        key: "position_error".into(),
        problem: format!("it must be finite and at least 0 m (it is {metres})"),
    })
}

/// Random numbers by SplitMix64 (Steele, Lea and Flood 2014).
pub(super) struct Stream(u64);

/// The odd integer nearest to 2⁶⁴ over the golden ratio.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

impl Stream {
    /// Streams of one seed start at hashed, hence unrelated, places of the same long period.
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        Self(mix(mix(seed.wrapping_add(GAMMA)).wrapping_add(stream.wrapping_mul(GAMMA))))
    }

    /// Two uniform numbers in [0, 1), of 32 bits each.
    pub(super) fn next_pair(&mut self) -> [f64; 2] {
        self.0 = self.0.wrapping_add(GAMMA);
        let bits = mix(self.0);
        [bits as u32, (bits >> 32) as u32].map(|half| f64::from(half) / 4_294_967_296.0)
    }
}

fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
