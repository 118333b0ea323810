//! Soft shadow mapping by back-projection (Guennebaud, Barthe, Paulin 2006).
//!
//! ```text
//!   light      ├──┤├──┤    ├─┤          each texel in front of the pixel, projected back onto the light
//!               \  \ \  \    |
//!   map          ├──┼──┤ ╵   |          a gap between neighbours at different distances: the nearer
//!                 \ \ \   ├──┤          texel reaches over it, to the left and up (section 4)
//!                  \ | |  /
//!   pixel             ●
//! ```
//! The technique is the sum over texels of the soft shadow map ([`crate::techniques::soft_shadow_map`]), published in
//! the same year, in screen space and texel by texel: each pixel visits the window of the map in which an occluder
//! could hide light from it. A hierarchy of the least and the largest distance (their hierarchical shadow map) shrinks
//! that window to the size that its nearest occluder needs, and finds pixels that are lit or in umbra without a visit.
//!
//! Where we depart: the bias is that of `techniques/common`, and the part of the light that the pixel's own surface
//! hides is a closed form. Their umbra is where every texel of the window is nearer than the pixel; here those texels
//! must also lie above the pixel's plane, which the pixel's own slope does not.
//!
//! **Limits.** Gaps are filled, overlaps are not removed: where a near edge passes before something further, both
//! count, and shadows come out too dark: 2 % in the mean on spheres and the bunny. A pixel in a wide penumbra fetches
//! as many texels as its window has, so the time grows with the square of the light's and of the map's side. Mesa's
//! CPU driver stops a shader after 65,535 turns of its loops; eight texels a turn are enough for a window of 700²
//! texels.

pub mod settings;
pub mod twin;

pub use settings::Settings;

use super::common::{FinestLevel, one_map};
use super::room::{Maps, PassInputs, Room, Shows, Takes};
use crate::graph::{Access, Graph, Pass, Push, ResourceId, Use};
use crate::shaders::module;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes::RECTANGLES
    }

    fn shows(&self) -> Shows {
        // The gaps between its texels are filled, and with them those that let a part of the light through.
        Shows { translucent: false, ..Shows::SOFT }
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
        declare(graph, front, inputs);
        Some(front)
    }
}

/// The push constants of `next_level.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct NextLevel {
    /// The map's side in texels.
    pub map: i32,
    /// The level to make, 2 and up.
    pub level: i32,
}

/// The number of nodes along a side of a level of a map.
fn level_side(map: u32, level: u32) -> u32 {
    map.div_ceil(1 << level)
}

/// The number of nodes in the levels before a level.
fn level_start(map: u32, level: u32) -> u32 {
    (1..level).map(|k| level_side(map, k).pow(2)).sum()
}

/// The level that has a single node.
fn top(map: u32) -> u32 {
    map.next_power_of_two().trailing_zeros()
}

/// Adds the passes that turn the map `front` into the visible fraction.
fn declare(graph: &mut Graph, front: ResourceId, inputs: &PassInputs) {
    let map = inputs.occluders.side;
    let nodes = u64::from(level_start(map, top(map) + 1));
    let levels = graph.buffer("back_projection.levels", nodes * size_of::<[f32; 2]>() as u64);
    let grid = |level| {
        let groups = level_side(map, level).div_ceil(8);
        [groups, groups, 1]
    };
    graph.push(Pass::compute(
        "back_projection.finest_level",
        module!("back_projection/finest_level.comp"),
        grid(1),
        Push::new(&FinestLevel { map: map as i32, inv_near: inputs.occluders.top() as f32 }),
        smallvec![
            Use::bound(0, front, Access::SampledCompute),
            Use::bound(1, levels, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    for level in 2..=top(map) {
        graph.push(Pass::compute(
            "back_projection.next_level",
            module!("back_projection/next_level.comp"),
            grid(level),
            Push::new(&NextLevel { map: map as i32, level: level as i32 }),
            smallvec![Use::bound(0, levels, Access::BufferUpdate)],
            inputs.need,
        ));
    }
    let more = [Use::bound(4, levels, Access::BufferReadCompute)];
    let name = "back_projection.visibility";
    one_map(
        graph,
        name,
        module!("back_projection/back_projection.comp"),
        front,
        top(map),
        &more,
        inputs,
    );
}
