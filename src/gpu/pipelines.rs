//! The pipelines of a description without images or buffers, to compile them before a node needs them.

use super::host::Host;
use super::maker::Maker;
use super::memory::{Allocator, MemoryBlock, MemoryRequest};
use super::owner::ObjectOwner;
use super::pipeline::PassObjects;
use crate::Error;
use crate::frame::{self, Description};
use crate::graph::{Pass, Work};
use crate::lent::TechniqueIndex;
use ash::vk;

/// The pipelines that nodes of one description have, made on a device without memory.
///
/// Made on another thread with [`Host::with_pipeline_cache`] and [`Host::with_layouts`], they leave the compiled code in the
/// cache, and the node that is created afterwards compiles nothing. With [`Host::with_pipeline_flags`] the driver tells what
/// it made of them.
#[must_use = "destroy it: dropping it leaks its pipelines"]
pub struct Pipelines {
    host: Host,
    owner: ObjectOwner,
    each: Vec<PassPipeline>,
}

/// One pipeline of a pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassPipeline {
    /// The technique whose pass it is, by its place in the description.
    pub technique: TechniqueIndex,
    /// The pass's name, as in a plan.
    pub pass: &'static str,
    /// The paths of its modules under `spirv/`: a compute shader, or a vertex shader and perhaps a fragment shader.
    pub modules: Vec<&'static str>,
    /// The pipeline.
    pub pipeline: vk::Pipeline,
}

impl Pipelines {
    /// Creates every pipeline that frames of this description need: of a pass that draws meshes one for each stride and each
    /// way of culling.
    ///
    /// # Errors
    /// See [`ShadowNode::new`](crate::ShadowNode::new). After an error every object is destroyed.
    pub fn new(host: &Host, description: &Description) -> Result<Self, Error> {
        let limits = host.limits_for(description)?;
        let graphs = frame::all_graphs(description, limits)?;
        let (each, owner) = Maker::run(host, &mut NoMemory, |maker| {
            let mut each = Vec::new();
            for (technique, graph) in (0..).map(TechniqueIndex).zip(&graphs) {
                for pass in graph.kinds() {
                    let made = PassObjects::new(maker, graph, pass, &description.position_strides)?;
                    let [whole, cut] = modules_of(pass);
                    let all = made.pipelines.iter().map(|pipeline| (pipeline, &whole));
                    let all = all.chain(made.cut_pipelines.iter().map(|pipeline| (pipeline, &cut)));
                    each.extend(all.map(|(&pipeline, modules)| {
                        let modules = modules.clone();
                        PassPipeline { technique, pass: pass.name, modules, pipeline }
                    }));
                }
            }
            Ok(each)
        })?;
        Ok(Self { host: host.clone(), owner, each })
    }

    /// All pipelines, technique by technique, in the order of the passes.
    pub fn each(&self) -> &[PassPipeline] {
        &self.each
    }

    /// Destroys the pipelines. The device must be alive.
    pub fn destroy(self) {
        // Pipelines have no memory to free.
        self.owner.destroy(&self.host.device, |_| {});
    }
}

/// The modules of a pass's pipelines, and those of its pipelines for meshes that textures cut out.
fn modules_of(pass: &Pass) -> [Vec<&'static str>; 2] {
    if let Work::Raster { vertex, fragment, cut, .. } = pass.work {
        let whole = std::iter::once(vertex).chain(fragment);
        let cut = cut.into_iter().flatten();
        return [whole.map(|m| m.path).collect(), cut.map(|m| m.path).collect()];
    }
    [pass.work.compute_shader().iter().map(|m| m.path).collect(), Vec::new()]
}

/// Pipelines take none.
struct NoMemory;

impl Allocator for NoMemory {
    fn allocate(&mut self, request: &MemoryRequest) -> Result<MemoryBlock, Error> {
        let problem = "pipelines are made without memory".into();
        let (resource, bytes) = (request.name.into(), request.requirements.size);
        Err(Error::Memory { resource, bytes, problem })
    }

    fn free(&mut self, _: MemoryBlock) {}
}
