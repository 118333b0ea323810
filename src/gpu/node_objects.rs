//! All that a node holds on the device.

use super::graph_objects::GraphObjects;
use super::host::Host;
use super::memory::Allocator;
use super::objects::{Object, Remade};
use super::record::{HostDraw, Recorder};
use super::result::ResultImage;
use super::timing::Timing;
use crate::Error;
use crate::frame::{Description, FramePlan};
use crate::graph::{Graph, ResourceId};
use ash::vk;

/// The result and the timestamps, and for each of the settings what its graph needs.
pub(crate) struct NodeObjects {
    result: Option<ResultImage>,
    settings: Vec<GraphObjects>,
    timing: Option<Timing>,
    slots: u32,
    lights: u32,
}

/// What a resize made anew; then what that replaced.
#[derive(Default)]
pub(crate) struct Resized {
    result: Option<ResultImage>,
    settings: Vec<Remade>,
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
        let mut made = Self { result: None, settings: Vec::new(), timing: None, slots, lights };
        match made.make(host, allocator, graphs, description) {
            Ok(()) => Ok(made),
            Err(e) => {
                made.destroy(host, allocator);
                Err(e)
            }
        }
    }

    fn make(
        &mut self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graphs: &[Graph],
        description: &Description,
    ) -> Result<(), Error> {
        let places = self.slots * self.lights;
        self.result = ResultImage::new(host, allocator, description)?;
        for graph in graphs {
            let objects = GraphObjects::new(host, allocator, graph, description, places)?;
            self.settings.push(objects);
        }
        let rows = graphs.iter().map(|g| g.passes().len()).max().unwrap_or(0);
        self.timing = Timing::new(host, places, self.kinds_before(graphs.len()), rows)?;
        Ok(())
    }

    /// Kinds of row of all settings before one: where its own begin among those of all.
    fn kinds_before(&self, settings: usize) -> usize {
        self.settings[..settings].iter().map(|s| s.rows.len()).sum()
    }

    /// Where a light of a frame slot has its descriptor sets and timestamps.
    fn place(&self, slot: u32, light: u32) -> usize {
        (slot * self.lights + light) as usize
    }

    /// Whether everything but images and buffers can stay for `graphs`, which have the same rows: no
    /// target of a raster has another shape.
    pub fn keeps_pipelines(&self, graphs: &[Graph]) -> bool {
        self.settings.iter().zip(graphs).all(|(settings, graph)| settings.keeps_pipelines(graph))
    }

    /// Makes images and buffers anew whose shape is another in `graphs`, and gives back the old ones;
    /// nothing is changed where that fails.
    pub fn resize(
        &mut self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graphs: &[Graph],
        description: &Description,
    ) -> Result<Resized, Error> {
        let mut resized = Resized::default();
        if let Err(e) = self.remake(host, allocator, graphs, description, &mut resized) {
            resized.destroy(host, allocator);
            return Err(e);
        }
        std::mem::swap(&mut self.result, &mut resized.result);
        let pairs = self.settings.iter_mut().zip(&mut resized.settings);
        pairs.zip(graphs).for_each(|((settings, remade), graph)| settings.exchange(graph, remade));
        Ok(resized)
    }

    fn remake(
        &self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graphs: &[Graph],
        description: &Description,
        resized: &mut Resized,
    ) -> Result<(), Error> {
        resized.result = ResultImage::new(host, allocator, description)?;
        for (settings, graph) in self.settings.iter().zip(graphs) {
            let remade = settings.remake(host, allocator, graph, description.inspect)?;
            resized.settings.push(remade);
        }
        Ok(())
    }

    /// What is behind a resource of one of the settings.
    pub fn get(&self, settings: u32, id: ResourceId) -> Object {
        self.settings.get(settings as usize).map_or(Object::None, |s| s.get(id))
    }

    /// The image behind a resource of one of the settings; null handles for what is no image.
    pub fn image(&self, settings: u32, id: ResourceId) -> (vk::Image, vk::ImageView) {
        self.settings.get(settings as usize).map_or(Default::default(), |s| s.image(id))
    }

    /// The node's own visibility image and a view of all of it; null handles where the host lends it.
    pub fn result(&self) -> (vk::Image, vk::ImageView) {
        self.result.as_ref().map_or(Default::default(), ResultImage::image)
    }

    /// A view of a light's layer of it; null where the host lends it.
    pub fn result_layer(&self, light: u32) -> vk::ImageView {
        match self.result.as_ref().map(|result| result.layer(light)) {
            Some(Object::Image { view, .. }) => view,
            _ => vk::ImageView::null(),
        }
    }

    /// Records a plan whose rows are the ones that these objects were made for.
    pub fn record(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        plan: &FramePlan,
        draw: &mut dyn FnMut(&HostDraw),
    ) {
        let index = plan.technique_index as usize;
        let Some(settings) = self.settings.get(index) else { return };
        Recorder {
            host,
            objects: &settings.objects,
            result: self.result.as_ref(),
            rows: &settings.rows,
            labels: &settings.labels,
            descriptors: &settings.descriptors,
            timing: self.timing.as_ref(),
            place: self.place(plan.slot, plan.light_index),
            first_kind: self.kinds_before(index),
            draw,
            cmd,
        }
        .record(plan);
    }

    /// The render pass of a kind of row of one of the settings and the size of its target; none for
    /// those that draw nothing.
    pub fn render_pass(
        &self,
        settings: u32,
        kind: usize,
    ) -> Option<(vk::RenderPass, vk::Extent2D)> {
        self.settings.get(settings as usize)?.render_pass(kind)
    }

    /// Each kind of row that a light's frame recorded last with a slot, and the milliseconds of all of its
    /// rows; kinds are counted over all settings.
    pub fn timings(&self, host: &Host, slot: u32, light: u32) -> Option<Vec<(usize, f64)>> {
        let there = slot < self.slots && light < self.lights;
        self.timing.as_ref().filter(|_| there)?.read(host, self.place(slot, light))
    }

    /// Name and bytes of everything in device memory: the result, then settings by settings.
    pub fn memory(&self) -> Vec<(&'static str, u64)> {
        let result = self.result.iter().map(ResultImage::memory);
        result.chain(self.settings.iter().flat_map(GraphObjects::memory)).collect()
    }

    /// The same of one of the settings alone.
    pub fn memory_of(&self, settings: u32) -> Vec<(&'static str, u64)> {
        self.settings.get(settings as usize).map_or(Vec::new(), |s| s.memory().collect())
    }

    /// How many Vulkan objects there are, memory apart.
    pub fn count(&self) -> usize {
        let result = self.result.as_ref().map_or(0, ResultImage::count);
        let pools = if self.timing.is_some() { self.slots * self.lights } else { 0 };
        let settings = self.settings.iter().map(GraphObjects::count);
        result + pools as usize + settings.sum::<usize>()
    }

    /// Destroys everything; no command may use it any more.
    pub fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        if let Some(timing) = self.timing {
            timing.destroy(host);
        }
        for settings in self.settings {
            settings.destroy(host, allocator);
        }
        if let Some(result) = self.result {
            result.destroy(host, allocator);
        }
    }
}

impl Resized {
    /// Destroys it; no command may use it any more.
    pub fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        for settings in self.settings {
            settings.destroy(host, allocator);
        }
        if let Some(result) = self.result {
            result.destroy(host, allocator);
        }
    }
}
