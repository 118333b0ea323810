//! The Vulkan objects of a node for one of its techniques.

use super::descriptors::Descriptors;
use super::maker::Maker;
use super::mesh_sets::{CutOutSets, MeshSets};
use super::objects::Objects;
use super::pipeline::PassObjects;
use crate::Error;
use crate::frame::Description;
use crate::graph::{Graph, Pass, Work};
use ash::vk;
use std::ffi::CString;

/// The objects for a graph: its resources, and for each kind of pass pipelines, a label and descriptor sets.
pub(crate) struct GraphObjects {
    pub objects: Objects,
    pub kinds: Vec<PassObjects>,
    pub labels: Vec<CString>,
    pub descriptors: Descriptors,
    pub mesh_sets: MeshSets,
    pub cut_out_sets: CutOutSets,
    /// The number of Vulkan objects that the node's owner does not keep one by one: descriptor sets, which are freed
    /// with their pool, and layouts that nodes share.
    pub unowned: usize,
}

impl GraphObjects {
    /// Creates all objects, with descriptor sets for a number of places.
    pub fn new(
        maker: &mut Maker,
        graph: &Graph,
        description: &Description,
        places: u32,
    ) -> Result<Self, Error> {
        let objects = Objects::new(maker, graph, description.inspect)?;
        let strides = &description.position_strides;
        let kinds = graph.kinds().map(|pass| {
            let mut made = PassObjects::new(maker, graph, pass, strides)?;
            made.attach(maker, graph, pass, &objects)?;
            Ok(made)
        });
        let kinds = kinds.collect::<Result<Vec<_>, _>>()?;
        let descriptors = Descriptors::new(maker, graph, &kinds, places)?;
        let mesh_sets = MeshSets::new(maker, graph, &kinds, description, places)?;
        let cut_out_sets = CutOutSets::new(maker, graph, &kinds, description, places)?;
        let own = kinds.len() * places as usize;
        let shared_layouts = if maker.host.layouts.is_some() { 2 * kinds.len() } else { 0 };
        Ok(Self {
            objects,
            labels: graph.kinds().map(|p| label(p.name)).collect(),
            descriptors,
            unowned: own + mesh_sets.count() + cut_out_sets.count() + shared_layouts,
            mesh_sets,
            cut_out_sets,
            kinds,
        })
    }

    /// Whether all objects but images and buffers can stay for `graph`, which has the same passes: no attachment
    /// changes its shape.
    pub fn keeps_pipelines(&self, graph: &Graph) -> bool {
        let rasters = graph.passes().iter().filter(|p| matches!(p.work, Work::Raster { .. }));
        rasters.flat_map(Pass::writes).all(|id| !self.objects.changes(graph, id))
    }

    /// The render pass of a kind of pass and the size of its attachments; `None` for a kind that draws nothing.
    pub fn render_pass(&self, kind: usize) -> Option<(vk::RenderPass, vk::Extent2D)> {
        let made = self.kinds.get(kind).filter(|k| k.render_pass != vk::RenderPass::null())?;
        Some((made.render_pass, made.extent))
    }
}

/// The debug label `antumbra.<name>`; names are literals without a zero byte.
fn label(name: &str) -> CString {
    CString::new(format!("antumbra.{name}")).unwrap_or_default()
}
