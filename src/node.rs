//! The node: the host's whole view of the crate.

mod parts;
mod shown;

pub use shown::{Inspected, LayerPass, PassTime, PlanObject, VisibilityImage};

use crate::Error;
use crate::audit::MeasuredError;
use crate::auto::{self, Auto, Choice};
use crate::frame::{
    self, Cache, CacheKey, Description, Frame, FramePlan, FramePlans, Limits, Memory, Stamp,
    Workspace,
};
use crate::gpu::{
    Allocator, Host, HostDraw, NodeObjects, Object, Requirements, ResourceBytes, Retired,
};
use crate::graph::{Draw, Layer, Owner, Pass, Shape, Target, Work};
use crate::lent::{LightIndex, Slot, TechniqueIndex};
use crate::stages::depth_layers;
use ash::vk;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Soft shadows as one node of the host's render graph.
///
/// The node borrows the host's device and memory and records into the host's command buffers; while recording it never
/// submits, waits, allocates or panics. Call [`ShadowNode::destroy`] once the device has completed the node's last
/// frame. Dropping the node leaks its Vulkan objects, because only the host knows when they are idle and which
/// allocator they came from.
pub struct ShadowNode {
    host: Host,
    description: Description,
    /// The description once for each of its techniques, with that technique alone.
    chosen: Vec<Description>,
    limits: Limits,
    objects: NodeObjects,
    /// The names of the kinds of pass that the objects were made for, technique by technique.
    kinds: Vec<&'static str>,
    /// The mark of plans that were made for these objects.
    stamp: Stamp,
    /// What the node still holds from recorded frames.
    cache: Mutex<Cache>,
}

/// The next [`Stamp`]: no two nodes share one, and no two sizes of a node.
static STAMPS: AtomicU64 = AtomicU64::new(1);

fn next_stamp() -> Stamp {
    Stamp(STAMPS.fetch_add(1, Ordering::Relaxed))
}

impl ShadowNode {
    /// Creates every pipeline, image and buffer that frames of this description need.
    ///
    /// # Errors
    /// [`Error::Device`] with everything that the device lacks; [`Error::Setting`] or [`Error::Frame`] for a description
    /// that cannot work, or not on this device; [`Error::DeviceLost`], [`Error::Vulkan`] or [`Error::Memory`] where driver
    /// or allocator fail. After an error every object is destroyed and all memory is freed.
    pub fn new(
        host: Host,
        allocator: &mut dyn Allocator,
        description: Description,
    ) -> Result<Self, Error> {
        let limits = host.limits_for(&description)?;
        let graphs = frame::all_graphs(&description, limits)?;
        let objects = NodeObjects::new(&host, allocator, &graphs, &description)?;
        let kinds = graphs.iter().flat_map(|graph| graph.kinds().map(|p| p.name)).collect();
        let cache = Mutex::new(Cache::new(description.lights, graphs.len()));
        let chosen = chosen(&description)?;
        Ok(Self { host, description, chosen, limits, objects, kinds, stamp: next_stamp(), cache })
    }

    fn cache(&self) -> MutexGuard<'_, Cache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The description that the node was made for.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Plans one frame of one light, in microseconds and without Vulkan calls. Record the plans of several lights in
    /// the order in which they were made.
    ///
    /// # Errors
    /// See [`frame::plan`].
    pub fn plan(&self, frame: &Frame) -> Result<FramePlan, Error> {
        let mut plan = FramePlan::default();
        self.plan_into(frame, &mut Workspace::default(), &mut Memory::default(), &mut plan)?;
        Ok(plan)
    }

    /// Plans the frames of several lights, in order, into plans that the host keeps from frame to frame. After the
    /// first call it allocates no memory, visits a list of meshes that frames share once, and does not visit it while
    /// the frames' revision stays. Record the plans in that order.
    ///
    /// # Errors
    /// See [`frame::plan`]; `plans` then holds those of the frames before the refused one.
    pub fn plan_all(&self, frames: &[Frame], plans: &mut FramePlans) -> Result<(), Error> {
        plans.begin();
        frames.iter().try_for_each(|frame| {
            plans.add(|workspace, memory, plan| self.plan_into(frame, workspace, memory, plan))
        })
    }

    fn plan_into(
        &self,
        frame: &Frame,
        workspace: &mut Workspace,
        memory: &mut Memory,
        plan: &mut FramePlan,
    ) -> Result<(), Error> {
        let key = CacheKey { light: frame.light_index, technique: frame.technique_index };
        let cached = self.cache().for_plan(key);
        let chosen;
        let description = match self.chosen.get(frame.technique_index.0 as usize) {
            Some(description) => description,
            // Returns the error for an index beyond the last technique.
            None => {
                chosen = self.description.choosing(frame.technique_index)?;
                &*chosen
            }
        };
        frame::plan_into(description, self.limits, frame, &cached, workspace, memory, plan)?;
        self.cache().planned(key, &plan.reuse);
        plan.stamp(self.stamp, self.objects.result().0);
        Ok(())
    }

