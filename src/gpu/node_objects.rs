//! All that a node holds on the device.

use super::descriptors::Descriptors;
use super::host::Host;
use super::memory::Allocator;
use super::objects::{Object, Objects};
use super::pipeline::RowPipeline;
use super::record::{HostDraw, Recorder};
use super::timing::Timing;
use crate::Error;
use crate::frame::{Description, FramePlan};
use crate::graph::{Graph, Pass, ResourceId, Shape, Work};
use ash::vk;
use std::ffi::CString;

/// Resources; pipelines, descriptor sets and labels for each kind of row; timestamps.
pub(crate) struct NodeObjects {
    objects: Objects,
    shapes: Vec<Shape>,
    rows: Vec<RowPipeline>,
    labels: Vec<CString>,
    descriptors: Descriptors,
    timing: Option<Timing>,
    slots: u32,
}

impl NodeObjects {
    /// Makes everything; nothing is left behind where that fails.
    pub fn new(
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        description: &Description,
    ) -> Result<Self, Error> {
        let objects = Objects::new(host, allocator, graph, description.inspect)?;
        let mut rows: Vec<RowPipeline> = Vec::with_capacity(graph.kinds().len());
        let made = graph
            .kinds()
            .try_for_each(|pass| {
                let strides = &description.position_strides;
                rows.push(RowPipeline::new(host, graph, pass, &objects, strides)?);
                Ok(())
            })
            .and_then(|()| {
                let slots = description.frames_in_flight;
                let descriptors = Descriptors::new(host, graph, &rows, slots)?;
                match Timing::new(host, slots, rows.len(), graph.passes().len()) {
                    Ok(timing) => Ok((descriptors, timing)),
                    Err(e) => {
                        descriptors.destroy(host);
                        Err(e)
                    }
                }
            });
        match made {
            Ok((descriptors, timing)) => Ok(Self {
                objects,
                shapes: graph.resources().iter().map(|r| r.shape).collect(),
                rows,
                labels: graph.kinds().map(|p| label(p.name)).collect(),
                descriptors,
                timing,
                slots: description.frames_in_flight,
            }),
            Err(e) => {
                rows.into_iter().for_each(|row| row.destroy(host));
                objects.destroy(host, allocator);
                Err(e)
            }
        }
    }

    /// Whether everything but images and buffers can stay for `graph`, which has the same rows: no
    /// target of a raster has another shape.
    pub fn keeps_pipelines(&self, graph: &Graph) -> bool {
        let rasters = graph.passes().iter().filter(|p| matches!(p.work, Work::Raster { .. }));
        rasters.flat_map(Pass::writes).all(|id| !self.changed(graph, id))
    }

    fn changed(&self, graph: &Graph, id: ResourceId) -> bool {
        self.shapes[id.index()] != graph.resource(id).shape
    }

    /// Makes images and buffers anew whose shape is another in `graph`, and gives back the old ones;
    /// nothing is changed where that fails.
    pub fn resize(
        &mut self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        inspect: bool,
    ) -> Result<Objects, Error> {
        let changed: Vec<_> =
            (0..self.shapes.len()).map(|i| self.changed(graph, graph.id(i))).collect();
        let changed = |id: ResourceId| changed[id.index()];
        let old = self.objects.remake(host, allocator, graph, changed, inspect)?;
        self.shapes = graph.resources().iter().map(|r| r.shape).collect();
        Ok(old)
    }

    /// What is behind a resource.
    #[cfg(feature = "headless")]
    pub fn get(&self, id: ResourceId) -> Object {
        self.objects.get(id)
    }

    /// The image behind a resource; null handles for what is no image.
    pub fn image(&self, id: ResourceId) -> (vk::Image, vk::ImageView) {
        match self.objects.get(id) {
            Object::Image { image, view } => (image, view),
            Object::Buffer(_) | Object::None => (vk::Image::null(), vk::ImageView::null()),
        }
    }

    /// Records a plan whose rows are the ones these objects were made for.
    pub fn record(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        plan: &FramePlan,
        draw: &mut dyn FnMut(&HostDraw),
    ) {
        Recorder {
            host,
            objects: &self.objects,
            rows: &self.rows,
            labels: &self.labels,
            descriptors: &self.descriptors,
            timing: self.timing.as_ref(),
            draw,
            cmd,
        }
        .record(plan);
    }

    /// The render pass of a kind of row and the size of its target; none for those that draw nothing.
    pub fn render_pass(&self, kind: usize) -> Option<(vk::RenderPass, vk::Extent2D)> {
        let row = self.rows.get(kind).filter(|r| r.render_pass != vk::RenderPass::null())?;
        Some((row.render_pass, row.extent))
    }

    /// Each kind of row that a slot recorded last, and the milliseconds of all of its rows.
    pub fn timings(&self, host: &Host, slot: u32) -> Option<Vec<(usize, f64)>> {
        self.timing.as_ref()?.read(host, slot)
    }

    /// Name and bytes of everything in device memory.
    pub fn memory(&self) -> Vec<(&'static str, u64)> {
        self.objects.memory().collect()
    }

    /// How many Vulkan objects there are, memory apart.
    pub fn count(&self) -> usize {
        let of_row = |r: &RowPipeline| {
            // layouts; then a render pass and a framebuffer where it draws
            2 + r.pipelines.len() + if r.render_pass == vk::RenderPass::null() { 0 } else { 2 }
        };
        let sets = self.rows.len() * self.slots as usize;
        let pools = 1 + if self.timing.is_some() { self.slots as usize } else { 0 };
        self.objects.count() + self.rows.iter().map(of_row).sum::<usize>() + sets + pools
    }

    /// Destroys everything; no command may use it any more.
    pub fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        if let Some(timing) = self.timing {
            timing.destroy(host);
        }
        self.descriptors.destroy(host);
        self.rows.into_iter().for_each(|row| row.destroy(host));
        self.objects.destroy(host, allocator);
    }
}

/// `antumbra.<name>`; names are literals without a zero byte.
fn label(name: &str) -> CString {
    CString::new(format!("antumbra.{name}")).unwrap_or_default()
}
