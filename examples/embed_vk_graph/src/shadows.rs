//! antumbra's node as a foreign pass of the graph: everything in this engine that knows the node.
//!
//! vk-graph places every barrier between commands from what each says it does. The node's plan says
//! the same of the node, so one command carries it: the plan's accesses become the command's, and
//! recording the command records the plan (`BorderBarriers::Host`; the node places the barriers
//! between its own passes itself, on images that vk-graph never sees).

use crate::Outcome;
use crate::device::Gpu;
use crate::frames::FRAMES_IN_FLIGHT;
use crate::geometry::{Model, STRIDE};
use crate::shot::Shot;
use crate::targets::{DEPTH, MASK};
use antumbra::{BorderBarriers, Description, Frame, Geometry, Host, HostImage, MeshBuffers};
use antumbra::{MeshInstance, Requirements, Retired, Scope, Settings, ShadowNode, Visibility};
use ash::vk;
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use std::time::{Duration, Instant};
use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};
use vk_graph::Graph;
use vk_graph::driver::DriverError;
use vk_graph::driver::image::Image;
use vk_graph::driver::sync::AccessType;

/// The node, and memory for it.
pub struct Shadows {
    /// Shared with the commands that record it: vk-graph calls them when the graph is submitted.
    node: Arc<Mutex<ShadowNode>>,
    allocator: Allocator,
    /// What resizes replaced, and the last frame that may use it.
    retired: Vec<(u64, Retired)>,
    /// `--lie`
    lie: bool,
}

/// What a frame's plan took, and what recording it will have taken.
pub struct Told {
    pub plan: Duration,
    pub passes: usize,
    /// Barriers of the node's own.
    pub barriers: usize,
    /// Filled when the graph is submitted.
    pub recorded: mpsc::Receiver<Result<Duration, antumbra::Error>>,
}

impl Shadows {
    /// Lends the device and makes the node for pictures of a size.
    pub fn new(gpu: &Gpu, extent: [u32; 2], settings: Settings, lie: bool) -> Outcome<Self> {
        let physical = &gpu.device.physical;
        let (instance, device): (&ash::Instance, &ash::Device) = (&physical.instance, &gpu.device);
        // SAFETY: the handles belong together, and `destroy` comes before vk-graph destroys them;
        // a graph keeps what it binds until its fence is signalled, and brings it into the said
        // layouts; a slot is recorded, and what was retired destroyed, only behind that fence.
        let host = unsafe {
            Host::borrow(instance.clone(), physical.handle, device.clone(), gpu.queue_family)
        };
        // One sentence with everything that is missing; on a device that vk-graph takes, nothing is.
        Requirements::of(&host).met()?;
        // vk-graph has an allocator too, but keeps it to itself.
        let mut allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device: physical.handle,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: false,
            allocation_sizes: gpu_allocator::AllocationSizes::default(),
        })?;
        let description = Description {
            settings,
            frames_in_flight: FRAMES_IN_FLIGHT,
            depth_format: DEPTH,
            mask_format: Some(MASK),
            position_strides: vec![STRIDE],
            lent_visibility: true,
            ..Description::new(extent)
        };
        let node = ShadowNode::new(host, &mut allocator, description)?;
        Ok(Self { node: Arc::new(Mutex::new(node)), allocator, retired: Vec::new(), lie })
    }

    /// The node.
    pub fn node(&self) -> MutexGuard<'_, ShadowNode> {
        lock(&self.node)
    }

    /// Plans the frame and adds the command that records it, between the G-buffer and whoever reads
    /// visibility. The frame that last had the shot's slot must be done when the graph is submitted.
    pub fn add(&self, graph: &mut Graph, shot: &Shot) -> Outcome<Told> {
        let meshes: Vec<_> = shot.models.iter().map(mesh).collect();
        let images = [&shot.targets.depth, &shot.targets.mask, &shot.targets.visibility];
        let [depth, mask, visibility] = images.map(|image| lend(image));
        let frame = Frame {
            mask: Some(mask?),
            visibility: Visibility::Lent(visibility?),
            slot: shot.slot,
            border_barriers: BorderBarriers::Host,
            ..Frame::new(shot.light.light, shot.world_from_ndc, &meshes, depth?)
        };
        let started = Instant::now();
        let plan = self.node().plan(&frame)?;
        let (tell, recorded) = mpsc::channel();
        let told = Told {
            plan: started.elapsed(),
            passes: plan.plan.steps.len(),
            barriers: plan.plan.steps.iter().map(|s| s.barriers.len()).sum(),
            recorded,
        };

        let mut command = graph.begin_cmd().debug_name("antumbra");
        // What this frame's passes leave alone has no node use, and no need of a barrier here.
        for (access, used) in plan.accesses().iter().filter_map(|a| Some((a, a.node?))) {
            let image = images.into_iter().find(|image| image.handle == access.image);
            let image = command.bind_resource(image.ok_or(access.name)?);
            let said = if self.lie && used.writes {
                AccessType::ComputeShaderReadOther // of a storage image, in GENERAL too
            } else {
                access_type(used.entry)?
            };
            command.set_resource_access(image, said);
        }
        let buffers = shot.models.iter().flat_map(|model| [&model.vertices, &model.indices]);
        let buffers: HashMap<_, _> = buffers.map(|buffer| (buffer.handle, buffer)).collect();
        for access in plan.buffer_accesses() {
            let buffer = command.bind_resource(buffers[&access.buffer]);
            command.set_resource_access(buffer, access_type(access.scope)?);
        }
        let node = self.node.clone();
        command.record_cmd(move |cmd| {
            let started = Instant::now();
            let done = lock(&node).record(cmd.handle, &plan).map(|()| started.elapsed());
            // Whoever does not listen does not care.
            let _ = tell.send(done);
        });
        Ok(told)
    }

    /// Makes the node fit pictures of another size. Frames up to `last_frame` may still run on what
    /// this replaces.
    pub fn resize(&mut self, extent: [u32; 2], last_frame: u64) -> Outcome<()> {
        let retired = lock(&self.node).resize(&mut self.allocator, extent)?;
        self.retired.push((last_frame, retired));
        Ok(())
    }

    /// Destroys what no frame after `done` uses.
    pub fn frame_done(&mut self, done: u64) {
        for (_, retired) in self.retired.extract_if(.., |(last_frame, _)| *last_frame <= done) {
            retired.destroy(&mut self.allocator);
        }
    }

    /// Destroys the node, once every frame is done, and says how many bytes it has left behind: 0.
    pub fn destroy(mut self) -> Outcome<u64> {
        self.frame_done(u64::MAX);
        let node = Arc::into_inner(self.node).ok_or("a graph still holds the node")?;
        let node = node.into_inner().unwrap_or_else(PoisonError::into_inner);
        node.destroy(&mut self.allocator);
        Ok(self.allocator.generate_report().total_allocated_bytes)
    }
}

