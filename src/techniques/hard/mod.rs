//! A hard shadow map from the light's centre, 3×3 percentage-closer filtered.
//!
//! Reeves, Salesin, Cook 1987: compare first, then filter. The filter is the mean of nine comparisons a
//! texel apart, each bilinear over four texels, as hardware does them; by fetches, because a comparison
//! sampler filters depth formats on some devices only. Together that is 4×4 texels, compared each with
//! the pixel's plane at its own place.
//!
//! **Limits.** The light is a point: no penumbra but the filter's three texels.

use crate::graph::{Graph, ResourceId};
use crate::shaders;
use crate::techniques::common::{Inputs, one_map};

/// How many comparisons along each axis are averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// 3×3 bilinear ones.
    Three,
    /// A bilinear one alone, for a shadow that stands for one whose penumbra no pixel shows.
    One,
}

/// Adds the row that turns the map `front` into `visibility`.
pub fn declare(
    graph: &mut Graph,
    front: ResourceId,
    visibility: ResourceId,
    filter: Filter,
    inputs: &Inputs,
) {
    let count = u32::from(filter == Filter::One);
    one_map(graph, "baseline.hard", shaders::HARD, (front, visibility), count, &[], inputs);
}
