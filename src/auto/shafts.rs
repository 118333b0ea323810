//! The time that pixels take where triangles are tested in shafts, beside the times that the table has.

use super::Features;

/// The number of triangles in a shaft whose tests take as long as all else that its pixels take.
const SHAFT: f64 = 32.0;

/// The most triangles in a shaft, by the technique's defaults: those of a denser one are not tested one by one. Its pixels
/// send rays, which take about as long as the tests of so many (`traced`'s knob `leaves`, of two triangles each).
const DENSE: f64 = 4096.0;

/// The time that pixels take where triangles are tested in shafts, over that of pixels with empty shafts: 1 and more.
///
/// A light of side L, blocked at a distance d_o and received at d_r, has a penumbra of P = L (d_r / d_o − 1). The shaft
/// from a receiver to the light is L (1 − d_o / d_r) = L P / (L + P) wide where the occluder is. A line of one metre
/// crosses e edges of the densest occluder, 4 to a triangle's width ([`crate::effects::Situation::edges`]), so that a
/// shaft of width w holds (e w / 4)² triangles. The time grows with the root of their number: a shaft's pixels stop when
/// the light is hidden, and shafts beside the occluders hold few. `docs/planner.md` says within what factor this
/// foretells times.
pub(super) fn shaft_work(features: &Features) -> f64 {
    // All lengths over the occluders' size.
    let light = (-features.size).exp2();
    let penumbra = features.penumbra.exp2() - 1.0;
    let width = light * penumbra / (light + penumbra);
    let triangles = (0.25 * (features.edges.exp2() - 1.0) * width).powi(2);
    1.0 + (triangles.min(DENSE) / SHAFT).sqrt()
}
