//! Depth layers: depth images of the occluders and receivers, seen from the light.
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
//! Where we depart: the front layer draws faces of either orientation, because the nearest face of a closed solid is a
//! front face anyway, and an open sheet must cast its shadow whichever way it is turned. The map's window is fitted to
//! the occluders in u and v apart, so it need not have the light's aspect.
//!
//! With `middle`, two more passes leave out the faces that do not lie beyond others (depth peeling, Everitt 2001): the
//! nearest front faces beyond the nearest back faces, and the nearest back faces beyond these. A face that is both counts
//! once more, as a sheet. Hosts that draw occluders with their own pipelines have no such layers.
//!
//! A host that already has depth images of the occluders lends those instead of meshes; one pass for each layer then
//! copies them into the form above, whatever their depth convention and window.

mod boxes;
mod eye;
mod host_maps;
mod view;

pub(crate) use boxes::{LightBox, Polygon, cut, cut_faces, each_face, outside_of, planes_around};
pub(crate) use eye::view_from;
pub use eye::{Projection, view};
pub(crate) use host_maps::HostMapView;
pub use view::{Eye, MapView, fit_from, fit_occluders, fit_receivers, is_aside};
pub(crate) use view::{
    fit_boxes, fit_boxes_from, fit_boxes_within, fit_receiver_boxes, nearest_of, pad, tangents_of,
    tangents_within, window_of,
};

use crate::graph::{
    Access, Draw, Graph, Layer, Need, Owner, Pass, Push, ResourceId, Target, Use, Work,
};
use crate::shaders::{self, module};
use crate::stages::views::inner::Inner;
use ash::vk;
use smallvec::smallvec;

/// The layers' format; the stored value is near · w.
pub const FORMAT: vk::Format = vk::Format::D32_SFLOAT;

/// The format of layers that are copied from the host's images: compute shaders cannot write depth formats.
const COPIED_FORMAT: vk::Format = vk::Format::R32_SFLOAT;

/// The push constants of a mesh draw: a matrix by columns, and what is subtracted from positions before it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct DepthPush {
    /// Mesh space, moved so that the origin is at 0, to the map's clip space.
    pub clip_from_mesh: [f32; 16],
    /// The mesh's origin, and a 0.
    pub origin: [f32; 4],
}

/// The push constants of `copy_map.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CopyPush {
    /// 1 where u or v run against the map's x or y.
    pub flip: [i32; 2],
    /// The side of map and layer, texels.
    pub side: i32,
    /// The factor in near · w = scale · stored + offset.
    pub scale: f32,
    /// The offset in the equation at [`Self::scale`].
    pub offset: f32,
    /// The map's value where it was cleared.
    pub empty: f32,
    /// The layer's value where there is no occluder.
    pub nothing: f32,
    /// The largest value that a surface may have in the layer.
    pub most: f32,
}

/// The layers that a technique reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Whether the back layer is read.
    pub back: bool,
    /// Whether the nearest back faces and the furthest front faces are read too.
    pub inner: bool,
    /// Whether the faces of a third piece of matter between those are read too.
    pub middle: bool,
    /// The receiver map's side in texels, where one is read.
    pub receiver_map: Option<u32>,
}

/// The layers as the graph's resources.
#[derive(Clone, Copy, Debug)]
pub struct DepthLayers {
    /// Occluders' nearest faces; 0 where there are none.
    pub front: ResourceId,
    /// Occluders' furthest back faces; 1 where there are none.
    pub back: Option<ResourceId>,
    /// Occluders' nearest back faces, 0 where there are none, and their furthest front faces, 1 where
    /// there are none.
    pub inner: Option<[ResourceId; 2]>,
    /// Occluders' nearest front faces beyond their nearest back faces, and their nearest back faces beyond these; 0 where
    /// there are none.
    pub middle: Option<[ResourceId; 2]>,
    /// Receivers' nearest faces; 0 where there are none.
    pub receivers: Option<ResourceId>,
}

/// The source of the occluders.
#[derive(Clone, Copy)]
pub(crate) enum Occluders<'a> {
    /// The frame's meshes.
    Meshes,
    /// Depth images that the host lends.
    Maps { front: ResourceId, back: Option<ResourceId>, camera: &'a HostMapView },
}

