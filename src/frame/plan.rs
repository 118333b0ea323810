//! The plan of one frame.

use super::accesses::{self, BufferAccess, HostAccess, ImageBarrier, NodeUse};
use super::cache::CacheKey;
use super::cut_outs::CutOutList;
use super::doubts::{Doubt, Sight};
use super::draws::{DrawList, MeshDraw};
use super::reuse::Reuse;
use super::triangles::TriangleList;
use super::views::PlannedView;
use crate::effects::Verdicts;
use crate::graph::{self, MeshList, ResourceId, Why};
use crate::lent::{Geometry, HostImage, LightIndex, Slot, TechniqueIndex};
use crate::technique::Technique;
use ash::vk;

/// Identifies the node, and its size, that a plan was made for; 0 for a plan that no node made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Stamp(pub u64);

/// A part of a plan, for hosts that record it into two command buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The passes before the first that uses an image of the host: they draw and prefilter the maps of the light, and need
    /// nothing of the G-buffer. The node's own draws read the host's vertex buffers here.
    Light,
    /// The other passes, which use the host's images.
    Pixels,
}

/// The plan of one frame of one light: which passes run behind which barriers, and why; with which images and meshes.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    pub(crate) plan: graph::Plan,
    /// The host's images by resource.
    pub(crate) imports: Vec<(ResourceId, HostImage)>,
    pub(crate) visibility: ResourceId,
    pub(super) slot: Slot,
    pub(super) verdicts: Verdicts,
    pub(super) light_index: LightIndex,
    pub(super) technique_index: TechniqueIndex,
    pub(crate) stamp: Stamp,
    pub(crate) reuse: Reuse,
    pub(super) sight: Sight,
    /// The views that share the pixels, and why there are so many; empty where the technique has none.
    pub(super) views: Vec<PlannedView>,
    pub(super) why_views: Why,
    pub(super) accesses: Vec<HostAccess>,
    pub(super) occluders: DrawList,
    pub(super) receivers: DrawList,
    /// The meshes whose triangles a pass reads; empty where none does.
    pub(crate) triangles: TriangleList,
    /// The meshes that textures cut out.
    pub(crate) cut_outs: CutOutList,
}

impl Default for FramePlan {
    /// A plan of no frame, which no node records.
    fn default() -> Self {
        Self {
            plan: graph::Plan::default(),
            imports: Vec::new(),
            visibility: ResourceId::default(),
            slot: Slot(0),
            verdicts: Verdicts::judge(None, Technique::default().room(), None, false),
            light_index: LightIndex(0),
            technique_index: TechniqueIndex(0),
            stamp: Stamp::default(),
            reuse: Reuse::default(),
            sight: Sight::default(),
            views: Vec::new(),
            why_views: Why::default(),
            accesses: Vec::new(),
            occluders: DrawList::default(),
            receivers: DrawList::default(),
            triangles: TriangleList::default(),
            cut_outs: CutOutList::default(),
        }
    }
}

impl FramePlan {
    /// The passes, their barriers, and those that are skipped, as data.
    pub fn plan(&self) -> &graph::Plan {
        &self.plan
    }

