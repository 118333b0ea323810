//! From one frame to what it records.

use super::accesses::{self, BufferAccess, HostAccess, ImageBarrier, NodeUse};
use super::boxes::Surroundings;
use super::fit::Fit;
use super::keep::{self, Keeping, Kept, Revisions, Ties};
use super::left::Whose;
use super::look::look;
use super::rows::{Ids, Limits, build, wanted};
use super::{
    BorderBarriers, Description, Frame, FramePlans, Geometry, HostImage, MeshBuffers, MeshInstance,
    Visibility,
};
use crate::graph::{self, Border, Compiler, Draw, Graph, MeshList, ResourceId, Work};
use crate::light::outline;
use crate::linear_light;
use crate::planner::Verdicts;
use crate::settings::{Settings, Technique};
use crate::{Error, RectangleLight};
use ash::vk;
use glam::DMat4;
use smallvec::{SmallVec, smallvec};
use std::borrow::Cow;

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

/// A mesh of a list, ready to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshDraw {
    /// The host's mesh.
    pub mesh: MeshInstance,
    /// Index into [`Description::position_strides`]; 0 for what the host draws.
    pub stride: usize,
    /// Which faces are fronts.
    pub faces: Faces,
}

/// The meshes of a list, and the matrices that bring them into each view of it.
#[derive(Clone, Debug, Default, PartialEq)]
struct DrawList {
    meshes: Vec<MeshDraw>,
    /// Mesh space to clip space, by column; view by view, mesh by mesh.
    clip_from_mesh: Vec<[f32; 16]>,
}

impl DrawList {
    fn clear(&mut self) {
        self.meshes.clear();
        self.clip_from_mesh.clear();
    }

    /// The meshes as each of some views sees them.
    fn fill<'a>(
        &mut self,
        description: &Description,
        meshes: impl Iterator<Item = &'a MeshInstance> + Clone,
        views: &[DMat4],
    ) -> Result<(), Error> {
        self.clear();
        for clip in views {
            let matrix = |m: &MeshInstance| (*clip * m.world_from_mesh).as_mat4().to_cols_array();
            self.clip_from_mesh.extend(meshes.clone().map(matrix));
        }
        for mesh in meshes {
            self.meshes.push(draw_of(description, mesh)?);
        }
        Ok(())
    }
}

/// Memory that planning uses again from frame to frame, for all lights.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    graph: Graph,
    compiler: Compiler,
    borders: Vec<Border>,
    pub surroundings: Surroundings,
}

/// What is remembered of a light from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    fit: Fit,
    ties: Ties,
    /// What the rows of its last plan came of.
    rows: Option<(Description, Shape)>,
    /// What its last draws came of: of which look at the meshes, from where.
    drawn: Option<(u64, Clips, Clips)>,
}

/// Matrices from the world into views: few techniques have more than one.
type Clips = SmallVec<[DMat4; 1]>;

/// What decides which rows a description has in a frame, and which of them run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    needs: u8,
    points: usize,
    lines: usize,
    kept: [bool; 3],
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
    /// What the frame needs and does without, and why.
    pub verdicts: Verdicts,
    /// Which of the description's lights it is for.
    pub light_index: u32,
    /// Which of the description's settings it uses.
    pub settings_index: u32,
    pub(crate) stamp: Stamp,
    pub(crate) keeping: Keeping,
    accesses: Vec<HostAccess>,
    occluders: DrawList,
    receivers: DrawList,
}

impl Default for FramePlan {
    /// Of no frame: no node records it.
    fn default() -> Self {
        Self {
            plan: graph::Plan::default(),
            imports: Vec::new(),
            visibility: ResourceId::default(),
            slot: 0,
            verdicts: Verdicts::judge(None, &Settings::default(), None, false),
            light_index: 0,
            settings_index: 0,
            stamp: Stamp::default(),
            keeping: Keeping::default(),
            accesses: Vec::new(),
            occluders: DrawList::default(),
            receivers: DrawList::default(),
        }
    }
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

    /// For people: what runs and why, what does not and why not, and what of the effects that the node can simulate
    /// is simulated or left out, with the bound on the error of that.
    pub fn explain(&self) -> String {
        format!("{}\n{}", self.plan.table(), self.verdicts)
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
        accesses::of_buffers(self.occluders.meshes.iter().chain(&self.receivers.meshes))
    }

    /// The meshes of a list.
    pub fn meshes(&self, list: MeshList) -> &[MeshDraw] {
        &self.list(list).meshes
    }

    /// The meshes of a list with their matrices in one of its views: mesh space to clip space, by
    /// column.
    pub fn draws(
        &self,
        list: MeshList,
        view: u32,
    ) -> impl Iterator<Item = (&MeshDraw, &[f32; 16])> {
        let DrawList { meshes, clip_from_mesh } = self.list(list);
        meshes.iter().zip(clip_from_mesh.iter().skip(view as usize * meshes.len()))
    }

    fn list(&self, list: MeshList) -> &DrawList {
        match list {
            MeshList::Occluders => &self.occluders,
            MeshList::Receivers => &self.receivers,
        }
    }