    /// Records a plan into a command buffer of the host, without submitting, waiting or allocating.
    ///
    /// The promises made at [`Host::borrow`] say what must hold for the command buffer and the plan's slot.
    ///
    /// # Errors
    /// [`Error::StalePlan`] where the plan was made by another node, before a resize, or counts on what has been
    /// replaced since; [`Error::NeedsHostDraws`] where it has meshes that the host draws; [`Error::Frame`] where there
    /// is no command buffer. Nothing is recorded then.
    pub fn record(&self, cmd: vk::CommandBuffer, plan: &FramePlan) -> Result<(), Error> {
        if plan.has_host_draws() {
            return Err(Error::NeedsHostDraws);
        }
        self.record_with(cmd, plan, &mut |_| {})
    }

    /// Records a plan with meshes that the host draws: calls `draw` for each of them in each layer that shows it,
    /// between the node's own draws. [`Self::layer_pass`] says what the host's pipelines must be compatible with.
    ///
    /// # Errors
    /// As [`Self::record`], but for [`Error::NeedsHostDraws`].
    pub fn record_with(
        &self,
        cmd: vk::CommandBuffer,
        plan: &FramePlan,
        draw: &mut dyn FnMut(&HostDraw),
    ) -> Result<(), Error> {
        self.record_parts(cmd, plan, None, draw)
    }

    /// The render pass and raster state that a host's own pipeline needs to draw into a layer of a technique; `None`
    /// where the technique has no such layer, or hosts do not draw into it.
    pub fn layer_pass(&self, technique: TechniqueIndex, layer: Layer) -> Option<LayerPass> {
        let description = self.description.choosing(technique).ok()?;
        let graph = frame::all_passes(&description, self.limits);
        let draws = |p: &Pass| match p.work {
            Work::Raster { draw: Draw::Layer { layer: l, .. }, fragment: None, target, .. } => {
                l == layer && matches!(target, Target::Depth { .. })
            }
            _ => false,
        };
        let kind = graph.kinds().position(draws)?;
        let (render_pass, extent) = self.objects.render_pass(technique, kind)?;
        Some(LayerPass { render_pass, extent, raster: depth_layers::raster_of(layer) })
    }

    /// The node's own visibility image, a new one after each resize; `None` where the host lends the image.
    pub fn visibility(&self) -> Option<VisibilityImage> {
        let (image, view) = self.objects.result();
        let Description { extent, lights: layers, .. } = self.description;
        let owned = image != vk::Image::null();
        owned.then_some(VisibilityImage { image, view, extent, layers })
    }

    /// A 2D image view of a light's layer of the node's visibility image; `None` for a light that does not exist, or
    /// where the host lends the image.
    pub fn visibility_layer(&self, light: LightIndex) -> Option<vk::ImageView> {
        let view = self.objects.result_layer(light);
        (light.0 < self.description.lights && view != vk::ImageView::null()).then_some(view)
    }

    /// Replaces every object that depends on the G-buffer's size, and returns the old ones to retire. Pipelines stay,
    /// and so do the timings of frames in flight.
    ///
    /// # Errors
    /// See [`Self::new`]; the node then keeps its old size, and accepts plans made before.
    pub fn resize(
        &mut self,
        allocator: &mut dyn Allocator,
        extent: [u32; 2],
    ) -> Result<Retired, Error> {
        let description = Description { extent, ..self.description.clone() };
        description.check()?;
        Requirements::of(&self.host).allow(&description)?;
        let graphs = frame::all_graphs(&description, self.limits)?;
        if !self.objects.keeps_pipelines(&graphs) {
            return self.reconfigure(allocator, description);
        }
        let chosen = chosen(&description)?;
        let old = self.objects.resize(&self.host, allocator, &graphs, &description)?;
        (self.description, self.chosen) = (description, chosen);
        self.stamp = next_stamp();
        self.cache().clear();
        Ok(Retired::new(self.host.clone(), old))
    }

    /// Replaces every object for another description, and returns the old ones to retire.
    ///
    /// # Errors
    /// See [`Self::new`]; the node then stays as it was, and accepts plans made before.
    pub fn reconfigure(
        &mut self,
        allocator: &mut dyn Allocator,
        description: Description,
    ) -> Result<Retired, Error> {
        let next = Self::new(self.host.clone(), allocator, description)?;
        let old = std::mem::replace(self, next);
        Ok(Retired::new(old.host, old.objects.into_owner()))
    }

