//! Percentage-closer soft shadows (Fernando 2005).
//!
//! ```text
//!   light     ├────── L ──────┤          1. the light through the near plane: which part of the map
//!              \      |      /              could hold blockers
//!   near plane  \  ├──┼──┤  /            2. their mean distance d_b
//!                \    |    /             3. the light through d_b: the penumbra's width in the map,
//!   blockers      \ ├─┼─┤ / d_b             L (1/d_b − 1/d_r) in tangents, and the share of the
//!                  \  |  /                  comparisons within it that pass
//!   receiver        \ ● / d_r
//! ```
//! All in metres of the rectangle as it is: width and height have a reach each. The taps are a disc of
//! points that lie far apart; each pixel turns it by an angle of its own, and equal areas of the disc go
//! to equal areas of the light's rectangle (Shirley and Chiu 1997), so that the mean over the taps is the
//! mean over the light. Each filter tap is bilinear over four comparisons, so that no filter is narrower
//! than a texel.
//!
//! Where we depart: the disc is a spiral (Vogel 1979) where others use a table of Poisson-disc points. It
//! needs no table, has as many points as are asked for, and as many of them in each ring as its area
//! takes, which a short prefix of a Poisson disc has not. Fernando leaves the bias to the user; here it is
//! the receiver-plane bias of this room. What the pixel's own surface hides of the light is a closed form,
//! and the taps that stand for the rest of the light say how much of that is hidden.
//!
//! **Limits.** One distance stands for all blockers, so shadows of things behind each other are wrong
//! where they overlap; blockers beside the light's view of the pixel count in the mean. The error does
//! not vanish with more taps. Pixels are turned apart, so that few taps show as grain.

use super::{Inputs, one_map};
use crate::graph::{Graph, ResourceId};
use crate::shaders;

/// Adds the row that turns the map `front` into `visibility`, with `taps` to search and as many to
/// filter.
pub fn declare(
    graph: &mut Graph,
    front: ResourceId,
    visibility: ResourceId,
    taps: u32,
    inputs: &Inputs,
) {
    one_map(graph, "baseline.pcss", shaders::PCSS, (front, visibility), taps, &[], inputs);
}
