//! From one frame to what it records.

use super::{BorderBarriers, Description, Frame, HostImage, MeshInstance};
use crate::depth_layers::{self, MapView};
use crate::graph::{self, Border, Graph, MeshList, Need, Owner, ResourceId};
use crate::settings::Technique;
use crate::visibility::{self, GBuffer};
use crate::{Error, RectangleLight, scene::Role, soft_shadow_map};
use glam::DMat4;

/// How a mesh's triangles are wound as the light sees them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Faces {
    /// Fronts are counter-clockwise.
    CounterClockwise,
    /// Fronts are clockwise: the mesh is mirrored.
    Clockwise,
    /// Every face is a front and a back.
    Both,
}

/// A mesh in one list's clip space, ready to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshDraw {
    /// The host's mesh.
    pub mesh: MeshInstance,
    /// Index into [`Description::position_strides`].
    pub stride: usize,
    /// Which faces are fronts.
    pub faces: Faces,
    /// Mesh space to clip space, by column.
    pub clip_from_mesh: [f32; 16],
}

/// What one frame records.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// Rows, barriers, and what was skipped.
    pub plan: graph::Plan,
    /// The host's images by resource.
    pub imports: Vec<(ResourceId, HostImage)>,
    /// The exported image.
    pub visibility: ResourceId,
    /// The frame in flight.
    pub slot: u32,
    occluders: Vec<MeshDraw>,
    receivers: Vec<MeshDraw>,
}

impl FramePlan {
    /// How the node touches the host's images and the visibility image: stages, accesses and layouts
    /// on entry and on exit. An image that this frame's rows leave alone is not in the list.
    pub fn accesses(&self) -> &[graph::BoundaryUse] {
        &self.plan.boundary
    }

    /// The meshes of a list.
    pub fn meshes(&self, list: MeshList) -> &[MeshDraw] {
        match list {
            MeshList::Occluders => &self.occluders,
            MeshList::Receivers => &self.receivers,
        }
    }
}

/// What a device's limits mean to a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// 2^−(sub-pixel bits): how far rasters move a vertex, in texels.
    pub snap: f32,
}

impl Default for Limits {
    /// The least that Vulkan guarantees: 4 sub-pixel bits.
    fn default() -> Self {
        Self { snap: 1.0 / 16.0 }
    }
}

/// The graph of one frame with the resources the host needs to find again.
pub(crate) struct FrameGraph {
    pub graph: Graph,
    pub depth: ResourceId,
    pub mask: Option<ResourceId>,
    pub visibility: ResourceId,
}

/// What the rows depend on, beyond the description.
struct Views {
    occluders: MapView,
    receivers: Option<MapView>,
    need: Need,
    light_from_ndc: [f32; 16],
    background: f32,
}

/// Every row that any frame of this description could run; what a node makes its objects from.
pub(crate) fn nominal(description: &Description, limits: Limits) -> FrameGraph {
    let side = description.settings.soft_shadow_map.map;
    let view = MapView { min: [-1.0; 2], max: [1.0; 2], near: 1.0, far: 2.0, side };
    let views = Views {
        occluders: view,
        receivers: Some(view),
        need: Need::Yes("nominal".into()),
        light_from_ndc: DMat4::IDENTITY.as_mat4().to_cols_array(),
        background: 0.0,
    };
    build(description, limits, &RectangleLight::unit(), &views)
}

/// The graph of a description with every row that any of its frames could run; the numbers in its
/// push constants mean nothing.
pub fn full_graph(description: &Description) -> Graph {
    nominal(description, Limits::default()).graph
}

fn build(
    description: &Description,
    limits: Limits,
    light: &RectangleLight,
    views: &Views,
) -> FrameGraph {
    let mut graph = Graph::new();
    let depth =
        graph.image("gbuffer.depth", description.depth_format, description.extent, Owner::Imported);
    let mask = description
        .mask_format
        .map(|format| graph.image("gbuffer.mask", format, description.extent, Owner::Imported));
    let visibility = visibility::declare(&mut graph, description.extent);
    let gbuffer = GBuffer {
        depth,
        mask,
        extent: description.extent,
        light_from_ndc: views.light_from_ndc,
        background: views.background,
    };
    match description.settings.technique {
        Technique::SoftShadowMap => {
            let settings = &description.settings.soft_shadow_map;
            let layers =
                depth_layers::declare(&mut graph, soft_shadow_map::wanted(settings), &views.need);
            let inputs = soft_shadow_map::Inputs {
                light,
                occluders: &views.occluders,
                receivers: views.receivers.as_ref(),
                gbuffer: &gbuffer,
                snap: limits.snap,
                need: &views.need,
            };
            soft_shadow_map::declare(&mut graph, &layers, visibility, settings, &inputs);
        }
    }
    let lit = match &views.need {
        Need::Yes(_) => Need::No("something can be shadowed, and is written elsewhere".into()),
        Need::No(why) => Need::Yes(why.clone()),
    };
    visibility::lit(&mut graph, visibility, description.extent, lit);
    FrameGraph { graph, depth, mask, visibility }
}

