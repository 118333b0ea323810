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
use crate::targets::{DEPTH, MASK, NORMALS, Targets};
use antumbra::{BorderBarriers, Description, Error, Frame, FramePlan, Geometry, Host, HostImage};
use antumbra::{MeshBuffers, MeshInstance, RetireQueue, Scope, ShadowNode, Technique, Visibility};
use gpu_allocator::vulkan::Allocator;
use std::sync::{Arc, mpsc};
use vk_graph::Graph;
use vk_graph::driver::{
    DriverError,
    image::{Image, ImageInfo},
    sync::AccessType,
};

/// The node, and memory for it.
pub struct Shadows {
    /// Shared with the commands that record it: vk-graph calls them when the graph is submitted.
    pub node: Arc<ShadowNode>,
    allocator: Allocator,
    retired: RetireQueue,
}

/// Comes when the graph is submitted: whether the node was recorded, or why not.
pub type Recorded = mpsc::Receiver<Result<(), Error>>;

impl Shadows {
    /// Lends the device and makes the node for pictures of a size.
    pub fn new(gpu: &Gpu, extent: [u32; 2], settings: Technique) -> Outcome<Self> {
        let instance = ash::Instance::clone(&gpu.device.physical.instance);
        let device = ash::Device::clone(&gpu.device);
        let physical_device = gpu.device.physical.handle;
        // SAFETY: the handles belong together, and `destroy` comes before vk-graph destroys them;
        // a graph keeps what it binds until its fence is signalled, and brings it into the said
        // layouts; a slot is recorded, and what was retired destroyed, only behind that fence.
        let host = unsafe { Host::borrow(instance, physical_device, device, gpu.queue_family) };
        // vk-graph has an allocator too, but keeps it to itself.
        let mut allocator = host.new_allocator()?;
        let description = Description {
            technique: settings,
            frames_in_flight: FRAMES_IN_FLIGHT,
            depth_format: DEPTH,
            mask_format: Some(MASK),
            normals: Some(NORMALS),
            position_strides: vec![STRIDE],
            lent_visibility: true,
            ..Description::new(extent)
        };
        let node = Arc::new(ShadowNode::new(host, &mut allocator, description)?);
        Ok(Self { node, allocator, retired: RetireQueue::default() })
    }

    /// Plans the node's work for a frame.
    pub fn plan(&self, shot: &Shot) -> Outcome<FramePlan> {
        let meshes: Vec<_> = shot.models.iter().map(mesh).collect();
        let depth = lend(&shot.targets.depth)?;
        let frame = Frame {
            mask: Some(lend(&shot.targets.mask)?),
            normals: Some(lend(&shot.targets.plane)?),
            visibility: Visibility::Lent(lend(&shot.targets.visibility)?),
            border_barriers: BorderBarriers::Host,
            ..Frame::new(shot.slot, shot.light.light, shot.world_from_ndc, &meshes, depth)
        };
        Ok(self.node.plan(&frame)?)
    }

    /// Adds the command that records the plan, between the G-buffer and whoever reads visibility.
    /// The frame that last had the shot's slot must be done when the graph is submitted.
    pub fn add(&self, graph: &mut Graph, shot: &Shot, plan: FramePlan) -> Outcome<Recorded> {
        let mut command = graph.begin_cmd().debug_name("antumbra");
        let Targets { depth, mask, plane, visibility, .. } = shot.targets;
        for image in [depth, mask, plane, visibility] {
            // What this frame's passes leave alone needs no barrier here.
            let Some(used) = plan.use_of(image.handle) else { continue };
            let image = command.bind_resource(image);
            command.set_resource_access(image, access_type(used.entry, shot.lie)?);
        }
        // `plan.buffer_accesses` leaves out the meshes that this frame does; here they do no harm.
        for model in shot.models {
            let buffers = [&model.vertices, &model.indices].map(|b| command.bind_resource(b));
            command.set_resource_access(buffers[0], AccessType::VertexBuffer);
            command.set_resource_access(buffers[1], AccessType::IndexBuffer);
        }
        let (tell, recorded) = mpsc::channel();
        let node = self.node.clone();
        command.record_cmd(move |cmd| {
            // Whoever does not listen does not care.
            let _ = tell.send(node.record(cmd.handle, &plan));
        });
        Ok(recorded)
    }

    /// Makes the node fit pictures of another size. Frames up to `last_frame` may still run on what
    /// this replaces.
    pub fn resize(&mut self, extent: [u32; 2], last_frame: u64) -> Outcome<()> {
        let node = Arc::get_mut(&mut self.node).ok_or("a graph was never submitted")?;
        self.retired.push(last_frame, node.resize(&mut self.allocator, extent)?);
        Ok(())
    }

    /// Destroys what no frame after `done` uses.
    pub fn frame_done(&mut self, done: u64) {
        self.retired.done(done, &mut self.allocator);
    }

    /// Destroys the node, once every frame is done, and says how many bytes it has left behind: 0.
    pub fn destroy(mut self) -> Outcome<u64> {
        self.frame_done(u64::MAX);
        let node = Arc::into_inner(self.node).ok_or("a graph was never submitted")?;
        node.destroy(&mut self.allocator);
        Ok(self.allocator.generate_report().total_allocated_bytes)
    }
}

/// A model as the node takes it.
fn mesh(
    Model { vertices, indices, count, bounds, instance, double_sided, .. }: &Model,
) -> MeshInstance {
    let buffers = MeshBuffers::indexed(vertices.handle, STRIDE, indices.handle, *count);
    let mesh = Geometry::Buffers(buffers);
    let mesh = MeshInstance::new(mesh, instance.world_from_mesh, *bounds, instance.role);
    MeshInstance { double_sided: *double_sided, ..mesh }
}

/// An image as the node takes it. The graph knows its uses before and after; of those the node only
/// needs the layout in which it will find what it reads.
fn lend(image: &Image) -> Result<HostImage, DriverError> {
    let ImageInfo { format, width, height, usage, .. } = image.info;
    let handles = (image.handle, image.view(image.info.into_image_view())?);
    let known = Scope::COMPUTE_SAMPLED;
    Ok(HostImage::new(handles, format, [width, height], usage, known, known))
}

/// vk-graph's word for what the node does, which stands for stage, access and layout alike.
fn access_type(scope: Scope, lie: bool) -> Outcome<AccessType> {
    match scope {
        Scope::COMPUTE_SAMPLED => Ok(AccessType::ComputeShaderReadSampledImageOrUniformTexelBuffer),
        // Of a storage image, in the same layout.
        Scope::COMPUTE_WRITTEN if lie => Ok(AccessType::ComputeShaderReadOther),
        Scope::COMPUTE_WRITTEN => Ok(AccessType::ComputeShaderWrite),
        _ => Err(format!("vk-graph has no word for {scope:?}").into()),
    }
}
