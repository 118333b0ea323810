//! What the host says each frame, and the plan that follows from it. No Vulkan calls.

use crate::depth_layers::{self, Bounds, MapView};
use crate::graph::{self, Border, Graph, MeshList, Need, Owner, ResourceId, Scope};
use crate::settings::{Settings, Technique};
use crate::visibility::{self, GBuffer};
use crate::{Error, RectangleLight, scene::Role, soft_shadow_map};
use ash::vk;
use glam::DMat4;

/// What stays the same from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// The G-buffer's width and height in pixels, 1 to 16384.
    pub extent: [u32; 2],
    /// The technique and its knobs.
    pub settings: Settings,
    /// How many frames may be recorded before the first of them is done, 1 to 8.
    pub frames_in_flight: u32,
    /// The format of the G-buffer's depth image.
    pub depth_format: vk::Format,
    /// The format of the mask, where there is one.
    pub mask_format: Option<vk::Format>,
    /// Lets the node's own images be copied out, for tests and debuggers; off by default.
    pub inspect: bool,
    /// Every distance between positions, in bytes, that a mesh may have; 12 is tightly packed.
    pub position_strides: Vec<u32>,
}

impl Description {
    /// The default settings for a D32_SFLOAT G-buffer without a mask, two frames in flight and
    /// tightly packed positions.
    pub fn new(extent: [u32; 2]) -> Self {
        Self {
            extent,
            settings: Settings::default(),
            frames_in_flight: 2,
            depth_format: vk::Format::D32_SFLOAT,
            mask_format: None,
            inspect: false,
            position_strides: vec![12],
        }
    }

    /// # Errors
    /// [`Error::Setting`] or [`Error::Frame`] for the first thing out of its range.
    pub fn check(&self) -> Result<(), Error> {
        self.settings.check()?;
        if self.extent.iter().any(|e| !(1..=16384).contains(e)) {
            let [w, h] = self.extent;
            return Err(Error::Frame(format!(
                "a G-buffer of {w}×{h} pixels is outside 1×1 to 16384×16384"
            )));
        }
        if !(1..=8).contains(&self.frames_in_flight) {
            return Err(Error::Frame("frames_in_flight must be 1 to 8".into()));
        }
        if !graph::is_depth_format(self.depth_format) {
            return Err(Error::Frame(format!(
                "the G-buffer's depth format {:?} holds no depth",
                self.depth_format
            )));
        }
        match self.position_strides.iter().find(|&&s| s < 12 || s % 4 != 0 || s > 2048) {
            Some(s) => Err(Error::Frame(format!(
                "a position stride of {s} bytes does not work; three floats take 12, and strides \
                 are multiples of 4 up to 2048"
            ))),
            None => Ok(()),
        }
    }
}

/// One of the host's images, how it was left and how it is wanted back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostImage {
    /// The image; may be null where the host places barriers itself.
    pub image: vk::Image,
    /// A 2D view of it, of the depth aspect for depth.
    pub view: vk::ImageView,
    /// Stage, access and layout of the host's last use before the node.
    pub before: Scope,
    /// Stage, access and layout of the host's first use after it.
    pub after: Scope,
}

/// A mesh as the host keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshInstance {
    /// Positions: three 32-bit floats each, in a buffer with `VERTEX_BUFFER` usage.
    pub positions: vk::Buffer,
    /// Where the first position is, in bytes.
    pub positions_offset: u64,
    /// Bytes from one position to the next; one of [`Description::position_strides`].
    pub positions_stride: u32,
    /// Indices: buffer, offset in bytes, type; none for a list of triangles without.
    pub indices: Option<(vk::Buffer, u64, vk::IndexType)>,
    /// How many indices, or vertices where there are none.
    pub count: u32,
    /// Mesh space to world space.
    pub world_from_mesh: DMat4,
    /// A box around the positions, in mesh space.
    pub bounds: Bounds,
    /// Occluder, receiver or both.
    pub role: Role,
    /// Both sides of each triangle are front faces.
    pub double_sided: bool,
}

/// Who places the barriers at the node's border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BorderBarriers {
    /// The node, from what the host says of its images.
    #[default]
    Node,
    /// The host, from [`FramePlan::accesses`].
    Host,
}

/// One frame, as the host sees it.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The light.
    pub light: RectangleLight,
    /// Normalized device coordinates and depth to world space: the inverse of view and projection.
    pub world_from_ndc: DMat4,
    /// The depth of pixels that show no surface: 0 with reversed depth, else 1.
    pub background: f32,
    /// Everything that blocks light or shows shadows.
    pub meshes: &'a [MeshInstance],
    /// The G-buffer's depth.
    pub depth: HostImage,
    /// Roles by pixel: red 1 blocks and receives, ½ receives only, 0 receives nothing.
    pub mask: Option<HostImage>,
    /// How the visibility image was last used, and how it will be used next.
    pub visibility_before: Scope,
    /// See [`Self::visibility_before`].
    pub visibility_after: Scope,
    /// Least and largest tangent (u, v) of the occluder map; none fits it to the occluders.
    pub window: Option<[[f64; 2]; 2]>,
    /// Which of the frames in flight this is, 0 and up. The frame that last had the same number
    /// must be done before this one is recorded.
    pub slot: u32,
    /// Who places the barriers at the border.
    pub border_barriers: BorderBarriers,
}

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