/// The source of a light's layers in a frame, and which of them it needs.
#[derive(Clone, Copy)]
pub struct LightLayers<'a> {
    pub(crate) occluders: Occluders<'a>,
    /// The number of the view that the layers are drawn through.
    pub(crate) view: u32,
    /// The next finer view, where the front layer tells what lies before its receivers.
    pub(crate) inner: Option<Inner<'a>>,
    pub(crate) needs: Needs<'a>,
}

/// Which layers a frame needs.
#[derive(Clone, Copy)]
pub(crate) struct Needs<'a> {
    pub front: &'a Need,
    pub back: &'a Need,
    pub inner: &'a Need,
    pub middle: &'a Need,
    pub receivers: &'a Need,
}

/// Adds the layers, of `map` texels a side, and the passes that make them. A layer that this frame does not need is
/// `None`, although its pass and image are declared.
pub(crate) fn declare(
    graph: &mut Graph,
    wanted: Wanted,
    map: u32,
    layers: &LightLayers,
) -> DepthLayers {
    let LightLayers { occluders, view, inner: finer, needs } = *layers;
    let need = needs.front;
    let (front, back) = match occluders {
        Occluders::Meshes => {
            let names = [FRONT, "depth_layers.front"];
            let front = drawn(graph, Layer::Front, names, map, view, need);
            let names = [BACK, "depth_layers.back"];
            (front, wanted.back.then(|| drawn(graph, Layer::Back, names, map, view, needs.back)))
        }
        Occluders::Maps { front, back, camera } => {
            let front = copied(graph, front, map, camera, Layer::Front, need);
            let back = back.filter(|_| wanted.back);
            (front, back.map(|b| copied(graph, b, map, camera, Layer::Back, needs.back)))
        }
    };
    if let Some(finer) = finer {
        finer.find(graph, front);
    }
    let inner = (wanted.inner && matches!(occluders, Occluders::Meshes)).then(|| {
        let names = ["depth_layers.near_back_depth", "depth_layers.near_back"];
        let near_back = drawn(graph, Layer::NearBack, names, map, view, needs.inner);
        let names = ["depth_layers.far_front_depth", "depth_layers.far_front"];
        [near_back, drawn(graph, Layer::FarFront, names, map, view, needs.inner)]
    });
    let middle = inner.filter(|_| wanted.middle).map(|[near_back, _]| {
        let names = ["depth_layers.middle_front_depth", "depth_layers.middle_front"];
        let front = beyond(graph, Layer::MiddleFront, names, near_back, map, view, needs.middle);
        let names = ["depth_layers.middle_back_depth", "depth_layers.middle_back"];
        [front, beyond(graph, Layer::MiddleBack, names, front, map, view, needs.middle)]
    });
    let names = ["depth_layers.receiver_depth", "depth_layers.receivers"];
    let receivers = wanted
        .receiver_map
        .map(|side| drawn(graph, Layer::Receivers, names, side, 0, needs.receivers));
    DepthLayers {
        front,
        back: back.filter(|_| needs.back.is_yes()),
        inner: inner.filter(|_| needs.inner.is_yes()),
        middle: middle.filter(|_| needs.middle.is_yes()),
        receivers,
    }
}

/// Adds the depth map of a hard shadow through one of the frame's views, for a technique that draws none from the light's
/// centre.
pub(crate) fn hard(graph: &mut Graph, side: u32, view: u32, need: &Need) -> ResourceId {
    drawn(graph, Layer::Front, ["depth_layers.hard_depth", "depth_layers.hard"], side, view, need)
}

/// The raster state of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    /// The faces that are culled.
    pub cull: vk::CullModeFlags,
    /// The depth that the layer is cleared to.
    pub clear: f32,
    /// The depth comparison: a new depth replaces an old one where new `compare` old.
    pub compare: vk::CompareOp,
}

/// The raster state with which a layer is drawn.
pub fn raster_of(layer: Layer) -> Raster {
    use vk::{CompareOp as Op, CullModeFlags as Cull};
    match layer {
        Layer::Front | Layer::Receivers => {
            Raster { cull: Cull::NONE, clear: 0.0, compare: Op::GREATER }
        }
        Layer::Back => Raster { cull: Cull::FRONT, clear: 1.0, compare: Op::LESS },
        Layer::NearBack => Raster { cull: Cull::FRONT, clear: 0.0, compare: Op::GREATER },
        Layer::FarFront => Raster { cull: Cull::BACK, clear: 1.0, compare: Op::LESS },
        Layer::MiddleFront => Raster { cull: Cull::BACK, clear: 0.0, compare: Op::GREATER },
        Layer::MiddleBack => Raster { cull: Cull::FRONT, clear: 0.0, compare: Op::GREATER },
        // Every face counts, without a depth test.
        Layer::Slices => Raster { cull: Cull::NONE, clear: 0.0, compare: Op::ALWAYS },
        Layer::FrontSlices => Raster { cull: Cull::BACK, clear: 0.0, compare: Op::ALWAYS },
        Layer::BackSlices => Raster { cull: Cull::FRONT, clear: 0.0, compare: Op::ALWAYS },
    }
}

