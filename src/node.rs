//! The node: the host's whole view of the crate.

mod shown;

pub use shown::{Inspected, LayerPass, PassTime, PlanObject, VisibilityImage};

use crate::Error;
use crate::auto::{self, Auto, Choice};
use crate::frame::{
    self, Cache, CacheKey, Description, Frame, FramePlan, FramePlans, Limits, Memory, Stamp,
    Workspace,
};
use crate::gpu::{
    Allocator, Host, HostDraw, NodeObjects, Object, Requirements, ResourceBytes, Retired,
};
use crate::graph::{Draw, Graph, Layer, Owner, Pass, Shape, Target, Work};
use crate::lent::{LightIndex, Slot, TechniqueIndex};
use crate::stages::depth_layers;
use ash::vk;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Soft shadows as one node of the host's render graph.
///
/// Borrows the host's device and memory; records into the host's command buffers; never submits,
/// waits, allocates or panics while recording. Give it back with [`ShadowNode::destroy`] once the
/// device is done with its last frame: dropping it alone leaks its Vulkan objects, because only the
/// host knows when they are idle and whose allocator they came from.
pub struct ShadowNode {
    host: Host,
    description: Description,
    /// The description with each of its techniques alone.
    chosen: Vec<Description>,
    limits: Limits,
    objects: NodeObjects,
    /// The names of the kinds of row that the objects were made for, settings by settings.
    kinds: Vec<&'static str>,
    /// What plans for these objects carry.
    stamp: Stamp,
    /// What the node still holds from recorded frames.
    cache: Mutex<Cache>,
}

/// The next [`Stamp`]: no two nodes or sizes share one.
static STAMPS: AtomicU64 = AtomicU64::new(1);

fn next_stamp() -> Stamp {
    Stamp(STAMPS.fetch_add(1, Ordering::Relaxed))
}

impl ShadowNode {
    /// Makes every pipeline, image and buffer that frames of this description need.
    ///
    /// # Errors
    /// [`Error::Device`] with every gap of the device; [`Error::Setting`] or [`Error::Frame`] for a
    /// description that cannot work, or not on this device; [`Error::DeviceLost`], [`Error::Vulkan`] or
    /// [`Error::Memory`] where the driver or the allocator refuses. Nothing is left behind: every object is
    /// destroyed and every piece of memory given back.
    pub fn new(
        host: Host,
        allocator: &mut dyn Allocator,
        description: Description,
    ) -> Result<Self, Error> {
        let requirements = Requirements::of(&host);
        requirements.met()?;
        description.check()?;
        requirements.allow(&description)?;
        let limits =
            Limits { subpixel_step: 0.5f32.powi(requirements.sub_pixel_bits.min(16) as i32) };
        let graphs = graphs(&description, limits)?;
        let objects = NodeObjects::new(&host, allocator, &graphs, &description)?;
        let kinds = graphs.iter().flat_map(|graph| graph.kinds().map(|p| p.name)).collect();
        let cache = Mutex::new(Cache::new(description.lights, graphs.len()));
        let chosen = chosen(&description)?;
        Ok(Self { host, description, chosen, limits, objects, kinds, stamp: next_stamp(), cache })
    }

    fn cache(&self) -> MutexGuard<'_, Cache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the node was made for.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Plans one frame of one light; microseconds, no Vulkan calls. Plans of several lights are recorded
    /// in the order in which they were made.
    ///
    /// # Errors
    /// See [`frame::plan`].
    pub fn plan(&self, frame: &Frame) -> Result<FramePlan, Error> {
        let mut plan = FramePlan::default();
        self.plan_into(frame, &mut Workspace::default(), &mut Memory::default(), &mut plan)?;
        Ok(plan)
    }

    /// Plans the frames of several lights, in order, into plans that are kept from frame to frame: after the first one it
    /// takes no new memory, places a list of meshes that frames share once, and looks at them no more while their
    /// revision stays. Record them in that order.
    ///
    /// # Errors
    /// See [`frame::plan`]; the plans are then those of the frames before the one that is refused.
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
            // Says what is wrong.
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

    /// Records a plan into a command buffer of the host's: no submit, no wait, no allocation.
    ///
    /// What must hold of the command buffer and the plan's slot was promised at [`Host::borrow`].
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

    /// As [`Self::record`], with `draw` called for each mesh that the host draws, in each layer that
    /// shows it, between the node's own draws. [`Self::layer_pass`] says what its pipelines must fit.
    ///
    /// # Errors
    /// As [`Self::record`], but for [`Error::NeedsHostDraws`].
    pub fn record_with(
        &self,
        cmd: vk::CommandBuffer,
        plan: &FramePlan,
        draw: &mut dyn FnMut(&HostDraw),
    ) -> Result<(), Error> {
        if plan.stamp != self.stamp {
            return Err(Error::StalePlan("was made by another node, or before a resize"));
        }
        if cmd == vk::CommandBuffer::null() {
            return Err(Error::Frame("the command buffer to record into is a null handle".into()));
        }
        let mut cache = self.cache();
        if !cache.agrees(plan.cache_key(), &plan.reuse) {
            let why = "counts on maps or pixels that a frame recorded since has replaced";
            return Err(Error::StalePlan(why));
        }
        cache.recorded(plan.cache_key(), &plan.reuse);
        drop(cache);
        self.objects.record(&self.host, cmd, plan, draw);
        Ok(())
    }

