//! antumbra's node in this program: all that a program built on wgpu writes for it.
//!
//! wgpu knows nothing of the node, so the two meet at the border that wgpu offers for foreign
//! commands. Its own tracker brings each texture into the state that the node uses it in; the node
//! records into an encoder that wgpu records nothing into; what comes behind it, wgpu believes to
//! come behind its own transitions:
//!
//! ```text
//!   encoder 1, of wgpu     depth and mask ► sampled      visibility ► storage, written
//!   encoder 2, raw         the node; no barriers at its border
//!   encoder 3, of wgpu     compose: visibility ► sampled, by wgpu itself
//! ```

use crate::device::{Gpu, Target};
use crate::gbuffer::GBuffer;
use crate::geometry::{Object, STRIDE};
use crate::occluder_maps::LightView;
use crate::{FRAMES_IN_FLIGHT, Outcome};
use antumbra::frame::{Geometry, MeshBuffers, OccluderMaps, Visibility};
use antumbra::{BorderBarriers, Description, Frame, FramePlan, Host, HostImage};
use antumbra::{MeshInstance, RectangleLight, Retired, Scope, ShadowNode};
use ash::vk;
use glam::DMat4;
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use wgpu::hal::api::Vulkan;
use wgpu::{BufferUses, TextureUses};

/// The layout that wgpu samples depth in; it writes storage textures in GENERAL.
const DEPTH_SAMPLED: Scope =
    Scope::COMPUTE_SAMPLED.in_layout(vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL);

/// The node and its memory.
pub struct Shadows {
    node: ShadowNode,
    allocator: Allocator,
    meshes: Vec<MeshInstance>,
    /// Keeps the device that the node borrows alive.
    _device: wgpu::Device,
}

/// What the node is lent for one frame.
pub struct Lent<'a> {
    pub light: RectangleLight,
    /// As Vulkan counts: y down.
    pub world_from_ndc: DMat4,
    pub gbuffer: &'a GBuffer,
    pub visibility: &'a Target,
    /// Maps of the program's own, and how they look at the world.
    pub occluders: Option<&'a LightView>,
    pub slot: u32,
}