const FRONT: &str = "depth_layers.front_depth";
const BACK: &str = "depth_layers.back_depth";

/// Adds a layer as the light's centre sees it; the names are those of its image and of its pass.
fn drawn(
    graph: &mut Graph,
    layer: Layer,
    [image, pass]: [&'static str; 2],
    side: u32,
    view: u32,
    need: &Need,
) -> ResourceId {
    let image = graph.image(image, FORMAT, [side, side], Owner::Transient);
    draw(graph, pass, image, layer, view, need);
    image
}

/// Adds a layer of the faces that lie beyond those of another layer.
fn beyond(
    graph: &mut Graph,
    layer: Layer,
    [image, name]: [&'static str; 2],
    nearer: ResourceId,
    side: u32,
    view: u32,
    need: &Need,
) -> ResourceId {
    let image = graph.image(image, FORMAT, [side, side], Owner::Transient);
    let Raster { cull, clear, compare } = raster_of(layer);
    let (fragment, cut) = match layer {
        Layer::MiddleBack => {
            (module!("depth_layers/not_before.frag"), module!("depth_layers/not_before_cut.frag"))
        }
        _ => (module!("depth_layers/beyond.frag"), module!("depth_layers/beyond_cut.frag")),
    };
    graph.push(Pass {
        name,
        uses: smallvec![
            Use::bound(0, nearer, Access::SampledFragment),
            Use::fixed(image, Access::DepthTarget),
        ],
        push: Push::NONE,
        work: Work::Raster {
            vertex: shaders::DEPTH_VERT,
            fragment: Some(fragment),
            cut: Some([shaders::DEPTH_CUT_VERT, cut]),
            cull,
            target: Target::Depth { clear, compare },
            draw: Draw::Layer { layer, view },
        },
        need: *need,
    });
    image
}

/// Adds the pass that draws a layer into a depth image, through one of the frame's views.
pub(crate) fn draw(
    graph: &mut Graph,
    name: &'static str,
    image: ResourceId,
    layer: Layer,
    view: u32,
    need: &Need,
) {
    let Raster { cull, clear, compare } = raster_of(layer);
    graph.push(Pass {
        name,
        uses: smallvec![Use::fixed(image, Access::DepthTarget)],
        push: Push::NONE,
        work: Work::Raster {
            vertex: shaders::DEPTH_VERT,
            fragment: None,
            cut: Some([shaders::DEPTH_CUT_VERT, shaders::CUT_FRAG]),
            cull,
            target: Target::Depth { clear, compare },
            draw: Draw::Layer { layer, view },
        },
        need: *need,
    });
}

fn copied(
    graph: &mut Graph,
    map: ResourceId,
    side: u32,
    camera: &HostMapView,
    layer: Layer,
    need: &Need,
) -> ResourceId {
    let back = layer == Layer::Back;
    let (image, name) =
        if back { (BACK, "depth_layers.copy_back") } else { (FRONT, "depth_layers.copy_front") };
    let image = graph.image(image, COPIED_FORMAT, [side, side], Owner::Transient);
    let near = camera.view.near;
    graph.push(Pass {
        name,
        uses: smallvec![
            Use::bound(0, map, Access::SampledCompute),
            Use::bound(1, image, Access::ImageWrite),
        ],
        push: Push::new(&CopyPush {
            flip: camera.flip.map(i32::from),
            side: side as i32,
            scale: (camera.scale * near) as f32,
            offset: (camera.offset * near) as f32,
            empty: if back { camera.near_value } else { camera.far_value },
            nothing: if back { 1.0 } else { 0.0 },
            // A back face on the near plane must not read as an empty texel.
            most: if back { 1.0 - f32::EPSILON } else { 1.0 },
        }),
        work: Work::Dispatch {
            shader: module!("depth_layers/copy_map.comp"),
            groups: [side.div_ceil(8), side.div_ceil(8), 1],
        },
        need: *need,
    });
    image
}