    /// Lets `auto` choose a technique for each light and sets each frame's [`Frame::technique_index`]. Where the node
    /// lacks a chosen technique, every object is replaced. Returns the choices, light by light, and the objects to
    /// retire. Call it before [`Self::plan`], with the frames of all lights.
    ///
    /// # Errors
    /// See [`Auto::choose_all`] and [`Self::new`]; the node then stays as it was.
    pub fn adapt(
        &mut self,
        allocator: &mut dyn Allocator,
        auto: &mut Auto,
        frames: &mut [Frame],
    ) -> Result<(Vec<Choice>, Option<Retired>), Error> {
        let choices = auto.choose_all(&self.description, frames)?;
        let mut retired = None;
        let known = |c: &Choice| self.description.all_techniques().any(|t| *t == c.technique);
        if !choices.iter().all(known) {
            let (technique, other_techniques) = auto::distinct(&choices);
            let description =
                Description { technique, other_techniques, ..self.description.clone() };
            retired = Some(self.reconfigure(allocator, description)?);
        }
        for (frame, choice) in frames.iter_mut().zip(&choices) {
            let mut all = self.description.all_techniques();
            let same = all.position(|t| *t == choice.technique);
            // Where more are chosen than a node may have, the rest use the first.
            frame.technique_index = TechniqueIndex(same.unwrap_or(0) as u32);
        }
        Ok((choices, retired))
    }

    /// The time of each pass in the last frame of a light that was recorded for `slot`. `None` while the device has not
    /// completed that frame, where no pass ran, where the queue family has no timestamps, and when the device is lost.
    /// Never waits.
    pub fn timings(&self, slot: Slot, light: LightIndex) -> Option<Vec<PassTime>> {
        let sums = self.objects.timings(&self.host, slot, light)?;
        Some(sums.into_iter().map(|(kind, ms)| PassTime { name: self.kinds[kind], ms }).collect())
    }

    /// The error of a light's last frame that was recorded for `slot`, as its audit measured it
    /// ([`Description::audit`]). `None` while the device has not completed that frame, and where it ran no audit: the
    /// description has none, nothing can be shadowed, or the image stayed as it was. Never waits.
    pub fn measured_error(&self, slot: Slot, light: LightIndex) -> Option<MeasuredError> {
        self.objects.measured_error(slot, light)
    }

    /// The node's own images that a plan uses, with the layouts they are in after it. They can be copied out where
    /// [`Description::inspect`] is set.
    pub fn inspect(&self, plan: &FramePlan) -> Vec<Inspected> {
        let graph = &plan.plan.graph;
        let last_layout = |id| {
            let steps = plan.plan.steps.iter().rev();
            let mut uses = steps.flat_map(|s| &graph.passes()[s.pass].uses);
            uses.find(|u| u.resource == id).map(|u| u.access.scope().layout)
        };
        (0..graph.resources().len())
            .map(|index| graph.id(index))
            .filter(|&id| matches!(graph.resource(id).owner, Owner::Transient | Owner::Kept))
            .filter_map(|id| {
                let resource = graph.resource(id);
                // The read-back copies one layer.
                let Shape::Image { format, width, height, layers: None } = resource.shape else {
                    return None;
                };
                let layout = last_layout(id)?;
                let (image, _) = self.objects.image(plan.technique_index(), id);
                Some(Inspected {
                    name: resource.name,
                    image,
                    format,
                    extent: [width, height],
                    layout,
                })
            })
            .collect()
    }

    /// The image or buffer of a resource of a plan's graph, by the resource's name, for tests and debuggers; `None`
    /// where no pass uses it, where the host lends it, and for the visibility image.
    pub fn object(&self, plan: &FramePlan, name: &str) -> Option<PlanObject> {
        let graph = &plan.plan.graph;
        let mut ids = (0..graph.resources().len()).map(|index| graph.id(index));
        let id = ids.find(|&id| graph.resource(id).name == name)?;
        match (self.objects.get(plan.technique_index(), id), graph.resource(id).shape) {
            (Object::Image { image, view }, _) => Some(PlanObject::Image { image, view }),
            (Object::Buffer(buffer), Shape::Buffer { bytes }) => {
                Some(PlanObject::Buffer { buffer, bytes })
            }
            _ => None,
        }
    }

    /// The bytes of each image and buffer that the node holds in device memory: the visibility image, then those of
    /// each technique in turn.
    pub fn memory(&self) -> Vec<ResourceBytes> {
        self.objects.memory()
    }

    /// The bytes of the images and buffers of one technique, which its lights share; empty for a technique that does
    /// not exist.
    pub fn memory_of(&self, technique: TechniqueIndex) -> Vec<ResourceBytes> {
        self.objects.memory_of(technique)
    }

    /// How many Vulkan objects the node holds.
    pub fn object_count(&self) -> usize {
        self.objects.count()
    }

    /// Destroys every object and frees all memory. The device must have completed every recorded frame.
    pub fn destroy(self, allocator: &mut dyn Allocator) {
        Retired::new(self.host, self.objects.into_owner()).destroy(allocator);
    }
}

/// The description once for each of its techniques, with that technique alone.
fn chosen(description: &Description) -> Result<Vec<Description>, Error> {
    let of = |index| Ok(description.choosing(TechniqueIndex(index as u32))?.into_owned());
    (0..description.all_techniques().count()).map(of).collect()
}

/// Threads may share a node: each records its own slots.
const _: () = {
    const fn shared<T: Send + Sync>() {}
    shared::<ShadowNode>();
    shared::<FramePlan>();
};
