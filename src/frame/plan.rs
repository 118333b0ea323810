//! From one frame to what it records.

use super::accesses::{self, BufferAccess, HostAccess, ImageBarrier, NodeUse};
use super::keep::{self, Keeping, Kept, Revisions};
use super::left::Whose;
use super::look::look;
use super::rows::{Limits, build, wanted};
use super::{
    BorderBarriers, Description, Frame, Geometry, HostImage, MeshBuffers, MeshInstance, Visibility,
};
use crate::graph::{self, Border, MeshList, ResourceId};
use crate::light::outline;
use crate::linear_light;
use crate::planner::Verdicts;
use crate::settings::Technique;
use crate::{Error, scene::Role};
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
    /// The meshes as each of some views sees them.
    fn new(
        description: &Description,
        meshes: &[MeshInstance],
        views: &[DMat4],
    ) -> Result<Self, Error> {
        let matrix =
            |clip: &DMat4, m: &MeshInstance| (*clip * m.world_from_mesh).as_mat4().to_cols_array();
        Ok(Self {
            clip_from_mesh: views
                .iter()
                .flat_map(|clip| meshes.iter().map(move |m| matrix(clip, m)))
                .collect(),
            meshes: meshes.iter().map(|m| draw_of(description, m)).collect::<Result<_, _>>()?,
        })
    }
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
    pub(crate) fn stamped(mut self, stamp: Stamp, own_visibility: vk::Image) -> Self {
        self.stamp = stamp;
        // Every image of the host's was checked to be none of these.
        for access in self.accesses.iter_mut().filter(|a| a.image == vk::Image::null()) {
            access.image = own_visibility;
        }
        self
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

/// As [`plan`], for a node in which earlier frames have left something.
pub(crate) fn plan_with(
    description: &Description,
    limits: Limits,
    frame: &Frame,
    kept: &Kept,
) -> Result<FramePlan, Error> {
    let description = &*description.choosing(frame.settings_index)?;
    frame.check(description)?;
    let turned = match description.settings.technique {
        Technique::LinearLight => linear_light::turned(&frame.light),
        _ => frame.light,
    };
    let outline = match turned == frame.light {
        true => frame.outline.map(<[_]>::to_vec),
        false => frame.outline.map(outline::quarter_turned),
    };
    let frame = &Frame { light: turned, outline: outline.as_deref(), ..*frame };
    let light = &frame.light;
    let of_role = |keep: fn(Role) -> bool| {
        let kept = frame.meshes.iter().filter(move |m| keep(m.role) && has_triangles(m));
        kept.copied().collect::<Vec<_>>()
    };
    let receivers = of_role(Role::receives);
    let mut occluders = of_role(Role::blocks);
    let (views, verdicts) = look(description, frame, &mut occluders, &receivers)?;
    let mut built = build(description, limits, light, &views);
    let pixels: Vec<_> = [Some(built.depth), built.mask].into_iter().flatten().collect();
    let revisions = Revisions { scene: frame.revision, view: frame.view_revision };
    let keeping = keep::apply(&mut built.graph, &pixels, &frame.visibility, revisions, kept);

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
        lent(built.light_texture, frame.light_texture),
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
    let wanted = wanted(&description.settings);
    let occluder_clips: Vec<_> =
        views.occluder_clips().into_iter().map(|clip| clip * to_light).collect();
    let receiver_clips = match (wanted.receiver_map, &views.receivers) {
        (Some(_), Some(view)) => vec![view.clip_from_light() * to_light],
        _ if description.settings.technique == Technique::LinearLight => occluder_clips.clone(),
        _ => Vec::new(),
    };
    Ok(FramePlan {
        accesses: borders
            .iter()
            .map(|b| access_of(&plan, b, &imports, frame.light_index))
            .collect(),
        plan,
        imports,
        visibility: built.visibility,
        slot: frame.slot,
        verdicts,
        light_index: frame.light_index,
        settings_index: frame.settings_index,
        stamp: Stamp::default(),
        keeping,
        occluders: DrawList::new(description, &occluders, &occluder_clips)?,
        receivers: if receiver_clips.is_empty() {
            DrawList::default()
        } else {
            DrawList::new(description, &receivers, &receiver_clips)?
        },
    })
}

pub(super) fn has_triangles(mesh: &MeshInstance) -> bool {
    match mesh.geometry {
        Geometry::Buffers(buffers) => buffers.count >= 3,
        Geometry::HostDrawn(_) => true,
    }
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
