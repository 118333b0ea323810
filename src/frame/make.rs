//! Makes the plan of one frame.

use super::accesses::{HostAccess, NodeUse};
use super::boxes::MeshBoxes;
use super::doubts::Sight;
use super::fit::Fit;
use super::inputs::frame_inputs;
use super::limits::Limits;
use super::passes::{Clips, Ids, build};
use super::plan::{FramePlan, Stamp};
use super::request::FitRequest;
use super::reuse::{self, Cached, CameraDependence, Revisions};
use super::triangles::TreeKey;
use super::views::PlannedView;
use super::{Description, Frame, FramePlans};
use crate::Error;
use crate::graph::{self, Border, Compiler, Draw, Graph, MeshList, ResourceId, Why, Work};
use crate::lent::{BorderBarriers, HostImage, LightIndex, MeshInstance, Visibility};
use ash::vk;
use smallvec::smallvec;

/// Memory that planning uses again from frame to frame and from light to light.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    graph: Graph,
    compiler: Compiler,
    borders: Vec<Border>,
    /// The sizes of the largest graph of any light so far.
    largest: [usize; 4],
    pub mesh_boxes: MeshBoxes,
}

/// What planning a light's frame reuses from the light's last one.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    fit: Fit,
    camera: CameraDependence,
    /// The description and shape that the last plan's passes were made for.
    built: Option<(Description, Shape)>,
    /// The number of the fit and the views that the last lists of draws were made for.
    drawn: Option<(u64, Clips, Clips)>,
}

/// What decides which passes a description has in a frame, and which of them run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    /// The bits of the passes that are needed.
    needs: u8,
    /// How many views the technique has.
    views: usize,
    /// The side of their maps, texels.
    side: u32,
    /// What the plan reuses, as [`reuse::Reuse::uses`] lists it.
    reuses: [bool; 5],
    /// Whether textures cut out some of the frame's meshes.
    cut_outs: bool,
    /// What decides which of the hierarchy's passes are needed.
    tree: (Option<u32>, bool),
}

impl Shape {
    /// What decides which passes there are, and on which resources.
    fn passes(&self) -> (u8, usize, u32) {
        (self.needs, self.views, self.side)
    }
}

/// Plans one frame: fits the maps, decides what runs, derives the barriers. Pure: no Vulkan calls.
///
/// # Errors
/// [`Error::Frame`] for numbers that are not finite, a light of a shape that the technique does not accept, an image of
/// another size, format, usage or layout than the description and the passes need, images or strides that the description
/// does not have, a reach that is not above 0, or a light, a technique or a frame slot beyond those of the description.
pub fn plan(description: &Description, limits: Limits, frame: &Frame) -> Result<FramePlan, Error> {
    plan_with(description, limits, frame, &Cached::default())
}

/// Plans the frames of several lights, in order, into memory that is kept from frame to frame; see
/// [`ShadowNode::plan_all`](crate::ShadowNode::plan_all).
///
/// # Errors
/// See [`plan`]; `plans` then holds those of the frames before the refused one.
pub fn plan_all(
    description: &Description,
    limits: Limits,
    frames: &[Frame],
    plans: &mut FramePlans,
) -> Result<(), Error> {
    plans.begin();
    let cached = Cached::default();
    frames.iter().try_for_each(|frame| {
        let description = &*description.choosing(frame.technique_index)?;
        plans.add(|workspace, memory, plan| {
            plan_into(description, limits, frame, &cached, workspace, memory, plan)
        })
    })
}

/// Plans one frame for a node whose cache holds `cached` for it; see [`plan`].
pub(crate) fn plan_with(
    description: &Description,
    limits: Limits,
    frame: &Frame,
    cached: &Cached,
) -> Result<FramePlan, Error> {
    let description = &*description.choosing(frame.technique_index)?;
    let (mut plan, mut memory) = (FramePlan::default(), Memory::default());
    let workspace = &mut Workspace::default();
    plan_into(description, limits, frame, cached, workspace, &mut memory, &mut plan)?;
    Ok(plan)
}

