//! All that a node holds on the device.

use super::descriptors::Descriptors;
use super::host::Host;
use super::memory::Allocator;
use super::objects::{Object, Objects};
use super::pipeline::RowPipeline;
use super::record::Recorder;
use super::timing::Timing;
use crate::Error;
use crate::frame::{Description, FramePlan};
use crate::graph::{Graph, ResourceId, Shape};
use ash::vk;
use std::ffi::CString;

/// Resources, pipelines, descriptor sets, timestamps and labels, row by row.
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
        let mut rows: Vec<RowPipeline> = Vec::with_capacity(graph.passes().len());
        let made = graph
            .passes()
            .iter()
            .try_for_each(|pass| {
                let strides = &description.position_strides;
                rows.push(RowPipeline::new(host, graph, pass, &objects, strides)?);
                Ok(())
            })
            .and_then(|()| {
                let slots = description.frames_in_flight;
                let descriptors = Descriptors::new(host, graph, &rows, slots)?;
                match Timing::new(host, slots, rows.len()) {
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
                labels: graph.passes().iter().map(|p| label(p.name)).collect(),
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

    /// The shape that a resource was made with.
    pub fn shape(&self, id: ResourceId) -> Shape {
        self.shapes[id.index()]
    }

    /// The image behind a resource; null handles for what is no image.
    pub fn image(&self, id: ResourceId) -> (vk::Image, vk::ImageView) {
        match self.objects.get(id) {
            Object::Image { image, view } => (image, view),
            Object::Buffer(_) | Object::None => (vk::Image::null(), vk::ImageView::null()),
        }
    }

    /// Records a plan whose rows are the ones these objects were made for.
    pub fn record(&mut self, host: &Host, cmd: vk::CommandBuffer, plan: &FramePlan) {
        Recorder {
            host,
            objects: &self.objects,
            rows: &self.rows,
            labels: &self.labels,
            descriptors: &mut self.descriptors,
            timing: self.timing.as_mut(),
            cmd,
        }
        .record(plan);
    }

    /// Row and milliseconds of what a slot recorded last.
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

/// What a resize or a reconfiguration replaced: alive until the frames that use it are done.
#[must_use = "destroy it once the frames recorded before are done, or its memory is lost"]
pub struct Retired {
    host: Host,
    objects: NodeObjects,
}

impl Retired {
    pub(crate) fn new(host: Host, objects: NodeObjects) -> Self {
        Self { host, objects }
    }

    /// Destroys it; the device must be done with every frame recorded before the replacement.
    pub fn destroy(self, allocator: &mut dyn Allocator) {
        self.objects.destroy(&self.host, allocator);
    }
}