impl Shadows {
    /// Lends wgpu's device to a new node.
    pub fn new(gpu: &Gpu, objects: &[Object], extent: [u32; 2], own_maps: bool) -> Outcome<Self> {
        // SAFETY: nothing that is reached through this is destroyed.
        let hal = unsafe { gpu.device.as_hal::<Vulkan>() }.ok_or("the device is not Vulkan's")?;
        let instance = hal.shared_instance().raw_instance().clone();
        let (device, physical_device) = (hal.raw_device().clone(), hal.raw_physical_device());
        let mut allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: false,
            allocation_sizes: gpu_allocator::AllocationSizes::default(),
        })?;
        // SAFETY: the handles are wgpu's, which `_device` keeps alive. The caller keeps what a
        // frame lends until its submission is done, and only then uses its slot again or destroys
        // what was retired.
        let host =
            unsafe { Host::borrow(instance, physical_device, device, hal.queue_family_index()) };
        let description = Description {
            frames_in_flight: FRAMES_IN_FLIGHT as u32,
            mask_format: Some(vk::Format::R8_UNORM),
            position_strides: vec![STRIDE],
            lent_visibility: true,
            occluder_maps: own_maps.then_some(vk::Format::D32_SFLOAT),
            ..Description::new(extent)
        };
        let meshes = objects.iter().map(mesh).collect::<Outcome<_>>()?;
        let node = ShadowNode::new(host, &mut allocator, description)?;
        Ok(Self { node, allocator, meshes, _device: gpu.device.clone() })
    }

    /// Plans a frame; pure.
    pub fn plan(&self, lent: &Lent) -> Outcome<FramePlan> {
        let GBuffer { depth, mask, .. } = lent.gbuffer;
        let maps = lent.occluders.map(|maps| -> Outcome<_> {
            Ok(OccluderMaps {
                front: image(&maps.front, vk::Format::D32_SFLOAT, DEPTH_SAMPLED)?,
                back: Some(image(&maps.back, vk::Format::D32_SFLOAT, DEPTH_SAMPLED)?),
                clip_from_world: maps.clip_from_world,
            })
        });
        let visibility = image(lent.visibility, vk::Format::R32_SFLOAT, Scope::COMPUTE_WRITTEN)?;
        let depth = image(depth, vk::Format::D32_SFLOAT, DEPTH_SAMPLED)?;
        Ok(self.node.plan(&Frame {
            mask: Some(image(mask, vk::Format::R8_UNORM, Scope::COMPUTE_SAMPLED)?),
            visibility: Visibility::Lent(visibility),
            occluder_maps: maps.transpose()?,
            border_barriers: BorderBarriers::Host,
            slot: lent.slot,
            ..Frame::new(lent.light, lent.world_from_ndc, &self.meshes, depth)
        })?)
    }

    /// Records encoders 1 and 2, to be submitted in this order before what reads visibility.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        plan: &FramePlan,
        lent: &Lent,
        objects: &[Object],
    ) -> Outcome<[wgpu::CommandBuffer; 2]> {
        let label = wgpu::CommandEncoderDescriptor { label: Some("shadows") };
        let mut border = gpu.device.create_command_encoder(&label);
        let buffers = objects.iter().flat_map(|object| {
            let vertices = (&object.vertices, BufferUses::VERTEX);
            [vertices, (&object.indices, BufferUses::INDEX)]
        });
        let sampled = [&lent.gbuffer.depth, &lent.gbuffer.mask].into_iter();
        let sampled = sampled.chain(lent.occluders.into_iter().flat_map(|m| [&m.front, &m.back]));
        let written = (lent.visibility, TextureUses::STORAGE_WRITE_ONLY);
        let textures = sampled.map(|t| (t, TextureUses::RESOURCE)).chain([written]);
        border.transition_resources(
            buffers.map(|(buffer, state)| wgpu::BufferTransition { buffer, state }),
            textures.map(|(t, state)| wgpu::TextureTransition {
                texture: &t.texture,
                selector: None,
                state,
            }),
        );
        let mut raw = gpu.device.create_command_encoder(&label);
        let node = &mut self.node;
        // SAFETY: the node only records, and wgpu records nothing into this encoder.
        unsafe {
            raw.as_hal_mut::<Vulkan, _, Outcome<()>>(|encoder| {
                let encoder = encoder.ok_or("the encoder is not Vulkan's")?;
                Ok(node.record(encoder.raw_handle(), plan)?)
            })
        }?;
        Ok([border.finish(), raw.finish()])
    }

    /// Another size; what this replaced goes to [`Self::destroy_retired`] once its frames are done.
    pub fn resize(&mut self, extent: [u32; 2]) -> Outcome<Retired> {
        Ok(self.node.resize(&mut self.allocator, extent)?)
    }

    /// Destroys what a resize replaced.
    pub fn destroy_retired(&mut self, retired: Retired) {
        retired.destroy(&mut self.allocator);
    }

    /// The node, for those who want to know about it.
    pub fn node(&self) -> &ShadowNode {
        &self.node
    }

    /// Destroys the node, and says how many bytes of device memory are still allocated then.
    pub fn destroy(mut self) -> u64 {
        self.node.destroy(&mut self.allocator);
        self.allocator.generate_report().total_allocated_bytes
    }
}

/// An object's buffers as the node takes them.
fn mesh(object: &Object) -> Outcome<MeshInstance> {
    let raw = |buffer: &wgpu::Buffer| -> Outcome<vk::Buffer> {
        // SAFETY: the buffer lives as long as the objects, which outlive the node.
        let hal = unsafe { buffer.as_hal::<Vulkan>() }.ok_or("a buffer was not made")?;
        // SAFETY: as above.
        Ok(unsafe { hal.raw_handle() })
    };
    Ok(MeshInstance {
        geometry: Geometry::Buffers(MeshBuffers {
            positions: raw(&object.vertices)?,
            positions_offset: 0,
            positions_stride: STRIDE,
            indices: Some((raw(&object.indices)?, 0, vk::IndexType::UINT32)),
            count: object.count,
        }),
        world_from_mesh: object.world_from_mesh,
        bounds: object.bounds,
        role: object.role,
        double_sided: object.double_sided,
    })
}

/// A texture as the node takes it; wgpu has it in the state `scope` on both sides of the node.
fn image(target: &Target, format: vk::Format, scope: Scope) -> Outcome<HostImage> {
    let missing = "a texture was not made";
    // One at a time: what `as_hal` gives holds a lock of wgpu's.
    // SAFETY: the caller keeps the texture until the submission that uses it is done.
    let image = unsafe { target.texture.as_hal::<Vulkan>().ok_or(missing)?.raw_handle() };
    // SAFETY: likewise the view.
    let view = unsafe { target.view.as_hal::<Vulkan>().ok_or(missing)?.raw_handle() };
    let usage = vk::ImageUsageFlags::SAMPLED
        | match scope.layout {
            vk::ImageLayout::GENERAL => vk::ImageUsageFlags::STORAGE,
            _ => vk::ImageUsageFlags::empty(),
        };
    Ok(HostImage {
        image,
        view,
        format,
        extent: target.extent(),
        usage,
        before: scope,
        after: scope,
    })
}
