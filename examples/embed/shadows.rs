//! Everything that the engine does for its soft shadows.

use crate::Outcome;
use crate::device::Gpu;
use crate::frames::FRAMES_IN_FLIGHT;
use crate::gbuffer;
use crate::geometry::{Model, STRIDE};
use crate::jelly::JellyPipelines;
use crate::resources::{COLOR_DRAWN, COMPOSE_READS, DEPTH_DRAWN, Image};
use crate::world::Seen;
use antumbra::graph::Scope;
use antumbra::{
    BorderBarriers, Description, Error, Frame, FramePlan, FramePlans, Geometry, Host, HostImage,
    MeshBuffers, MeshInstance, ShadowNode, Slot, Technique, Visibility,
};
use ash::vk;
use std::sync::Arc;

/// The node, and what draws the engine's own meshes into its maps.
pub struct Shadows {
    pub node: ShadowNode,
    jelly: JellyPipelines,
    border_barriers: BorderBarriers,
    /// The meshes and the plan of the last frame, whose memory the next one takes.
    meshes: Vec<MeshInstance>,
    plans: FramePlans,
}

impl Shadows {
    pub fn new(
        gpu: &mut Gpu,
        extent: [u32; 2],
        technique: Technique,
        border_barriers: BorderBarriers,
    ) -> Outcome<Self> {
        // Lend the device. The node never creates or submits anything behind the engine's back.
        // SAFETY: the handles belong together and live until the engine's end, behind the node; what
        // each frame lends is alive, in the said state, until the frame's fence is signalled; a slot
        // is recorded, and replaced objects are destroyed, only behind that fence.
        let mut host = unsafe {
            let (instance, device) = (gpu.instance.clone(), gpu.device.clone());
            Host::borrow(instance, gpu.physical_device, device, gpu.queue_family)
        }
        .with_pipeline_cache(gpu.pipeline_cache)
        .with_layouts(Arc::clone(&gpu.layouts));
        if let Some(debug_utils) = &gpu.debug_utils {
            host = host.with_debug_utils(debug_utils.clone());
        }
        let description = Description {
            frames_in_flight: FRAMES_IN_FLIGHT as u32,
            depth_format: gbuffer::DEPTH,
            mask_format: Some(gbuffer::MASK),
            normals: Some(gbuffer::NORMALS),
            position_strides: vec![STRIDE],
            technique,
            ..Description::new(extent)
        };
        // Its memory comes from the engine's allocator. A device that it cannot run on is refused with
        // all that is missing, in one sentence.
        let node = ShadowNode::new(host, &mut gpu.allocator, description)?;
        let jelly = JellyPipelines::new(gpu, &node)?;
        let (meshes, plans) = (Vec::new(), FramePlans::new());
        Ok(Self { node, jelly, border_barriers, meshes, plans })
    }

    /// Plans the node's work for this frame.
    pub fn plan(&mut self, seen: &Seen) -> Result<(), Error> {
        let meshes = seen.models.iter().zip(0..).map(|(model, n)| mesh(model, n, seen.seconds));
        self.meshes.clear();
        self.meshes.extend(meshes);
        let depth = lend(&seen.gbuffer.depth, DEPTH_DRAWN);
        let slot = Slot(seen.slot as u32);
        let frame = Frame {
            mask: Some(lend(&seen.gbuffer.mask, COLOR_DRAWN)),
            normals: Some(lend(&seen.gbuffer.plane, COLOR_DRAWN)),
            visibility: Visibility::Own { before: COMPOSE_READS, after: COMPOSE_READS },
            border_barriers: self.border_barriers,
            // While it stays, so do the node's maps: it must change with every pose.
            revision: seen.revision,
            ..Frame::new(slot, *seen.light, seen.clip_from_world.inverse(), &self.meshes, depth)
        };
        self.node.plan_all(&[frame], &mut self.plans)
    }

    /// The plan of this frame.
    pub fn planned(&self) -> Option<&FramePlan> {
        self.plans.all().first()
    }

    /// Records it, between the G-buffer and whoever reads visibility.
    pub fn record(&mut self, gpu: &Gpu, cmd: vk::CommandBuffer, seen: &Seen) -> Result<(), Error> {
        let Some(plan) = self.plans.all().first() else { return Ok(()) };
        // Only where the engine chose to record the barriers itself.
        let host = self.border_barriers == BorderBarriers::Host;
        let place = |barrier| {
            if host {
                gpu.place(cmd, &barrier);
            }
        };
        plan.entry_barriers().for_each(place);
        let jelly = &self.jelly;
        self.node.record_with(cmd, plan, &mut |draw| {
            jelly.draw(gpu, draw, &seen.models[draw.mesh as usize], seen.seconds);
        })?;
        plan.exit_barriers().for_each(place);
        Ok(())
    }

    /// Destroys it; the device must be done with every frame.
    pub fn destroy(self, gpu: &mut Gpu) {
        self.jelly.destroy(gpu);
        self.node.destroy(&mut gpu.allocator);
    }
}

fn lend(image: &Image, before: Scope) -> HostImage {
    let Image { raw: image, view, format, extent, usage, .. } = *image;
    HostImage::new((image, view), format, extent, usage, before, COMPOSE_READS)
}

/// A model as a mesh of the node: its buffers, or, for a jelly, the number that the draw callback gets.
fn mesh(model: &Model, number: u64, seconds: f64) -> MeshInstance {
    let (vertices, indices) = (model.vertices.raw, model.indices.raw);
    let geometry = match model.object.jelly {
        Some(_) => Geometry::HostDrawn(number),
        None => Geometry::Buffers(MeshBuffers::indexed(vertices, STRIDE, indices, model.count)),
    };
    let world_from_mesh = model.world_from_mesh(seconds);
    let mesh = MeshInstance::new(geometry, world_from_mesh, model.bounds, model.object.role);
    MeshInstance { double_sided: model.double_sided, ..mesh }
}
