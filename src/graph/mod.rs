//! The render graph as pure data: no Vulkan calls, tested without a device.
//!
//! ```text
//!  Graph   resources + passes: every pass that a technique may run, in order
//!    │ compile: drop passes that the frame does not need or whose output nobody reads
//!    ▼
//!  Plan    steps = barriers + pass; the host's accesses on entry and exit; what was skipped, and why
//!    │ gpu::record
//!    ▼
//!  vkCmd*
//! ```

mod access;
mod barrier;
mod pass;
mod plan;
mod resource;
mod show;
mod sync2;
mod why;

pub use access::{Access, Scope};
pub use barrier::{Barrier, State};
pub use pass::{
    COLOR_ATTACHMENTS, Draw, INVOCATIONS, Layer, MeshList, Need, PUSH_BYTES, Pass, Push, Reason,
    STORAGE_BYTES, Target, Use, Uses, Work,
};
pub(crate) use plan::Compiler;
pub use plan::{Barriers, Border, BoundaryUse, Plan, ResourceBarrier, Skipped, Step, compile};
pub(crate) use resource::aspects;
pub use resource::{Owner, Resource, ResourceId, Shape, Until, is_color_format, is_depth_format};
pub use show::Run;
pub use why::{Part, Why};

use ash::vk;
use pass::CUT_OUTS_BINDING;
use std::ops::Range;

