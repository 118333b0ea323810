//! Depth layers: what the light sees.
//!
//! ```text
//!        light's centre
//!            / | \            front      occluders' nearest faces
//!           /  |  \           back       occluders' furthest back faces
//!          /  ___  \          receivers  receivers' nearest faces
//!         /  /   \  \
//!        /   \___/   \        stored: near · w, with w = 1/d and d the distance along
//!       /_____________\       the light's normal; 0 where there is nothing
//! ```
//! The pinhole is the light's centre and the map is parallel to the light (Atty 2006 section 3.2).
//! The projection is reversed with an infinite far plane, so w comes back by one multiplication and
//! keeps its relative precision at every distance.
//!
//! Where we depart: the front layer takes faces of either orientation, because the nearest face of a
//! closed solid is a front face anyway, and an open sheet must cast its shadow whichever way it is
//! turned. The map's window is fitted to the occluders in u and v apart, so it need not have the
//! light's aspect.

mod view;

pub use view::{Bounds, MapView, fit_occluders, fit_receivers, is_aside};

use crate::graph::{
    Access, Draw, Graph, MeshList, Need, Owner, Pass, Push, ResourceId, Target, Use, Work,
};
use crate::shaders;
use ash::vk;

/// The layers' format; the stored value is near · w.
pub const FORMAT: vk::Format = vk::Format::D32_SFLOAT;

/// The matrix that a mesh draw pushes, column by column.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct DepthPush {
    /// Mesh space to the map's clip space.
    pub clip_from_mesh: [f32; 16],
}

/// Which layers a technique reads, and at which size.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// The occluder maps' side in texels.
    pub map: u32,
    /// Whether the back layer is read.
    pub back: bool,
    /// The receiver map's side in texels, where one is read.
    pub receiver_map: Option<u32>,
}

/// The layers as resources.
#[derive(Clone, Copy, Debug)]
pub struct DepthLayers {
    /// Occluders' nearest faces; 0 where there are none.
    pub front: ResourceId,
    /// Occluders' furthest back faces; 1 where there are none.
    pub back: Option<ResourceId>,
    /// Receivers' nearest faces; 0 where there are none.
    pub receivers: Option<ResourceId>,
}

/// Adds the layers and the passes that draw them; `need` says whether anything can be shadowed.
pub fn declare(graph: &mut Graph, wanted: Wanted, need: &Need) -> DepthLayers {
    let mut layer = |name, pass, side, list, cull, clear, compare| {
        let image = graph.image(name, FORMAT, [side, side], Owner::Transient);
        graph.push(Pass {
            name: pass,
            uses: vec![Use::fixed(image, Access::DepthTarget)],
            push: Push::NONE,
            work: Work::Raster {
                vertex: shaders::DEPTH_VERT,
                fragment: None,
                cull,
                target: Target::Depth { clear, compare },
                draw: Draw::Meshes(list),
            },
            need: need.clone(),
        });
        image
    };
    use vk::{CompareOp as Op, CullModeFlags as Cull};
    let front = layer(
        "depth_layers.front_depth",
        "depth_layers.front",
        wanted.map,
        MeshList::Occluders,
        Cull::NONE,
        0.0,
        Op::GREATER,
    );
    let back = wanted.back.then(|| {
        layer(
            "depth_layers.back_depth",
            "depth_layers.back",
            wanted.map,
            MeshList::Occluders,
            Cull::FRONT,
            1.0,
            Op::LESS,
        )
    });
    let receivers = wanted.receiver_map.map(|side| {
        layer(
            "depth_layers.receiver_depth",
            "depth_layers.receivers",
            side,
            MeshList::Receivers,
            Cull::NONE,
            0.0,
            Op::GREATER,
        )
    });
    DepthLayers { front, back, receivers }
}
