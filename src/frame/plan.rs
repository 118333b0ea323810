//! From one frame to what it records.

use super::accesses::{self, BufferAccess, HostAccess, ImageBarrier, NodeUse};
use super::{
    BorderBarriers, Description, Frame, Geometry, HostImage, MeshBuffers, MeshInstance, Visibility,
};
use crate::depth_layers::{self, HostMapView, MapView};
use crate::graph::{self, Border, Graph, MeshList, Need, Owner, ResourceId};
use crate::settings::Technique;
use crate::visibility::{self, GBuffer};
use crate::{Error, RectangleLight, scene::Role, soft_shadow_map};
use ash::vk;
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
    /// Index into [`Description::position_strides`]; 0 for what the host draws.
    pub stride: usize,
    /// Which faces are fronts.
    pub faces: Faces,
    /// Mesh space to clip space, by column.
    pub clip_from_mesh: [f32; 16],
}

/// Which node a plan was made by, and since which resize; none for a plan made without a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Stamp(pub u64);

/// What one frame records.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// Rows, barriers, and what was skipped.
    pub plan: graph::Plan,
    /// The host's images by resource.
    pub imports: Vec<(ResourceId, HostImage)>,
    /// Where the result goes.
    pub visibility: ResourceId,
    /// The frame in flight.
    pub slot: u32,
    pub(crate) stamp: Stamp,
    accesses: Vec<HostAccess>,
    occluders: Vec<MeshDraw>,
    receivers: Vec<MeshDraw>,
}

impl FramePlan {
    /// Every image that crosses the node's border: how the host leaves it, how the node uses it, if
    /// this frame does, and how the host takes it back.
    pub fn accesses(&self) -> &[HostAccess] {
        &self.accesses
    }

    /// How the node uses one of the images of the border; none where this frame leaves it alone.
    pub fn use_of(&self, image: vk::Image) -> Option<NodeUse> {
        self.accesses.iter().find(|a| a.image == image)?.node
    }

    /// The barriers to place before the node, for a host that asked for [`BorderBarriers::Host`].
    pub fn entry_barriers(&self) -> impl Iterator<Item = ImageBarrier> + '_ {
        self.accesses.iter().filter_map(HostAccess::entry_barrier)
    }

    /// The barriers to place behind the node, for a host that asked for [`BorderBarriers::Host`].
    pub fn exit_barriers(&self) -> impl Iterator<Item = ImageBarrier> + '_ {
        self.accesses.iter().filter_map(HostAccess::exit_barrier)
    }

    /// The vertex and index buffers that this frame reads, each once. The node places no barrier for
    /// them: what was written to them must be visible to these scopes.
    pub fn buffer_accesses(&self) -> Vec<BufferAccess> {
        accesses::of_buffers(self.occluders.iter().chain(&self.receivers))
    }

    /// The meshes of a list.
    pub fn meshes(&self, list: MeshList) -> &[MeshDraw] {
        match list {
            MeshList::Occluders => &self.occluders,
            MeshList::Receivers => &self.receivers,
        }
    }

    /// Whether some of its meshes are the host's to draw.
    pub fn has_host_draws(&self) -> bool {
        let mut all = self.occluders.iter().chain(&self.receivers);
        all.any(|d| matches!(d.mesh.geometry, Geometry::HostDrawn(_)))
    }

    /// Puts the node's mark on it, and the image that the node owns.
    pub(crate) fn stamped(mut self, stamp: Stamp, own_visibility: vk::Image) -> Self {
        self.stamp = stamp;
        let name = self.plan.graph.resource(self.visibility).name;
        for a in self.accesses.iter_mut().filter(|a| a.name == name) {
            if a.image == vk::Image::null() {
                a.image = own_visibility;
            }
        }
        self
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
    pub occluder_maps: [Option<ResourceId>; 2],
    pub visibility: ResourceId,
}

/// A view for rows that do not run.
const PLACEHOLDER: MapView =
    MapView { min: [-1.0; 2], max: [1.0; 2], near: 1.0, far: 2.0, side: 16 };

/// What the rows depend on, beyond the description.
struct Views {
    occluders: MapView,
    host_maps: Option<HostMapView>,
    receivers: Option<MapView>,
    need: Need,
    light_from_ndc: [f32; 16],
    background: f32,
}