/// Resources, and the passes that use them in the order in which they may run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    resources: Vec<Resource>,
    passes: Vec<Pass>,
    reasons: Vec<Why>,
    /// The kind of each pass.
    kinds: Vec<u16>,
    /// The index of the first pass of each kind.
    firsts: Vec<usize>,
    /// The resources that are still to be declared again; see [`Self::again`].
    again: Range<usize>,
    /// The buffer of the meshes that textures cut out; `None` where the description has none.
    cut_outs: Option<ResourceId>,
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Self {
        Self::default()
    }

    /// Declares a 2D image.
    pub fn image(
        &mut self,
        name: &'static str,
        format: vk::Format,
        [width, height]: [u32; 2],
        owner: Owner,
    ) -> ResourceId {
        let shape = Shape::Image { format, width, height, layers: None };
        self.add(Resource { name, shape, owner, until: None })
    }

    /// Declares a transient array image of at least one layer. Shaders see all of its layers, and a barrier covers all
    /// of them.
    pub fn image_array(
        &mut self,
        name: &'static str,
        format: vk::Format,
        [width, height]: [u32; 2],
        layers: u32,
    ) -> ResourceId {
        let shape = Shape::Image { format, width, height, layers: Some(layers.max(1)) };
        self.add(Resource { name, shape, owner: Owner::Transient, until: None })
    }

    /// Declares a transient buffer of at least 16 bytes: a buffer that small maps leave empty has to be bound all the
    /// same.
    pub fn buffer(&mut self, name: &'static str, bytes: u64) -> ResourceId {
        let shape = Shape::Buffer { bytes: bytes.max(16) };
        self.add(Resource { name, shape, owner: Owner::Transient, until: None })
    }

    /// Declares a buffer of at least 16 bytes that the node reads on the host once the device has completed the frame.
    pub fn host_read_buffer(&mut self, name: &'static str, bytes: u64) -> ResourceId {
        let shape = Shape::Buffer { bytes: bytes.max(16) };
        self.add(Resource { name, shape, owner: Owner::HostRead, until: None })
    }

    /// Makes the content of a transient resource stay for later frames.
    pub fn keep(&mut self, id: ResourceId) {
        if let Some(resource) = self.resources.get_mut(id.index()) {
            resource.owner = Owner::Kept;
        }
    }

    /// Makes the content of a resource stay for the frames of all lights, until the meshes are other ones or elsewhere.
    pub fn keep_until(&mut self, id: ResourceId, until: Until) {
        self.keep(id);
        if let Some(resource) = self.resources.get_mut(id.index()) {
            resource.until = Some(until);
        }
    }

    /// How long the results of a pass are valid; `None` where they depend on the light or the camera.
    ///
    /// What it writes for passes of its own kind alone counts for nothing.
    pub fn until(&self, pass: &Pass) -> Option<Until> {
        pass.writes().find_map(|id| self.resource(id).until)
    }

    /// Marks the passes for whose index `which` holds as not needed, for a reason.
    pub(crate) fn leave_out(&mut self, which: impl Fn(usize) -> bool, why: impl Into<Why>) {
        let why = self.because(why);
        let passes = self.passes.iter_mut().enumerate().filter(|(place, _)| which(*place));
        for (_, pass) in passes.filter(|(_, p)| p.need.is_yes()) {
            pass.need = Need::No(why);
        }
    }

    /// Adds a reason that passes may refer to.
    pub fn because(&mut self, why: impl Into<Why>) -> Reason {
        // A graph has a few reasons for all of its passes.
        let reason = Reason(self.reasons.len() as u16);
        self.reasons.push(why.into());
        reason
    }

    /// Adds the reason of a need, and returns the need that refers to it.
    pub fn need(&mut self, need: &Need<Why>) -> Need {
        match need {
            Need::Yes(why) => Need::Yes(self.because(*why)),
            Need::No(why) => Need::No(self.because(*why)),
        }
    }

    /// Why a pass is needed, or is not.
    pub fn why(&self, pass: &Pass) -> Why {
        let (Need::Yes(Reason(place)) | Need::No(Reason(place))) = pass.need;
        self.reasons.get(usize::from(place)).copied().unwrap_or_default()
    }

    /// Removes everything and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.resources.clear();
        self.reasons.clear();
        self.passes.clear();
        self.kinds.clear();
        self.firsts.clear();
        self.again = 0..0;
        self.cut_outs = None;
    }

    /// How many resources, reasons, passes and kinds of them there are.
    pub(crate) fn sizes(&self) -> [usize; 4] {
        [self.resources.len(), self.reasons.len(), self.passes.len(), self.firsts.len()]
    }

    /// Reserves memory for a graph of these sizes.
    pub(crate) fn reserve(&mut self, [resources, reasons, passes, kinds]: [usize; 4]) {
        self.resources.reserve(resources);
        self.reasons.reserve(reasons);
        self.passes.reserve(passes);
        self.kinds.reserve(passes);
        self.firsts.reserve(kinds);
    }

    /// Whether two graphs differ in push constants, grids and reasons alone: then they run the same passes behind the
    /// same barriers.
    #[cfg(test)]
    pub(super) fn differs_in_numbers_alone(&self, other: &Self) -> bool {
        let same = |(a, b): (&Pass, &Pass)| a.does_work_of(b) && a.need.is_yes() == b.need.is_yes();
        self.resources == other.resources
            && self.passes.len() == other.passes.len()
            && self.passes.iter().zip(&other.passes).all(same)
    }

    /// The number of resources that are declared.
    pub(crate) fn declared(&self) -> usize {
        self.resources.len()
    }

    /// Makes the next declarations stand for the resources from the `first` on, which are declared again in the same
    /// order and form: what follows is done once more, with other numbers, on the same resources.
    pub(crate) fn again(&mut self, first: usize) {
        self.again = first..self.resources.len();
    }

    /// Makes the next declarations those of new resources.
    pub(crate) fn declares_anew(&mut self) {
        self.again = 0..0;
    }

    fn add(&mut self, resource: Resource) -> ResourceId {
        if let Some(index) = self.again.next() {
            let Resource { name, shape, .. } = self.resources[index];
            debug_assert_eq!((name, shape), (resource.name, resource.shape));
            return self.id(index);
        }
        // A graph has tens of resources; the id would wrap at 65536.
        let id = ResourceId(self.resources.len() as u16);
        self.resources.push(resource);
        id
    }

    /// Declares the buffer of the meshes that textures cut out, and the pass that writes it. Passes that draw meshes, and
    /// are appended after this, read it.
    pub(crate) fn cut_outs(&mut self, bytes: u64, need: &Need) {
        let buffer = self.buffer("cut_outs.meshes", bytes);
        // Frames whose maps are kept, or without such meshes, do not write it.
        self.keep(buffer);
        let uses = smallvec::smallvec![Use::fixed(buffer, Access::TransferWrite)];
        let work = Work::CutOuts;
        let pass = Pass { name: "cut_outs.write", uses, push: Push::NONE, work, need: *need };
        self.push(pass);
        self.cut_outs = Some(buffer);
    }

    /// Appends a pass.
    pub fn push(&mut self, mut pass: Pass) {
        if let (Some(cut_outs), Work::Raster { cut: Some(_), .. }) = (self.cut_outs, pass.work) {
            pass.uses.push(Use::bound(CUT_OUTS_BINDING, cut_outs, Access::BufferReadVertex));
        }
        // Repeated passes come close together, so the search ends soon.
        let known = self.firsts.iter().rposition(|&first| self.passes[first].name == pass.name);
        let kind = known.unwrap_or_else(|| {
            self.firsts.push(self.passes.len());
            self.firsts.len() - 1
        });
        self.kinds.push(kind as u16);
        self.passes.push(pass);
    }

    /// The kind of the pass at an index: passes of one name are of one kind, counted from 0 in the order in which names
    /// first appear.
    pub fn kind_of(&self, place: usize) -> usize {
        usize::from(self.kinds[place])
    }

    /// The first pass of each kind.
    pub fn kinds(&self) -> impl ExactSizeIterator<Item = &Pass> {
        self.firsts.iter().map(|&place| &self.passes[place])
    }

    /// A pass that the descriptors and the pipeline of its kind's first pass do not serve; `None` where there is none.
    pub(super) fn mismatched_pass(&self) -> Option<&Pass> {
        let mut passes = self.passes.iter().zip(&self.kinds);
        let first = |kind: u16| &self.passes[self.firsts[usize::from(kind)]];
        passes.find(|(pass, kind)| !pass.is_kind_of(first(**kind))).map(|(pass, _)| pass)
    }

    /// All resources, at the indices of [`ResourceId::index`].
    pub fn resources(&self) -> &[Resource] {
        &self.resources
    }

    /// One resource.
    pub fn resource(&self, id: ResourceId) -> &Resource {
        &self.resources[id.index()]
    }

    /// The id of the resource at an index in [`Self::resources`].
    pub fn id(&self, index: usize) -> ResourceId {
        ResourceId(index as u16)
    }

    /// All passes, including those that are not needed.
    pub fn passes(&self) -> &[Pass] {
        &self.passes
    }

    /// The accesses of all passes, needed or not, to a resource.
    pub fn uses_of(&self, id: ResourceId) -> impl Iterator<Item = Access> + '_ {
        self.passes.iter().flat_map(|p| &p.uses).filter(move |u| u.resource == id).map(|u| u.access)
    }
}
