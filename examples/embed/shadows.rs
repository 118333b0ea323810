//! Everything that the engine does for its soft shadows.

use crate::Outcome;
use crate::device::Gpu;
use crate::frames::FRAMES_IN_FLIGHT;
use crate::gbuffer::{self, GBuffer};
use crate::geometry::{self, Model};
use crate::jelly::JellyPipelines;
use crate::resources::{COLOR_DRAWN, COMPOSE_READS, DEPTH_DRAWN, Image};
use antumbra::graph::Scope;
use antumbra::{
    BorderBarriers, Description, Error, Frame, FramePlan, Host, HostImage, RectangleLight,
    Requirements, Retired, ShadowNode, Visibility,
};
use ash::vk;
use glam::DMat4;

/// What a frame's shadows depend on.
pub struct Seen<'a> {
    pub light: &'a RectangleLight,
    pub clip_from_world: &'a DMat4,
    pub models: &'a [Model],
    pub gbuffer: &'a GBuffer,
    pub seconds: f64,
    pub slot: usize,
}

/// The node, and what draws the engine's own meshes into its maps.
pub struct Shadows {
    pub node: ShadowNode,
    jelly: JellyPipelines,
    border_barriers: BorderBarriers,
}

impl Shadows {
    pub fn new(gpu: &mut Gpu, extent: [u32; 2], border_barriers: BorderBarriers) -> Outcome<Self> {
        // Lend the device. The node never creates or submits anything behind the engine's back.
        // SAFETY: the handles belong together and live until the engine's end, behind the node; what
        // each frame lends is alive, in the said state, until the frame's fence is signalled; a slot
        // is recorded, and replaced objects are destroyed, only behind that fence.
        let mut host = unsafe {
            let (instance, device) = (gpu.instance.clone(), gpu.device.clone());
            Host::borrow(instance, gpu.physical_device, device, gpu.queue_family)
        }
        .with_pipeline_cache(gpu.pipeline_cache);
        if let Some(debug_utils) = &gpu.debug_utils {
            host = host.with_debug_utils(debug_utils.clone());
        }
        // One sentence with everything that is missing; on a device of Vulkan 1.1, nothing is.
        Requirements::of(&host).met()?;
        let description = Description {
            frames_in_flight: FRAMES_IN_FLIGHT as u32,
            depth_format: gbuffer::DEPTH,
            mask_format: Some(gbuffer::MASK),
            position_strides: vec![geometry::STRIDE],
            ..Description::new(extent)
        };
        // Its memory comes from the engine's allocator.
        let node = ShadowNode::new(host, &mut gpu.allocator, description)?;
        let jelly = JellyPipelines::new(gpu, &node)?;
        Ok(Self { node, jelly, border_barriers })
    }

    /// What the node will do this frame, from what the engine says of it.
    pub fn plan(&self, seen: &Seen) -> Result<FramePlan, Error> {
        let meshes: Vec<_> = seen
            .models
            .iter()
            .zip(0..)
            .map(|(m, number)| m.for_node(number, seen.seconds))
            .collect();
        let depth = lend(&seen.gbuffer.depth, DEPTH_DRAWN);
        self.node.plan(&Frame {
            mask: Some(lend(&seen.gbuffer.mask, COLOR_DRAWN)),
            visibility: Visibility::Own { before: COMPOSE_READS, after: COMPOSE_READS },
            slot: seen.slot as u32,
            border_barriers: self.border_barriers,
            ..Frame::new(*seen.light, seen.clip_from_world.inverse(), &meshes, depth)
        })
    }

    /// Records it, between the G-buffer and whoever reads visibility.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        cmd: vk::CommandBuffer,
        plan: &FramePlan,
        seen: &Seen,
    ) -> Result<(), Error> {
        // These two loops are empty where the node places the barriers.
        let host = self.border_barriers == BorderBarriers::Host;
        for barrier in plan.entry_barriers().filter(|_| host) {
            gpu.place(cmd, &barrier);
        }
        let jelly = &self.jelly;
        self.node.record_with(cmd, plan, &mut |draw| {
            jelly.draw(gpu, draw, &seen.models[draw.mesh as usize], seen.seconds);
        })?;
        for barrier in plan.exit_barriers().filter(|_| host) {
            gpu.place(cmd, &barrier);
        }
        Ok(())
    }

    /// Follows the G-buffer's size; what that replaced is destroyed when no frame uses it any more.
    pub fn resize(&mut self, gpu: &mut Gpu, extent: [u32; 2]) -> Result<Retired, Error> {
        self.node.resize(&mut gpu.allocator, extent)
    }

    /// Destroys it; the device must be done with every frame.
    pub fn destroy(self, gpu: &mut Gpu) {
        self.jelly.destroy(gpu);
        self.node.destroy(&mut gpu.allocator);
    }
}

fn lend(image: &Image, before: Scope) -> HostImage {
    let Image { raw: image, view, format, extent, usage, .. } = *image;
    HostImage { image, view, format, extent, usage, before, after: COMPOSE_READS }
}
