//! How near to the light occluders come before the receivers of a view, for views from the light's centre.
//!
//! A map from the centre shows what lies near the light far aside, even where it lies straight between the light and a
//! receiver. So a view from there has all that a receiver's rays meet only where the nearest of it lies in the view's
//! window: which the map of the next wider view tells, since the finer view's region lies within that one's.

use crate::graph::{Access, Graph, Need, Pass, Push, ResourceId, Use};
use crate::shaders::module;
use crate::stages::depth_layers::MapView;
use crate::stages::nearest::nodes_a_row;
use crate::stages::visibility::{self, grid};
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The tangents from which on a view keeps half of its window at least (`light_space.glsl`).
const WIDE: f64 = 5.0;

/// The push constants of `views/nodes.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Nodes {
    /// Map texels a unit of u and v.
    pub texels_per_uv: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// The largest u and v of the finer view's window.
    pub tangent: f32,
    /// The w of the map's near plane, 1/m.
    pub inv_near: f32,
    /// The map's side in texels.
    pub map: i32,
}

/// The push constants of `views/nearest.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Nearest {
    /// The map's side in texels.
    pub map: i32,
    /// Where the number is among the constants, in floats.
    pub at: i32,
    /// Where that of the map's own view is.
    pub own: i32,
    /// The largest of the own view that counts, 1/m.
    pub most: f32,
    /// How much nearer than the finer view's the own view's may be, 1/m.
    pub slack: f32,
}

/// The next finer view than the one that a map is drawn for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inner<'a> {
    /// The finer view's number.
    pub view: u32,
    /// The largest u and v of the finer view's window, and of the map's own view.
    pub tangents: [f64; 2],
    /// The view of the map.
    pub map: &'a MapView,
    /// Half the light's width and height, m.
    pub half: [f64; 2],
    /// The buffer that [`declare`] returns.
    pub nodes: ResourceId,
    /// The buffer of the constants of the passes over the pixels.
    pub constants: ResourceId,
    /// Whether there is such a view.
    pub need: Need,
}

/// Declares the buffer of the nodes of a map of `side` texels.
pub(crate) fn declare(graph: &mut Graph, side: u32) -> ResourceId {
    let row = nodes_a_row(side);
    graph.buffer("views.nodes", 4 * u64::from(row * row))
}

impl Inner<'_> {
    /// Adds the passes that find the nearest occluder before the receivers of the finer view from the map `front`.
    pub fn find(&self, graph: &mut Graph, front: ResourceId) {
        // The finer view's rim, at a slope of `finer − half · nearest`, is nowhere beyond the own view's.
        let [finer, own] = self.tangents;
        let half = self.half[0].max(self.half[1]).max(1e-30);
        let most = if own >= WIDE { 0.5 * own / half } else { f64::from(f32::MAX) };
        let slack = (own - finer) / half;
        let map = self.map.side;
        let row = nodes_a_row(map);
        let nodes = self.nodes;
        graph.push(Pass::compute(
            "views.nodes",
            module!("views/nodes.comp"),
            grid([row; 2]),
            Push::new(&Nodes {
                texels_per_uv: self.map.texels_per_uv().map(|x| x as f32),
                first: self.map.first().map(|x| x as f32),
                half_light: self.half.map(|x| x as f32),
                tangent: self.tangents[0] as f32,
                inv_near: self.map.top() as f32,
                map: map as i32,
            }),
            smallvec![
                Use::bound(0, front, Access::SampledCompute),
                Use::bound(1, nodes, Access::BufferWriteCompute),
            ],
            &self.need,
        ));
        graph.push(Pass::compute(
            "views.nearest",
            module!("views/nearest.comp"),
            [1, 1, 1],
            Push::new(&Nearest {
                map: map as i32,
                at: visibility::nearest_at(self.view) as i32,
                own: visibility::nearest_at(self.view + 1) as i32,
                most: most as f32,
                slack: slack as f32,
            }),
            smallvec![
                Use::bound(0, nodes, Access::BufferReadCompute),
                Use::bound(1, self.constants, Access::BufferUpdate),
            ],
            &self.need,
        ));
    }
}
