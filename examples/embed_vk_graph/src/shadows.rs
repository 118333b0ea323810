//! antumbra's node as a foreign pass of the graph: everything in this engine that knows the node.

use crate::Outcome;
use crate::device::Gpu;
use crate::frames::FRAMES_IN_FLIGHT;
use crate::geometry::{Model, ModelNodes, STRIDE};
use crate::targets::{DEPTH, MASK, TargetNodes, Targets};
use antumbra::graph::Scope;
use antumbra::{BorderBarriers, Description, Frame, Host, HostImage, MeshInstance, Requirements};
use antumbra::{RectangleLight, Retired, Settings, ShadowNode};
use ash::vk;
use glam::DMat4;
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use vk::{AccessFlags as Access, ImageLayout as Layout, PipelineStageFlags as Stage};
use vk_graph::Graph;
use vk_graph::driver::image::Image;
use vk_graph::driver::sync::AccessType;

/// The node, and memory for it.
pub struct Shadows {
    /// Shared with the command that records it, which is called when the graph is submitted.
    node: Arc<Mutex<ShadowNode>>,
    allocator: Allocator,
    /// What resizes replaced, and the last frame that may use it.
    retired: Vec<(u64, Retired)>,
}

/// Interim.
pub struct Told {
    pub plan: Duration,
    pub passes: usize,
    pub recorded: Arc<OnceLock<Result<Duration, antumbra::Error>>>,
}

impl Shadows {
    /// Lends the device and makes the node.
    pub fn new(gpu: &Gpu, extent: [u32; 2], settings: Settings) -> Outcome<Self> {
        let physical = &gpu.device.physical;
        let (instance, device): (&ash::Instance, &ash::Device) = (&physical.instance, &gpu.device);
        // SAFETY: the handles belong together, and the node is gone before vk-graph destroys them;
        // the graphs keep what each frame lends until its fence is signalled, and vk-graph brings it
        // into the said state; a slot is recorded, and what was retired destroyed, only behind that
        // fence.
        let host = unsafe {
            Host::borrow(instance.clone(), physical.handle, device.clone(), gpu.queue_family)
        };
        Requirements::of(&host).met()?;
        // vk-graph keeps its allocator to itself.
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
            ..Description::new(extent)
        };
        let node = ShadowNode::new(host, &mut allocator, description)?;
        Ok(Self { node: Arc::new(Mutex::new(node)), allocator, retired: Vec::new() })
    }

    /// Interim: the node's own image.
    pub fn visibility(&self, gpu: &Gpu) -> Arc<Image> {
        let v = self.node.lock().unwrap().visibility();
        let info = vk_graph::driver::image::ImageInfo::image_2d(v.extent[0], v.extent[1], vk::Format::R32_SFLOAT,
            vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_SRC);
        Arc::new(unsafe { Image::from_raw(&gpu.device, v.image, info) })
    }

    pub fn add(
        &self,
        graph: &mut Graph,
        targets: &Targets,
        nodes: &TargetNodes,
        models: &[(&Model, ModelNodes)],
        light: RectangleLight,
        world_from_ndc: DMat4,
        slot: u32,
        lie: bool,
    ) -> Outcome<Told> {
        let meshes: Vec<_> = models.iter().map(|(model, _)| mesh(model)).collect();
        let sampled = Scope { stage: Stage::COMPUTE_SHADER, access: Access::SHADER_READ, layout: Layout::SHADER_READ_ONLY_OPTIMAL };
        let lend = |image: &Image| -> Outcome<HostImage> {
            let view = image.view(image.info.into_image_view())?;
            Ok(HostImage { image: image.handle, view, before: sampled, after: sampled })
        };
        let frame = Frame {
            light,
            world_from_ndc,
            background: 0.0,
            meshes: &meshes,
            depth: lend(&targets.depth)?,
            mask: Some(lend(&targets.mask)?),
            visibility_before: sampled,
            visibility_after: sampled,
            window: None,
            slot,
            border_barriers: BorderBarriers::Host,
        };
        let started = Instant::now();
        let plan = self.node.lock().unwrap().plan(&frame)?;
        let took = started.elapsed();
        let mut command = graph.begin_cmd().debug_name("antumbra");
        for use_ in plan.accesses() {
            let image = match use_.name {
                "gbuffer.depth" => nodes.depth,
                "gbuffer.mask" => nodes.mask,
                _ => nodes.visibility,
            };
            let mut access = access_type(use_.entry)?;
            if lie && use_.writes { access = AccessType::ComputeShaderReadOther }
            command.set_resource_access(image, access);
        }
        for (_, nodes) in models {
            command.set_resource_access(nodes.vertices, AccessType::VertexBuffer);
            command.set_resource_access(nodes.indices, AccessType::IndexBuffer);
        }
        let recorded = Arc::new(OnceLock::new());
        let told = Told { plan: took, passes: plan.plan.steps.len(), recorded: recorded.clone() };
        let node = self.node.clone();
        command.record_cmd(move |cmd| {
            let started = Instant::now();
            let r = node.lock().unwrap_or_else(PoisonError::into_inner).record(cmd.handle, &plan);
            let _ = recorded.set(r.map(|()| started.elapsed()));
        });
        Ok(told)
    }

    pub fn resize(&mut self, extent: [u32; 2], last_frame: u64) -> Outcome<()> {
        let retired = self.node.lock().unwrap().resize(&mut self.allocator, extent)?;
        self.retired.push((last_frame, retired));
        Ok(())
    }

    pub fn frame_done(&mut self, done: u64) {
        for (_, retired) in self.retired.extract_if(.., |(last, _)| *last <= done) {
            retired.destroy(&mut self.allocator);
        }
    }

    pub fn size(&self) -> (usize, u64) {
        let node = self.node.lock().unwrap();
        (node.object_count(), node.memory().iter().map(|m| m.1).sum())
    }

    pub fn destroy(mut self) -> Outcome<u64> {
        let node = Arc::into_inner(self.node).ok_or("held")?.into_inner().unwrap();
        node.destroy(&mut self.allocator);
        for (_, r) in self.retired { r.destroy(&mut self.allocator); }
        Ok(self.allocator.generate_report().total_allocated_bytes)
    }
}

fn mesh(model: &Model) -> MeshInstance {
    MeshInstance {
        positions: model.vertices.handle,
        positions_offset: 0,
        positions_stride: STRIDE,
        indices: Some((model.indices.handle, 0, vk::IndexType::UINT32)),
        count: model.count,
        world_from_mesh: model.instance.world_from_mesh,
        bounds: model.bounds,
        role: model.instance.role,
        double_sided: model.double_sided,
    }
}

fn access_type(scope: Scope) -> Outcome<AccessType> {
    match (scope.stage, scope.access, scope.layout) {
        (Stage::COMPUTE_SHADER, Access::SHADER_READ, Layout::SHADER_READ_ONLY_OPTIMAL) => {
            Ok(AccessType::ComputeShaderReadSampledImageOrUniformTexelBuffer)
        }
        (Stage::COMPUTE_SHADER, Access::SHADER_WRITE, Layout::GENERAL) => {
            Ok(AccessType::ComputeShaderWrite)
        }
        _ => Err(format!("vk-graph has no word for {scope:?}").into()),
    }
}
