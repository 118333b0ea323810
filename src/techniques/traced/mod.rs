//! The visible fraction from the blocking triangles themselves.

pub mod constants;
pub mod passes;
pub mod settings;
mod weights;

pub use settings::Settings;

use super::room::{HostDraws, Maps, PassInputs, Room, Shapes, Shows, Takes};
use crate::graph::{Graph, ResourceId};
use crate::stages::hierarchy;

/// The side of the maps that the technique does not have; a placeholder's.
const NO_MAP: u32 = 16;

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes {
            host_draws: HostDraws::Receivers(
                "has no triangles for the hierarchy that traced reads",
            ),
            shapes: Shapes::ALL,
            lent_maps: Err("works with triangles, and does not read depth images of occluders"),
            ..Takes::RECTANGLES
        }
    }

    fn shows(&self) -> Shows {
        Shows { back_side: true, fusion: true, ..Shows::SOFT }
    }

    fn maps(&self) -> Maps {
        Maps::own_views(NO_MAP)
    }

    fn pixel_list(&self, extent: [u32; 2]) -> Option<(u64, &'static str)> {
        Some((passes::slot_bytes(extent), "give it fewer than 8.3 million pixels"))
    }

    fn reads_triangles(&self) -> bool {
        true
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        let (sizes, _) = inputs.tree;
        let tree = hierarchy::declare(graph, *sizes, inputs.need);
        let constants = constants::declare(graph, self, inputs);
        passes::declare(graph, self, &tree, constants, inputs);
        None
    }
}