    /// What a host's own pipeline must fit to draw into a layer; none where the technique has no such layer.
    pub fn layer_pass(&self, technique: TechniqueIndex, layer: Layer) -> Option<LayerPass> {
        let description = self.description.choosing(technique).ok()?;
        let graph = frame::all_passes(&description, self.limits);
        let draws = |p: &Pass| match p.work {
            Work::Raster { draw: Draw::Layer { layer: l, .. }, target, .. } => {
                l == layer && matches!(target, Target::Depth { .. })
            }
            _ => false,
        };
        let kind = graph.kinds().position(draws)?;
        let (render_pass, extent) = self.objects.render_pass(technique, kind)?;
        Some(LayerPass { render_pass, extent, raster: depth_layers::raster_of(layer) })
    }

    /// The node's own image that holds the result, another one after each resize; none where the host lends it.
    pub fn visibility(&self) -> Option<VisibilityImage> {
        let (image, view) = self.objects.result();
        let Description { extent, lights: layers, .. } = self.description;
        let owned = image != vk::Image::null();
        owned.then_some(VisibilityImage { image, view, extent, layers })
    }

    /// A 2D view of a light's layer of that image; none for a light that does not exist, or where the
    /// host lends the image.
    pub fn visibility_layer(&self, light: LightIndex) -> Option<vk::ImageView> {
        let view = self.objects.result_layer(light);
        (light.0 < self.description.lights && view != vk::ImageView::null()).then_some(view)
    }

    /// Makes what depends on the G-buffer's size anew and gives back what to retire. Pipelines stay,
    /// and so do the timings of frames in flight.
    ///
    /// # Errors
    /// As [`Self::new`]; the node then goes on at its old size, and plans made before still fit it.
    pub fn resize(
        &mut self,
        allocator: &mut dyn Allocator,
        extent: [u32; 2],
    ) -> Result<Retired, Error> {
        let description = Description { extent, ..self.description.clone() };
        description.check()?;
        Requirements::of(&self.host).allow(&description)?;
        let graphs = graphs(&description, self.limits)?;
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

    /// Makes everything anew for another description and gives back what to retire.
    ///
    /// # Errors
    /// As [`Self::new`]; the node then goes on as it was, and plans made before still fit it.
    pub fn reconfigure(
        &mut self,
        allocator: &mut dyn Allocator,
        description: Description,
    ) -> Result<Retired, Error> {
        let next = Self::new(self.host.clone(), allocator, description)?;
        let old = std::mem::replace(self, next);
        Ok(Retired::new(old.host, old.objects.into_owner()))
    }

    /// Asks `auto` what to compute the shadows of a frame's lights with, and makes the node anew where it was not made for
    /// that: the answers, light by light, and what to retire then. Each frame is told its settings. Call it before
    /// [`Self::plan`], with the frames of all lights.
    ///
    /// # Errors
    /// As [`Auto::choose_all`] and [`Self::new`]; the node then goes on as it was.
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
            // Beyond as many settings as a node may have, the first serve.
            frame.technique_index = TechniqueIndex(same.unwrap_or(0) as u32);
        }
        Ok((choices, retired))
    }

    /// What each pass took that `slot` recorded last for a light; none until the host knows that its commands are done,
    /// where no pass ran, where the queue family has no timestamps, or when the device is lost. Never waits.
    pub fn timings(&self, slot: Slot, light: LightIndex) -> Option<Vec<PassTime>> {
        let sums = self.objects.timings(&self.host, slot, light)?;
        Some(sums.into_iter().map(|(kind, ms)| PassTime { name: self.kinds[kind], ms }).collect())
    }

    /// The node's own images that a plan writes, and the layout they are in behind it; they can be
    /// copied out where the description says `inspect`.
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
                // A read-back has room for one layer.
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

    /// The image or buffer behind a resource of a plan's graph, by the resource's name, for tests and
    /// debuggers; none where no pass touches it, where the host lends it, and for the visibility image.
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

    /// Everything that the node holds in device memory: the visibility image, then the resources of each technique.
    pub fn memory(&self) -> Vec<ResourceBytes> {
        self.objects.memory()
    }

    /// What one of the techniques holds for the lights that choose it; nothing for one that does not exist.
    pub fn memory_of(&self, technique: TechniqueIndex) -> Vec<ResourceBytes> {
        self.objects.memory_of(technique)
    }

    /// How many Vulkan objects the node holds.
    pub fn object_count(&self) -> usize {
        self.objects.count()
    }

    /// Destroys everything. The device must be done with every frame that was recorded.
    pub fn destroy(self, allocator: &mut dyn Allocator) {
        Retired::new(self.host, self.objects.into_owner()).destroy(allocator);
    }
}

/// Every pass that any frame may run, for each of the description's techniques.
fn graphs(description: &Description, limits: Limits) -> Result<Vec<Graph>, Error> {
    let of = |index| {
        Ok(frame::all_passes(&*description.choosing(TechniqueIndex(index as u32))?, limits))
    };
    (0..description.all_techniques().count()).map(of).collect()
}

/// The description with each of its techniques alone.
fn chosen(description: &Description) -> Result<Vec<Description>, Error> {
    let of = |index| Ok(description.choosing(TechniqueIndex(index as u32))?.into_owned());
    (0..description.all_techniques().count()).map(of).collect()
}

/// A node may be shared by threads: each records slots of its own.
const _: () = {
    const fn shared<T: Send + Sync>() {}
    shared::<ShadowNode>();
    shared::<FramePlan>();
};