fn lock(node: &Mutex<ShadowNode>) -> MutexGuard<'_, ShadowNode> {
    node.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A model as the node takes it.
fn mesh(model: &Model) -> MeshInstance {
    MeshInstance {
        geometry: Geometry::Buffers(MeshBuffers {
            positions: model.vertices.handle,
            positions_offset: 0,
            positions_stride: STRIDE,
            indices: Some((model.indices.handle, 0, vk::IndexType::UINT32)),
            count: model.count,
        }),
        world_from_mesh: model.instance.world_from_mesh,
        bounds: model.bounds,
        role: model.instance.role,
        double_sided: model.double_sided,
    }
}

/// An image as the node takes it. vk-graph brings what a compute shader fetches into
/// SHADER_READ_ONLY_OPTIMAL; the rest of the scopes is the graph's to know, not the node's.
fn lend(image: &Image) -> Result<HostImage, DriverError> {
    let info = image.info;
    Ok(HostImage {
        image: image.handle,
        view: image.view(info.into_image_view())?,
        format: info.format,
        extent: [info.width, info.height],
        usage: info.usage,
        before: Scope::COMPUTE_SAMPLED,
        after: Scope::COMPUTE_SAMPLED,
    })
}

/// vk-graph's word for a use, which stands for stage, access and layout alike.
fn access_type(scope: Scope) -> Outcome<AccessType> {
    let fetched = (Access::SHADER_READ, Layout::SHADER_READ_ONLY_OPTIMAL);
    Ok(match (scope.stage, (scope.access, scope.layout)) {
        (Stage::COMPUTE_SHADER, f) if f == fetched => {
            AccessType::ComputeShaderReadSampledImageOrUniformTexelBuffer
        }
        (Stage::FRAGMENT_SHADER, f) if f == fetched => {
            AccessType::FragmentShaderReadSampledImageOrUniformTexelBuffer
        }
        (_, f) if f == fetched => AccessType::AnyShaderReadSampledImageOrUniformTexelBuffer,
        (Stage::COMPUTE_SHADER, (Access::SHADER_WRITE, Layout::GENERAL)) => {
            AccessType::ComputeShaderWrite
        }
        (Stage::VERTEX_INPUT, (Access::VERTEX_ATTRIBUTE_READ, _)) => AccessType::VertexBuffer,
        (Stage::VERTEX_INPUT, (Access::INDEX_READ, _)) => AccessType::IndexBuffer,
        _ => return Err(format!("vk-graph has no word for {scope:?}").into()),
    })
}
