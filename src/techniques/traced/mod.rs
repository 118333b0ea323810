//! The visible fraction from the blocking triangles themselves.

pub mod passes;
pub mod settings;
mod weights;

pub use settings::Settings;

use super::room::{HostDraws, Maps, PassInputs, Room, Shapes, Shows, Takes};
use crate::graph::{Graph, ResourceId};

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

    fn reads_triangles(&self) -> bool {
        true
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        passes::declare(graph, self, &inputs.hierarchy?, inputs);
        None
    }
}