    /// The passes that run, in order, and why each does.
    pub fn passes(&self) -> impl Iterator<Item = (&'static str, String)> + '_ {
        let graph = &self.plan.graph;
        self.plan.runs().into_iter().map(|run| (run.pass.name, graph.why(run.pass).to_string()))
    }

    /// The passes that do not run, and why not.
    pub fn skipped(&self) -> impl Iterator<Item = (&'static str, String)> + '_ {
        self.plan.reasons().map(|(pass, why)| (pass.name, why.to_string()))
    }

    /// How many steps of [`graph::Plan::steps`] are [`Part::Light`]'s; the others are [`Part::Pixels`]'s. Where several views
    /// share the maps, it is the first view's; where the host lends occluder maps, there may be none.
    pub fn light_steps(&self) -> usize {
        let graph = &self.plan.graph;
        let of_host = |u: &graph::Use| graph.resource(u.resource).owner.is_shared();
        let uses_host = |s: &graph::Step| graph.passes()[s.pass].uses.iter().any(of_host);
        self.plan.steps.iter().position(uses_host).unwrap_or(self.plan.steps.len())
    }

    /// Which effects are simulated, which are left out, and what each decision follows from.
    pub fn verdicts(&self) -> &Verdicts {
        &self.verdicts
    }

    /// The frame in flight.
    pub fn slot(&self) -> Slot {
        self.slot
    }

    /// The light that it is for.
    pub fn light_index(&self) -> LightIndex {
        self.light_index
    }

    /// The technique that it uses.
    pub fn technique_index(&self) -> TechniqueIndex {
        self.technique_index
    }

    /// The accesses to every image that node and host share: the host's last use before the node, the node's uses, if
    /// this frame has any, and the host's first use after it.
    pub fn accesses(&self) -> &[HostAccess] {
        &self.accesses
    }

    /// How the node uses an image that it shares with the host; `None` where this frame does not use it.
    pub fn use_of(&self, image: vk::Image) -> Option<NodeUse> {
        self.accesses.iter().find(|a| a.image == image)?.node
    }

    /// Everything in the frame that looks like a mistake and may be meant, such as a camera that shows the world
    /// mirrored; a frame that is in order has no doubts. Each [`Doubt`] is a sentence, and [`Self::explain`] begins
    /// with them.
    pub fn doubts(&self) -> &[Doubt] {
        self.sight.doubts()
    }

    /// The views through which the frame sees the light's occluders, and that share its pixels; the finest first. There
    /// are none where nothing can be shadowed, or the technique draws no maps from the light's centre or behind it.
    pub fn views(&self) -> &[PlannedView] {
        &self.views
    }

    /// Why there are as many views as there are; empty where there are none.
    pub fn why_views(&self) -> String {
        self.why_views.to_string()
    }

    /// A report for people: the doubts, which passes run and why, which do not and why not, how the camera is
    /// understood, the views of the light and why there are so many, and which effects are simulated or left out, with a bound on the error of each that is left out.
    pub fn explain(&self) -> String {
        let doubts: String =
            self.doubts().iter().map(|doubt| format!("doubt: {doubt}\n")).collect();
        let views: String = self.views.iter().map(|view| format!("  {view}\n")).collect();
        let views = match self.views.len() {
            0 => views,
            count => format!("views: {count}, since {}\n{views}", self.why_views),
        };
        format!("{doubts}{}\n{}\n{views}{}", self.plan.table(), self.sight, self.verdicts)
    }

    /// The barriers to record before the node, for a host that chose
    /// [`BorderBarriers::Host`](super::BorderBarriers::Host).
    pub fn entry_barriers(&self) -> impl Iterator<Item = ImageBarrier> + '_ {
        self.accesses.iter().filter_map(HostAccess::entry_barrier)
    }

    /// The barriers to record after the node, for a host that chose
    /// [`BorderBarriers::Host`](super::BorderBarriers::Host).
    pub fn exit_barriers(&self) -> impl Iterator<Item = ImageBarrier> + '_ {
        self.accesses.iter().filter_map(HostAccess::exit_barrier)
    }

    /// The vertex and index buffers that this frame reads, each once. The node records no barrier for them: the host
    /// must make what it wrote to them visible to these scopes.
    pub fn buffer_accesses(&self) -> Vec<BufferAccess> {
        let drawn = self.occluders.meshes.iter().chain(&self.receivers.meshes);
        accesses::of_buffers(drawn, &self.triangles.meshes, &self.cut_outs.sets)
    }

    /// The meshes of a list.
    pub fn meshes(&self, list: MeshList) -> &[MeshDraw] {
        &self.list(list).meshes
    }

    /// The meshes of a list with their matrices from mesh space, moved by [`MeshDraw::origin`], to the clip space of one of
    /// the list's views, column-major. Empty for a view that does not exist.
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

    /// Whether the host has to draw some of the plan's meshes.
    pub fn has_host_draws(&self) -> bool {
        let mut all = self.occluders.meshes.iter().chain(&self.receivers.meshes);
        all.any(|d| matches!(d.mesh.geometry, Geometry::HostDrawn(_)))
    }

    /// Where its results lie in the node's cache.
    pub(crate) fn cache_key(&self) -> CacheKey {
        CacheKey { light: self.light_index, technique: self.technique_index }
    }

    /// Marks the plan as made for a node, and fills in the node's own visibility image.
    pub(crate) fn stamp(&mut self, stamp: Stamp, own_visibility: vk::Image) {
        self.stamp = stamp;
        // Null handles stand for the node's own image: those of lent images were refused.
        for access in self.accesses.iter_mut().filter(|a| a.image == vk::Image::null()) {
            access.image = own_visibility;
        }
    }
}
