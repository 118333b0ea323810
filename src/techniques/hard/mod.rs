//! A hard shadow map from the light's centre, 3×3 percentage-closer filtered.
//!
//! Comparisons come before the filter (Reeves, Salesin and Cook 1987). The filter is the mean of nine comparisons a
//! texel apart, each bilinear over four texels like a hardware comparison; shaders fetch and compare, because a
//! comparison sampler filters depth formats on some devices only. Together they read 4×4 texels, each compared with
//! the pixel's plane at the texel's own place.
//!
//! **Limits.** The light is a point: there is no penumbra but the filter's three texels.

pub mod settings;

pub use settings::Settings;

use super::common::one_map;
use super::room::{Maps, PassInputs, Room, Shapes, Shows, Takes};
use crate::graph::{Graph, Need, ResourceId};
use crate::shaders::module;

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes { shapes: Shapes::LINES, ..Takes::RECTANGLES }
    }

    fn shows(&self) -> Shows {
        Shows { penumbra: false, ..Shows::SOFT }
    }

    fn maps(&self) -> Maps {
        Maps::by_views(self.map, 256, self.views)
    }

    fn most_served(&self) -> u32 {
        self.views
    }

    fn takes_parallel(&self) -> bool {
        true
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        let side = inputs.occluders.side;
        let front = inputs.depth_layers(graph, self.maps().layers, side).front;
        declare(graph, front, Filter::Three, inputs.need, inputs);
        Some(front)
    }
}

/// The number of comparisons that are averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// 3×3 bilinear comparisons.
    Three,
    /// One bilinear comparison, for a shadow that stands for a soft one whose penumbra is narrower than a pixel.
    One,
}

/// Adds the pass that turns the map `front` into the visible fraction, where `need` says so.
pub(crate) fn declare(
    graph: &mut Graph,
    front: ResourceId,
    filter: Filter,
    need: &Need,
    inputs: &PassInputs,
) {
    let count = u32::from(filter == Filter::One);
    one_map(
        graph,
        "hard.visibility",
        module!("hard/hard.comp"),
        front,
        count,
        &[],
        &PassInputs { need, ..*inputs },
    );
}