    /// Whether some of its meshes are the host's to draw.
    pub fn has_host_draws(&self) -> bool {
        let mut all = self.occluders.meshes.iter().chain(&self.receivers.meshes);
        all.any(|d| matches!(d.mesh.geometry, Geometry::HostDrawn(_)))
    }

    /// Whose pixels it writes, by which settings.
    pub(crate) fn whose(&self) -> Whose {
        Whose { light: self.light_index, settings: self.settings_index }
    }

    /// Puts the node's mark on it, and the image that the node owns.
    pub(crate) fn stamp(&mut self, stamp: Stamp, own_visibility: vk::Image) {
        self.stamp = stamp;
        // Every image of the host's was checked to be none of these.
        for access in self.accesses.iter_mut().filter(|a| a.image == vk::Image::null()) {
            access.image = own_visibility;
        }
    }
}

/// Plans one frame: fits the maps, decides what runs, derives the barriers. Pure: no Vulkan calls.
///
/// # Errors
/// [`Error::Frame`] for numbers that are not finite, a line or an outline that the technique does not
/// take, an outline that is not what [`Frame::outline`] asks for, an image of another size, format,
/// usage or layout than the description and the passes need, images or strides that the description
/// does not have, or a light, settings or a frame slot beyond those of the description.
pub fn plan(description: &Description, limits: Limits, frame: &Frame) -> Result<FramePlan, Error> {
    plan_with(description, limits, frame, &Kept::default())
}

/// As [`plan`], of several lights, in memory that is kept: see [`ShadowNode::plan_all`](crate::ShadowNode::plan_all).
///
/// # Errors
/// As [`plan`]; the plans are then those of the frames before the one that is refused.
pub fn plan_all(
    description: &Description,
    limits: Limits,
    frames: &[Frame],
    plans: &mut FramePlans,
) -> Result<(), Error> {
    plans.begin();
    let kept = Kept::default();
    frames.iter().try_for_each(|frame| {
        let description = &*description.choosing(frame.settings_index)?;
        plans.add(|workspace, memory, plan| {
            plan_into(description, limits, frame, &kept, workspace, memory, plan)
        })
    })
}

/// As [`plan`], for a node in which earlier frames have left something.
pub(crate) fn plan_with(
    description: &Description,
    limits: Limits,
    frame: &Frame,
    kept: &Kept,
) -> Result<FramePlan, Error> {
    let description = &*description.choosing(frame.settings_index)?;
    let (mut plan, mut memory) = (FramePlan::default(), Memory::default());
    let workspace = &mut Workspace::default();
    plan_into(description, limits, frame, kept, workspace, &mut memory, &mut plan)?;
    Ok(plan)
}

/// As [`plan_with`], by a description that has the frame's settings alone, and in the memory of earlier frames of the
/// light. After an error the plan is of no frame.
pub(crate) fn plan_into(
    description: &Description,
    limits: Limits,
    frame: &Frame,
    kept: &Kept,
    workspace: &mut Workspace,
    memory: &mut Memory,
    plan: &mut FramePlan,
) -> Result<(), Error> {
    // Where it fails, nothing of the frame before is left to build on.
    plan.stamp = Stamp::default();
    let settings = &description.settings;
    frame.check(description, settings)?;
    let (light, outline) = match settings.technique {
        Technique::LinearLight => along(frame),
        _ => (frame.light, frame.outline.map(Cow::Borrowed)),
    };
    let frame = &Frame { light, outline: outline.as_deref(), ..*frame };
    let Workspace { graph, compiler, borders, surroundings } = workspace;
    let Memory { fit, ties, rows, drawn } = memory;
    fit.update(description, settings, frame, surroundings)?;
    let (views, verdicts) = look(description, frame, fit)?;
    graph.clear();
    let ids = build(graph, description, limits, &light, &views);
    let occluder_clips = views.occluder_clips();
    let receiver_view = views.receivers;
    let (points, lines) = (views.points.len(), views.lines.len());
    let needs = views.needs.bits();
    // Which rows there are is told by description and needs, before it is told what of them is kept.
    let before = rows.take().filter(|(of, shape)| {
        of == description && (shape.needs, shape.points, shape.lines) == (needs, points, lines)
    });
    if before.is_none() {
        ties.find(graph, ids.pixels());
    }
    let revisions = Revisions { scene: frame.revision, view: frame.view_revision };
    plan.keeping = keep::apply(graph, ties, &frame.visibility, revisions, kept);
    let shape = Shape { needs, points, lines, kept: plan.keeping.uses() };
    plan.imports.clear();
    plan.imports.extend(imports(&ids, frame));
    fill_borders(borders, &plan.imports, ids.visibility, frame);
    let place = frame.border_barriers == BorderBarriers::Node;
    let same = before.as_ref().is_some_and(|(_, before)| *before == shape);
    compiler.compile(graph, borders, place, same, &mut plan.plan)?;
    // The next frame's rows are built where this one's have been.
    graph.clear();
    graph.reserve_for(&plan.plan.graph);
    let of = before.map_or_else(|| description.clone(), |(of, _)| of);
    *rows = Some((of, shape));
    plan.accesses.clear();
    for border in &*borders {
        plan.accesses.push(access_of(&plan.plan, border, &plan.imports, frame.light_index));
    }
    plan.visibility = ids.visibility;
    plan.verdicts = verdicts;
    plan.slot = frame.slot;
    (plan.light_index, plan.settings_index) = (frame.light_index, frame.settings_index);

    let to_light = fit.light_from_world;
    let occluder_clips: Clips = occluder_clips.iter().map(|clip| *clip * to_light).collect();
    let receiver_clips = match (wanted(settings).receiver_map, &receiver_view) {
        (Some(_), Some(view)) => smallvec![view.clip_from_light() * to_light],
        _ if settings.technique == Technique::LinearLight => occluder_clips.clone(),
        _ => SmallVec::new(),
    };
    let of = (fit.number(), occluder_clips, receiver_clips);
    if !same || drawn.as_ref() != Some(&of) {
        *drawn = None;
        fill_draws(plan, description, frame.meshes, fit, [&of.1, &of.2])?;
        *drawn = Some(of);
    }
    Ok(())
}

