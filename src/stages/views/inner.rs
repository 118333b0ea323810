//! How near to the light occluders come before the receivers of a view, for views from the light's centre.
//!
//! A map from the centre shows what lies near the light far aside, even where it lies straight between the light and a
//! receiver. So a view from there has all that a receiver's rays meet only where the nearest of it lies in the view's
//! window: which the map of the next wider view tells, since the finer view's region lies within that one's.

use crate::graph::{Access, Graph, Need, Pass, Push, ResourceId, Use};
use crate::shaders::module;
use crate::stages::depth_layers::MapView;
use crate::stages::nearest::nodes_a_row;
use crate::stages::views::Served;
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
    /// Texel coordinates of the middle of the finer view's window.
    pub middle: [f32; 2],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// Half the finer view's window in u and in v.
    pub tangents: [f32; 2],
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
    /// The finer view and the map's own, where there is such a view.
    pub views: Option<[&'a Served; 2]>,
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

/// What the finer view's region follows from.
struct Bounds {
    /// How far aside of the own view's window the finer one's middle is, tangents.
    aside: [f64; 2],
    /// Half the finer view's window in u and in v.
    tangents: [f64; 2],
    /// The nearest occluder before the own view's receivers that counts, 1/m.
    most: f64,
    /// How much nearer it may be than that before the finer view's, 1/m.
    slack: f64,
}

impl Bounds {
    /// The bounds of a finer view and the map's own. The finer view's rim, at slopes of `tangents − half · nearest` around
    /// `aside`, is nowhere beyond the own view's.
    fn of(views: Option<[&Served; 2]>, half: [f64; 2]) -> Self {
        let Some([finer, own]) = views else {
            return Self { aside: [0.0; 2], tangents: [0.0; 2], most: 0.0, slack: 0.0 };
        };
        let [tangents, wide] = [finer, own].map(|view| view.region.tangents());
        let aside = [0, 1].map(|i| finer.aside[i] - own.aside[i]);
        let (mut most, mut slack) = (0.0f64, f64::INFINITY);
        for i in 0..2 {
            let half = half[i].max(1e-30);
            let counts = if wide[i] >= WIDE { 0.5 * wide[i] / half } else { f64::INFINITY };
            most = most.max(counts);
            slack = slack.min((wide[i] - aside[i].abs() - tangents[i]) / half);
        }
        let most = most.min(f64::from(f32::MAX));
        Self { aside, tangents, most, slack }
    }
}

/// Declares the buffer of the nodes of a map of `side` texels.
pub(crate) fn declare(graph: &mut Graph, side: u32) -> ResourceId {
    let row = nodes_a_row(side);
    graph.buffer("views.nodes", 4 * u64::from(row * row))
}

impl Inner<'_> {
    /// Adds the passes that find the nearest occluder before the receivers of the finer view from the map `front`.
    pub fn find(&self, graph: &mut Graph, front: ResourceId) {
        let map = self.map.side;
        let Bounds { aside, tangents, most, slack } = Bounds::of(self.views, self.half);
        let [first, per] = [self.map.first(), self.map.texels_per_uv()];
        let row = nodes_a_row(map);
        let nodes = self.nodes;
        graph.push(Pass::compute(
            "views.nodes",
            module!("views/nodes.comp"),
            grid([row; 2]),
            Push::new(&Nodes {
                texels_per_uv: per.map(|x| x as f32),
                middle: [0, 1].map(|i| (first[i] + aside[i] * per[i]) as f32),
                half_light: self.half.map(|x| x as f32),
                tangents: tangents.map(|x| x as f32),
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
