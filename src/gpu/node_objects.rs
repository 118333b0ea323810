//! All Vulkan objects of a node.

use super::graph_objects::GraphObjects;
use super::host::Host;
use super::maker::Maker;
use super::measured::Measured;
use super::memory::{Allocator, ResourceBytes};
use super::objects::Object;
use super::owner::{Made, ObjectOwner};
use super::record::{HostDraw, Recorder};
use super::result::ResultImage;
use super::timing::Timing;
use crate::Error;
use crate::audit::MeasuredError;
use crate::frame::{Description, FramePlan, Part};
use crate::graph::{Graph, ResourceId};
use crate::lent::{LightIndex, Slot, TechniqueIndex};
use ash::vk;

/// The visibility image, the timestamps, the objects of each technique's graph, and the owner of them all.
pub(crate) struct NodeObjects {
    result: Option<ResultImage>,
    settings: Vec<GraphObjects>,
    timing: Option<Timing>,
    measured: Option<Measured>,
    slots: u32,
    lights: u32,
    owner: ObjectOwner,
}

impl NodeObjects {
    /// Creates all objects for the graphs of the description's techniques. Where that fails, those already created are
    /// destroyed.
    pub fn new(
        host: &Host,
        allocator: &mut dyn Allocator,
        graphs: &[Graph],
        description: &Description,
    ) -> Result<Self, Error> {
        let (slots, lights) = (description.frames_in_flight, description.lights);
        let places = slots * lights;
        let ((result, settings, timing, measured), owner) = Maker::run(host, allocator, |maker| {
            let result = ResultImage::new(maker, description)?;
            let settings = graphs.iter().map(|g| GraphObjects::new(maker, g, description, places));
            let settings = settings.collect::<Result<Vec<_>, _>>()?;
            let passes = graphs.iter().map(|g| g.passes().len()).max().unwrap_or(0);
            let timing = Timing::new(maker, places, kinds_of(&settings), passes)?;
            let measured = Measured::new(maker, graphs, description)?;
            Ok((result, settings, timing, measured))
        })?;
        Ok(Self { result, settings, timing, measured, slots, lights, owner })
    }

    /// The place of the descriptor sets and timestamps of a light in a frame slot.
    fn place(&self, slot: Slot, light: LightIndex) -> usize {
        (slot.0 * self.lights + light.0) as usize
    }

    /// Whether all objects but images and buffers can stay for `graphs`, which have the same passes: no attachment
    /// changes its shape.
    pub fn keeps_pipelines(&self, graphs: &[Graph]) -> bool {
        self.settings.iter().zip(graphs).all(|(settings, graph)| settings.keeps_pipelines(graph))
    }

    /// Replaces the visibility image, and the images and buffers whose shape differs in `graphs`, and returns the owner
    /// of the old ones. Where that fails, nothing changes.
    pub fn resize(
        &mut self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graphs: &[Graph],
        description: &Description,
    ) -> Result<ObjectOwner, Error> {
        let ((result, resized), owner) = Maker::run(host, allocator, |maker| {
            let result = ResultImage::new(maker, description)?;
            let pairs = self.settings.iter().zip(graphs);
            let resized = pairs.map(|(s, g)| s.objects.resized(maker, g, description.inspect));
            Ok((result, resized.collect::<Result<Vec<_>, _>>()?))
        })?;
        let mut replaced: Vec<Made> = self.result.iter().flat_map(ResultImage::handles).collect();
        self.result = result;
        for (settings, resized) in self.settings.iter_mut().zip(resized) {
            replaced.extend(settings.objects.replaced_by(&resized));
            settings.objects = resized;
        }
        Ok(self.owner.exchange(&replaced, owner))
    }

    /// The object of a resource of one of the techniques.
    pub fn get(&self, TechniqueIndex(settings): TechniqueIndex, id: ResourceId) -> Object {
        self.settings.get(settings as usize).map_or(Object::None, |s| s.objects.get(id))
    }