/// The lists of what is drawn; what no row draws needs no matrices.
fn fill_draws(
    plan: &mut FramePlan,
    description: &Description,
    meshes: &[MeshInstance],
    fit: &Fit,
    [occluder_clips, receiver_clips]: [&Clips; 2],
) -> Result<(), Error> {
    let FramePlan { plan, occluders, receivers, .. } = plan;
    for (list, draws, placed, clips) in [
        (MeshList::Occluders, occluders, &fit.occluders, occluder_clips),
        (MeshList::Receivers, receivers, &fit.receivers, receiver_clips),
    ] {
        match is_drawn(plan, list) {
            true => draws.fill(description, placed.meshes(meshes), clips)?,
            false => draws.clear(),
        }
    }
    Ok(())
}

/// How the host's resources and the result are left and taken back.
fn fill_borders(
    borders: &mut Vec<Border>,
    imports: &[(ResourceId, HostImage)],
    visibility: ResourceId,
    frame: &Frame,
) {
    borders.clear();
    borders.extend(imports.iter().map(|(resource, i)| Border {
        resource: *resource,
        before: i.before,
        after: i.after,
    }));
    if let Visibility::Own { before, after } = frame.visibility {
        borders.push(Border { resource: visibility, before, after });
    }
}

/// Light and outline as linear lights take them, longer along x.
fn along<'a>(frame: &Frame<'a>) -> (RectangleLight, Option<Cow<'a, [[f64; 2]]>>) {
    let turned = linear_light::turned(&frame.light);
    let outline = match turned == frame.light {
        true => frame.outline.map(Cow::Borrowed),
        false => frame.outline.map(|corners| Cow::Owned(outline::quarter_turned(corners))),
    };
    (turned, outline)
}

/// The host's images by resource.
fn imports(ids: &Ids, frame: &Frame) -> impl Iterator<Item = (ResourceId, HostImage)> {
    let lent = |id: Option<ResourceId>, image: Option<HostImage>| id.zip(image);
    let maps = frame.occluder_maps;
    let result = match frame.visibility {
        Visibility::Lent(image) => Some(image),
        Visibility::Own { .. } => None,
    };
    [
        lent(Some(ids.depth), Some(frame.depth)),
        lent(ids.mask, frame.mask),
        lent(ids.occluder_maps[0], maps.map(|m| m.front)),
        lent(ids.occluder_maps[1], maps.and_then(|m| m.back)),
        lent(ids.light_texture, frame.light_texture),
        lent(Some(ids.visibility), result),
    ]
    .into_iter()
    .flatten()
}

/// Whether some row that runs draws the meshes of a list.
fn is_drawn(plan: &graph::Plan, list: MeshList) -> bool {
    plan.steps.iter().any(|step| match plan.graph.passes()[step.pass].work {
        Work::Raster { draw: Draw::Layer { layer, .. }, .. } => layer.meshes() == list,
        _ => false,
    })
}

/// What a host must know of one image of the border.
fn access_of(
    plan: &graph::Plan,
    border: &Border,
    imports: &[(ResourceId, HostImage)],
    light_index: u32,
) -> HostAccess {
    let resource = plan.graph.resource(border.resource);
    let used = plan.boundary.iter().find(|b| b.resource == border.resource);
    let host = imports.iter().find(|(id, _)| *id == border.resource);
    HostAccess {
        name: resource.name,
        image: host.map_or(vk::Image::null(), |(_, i)| i.image),
        layer: if host.is_none() { light_index } else { 0 },
        aspect: graph::aspects(resource.shape),
        before: border.before,
        node: used.map(|b| NodeUse { entry: b.entry, exit: b.exit, writes: b.writes }),
        after: border.after,
    }
}

fn draw_of(description: &Description, mesh: &MeshInstance) -> Result<MeshDraw, Error> {
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
    Ok(MeshDraw { mesh: *mesh, stride, faces })
}
