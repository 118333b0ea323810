//! The knobs of soft shadow maps, and the gather's tolerance.

use crate::Error;

/// Where visibility is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Receivers {
    /// At the G-buffer's pixels, self-shadowing included.
    #[default]
    Pixels,
    /// On a soft shadow map, projected onto the pixels; occluders do not receive from themselves.
    Map,
}

impl Receivers {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] = &[("pixels", Self::Pixels), ("map", Self::Map)];
}

/// Which faces of the occluders become micro-patches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// The nearest faces.
    One,
    /// The nearest faces' texels at the distance of the furthest back faces (Fig. 11b).
    Bottom,
    /// The larger shadow of the nearest faces and of the furthest back faces (section 3.5).
    Two,
    /// The mean of the shadow of the nearest faces and of that of the furthest back faces, where each
    /// back face that does not lie before the receiver is stood in for by the front face before it.
    /// Gaps between the patches of the one are overlaps of the other, and cancel (see the module).
    /// Blending, which cannot choose by receiver, takes the larger shadow instead.
    #[default]
    Mean,
}

impl Sides {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] =
        &[("one", Self::One), ("bottom", Self::Bottom), ("two", Self::Two), ("mean", Self::Mean)];
}

/// How micro-patches are added up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accumulate {
    /// Each receiver visits the texels; far ones by closed form.
    #[default]
    Gather,
    /// Penumbra rectangles blended into 32-bit floats.
    Blend,
    /// Penumbra rectangles blended into 16-bit floats, to show why not (appendix A).
    BlendFp16,
}

impl Accumulate {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] =
        &[("gather", Self::Gather), ("blend", Self::Blend), ("blend-fp16", Self::BlendFp16)];
}

/// Every knob of soft shadow maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The soft shadow map's side, texels, 1 to 4096; 256 by default. Unused at the pixels.
    pub receiver_map: u32,
    /// Where visibility is computed.
    pub receivers: Receivers,
    /// Which faces become micro-patches.
    pub sides: Sides,
    /// How they are added up.
    pub accumulate: Accumulate,
    /// The most that the gather's series may add to the error of the visible fraction, 0 to 0.1;
    /// 1e-4 by default. 0 uses it only where it is exact.
    pub tolerance: f32,
    /// Whether tiles of pixels that no occluder can be felt from are left out of the gather, at the pixels.
    pub classify: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            receiver_map: 256,
            receivers: Receivers::default(),
            sides: Sides::default(),
            accumulate: Accumulate::default(),
            tolerance: 1e-4,
            classify: true,
        }
    }
}

impl Settings {
    /// Whether the knob with this key is within its range; keys of other techniques pass.
    pub(crate) fn in_range(&self, key: &str) -> bool {
        match key {
            "receiver_map" => (1..=4096).contains(&self.receiver_map),
            "tolerance" => (0.0..=0.1).contains(&self.tolerance),
            _ => true,
        }
    }

    /// Checks the knobs that depend on each other.
    pub(crate) fn check_agreement(&self) -> Result<(), Error> {
        if self.receivers == Receivers::Pixels && self.accumulate != Accumulate::Gather {
            return Err(Error::Setting {
                key: "accumulate".into(),
                problem: "blending adds into a soft shadow map; set receivers=map with it".into(),
            });
        }
        Ok(())
    }
}

/// The largest q with g(q)/(1 − g(q)) ≤ `tolerance`, g(q) = (5q⁴ − 4q⁵)(1 + q)²/(1 − q)² (see the
/// module's derivation): how far a node's texels may spread, as a share of the distance in w to the receiver.
pub fn spread_of(tolerance: f32) -> f32 {
    let wanted = f64::from(tolerance) / (1.0 + f64::from(tolerance));
    let rest = |q: f64| (5.0 - 4.0 * q) * q.powi(4) * ((1.0 + q) / (1.0 - q)).powi(2);
    // g grows on [0, 1); bisect to more digits than a float has.
    let (mut low, mut high) = (0.0, 0.9);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if rest(middle) <= wanted { low = middle } else { high = middle }
    }
    low as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_keeps_its_promise_at_the_edge_of_its_range() {
        for tolerance in [1e-6_f32, 1e-5, 1e-4, 1e-3, 1e-2, 0.1] {
            let q = f64::from(spread_of(tolerance));
            let mut tight: f64 = 0.0;
            for d in [-q, q] {
                let exact = 1.0 / ((1.0 + d) * (1.0 + d));
                let series = 1.0 - 2.0 * d + 3.0 * d * d - 4.0 * d * d * d;
                let error = (exact - series).abs();
                assert!(error <= f64::from(tolerance) * 1.0001, "{tolerance}: {error}");
                tight = tight.max(error);
            }
            assert!(tight > 0.5 * f64::from(tolerance), "{tolerance}: the range could be wider");
        }
        // Nothing is within a spread of 0 but texels at one distance, for which the series is exact.
        assert_eq!(spread_of(0.0), 0.0);
    }
}
