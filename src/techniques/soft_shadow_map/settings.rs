//! The knobs of soft shadow maps, and the gather's tolerance.

use crate::Error;
use crate::knob::{Field, Knobs, MAP_OF_128, choice, choices};

/// Where visibility is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Receivers {
    /// At the G-buffer's pixels, self-shadowing included.
    #[default]
    Pixels,
    /// At the texels of a soft shadow map, which is projected onto the pixels; occluders do not receive from
    /// themselves.
    Map,
}

choices! { Receivers: "pixels" => Pixels, "map" => Map }

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

choices! { Sides: "one" => One, "bottom" => Bottom, "two" => Two, "mean" => Mean }

/// How micro-patches are added up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accumulate {
    /// Each receiver sums the texels; far ones by closed form.
    #[default]
    Gather,
    /// Penumbra rectangles blended into 32-bit floats.
    Blend,
    /// Penumbra rectangles blended into 16-bit floats, to show why not (appendix A).
    BlendFp16,
}

choices! { Accumulate: "gather" => Gather, "blend" => Blend, "blend-fp16" => BlendFp16 }

/// The knobs of soft shadow maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The maps' side, texels, 1 to 4096; 0, the default, for 128 where one view serves a light and 512 where several do.
    /// With 256 instead of 128 the median error of twelve scenes is 1.1 % instead of 1.3, in twice the time
    /// (`docs/accuracy.md`).
    pub map: u32,
    /// The most views of a light, 1 to 8; 6 by default.
    pub views: u32,
    /// The soft shadow map's side, texels, 1 to 4096; 256 by default. Unused at the pixels.
    pub receiver_map: u32,
    /// Where visibility is computed.
    pub receivers: Receivers,
    /// Which faces become micro-patches.
    pub sides: Sides,
    /// How micro-patches are added up.
    pub accumulate: Accumulate,
    /// The most that the gather's series may add to the error of the visible fraction, 0 to 0.1;
    /// 1e-4 by default. 0 uses the series only where it is exact. At the pixels the patches' slopes add some times as much.
    pub tolerance: f32,
    /// Whether tiles of pixels that no occluder can shadow are skipped, at the pixels; on by default.
    pub classify: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            map: 0,
            receiver_map: 256,
            views: 6,
            receivers: Receivers::default(),
            sides: Sides::default(),
            accumulate: Accumulate::default(),
            tolerance: 1e-4,
            classify: true,
        }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "soft-shadow-map";
    const FIELDS: &'static [Field<Self>] = &[
        Field::map_of_views(MAP_OF_128, |s| s.map, |s, map| s.map = map),
        Field::views(|s| s.views, |s, views| s.views = views),
        Field::whole(
            "receiver_map",
            "texels",
            [1, 4096],
            "side of the soft shadow map, with receivers=map",
            |s| s.receiver_map,
            |s, side| s.receiver_map = side,
        ),
        choice!(
            "receivers",
            Receivers,
            "where visibility is computed: at the G-buffer's pixels, with self-shadowing, or on a soft shadow map that \
             is projected onto them, without",
            receivers
        ),
        choice!(
            "sides",
            Sides,
            "which faces of the occluders shadow: one, the front faces; bottom, front texels at the distance of the \
             back faces; two, the darker of both; mean, the average of both, which is the nearest to the truth \
             (blending takes the darker)",
            sides
        ),
        choice!(
            "accumulate",
            Accumulate,
            "how micro-patches are added up; the blends need receivers=map, and blend-fp16 is for studying what goes \
             wrong with 16-bit floats",
            accumulate
        ),
        Field::real(
            "tolerance",
            "visible fraction",
            [0.0, 0.1],
            "most that the gather's shortcut for far texels may add to the error, and some times as much by the slopes of \
             patches at the pixels; 0 uses the shortcut only where it is exact",
            |s| s.tolerance,
            |s, tolerance| s.tolerance = tolerance,
        ),
        Field::classify(|s| s.classify, |s, on| s.classify = on),
    ];
}

impl Settings {
    /// Checks the knobs that must agree with each other.
    pub(super) fn check_together(&self) -> Result<(), Error> {
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
        // A spread of 0 holds only texels at one distance, for which the series is exact.
        assert_eq!(spread_of(0.0), 0.0);
    }
}