/// Plans one frame: fits the maps, decides what runs, derives the barriers. Pure: no Vulkan calls.
///
/// # Errors
/// [`Error::Frame`] for numbers that are not finite, a mask or stride that the description does not
/// have, or a frame slot beyond the frames in flight.
pub fn plan(description: &Description, limits: Limits, frame: &Frame) -> Result<FramePlan, Error> {
    check(description, frame)?;
    let light = &frame.light;
    let list = |keep: fn(Role) -> bool| {
        let kept = frame.meshes.iter().filter(move |m| keep(m.role) && m.count >= 3);
        kept.copied().collect::<Vec<_>>()
    };
    let boxes = |meshes: &[MeshInstance]| {
        meshes.iter().map(|m| (m.bounds, m.world_from_mesh)).collect::<Vec<_>>()
    };
    let receivers = list(Role::receives);
    let receiver_boxes = boxes(&receivers);
    let mut occluders = list(Role::blocks);
    let given = occluders.len();
    occluders.retain(|m| {
        !depth_layers::is_aside(light, &(m.bounds, m.world_from_mesh), &receiver_boxes)
    });

    let settings = &description.settings.soft_shadow_map;
    let wanted = soft_shadow_map::wanted(settings);
    let fit = depth_layers::fit_occluders(light, &boxes(&occluders), frame.window, settings.map);
    let receiver_fit = fit.as_ref().and_then(|view| {
        let side = wanted.receiver_map.unwrap_or(settings.map);
        depth_layers::fit_receivers(light, &receiver_boxes, view, side)
    });
    let need = match (&fit, &receiver_fit) {
        (None, _) if given == 0 => Need::No("there are no occluders".into()),
        (None, _) if occluders.is_empty() => {
            Need::No("every occluder is flat, with light and receivers on one side of it".into())
        }
        (None, _) => Need::No("every occluder lies behind the light".into()),
        (_, None) => Need::No("no receiver lies where an occluder could shadow it".into()),
        _ => Need::Yes(
            format!(
                "{} of {given} occluder meshes can shadow some of {} receiver meshes",
                occluders.len(),
                receivers.len()
            )
            .into(),
        ),
    };
    let placeholder = MapView { min: [-1.0; 2], max: [1.0; 2], near: 1.0, far: 2.0, side: 16 };
    let to_light = light.light_from_world();
    let views = Views {
        occluders: fit.unwrap_or(placeholder),
        receivers: Some(receiver_fit.unwrap_or(placeholder)),
        need,
        light_from_ndc: (to_light * frame.world_from_ndc).as_mat4().to_cols_array(),
        background: frame.background,
    };
    let built = build(description, limits, light, &views);

    let mut imports = vec![(built.depth, frame.depth)];
    imports.extend(built.mask.zip(frame.mask));
    let mut borders: Vec<_> = imports
        .iter()
        .map(|(resource, i)| Border { resource: *resource, before: i.before, after: i.after })
        .collect();
    borders.push(Border {
        resource: built.visibility,
        before: frame.visibility_before,
        after: frame.visibility_after,
    });
    let place = frame.border_barriers == BorderBarriers::Node;
    let plan = graph::compile(built.graph, &borders, place)?;
    let draws = |meshes: &[MeshInstance], view: &MapView| {
        let clip = view.clip_from_light() * to_light;
        meshes.iter().map(|m| draw_of(description, m, &clip)).collect::<Result<Vec<_>, _>>()
    };
    Ok(FramePlan {
        plan,
        imports,
        visibility: built.visibility,
        slot: frame.slot,
        occluders: draws(&occluders, &views.occluders)?,
        receivers: match (wanted.receiver_map, &views.receivers) {
            (Some(_), Some(view)) => draws(&receivers, view)?,
            _ => Vec::new(),
        },
    })
}

fn draw_of(
    description: &Description,
    mesh: &MeshInstance,
    clip_from_world: &DMat4,
) -> Result<MeshDraw, Error> {
    let wanted = mesh.positions_stride;
    let stride =
        description.position_strides.iter().position(|&s| s == wanted).ok_or_else(|| {
            Error::Frame(format!(
                "a mesh has a position stride of {wanted} bytes, which the description's \
             position_strides {:?} do not hold",
                description.position_strides
            ))
        })?;
    let faces = if mesh.double_sided {
        Faces::Both
    } else if mesh.world_from_mesh.determinant() < 0.0 {
        Faces::Clockwise
    } else {
        Faces::CounterClockwise
    };
    let clip_from_mesh = (*clip_from_world * mesh.world_from_mesh).as_mat4().to_cols_array();
    Ok(MeshDraw { mesh: *mesh, stride, faces, clip_from_mesh })
}

fn check(description: &Description, frame: &Frame) -> Result<(), Error> {
    let bad = |what: String| Err(Error::Frame(what));
    if frame.slot >= description.frames_in_flight {
        return bad(format!(
            "frame slot {} does not exist; the description has {} frames in flight",
            frame.slot, description.frames_in_flight
        ));
    }
    if !frame.world_from_ndc.is_finite() || frame.world_from_ndc.determinant() == 0.0 {
        return bad("world_from_ndc must be finite and invertible".into());
    }
    if frame.mask.is_some() != description.mask_format.is_some() {
        return bad("a mask must be given each frame exactly where the description has one".into());
    }
    if let Some([min, max]) = frame.window {
        let good = (0..2).all(|i| min[i].is_finite() && max[i].is_finite() && min[i] < max[i]);
        if !good {
            return bad("the occluder map's window must have finite tangents, least first".into());
        }
    }
    for (index, mesh) in frame.meshes.iter().enumerate() {
        let bounds = mesh.bounds.iter().flatten();
        if !mesh.world_from_mesh.is_finite() || bounds.into_iter().any(|b| !b.is_finite()) {
            return bad(format!("mesh {index}: its transform and bounds must be finite numbers"));
        }
    }
    Ok(())
}
