//! All that a node has on the device.

use super::graph_objects::GraphObjects;
use super::host::Host;
use super::maker::Maker;
use super::memory::{Allocator, ResourceBytes};
use super::objects::Object;
use super::owner::{Made, ObjectOwner};
use super::record::{HostDraw, Recorder};
use super::result::ResultImage;
use super::timing::Timing;
use crate::Error;
use crate::frame::{Description, FramePlan};
use crate::graph::{Graph, ResourceId};
use crate::lent::{LightIndex, Slot, TechniqueIndex};
use ash::vk;

/// The result and the timestamps, what the graph of each of the settings needs, and the owner of it all.
pub(crate) struct NodeObjects {
    result: Option<ResultImage>,
    settings: Vec<GraphObjects>,
    timing: Option<Timing>,
    slots: u32,
    lights: u32,
    owner: ObjectOwner,
}

impl NodeObjects {
    /// Makes everything, for the graphs of the description's settings; nothing is left behind where
    /// that fails.
    pub fn new(
        host: &Host,
        allocator: &mut dyn Allocator,
        graphs: &[Graph],
        description: &Description,
    ) -> Result<Self, Error> {
        let (slots, lights) = (description.frames_in_flight, description.lights);
        let places = slots * lights;
        let ((result, settings, timing), owner) = Maker::run(host, allocator, |maker| {
            let result = ResultImage::new(maker, description)?;
            let settings = graphs.iter().map(|g| GraphObjects::new(maker, g, description, places));
            let settings = settings.collect::<Result<Vec<_>, _>>()?;
            let passes = graphs.iter().map(|g| g.passes().len()).max().unwrap_or(0);
            let timing = Timing::new(maker, places, kinds_of(&settings), passes)?;
            Ok((result, settings, timing))
        })?;
        Ok(Self { result, settings, timing, slots, lights, owner })
    }

    /// Where a light of a frame slot has its descriptor sets and timestamps.
    fn place(&self, slot: Slot, light: LightIndex) -> usize {
        (slot.0 * self.lights + light.0) as usize
    }

    /// Whether everything but images and buffers can stay for `graphs`, which have the same passes: no
    /// target of a raster has another shape.
    pub fn keeps_pipelines(&self, graphs: &[Graph]) -> bool {
        self.settings.iter().zip(graphs).all(|(settings, graph)| settings.keeps_pipelines(graph))
    }

    /// Makes the result anew, and the images and buffers whose shape is another in `graphs`, and
    /// returns the owner of the old ones; nothing is changed where that fails.
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

    /// What is behind a resource of one of the settings.
    pub fn get(&self, TechniqueIndex(settings): TechniqueIndex, id: ResourceId) -> Object {
        self.settings.get(settings as usize).map_or(Object::None, |s| s.objects.get(id))
    }

    /// The image behind a resource of one of the settings; null handles for what is no image.
    pub fn image(&self, technique: TechniqueIndex, id: ResourceId) -> (vk::Image, vk::ImageView) {
        self.get(technique, id).image()
    }

    /// The node's own visibility image and a view of all of it; null handles where the host lends it.
    pub fn result(&self) -> (vk::Image, vk::ImageView) {
        self.result.as_ref().map_or(Default::default(), ResultImage::image)
    }

    /// A view of a light's layer of it; null where the host lends it.
    pub fn result_layer(&self, light: LightIndex) -> vk::ImageView {
        self.result.as_ref().map_or(Default::default(), |result| result.layer(light.0).image().1)
    }

    /// Records a plan whose passes are the ones that these objects were made for.
    pub fn record(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        plan: &FramePlan,
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
            timing: self.timing.as_ref(),
            place: self.place(plan.slot(), plan.light_index()),
            first_kind: kinds_of(&self.settings[..index]),
            draw,
            cmd,
        }
        .record(plan);
    }

    /// The render pass of a kind of pass of one of the settings and the size of its target; none for
    /// those that draw nothing.
    pub fn render_pass(
        &self,
        TechniqueIndex(settings): TechniqueIndex,
        kind: usize,
    ) -> Option<(vk::RenderPass, vk::Extent2D)> {
        self.settings.get(settings as usize)?.render_pass(kind)
    }

    /// Each kind of pass that a light's frame recorded last with a slot, and the milliseconds of all of
    /// its passes; kinds are counted over all settings.
    pub fn timings(&self, host: &Host, slot: Slot, light: LightIndex) -> Option<Vec<(usize, f64)>> {
        let there = slot.0 < self.slots && light.0 < self.lights;
        self.timing.as_ref().filter(|_| there)?.read(host, self.place(slot, light))
    }

    /// Name and bytes of everything in device memory: the result, then settings by settings.
    pub fn memory(&self) -> Vec<ResourceBytes> {
        let result = self.result.iter().map(ResultImage::memory);
        result.chain(self.settings.iter().flat_map(|s| s.objects.memory())).collect()
    }

    /// Name and bytes of what one of the settings has in device memory.
    pub fn memory_of(&self, TechniqueIndex(settings): TechniqueIndex) -> Vec<ResourceBytes> {
        self.settings.get(settings as usize).map_or(Vec::new(), |s| s.objects.memory().collect())
    }

    /// How many Vulkan objects there are, memory apart.
    pub fn count(&self) -> usize {
        self.owner.count() + self.settings.iter().map(|s| s.unowned).sum::<usize>()
    }

    /// The owner of everything, for when no command uses it any more.
    pub fn into_owner(self) -> ObjectOwner {
        self.owner
    }
}

/// How many kinds of pass some settings have in all.
fn kinds_of(settings: &[GraphObjects]) -> usize {
    settings.iter().map(|s| s.kinds.len()).sum()
}