/// Plans one frame into the memory of the light's earlier frames. The description has the frame's technique alone.
/// After an error no node records the plan.
pub(crate) fn plan_into(
    description: &Description,
    limits: Limits,
    frame: &Frame,
    cached: &Cached,
    workspace: &mut Workspace,
    memory: &mut Memory,
    plan: &mut FramePlan,
) -> Result<(), Error> {
    // An error must leave no stamp of the last frame, so that no node records a plan of both.
    plan.stamp = Stamp::default();
    let room = description.technique.room();
    frame.check(description, room)?;
    let light = room.turned(&frame.light);
    let frame = &Frame { light, ..*frame };
    let Workspace { graph, compiler, borders, largest, mesh_boxes } = workspace;
    let Memory { fit, camera, built, drawn } = memory;
    let request = FitRequest::of(&description.technique);
    fit.update(description, &request, frame, mesh_boxes)?;
    let camera_of_views = fit.camera(frame);
    plan.cut_outs.fill(&description.cut_outs, frame.meshes)?;
    plan.triangles.meshes.clear();
    if description.has_hierarchy() {
        plan.triangles.fill(description, frame.meshes, &plan.cut_outs)?;
    }
    let tree = description.has_hierarchy().then(|| TreeKey::of(&plan.triangles, frame));
    let (inputs, verdicts) =
        frame_inputs(description, frame, fit, &plan.triangles, &plan.cut_outs)?;
    graph.clear();
    let ids = build(graph, description, limits, &inputs);
    let occluder_clips = inputs.occluder_clips();
    let (receiver_view, views, needs) =
        (inputs.receivers, inputs.views.count() + inputs.occluders.len(), inputs.needs.bits());
    let side = inputs.occluders[0].map.side;
    let lit = inputs.needs.unshadowed().is_some();
    let (cut_outs, of_tree) = (inputs.cut_outs > 0, inputs.tree.0.decides());
    let (own, served) = (inputs.views.count(), inputs.occluders.len());
    let through_views = inputs.needs.technique.is_yes() || served > 1;
    // Description, needs and views decide which passes there are; only then can the cache leave some of them out.
    let before = built
        .take()
        .filter(|(of, shape)| of == description && shape.passes() == (needs, views, side));
    if before.is_none() {
        camera.find(graph, ids.pixels());
    }
    let revisions =
        Revisions { scene: frame.revision, view: frame.view_revision, camera: camera_of_views };
    plan.reuse = reuse::apply(graph, camera, lit, (&frame.visibility, tree), revisions, cached);
    let reuses = plan.reuse.uses();
    let shape = Shape { needs, views, side, reuses, cut_outs, tree: of_tree };
    plan.imports.clear();
    plan.imports.extend(imports(&ids, frame));
    fill_borders(borders, &plan.imports, ids.visibility, frame);
    let place = frame.border_barriers == BorderBarriers::Node;
    let same = before.as_ref().is_some_and(|(_, before)| *before == shape);
    compiler.compile(graph, borders, place, same, &mut plan.plan)?;
    // The compiler has exchanged graphs with the plan: make room for the next light's passes now.
    for (most, size) in largest.iter_mut().zip(plan.plan.graph.sizes()) {
        *most = size.max(*most);
    }
    graph.clear();
    graph.reserve(*largest);
    let of = before.map_or_else(|| description.clone(), |(of, _)| of);
    *built = Some((of, shape));
    plan.accesses.clear();
    for border in &*borders {
        plan.accesses.push(access_of(&plan.plan, border, &plan.imports, frame.light_index));
    }
    plan.visibility = ids.visibility;
    plan.sight = Sight::of(description, frame, fit, verdicts.situation());
    plan.verdicts = verdicts;
    plan.slot = frame.slot;
    (plan.light_index, plan.technique_index) = (frame.light_index, frame.technique_index);

    // Meshes that no pass reads in this frame are no accesses of it.
    if !plan
        .plan
        .steps
        .iter()
        .any(|s| matches!(plan.plan.graph.passes()[s.pass].work, Work::EachMesh { .. }))
    {
        plan.triangles.meshes.clear();
    }
    plan.views.clear();
    if through_views
        && served == fit.served.len()
        && (fit.parallel || own == 0)
        && (room.most_served() > 1 || room.takes_parallel())
    {
        plan.views.extend(fit.served.iter().map(PlannedView::of));
    }
    plan.why_views = if plan.views.is_empty() { Why::default() } else { fit.why_served };
    let maps = room.maps();
    let receiver_clips = match maps.layers.receiver_map {
        Some(_) => smallvec![receiver_view.clip_from_light()],
        None if maps.receivers_in_views => occluder_clips.clone(),
        None => Clips::new(),
    };
    let of = (fit.number(), occluder_clips, receiver_clips);
    if !same || drawn.as_ref() != Some(&of) {
        *drawn = None;
        fill_draws(plan, description, frame.meshes, fit, [&of.1, &of.2])?;
        *drawn = Some(of);
    }
    Ok(())
}

/// Fills the plan's lists of draws; a list that no pass draws stays empty.
fn fill_draws(
    plan: &mut FramePlan,
    description: &Description,
    meshes: &[MeshInstance],
    fit: &Fit,
    [occluder_clips, receiver_clips]: [&Clips; 2],
) -> Result<(), Error> {
    let FramePlan { plan, occluders, receivers, cut_outs, .. } = plan;
    for (list, draws, placed, clips) in [
        (MeshList::Occluders, occluders, &fit.occluders, occluder_clips),
        (MeshList::Receivers, receivers, &fit.receivers, receiver_clips),
    ] {
        match is_drawn(plan, list) {
            true => {
                let meshes = placed.places.iter().map(|&place| (place, &meshes[place as usize]));
                draws.fill(description, meshes, cut_outs, &fit.space_from_world, clips)?;
            }
            false => draws.clear(),
        }
    }
    Ok(())
}

/// Collects the host's scopes before and after the node for each shared image.
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

/// The graph's resources that stand for the host's images, with these images.
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
        lent(ids.normal, frame.normals),
        lent(ids.occluder_maps[0], maps.map(|m| m.front)),
        lent(ids.occluder_maps[1], maps.and_then(|m| m.back)),
        lent(ids.light_texture, frame.light_texture),
        lent(Some(ids.visibility), result),
    ]
    .into_iter()
    .flatten()
}

/// Whether a pass that runs draws the meshes of a list.
fn is_drawn(plan: &graph::Plan, list: MeshList) -> bool {
    plan.steps.iter().any(|step| match plan.graph.passes()[step.pass].work {
        Work::Raster { draw: Draw::Layer { layer, .. }, .. } => layer.meshes() == list,
        _ => false,
    })
}

/// The accesses to one image that node and host share.
fn access_of(
    plan: &graph::Plan,
    border: &Border,
    imports: &[(ResourceId, HostImage)],
    light_index: LightIndex,
) -> HostAccess {
    let resource = plan.graph.resource(border.resource);
    let used = plan.boundary.iter().find(|b| b.resource == border.resource);
    let host = imports.iter().find(|(id, _)| *id == border.resource);
    HostAccess {
        name: resource.name,
        image: host.map_or(vk::Image::null(), |(_, i)| i.image),
        layer: if host.is_none() { light_index.0 } else { 0 },
        aspect: graph::aspects(resource.shape),
        before: border.before,
        node: used.map(|b| NodeUse { entry: b.entry, exit: b.exit, writes: b.writes }),
        after: border.after,
    }
}
