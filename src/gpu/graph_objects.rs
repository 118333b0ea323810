//! What a node holds on the device for one of its settings.

use super::descriptors::Descriptors;
use super::host::Host;
use super::memory::Allocator;
use super::objects::{Object, Objects, Remade};
use super::pipeline::RowPipeline;
use crate::Error;
use crate::frame::Description;
use crate::graph::{Graph, Pass, ResourceId, Shape, Work};
use ash::vk;
use std::ffi::CString;

/// The resources of a graph; pipelines, descriptor sets and labels for each kind of its rows.
pub(crate) struct GraphObjects {
    pub objects: Objects,
    shapes: Vec<Shape>,
    pub rows: Vec<RowPipeline>,
    pub labels: Vec<CString>,
    pub descriptors: Descriptors,
    sets: usize,
}

impl GraphObjects {
    /// Makes everything, with descriptor sets for so many places; nothing is left behind where that
    /// fails.
    pub fn new(
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        description: &Description,
        places: u32,
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
            .and_then(|()| Descriptors::new(host, graph, &rows, places));
        match made {
            Ok(descriptors) => Ok(Self {
                objects,
                shapes: graph.resources().iter().map(|r| r.shape).collect(),
                labels: graph.kinds().map(|p| label(p.name)).collect(),
                descriptors,
                sets: rows.len() * places as usize,
                rows,
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

    /// Makes images and buffers anew whose shape is another in `graph`, to be exchanged; nothing is left
    /// behind where that fails.
    pub fn remake(
        &self,
        host: &Host,
        allocator: &mut dyn Allocator,
        graph: &Graph,
        inspect: bool,
    ) -> Result<Remade, Error> {
        let changed: Vec<_> =
            (0..self.shapes.len()).map(|i| self.changed(graph, graph.id(i))).collect();
        let changed = |id: ResourceId| changed[id.index()];
        self.objects.remake(host, allocator, graph, changed, inspect)
    }

    /// Takes what was made anew for `graph`, and leaves there what that replaces.
    pub fn exchange(&mut self, graph: &Graph, remade: &mut Remade) {
        self.objects.exchange(remade);
        self.shapes = graph.resources().iter().map(|r| r.shape).collect();
    }

    /// What is behind a resource.
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

    /// The render pass of a kind of row and the size of its target; none for those that draw nothing.
    pub fn render_pass(&self, kind: usize) -> Option<(vk::RenderPass, vk::Extent2D)> {
        let row = self.rows.get(kind).filter(|r| r.render_pass != vk::RenderPass::null())?;
        Some((row.render_pass, row.extent))
    }

    /// Name and bytes of everything in device memory.
    pub fn memory(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        self.objects.memory()
    }

    /// How many Vulkan objects there are, memory apart.
    pub fn count(&self) -> usize {
        let of_row = |r: &RowPipeline| {
            // layouts; then a render pass and a framebuffer where it draws
            2 + r.pipelines.len() + if r.render_pass == vk::RenderPass::null() { 0 } else { 2 }
        };
        // The sets' pool too.
        self.objects.count() + self.rows.iter().map(of_row).sum::<usize>() + self.sets + 1
    }

    /// Destroys everything; no command may use it any more.
    pub fn destroy(self, host: &Host, allocator: &mut dyn Allocator) {
        self.descriptors.destroy(host);
        self.rows.into_iter().for_each(|row| row.destroy(host));
        self.objects.destroy(host, allocator);
    }
}

/// `antumbra.<name>`; names are literals without a zero byte.
fn label(name: &str) -> CString {
    CString::new(format!("antumbra.{name}")).unwrap_or_default()
}