/// Every row that any frame of this description could run; what a node makes its objects from.
pub(crate) fn nominal(description: &Description, limits: Limits) -> FrameGraph {
    let side = description.settings.soft_shadow_map.map;
    let view = MapView { side, ..PLACEHOLDER };
    let views = Views {
        occluders: view,
        host_maps: description.occluder_maps.map(|_| HostMapView {
            view,
            flip: [false; 2],
            scale: 1.0,
            offset: 0.0,
            far_value: 0.0,
            near_value: 1.0,
            error: 0.0,
        }),
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
    let settings = &description.settings.soft_shadow_map;
    let wanted = soft_shadow_map::wanted(settings);
    let map = |graph: &mut Graph, name| {
        description
            .occluder_maps
            .map(|format| graph.image(name, format, [settings.map; 2], Owner::Imported))
    };
    let front = map(&mut graph, "occluder_maps.front");
    let back = if wanted.back { map(&mut graph, "occluder_maps.back") } else { None };
    let visibility =
        visibility::declare(&mut graph, description.extent, description.lent_visibility);
    let gbuffer = GBuffer {
        depth,
        mask,
        extent: description.extent,
        light_from_ndc: views.light_from_ndc,
        background: views.background,
    };
    match description.settings.technique {
        Technique::SoftShadowMap => {
            let occluders = match (front, &views.host_maps) {
                (Some(front), Some(camera)) => {
                    depth_layers::Occluders::Maps { front, back, camera }
                }
                _ => depth_layers::Occluders::Meshes,
            };
            let layers = depth_layers::declare(&mut graph, wanted, &occluders, &views.need);
            let inputs = soft_shadow_map::Inputs {
                light,
                occluders: &views.occluders,
                receivers: views.receivers.as_ref(),
                gbuffer: &gbuffer,
                snap: limits.snap,
                depth_error: views.host_maps.map_or(0.0, |m| m.error),
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
    FrameGraph { graph, depth, mask, occluder_maps: [front, back], visibility }
}

/// Plans one frame: fits the maps, decides what runs, derives the barriers. Pure: no Vulkan calls.
///
/// # Errors
/// [`Error::Frame`] for numbers that are not finite, an image of another size, format, usage or
/// layout than the description and the passes need, images or strides that the description does not
/// have, or a frame slot beyond the frames in flight.
pub fn plan(description: &Description, limits: Limits, frame: &Frame) -> Result<FramePlan, Error> {
    frame.check(description)?;
    let light = &frame.light;
    let of_role = |keep: fn(Role) -> bool| {
        let kept = frame.meshes.iter().filter(move |m| keep(m.role) && has_triangles(m));
        kept.copied().collect::<Vec<_>>()
    };
    let receivers = of_role(Role::receives);
    let mut occluders = of_role(Role::blocks);
    let views = look(description, frame, &mut occluders, &receivers)?;
    let built = build(description, limits, light, &views);

    let lent = |id: Option<ResourceId>, image: Option<HostImage>| id.zip(image);
    let maps = frame.occluder_maps;
    let result = match frame.visibility {
        Visibility::Lent(image) => Some(image),
        Visibility::Own { .. } => None,
    };
    let imports: Vec<_> = [
        lent(Some(built.depth), Some(frame.depth)),
        lent(built.mask, frame.mask),
        lent(built.occluder_maps[0], maps.map(|m| m.front)),
        lent(built.occluder_maps[1], maps.and_then(|m| m.back)),
        lent(Some(built.visibility), result),
    ]
    .into_iter()
    .flatten()
    .collect();
    let mut borders: Vec<_> = imports
        .iter()
        .map(|(resource, i)| Border { resource: *resource, before: i.before, after: i.after })
        .collect();
    if let Visibility::Own { before, after } = frame.visibility {
        borders.push(Border { resource: built.visibility, before, after });
    }
    let place = frame.border_barriers == BorderBarriers::Node;
    let plan = graph::compile(built.graph, &borders, place)?;

    let to_light = light.light_from_world();
    let draws = |meshes: &[MeshInstance], view: &MapView| {
        let clip = view.clip_from_light() * to_light;
        meshes.iter().map(|m| draw_of(description, m, &clip)).collect::<Result<Vec<_>, _>>()
    };
    let wanted = soft_shadow_map::wanted(&description.settings.soft_shadow_map);
    Ok(FramePlan {
        accesses: borders.iter().map(|b| access_of(&plan, b, &imports)).collect(),
        plan,
        imports,
        visibility: built.visibility,
        slot: frame.slot,
        stamp: Stamp::default(),
        occluders: draws(&occluders, &views.occluders)?,
        receivers: match (wanted.receiver_map, &views.receivers) {
            (Some(_), Some(view)) => draws(&receivers, view)?,
            _ => Vec::new(),
        },
    })
}

fn has_triangles(mesh: &MeshInstance) -> bool {
    match mesh.geometry {
        Geometry::Buffers(buffers) => buffers.count >= 3,
        Geometry::HostDrawn(_) => true,
    }
}

/// Fits the maps and says whether anything can be shadowed; keeps of `occluders` what the node draws.
fn look(
    description: &Description,
    frame: &Frame,
    occluders: &mut Vec<MeshInstance>,
    receivers: &[MeshInstance],
) -> Result<Views, Error> {
    let light = &frame.light;
    let settings = &description.settings.soft_shadow_map;
    let boxes = |meshes: &[MeshInstance]| {
        meshes.iter().map(|m| (m.bounds, m.world_from_mesh)).collect::<Vec<_>>()
    };
    let receiver_boxes = boxes(receivers);
    let host_maps = match (&frame.occluder_maps, description.occluder_maps) {
        (Some(maps), Some(format)) => {
            Some(HostMapView::new(light, &maps.clip_from_world, settings.map, format)?)
        }
        _ => None,
    };
    let given = occluders.len();
    let fit = if let Some(maps) = &host_maps {
        occluders.clear();
        Some(maps.view)
    } else {
        occluders.retain(|m| {
            !depth_layers::is_aside(light, &(m.bounds, m.world_from_mesh), &receiver_boxes)
        });
        depth_layers::fit_occluders(light, &boxes(occluders), frame.window, settings.map)
    };
    let receiver_fit = fit.as_ref().and_then(|view| {
        let side = soft_shadow_map::wanted(settings).receiver_map.unwrap_or(settings.map);
        depth_layers::fit_receivers(light, &receiver_boxes, view, side)
    });
    let need = match (&fit, &receiver_fit) {
        (None, _) if given == 0 => Need::No("there are no occluders".into()),
        (None, _) if occluders.is_empty() => {
            Need::No("every occluder is flat, with light and receivers on one side of it".into())
        }
        (None, _) => Need::No("every occluder lies behind the light".into()),
        (_, None) => Need::No("no receiver lies where an occluder could shadow it".into()),
        _ if host_maps.is_some() => Need::Yes(
            format!("the host's maps may shadow some of {} receiver meshes", receivers.len())
                .into(),
        ),
        _ => Need::Yes(
            format!(
                "{} of {given} occluder meshes can shadow some of {} receiver meshes",
                occluders.len(),
                receivers.len()
            )
            .into(),
        ),
    };
    let light_from_ndc = light.light_from_world() * frame.world_from_ndc;
    Ok(Views {
        occluders: fit.unwrap_or(PLACEHOLDER),
        host_maps,
        receivers: Some(receiver_fit.unwrap_or(PLACEHOLDER)),
        need,
        light_from_ndc: light_from_ndc.as_mat4().to_cols_array(),
        background: frame.background,
    })
}

/// What a host must know of one image of the border.
fn access_of(
    plan: &graph::Plan,
    border: &Border,
    imports: &[(ResourceId, HostImage)],
) -> HostAccess {
    let resource = plan.graph.resource(border.resource);
    let used = plan.boundary.iter().find(|b| b.resource == border.resource);
    let host = imports.iter().find(|(id, _)| *id == border.resource);
    HostAccess {
        name: resource.name,
        image: host.map_or(vk::Image::null(), |(_, i)| i.image),
        aspect: graph::aspects(resource.shape),
        before: border.before,
        node: used.map(|b| NodeUse { entry: b.entry, exit: b.exit, writes: b.writes }),
        after: border.after,
    }
}

fn draw_of(
    description: &Description,
    mesh: &MeshInstance,
    clip_from_world: &DMat4,
) -> Result<MeshDraw, Error> {
    let strides = &description.position_strides;
    let stride = match mesh.geometry {
        Geometry::HostDrawn(_) => 0,
        Geometry::Buffers(MeshBuffers { positions_stride: wanted, .. }) => {
            strides.iter().position(|&s| s == wanted).ok_or_else(|| {
                Error::Frame(format!(
                    "a mesh has a position stride of {wanted} bytes, which the description's \
                     position_strides {strides:?} do not hold"
                ))
            })?
        }
    };
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
