//! Everything that the program does for its soft shadows.
//!
//! wgpu knows nothing of the node, so they meet where wgpu lets other commands in. Its tracker
//! brings each texture into the state that the node uses it in; the node records into an encoder
//! that wgpu records nothing into; and wgpu takes what was written there for its own:
//!
//! ```text
//!   an encoder for the tracker    depth, mask, plane ► sampled    visibility ► written as storage
//!   a raw encoder                 the node, without barriers at its border
//!   whoever shades                visibility ► sampled, by wgpu
//! ```

use crate::device::{Gpu, Target};
use crate::gbuffer::NORMALS;
use crate::geometry::{Object, STRIDE};
use crate::{FRAMES_IN_FLIGHT, Outcome, Seen, Targets, raw};
use antumbra::{BorderBarriers, Description, Frame, FramePlan, Geometry, Host, HostImage, Slot};
use antumbra::{MeshBuffers, MeshInstance, OccluderMaps, Retired, Scope, ShadowNode, Visibility};
use ash::vk;
use gpu_allocator::vulkan::Allocator;
use wgpu::hal::api::Vulkan;
use wgpu::{CommandBuffer, TextureTransition, TextureUses};

/// The layout that wgpu samples depth in; for the others it is the usual one.
const DEPTH_SAMPLED: Scope =
    Scope::COMPUTE_SAMPLED.in_layout(vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL);

/// The node and its memory.
pub struct Shadows {
    pub node: ShadowNode,
    allocator: Allocator,
    /// Keeps the device that the node borrows; the last to go.
    gpu: Gpu,
}

impl Shadows {
    /// `own_maps`: each frame brings occluder maps of the program's own.
    pub fn new(gpu: &Gpu, extent: [u32; 2], own_maps: bool) -> Outcome<Self> {
        // SAFETY: what is reached through this is only lent, and nothing of it is destroyed.
        let hal = unsafe { gpu.device.as_hal::<Vulkan>() }.ok_or("wgpu runs without Vulkan")?;
        let instance = hal.shared_instance().raw_instance().clone();
        let (physical_device, family) = (hal.raw_physical_device(), hal.queue_family_index());
        // SAFETY: the handles belong together, and `gpu` keeps them. What a frame lends is kept,
        // a slot is not recorded again and what was replaced is not destroyed until wgpu says that
        // the frame's submission is done.
        let host =
            unsafe { Host::borrow(instance, physical_device, hal.raw_device().clone(), family) };
        // wgpu does not lend its own.
        let mut allocator = host.new_allocator()?;
        let description = Description {
            frames_in_flight: FRAMES_IN_FLIGHT as u32,
            mask_format: Some(vk::Format::R8_UNORM),
            normals: Some(NORMALS),
            position_strides: vec![STRIDE],
            lent_visibility: true,
            occluder_maps: own_maps.then_some(vk::Format::D32_SFLOAT),
            ..Description::new(extent)
        };
        let node = ShadowNode::new(host, &mut allocator, description)?;
        Ok(Self { node, allocator, gpu: gpu.clone() })
    }

    /// Plans the node's work for this frame.
    pub fn plan(&self, seen: &Seen, meshes: &[MeshInstance]) -> Result<FramePlan, antumbra::Error> {
        let Targets { gbuffer, visibility, .. } = seen.targets;
        let depth = lend(&gbuffer.depth, DEPTH_SAMPLED);
        let slot = Slot(seen.slot as u32);
        self.node.plan(&Frame {
            mask: Some(lend(&gbuffer.mask, Scope::COMPUTE_SAMPLED)),
            normals: Some(lend(&gbuffer.plane, Scope::COMPUTE_SAMPLED)),
            visibility: Visibility::Lent(lend(visibility, Scope::COMPUTE_WRITTEN)),
            occluder_maps: seen.maps.map(|maps| OccluderMaps {
                front: lend(&maps.front, DEPTH_SAMPLED),
                back: Some(lend(&maps.back, DEPTH_SAMPLED)),
                clip_from_world: maps.clip_from_world,
            }),
            border_barriers: BorderBarriers::Host,
            ..Frame::new(slot, seen.world.light.light, seen.view.world_from_ndc(), meshes, depth)
        })
    }

    /// Records it, to be submitted in this order between what draws and what shades. (The meshes'
    /// buffers are where the G-buffer's pass, which draws every mesh, has them already.)
    pub fn record(&mut self, plan: &FramePlan, seen: &Seen) -> Outcome<[CommandBuffer; 2]> {
        let Targets { gbuffer, visibility, .. } = seen.targets;
        let [mut tracked, mut raw] = ["border", "shadows"].map(|name| self.gpu.encoder(name));
        let sampled = [&gbuffer.depth, &gbuffer.mask, &gbuffer.plane].into_iter();
        let sampled = sampled.chain(seen.maps.into_iter().flat_map(|m| [&m.front, &m.back]));
        let textures = sampled
            .map(|target| (target, TextureUses::RESOURCE))
            .chain([(visibility, TextureUses::STORAGE_WRITE_ONLY)])
            .map(|(t, state)| TextureTransition { texture: &t.texture, selector: None, state });
        tracked.transition_resources(std::iter::empty(), textures);
        // SAFETY: the node only records, and wgpu records nothing into this encoder.
        let recorded = unsafe {
            raw.as_hal_mut::<Vulkan, _, _>(|hal| Some(self.node.record(hal?.raw_handle(), plan)))
        };
        recorded.ok_or("wgpu runs without Vulkan")??;
        Ok([tracked.finish(), raw.finish()])
    }

    /// Follows the G-buffer's size; what that replaced is destroyed when no frame uses it any more.
    pub fn resize(&mut self, extent: [u32; 2]) -> Result<Retired, antumbra::Error> {
        self.node.resize(&mut self.allocator, extent)
    }

    /// Destroys what a resize replaced.
    pub fn destroy_retired(&mut self, retired: Retired) {
        retired.destroy(&mut self.allocator);
    }

    /// Destroys it, and says how many bytes were never given back; every frame must be done.
    pub fn destroy(mut self) -> u64 {
        self.node.destroy(&mut self.allocator);
        self.allocator.generate_report().total_allocated_bytes
    }
}

/// A texture as the node takes it. wgpu has it in this state before the node and believes it there
/// behind.
fn lend(target: &Target, scope: Scope) -> HostImage {
    let raw::RawImage { image, view, format, usage } = target.raw;
    HostImage::new((image, view), format, target.extent(), usage, scope, scope)
}

/// An object as the node takes it: the buffers that the program draws it from.
pub fn mesh(object: &Object) -> Outcome<MeshInstance> {
    let (vertices, indices) = (raw::buffer(&object.vertices)?, raw::buffer(&object.indices)?);
    let buffers = MeshBuffers::indexed(vertices, STRIDE, indices, object.count);
    let Object { world_from_mesh, bounds, role, double_sided, .. } = *object;
    let mesh = MeshInstance::new(Geometry::Buffers(buffers), world_from_mesh, bounds, role);
    Ok(MeshInstance { double_sided, ..mesh })
}
