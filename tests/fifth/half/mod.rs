//! A sketch of a technique: the visible fraction is ½ at every pixel.

pub mod settings;

pub use settings::Settings;

use super::room::{Maps, PassInputs, Room, Shows, Takes};
use crate::graph::{Access, Graph, Pass, Push, ResourceId, Use};
use crate::shaders::module;
use crate::stages::visibility::grid;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes::RECTANGLES
    }

    fn shows(&self) -> Shows {
        Shows::SOFT
    }

    fn maps(&self) -> Maps {
        Maps::own_views(self.map)
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        let extent = inputs.gbuffer.extent;
        graph.push(Pass::compute(
            "half.visibility",
            module!("half/half.comp"),
            grid(extent),
            Push::new(&Half { extent: extent.map(|e| e as i32) }),
            smallvec![Use::bound(0, inputs.visibility, Access::ImageWrite)],
            inputs.need,
        ));
        None
    }
}

/// What `half.comp` is given.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Half {
    /// Width and height of the visibility image.
    pub extent: [i32; 2],
}