    /// The image of a resource of one of the techniques, with its view; null handles for a resource that is no image.
    pub fn image(&self, technique: TechniqueIndex, id: ResourceId) -> (vk::Image, vk::ImageView) {
        self.get(technique, id).image()
    }

    /// The node's own visibility image with a view of the whole of it; null handles where the host lends the image.
    pub fn result(&self) -> (vk::Image, vk::ImageView) {
        self.result.as_ref().map_or(Default::default(), ResultImage::image)
    }

    /// A view of a light's layer of the node's own visibility image; a null handle where the host lends the image.
    pub fn result_layer(&self, light: LightIndex) -> vk::ImageView {
        self.result.as_ref().map_or(Default::default(), |result| result.layer(light.0).image().1)
    }

    /// Records a plan for whose passes these objects were made, or a part of it.
    pub fn record(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        (plan, part): (&FramePlan, Option<Part>),
        draw: &mut dyn FnMut(&HostDraw),
    ) {
        let index = plan.technique_index().0 as usize;
        let Some(settings) = self.settings.get(index) else { return };
        Recorder {
            host,
            objects: &settings.objects,
            result: self.result.as_ref(),
            kinds: &settings.kinds,
            labels: &settings.labels,
            descriptors: &settings.descriptors,
            mesh_sets: &settings.mesh_sets,
            cut_out_sets: &settings.cut_out_sets,
            timing: self.timing.as_ref(),
            measured: self.measured.as_ref(),
            number: 0,
            place: self.place(plan.slot(), plan.light_index()),
            first_kind: kinds_of(&self.settings[..index]),
            draw,
            cmd,
        }
        .record(plan, part);
    }

    /// The render pass of a kind of pass of one of the techniques, and the size of its attachments; `None` for a kind
    /// that draws nothing.
    pub fn render_pass(
        &self,
        TechniqueIndex(settings): TechniqueIndex,
        kind: usize,
    ) -> Option<(vk::RenderPass, vk::Extent2D)> {
        self.settings.get(settings as usize)?.render_pass(kind)
    }

    /// The kinds of pass in the last frame that a light recorded for a slot, each with the milliseconds of all of its
    /// passes; kinds are counted over all techniques.
    pub fn timings(&self, host: &Host, slot: Slot, light: LightIndex) -> Option<Vec<(usize, f64)>> {
        let there = slot.0 < self.slots && light.0 < self.lights;
        self.timing.as_ref().filter(|_| there)?.read(host, self.place(slot, light))
    }

    /// The error of the last frame that a light recorded for a slot; `None` until the device has completed it.
    pub fn measured_error(&self, slot: Slot, light: LightIndex) -> Option<MeasuredError> {
        let there = slot.0 < self.slots && light.0 < self.lights;
        self.measured.as_ref().filter(|_| there)?.read(self.place(slot, light))
    }

    /// Name and bytes of each image and buffer in device memory: the visibility image, what the host reads, then
    /// technique by technique.
    pub fn memory(&self) -> Vec<ResourceBytes> {
        let result = self.result.iter().map(ResultImage::memory);
        let result = result.chain(self.measured.iter().map(Measured::memory));
        result.chain(self.settings.iter().flat_map(|s| s.objects.memory())).collect()
    }

    /// Name and bytes of each image and buffer of one of the techniques.
    pub fn memory_of(&self, TechniqueIndex(settings): TechniqueIndex) -> Vec<ResourceBytes> {
        self.settings.get(settings as usize).map_or(Vec::new(), |s| s.objects.memory().collect())
    }

    /// The number of Vulkan objects, without memory objects.
    pub fn count(&self) -> usize {
        self.owner.count() + self.settings.iter().map(|s| s.unowned).sum::<usize>()
    }

    /// The owner of all objects, to destroy them once no command uses them.
    pub fn into_owner(self) -> ObjectOwner {
        self.owner
    }
}

/// The number of kinds of pass of some techniques together.
fn kinds_of(settings: &[GraphObjects]) -> usize {
    settings.iter().map(|s| s.kinds.len()).sum()
}
