//! Poses meshes on the device, before anything draws them: morph targets and joints, in one compute pass.
//!
//! A posed mesh has one vertex buffer, which this pass writes and the G-buffer and the node draw from. One is enough for
//! all frames in flight: the device goes through them one after the other, and a barrier holds the pass back until the
//! frame before has read what it wrote. The node knows meshes by their buffers, so that its hierarchy of triangles, where
//! the technique has one, is then fitted to the new places and not built anew.

use crate::Outcome;
use crate::device::Gpu;
use crate::frames::FRAMES_IN_FLIGHT;
use crate::geometry::Model;
use crate::resources::Buffer;
use crate::skin::{Pose, Skin};
use antumbra::lent::MeshBounds;
use ash::vk;
use gpu_allocator::MemoryLocation;

/// Buffers of `posing.comp`: rest, influences, pose, posed.
const BINDINGS: usize = 4;

/// Vertices of a workgroup.
const GROUP: u32 = 64;

/// `posing.comp`
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Push {
    vertices: u32,
    influences: u32,
    joints: u32,
    targets: u32,
}

/// The pipeline.
pub struct PosingPass {
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
}

/// A skin on the device, and the pose that it has there.
pub struct Skinned {
    pub skin: Skin,
    push: Push,
    /// Vertices at rest with what targets add to them, and influences.
    inputs: [Buffer; 2],
    /// The pose of each frame in flight, which the processor writes.
    poses: Vec<Buffer>,
    pool: vk::DescriptorPool,
    sets: Vec<vk::DescriptorSet>,
    /// The pose that the vertex buffer has once the last recorded frame is done, and the next one.
    pub pose: Pose,
    next: Pose,
    /// Counts the poses that differed from the one before: 0 before the first.
    revision: u64,
    /// Whether this frame's pose is a new one.
    moved: bool,
}

impl PosingPass {
    pub fn new(gpu: &Gpu) -> Outcome<Self> {
        let device = &gpu.device;
        let bindings = [0, 1, 2, 3].map(|binding| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::COMPUTE)
        });
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device lives.
        let set_layout = unsafe { device.create_descriptor_set_layout(&create, None) }?;
        let ranges = [vk::PushConstantRange {
            stage_flags: vk::ShaderStageFlags::COMPUTE,
            offset: 0,
            size: size_of::<Push>() as u32,
        }];
        let set_layouts = [set_layout];
        let create = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(&ranges);
        // SAFETY: as above.
        let layout = unsafe { device.create_pipeline_layout(&create, None) }?;
        let module = gpu.shader(include_bytes!("shaders/posing.comp.spv"))?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(c"main");
        let create = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout)];
        // SAFETY: the layout is the shader's; a pipeline does not need its module once it is made.
        let made = unsafe {
            let made = device.create_compute_pipelines(gpu.pipeline_cache, &create, None);
            device.destroy_shader_module(module, None);
            made
        };
        let pipeline = made.map_err(|(_, e)| e)?[0];
        Ok(Self { set_layout, layout, pipeline })
    }

    /// Poses the models whose pose is new in this frame, and leaves the others as they are.
    pub fn record(&self, gpu: &Gpu, cmd: vk::CommandBuffer, slot: usize, models: &[Model]) {
        let moved = || models.iter().filter_map(|m| m.skinned.as_ref()).filter(|s| s.moved);
        if moved().next().is_none() {
            return;
        }
        use vk::{AccessFlags as Access, PipelineStageFlags as Stage};
        let readers = Stage::VERTEX_INPUT | Stage::COMPUTE_SHADER;
        let (device, none) = (&gpu.device, vk::DependencyFlags::empty());
        let point = vk::PipelineBindPoint::COMPUTE;
        let written = [vk::MemoryBarrier::default()
            .src_access_mask(Access::SHADER_WRITE)
            .dst_access_mask(Access::VERTEX_ATTRIBUTE_READ | Access::SHADER_READ)];
        // SAFETY: `cmd` is recording outside a render pass. The sets' buffers outlive the frame; those that hold the
        // slot's poses were written before this frame is submitted, behind the last frame of the slot.
        unsafe {
            // The frame before has drawn from the buffers, and its node has read them, before they are written.
            device.cmd_pipeline_barrier(cmd, readers, Stage::COMPUTE_SHADER, none, &[], &[], &[]);
            device.cmd_bind_pipeline(cmd, point, self.pipeline);
            for skinned in moved() {
                let (set, push) = ([skinned.sets[slot]], bytemuck::bytes_of(&skinned.push));
                let stage = vk::ShaderStageFlags::COMPUTE;
                device.cmd_bind_descriptor_sets(cmd, point, self.layout, 0, &set, &[]);
                device.cmd_push_constants(cmd, self.layout, stage, 0, push);
                device.cmd_dispatch(cmd, skinned.push.vertices.div_ceil(GROUP), 1, 1);
            }
            // The node places no barrier for buffers: this one makes them ready for its reads and the G-buffer's.
            device.cmd_pipeline_barrier(
                cmd,
                Stage::COMPUTE_SHADER,
                readers,
                none,
                &written,
                &[],
                &[],
            );
        }
    }

    /// Destroys it; no frame may use it any more.
    pub fn destroy(self, gpu: &Gpu) {
        // SAFETY: the caller waited for every frame that uses it.
        unsafe {
            gpu.device.destroy_pipeline(self.pipeline, None);
            gpu.device.destroy_pipeline_layout(self.layout, None);
            gpu.device.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}

impl Skinned {
    /// Uploads a skin whose mesh has these vertices at rest, six floats each, and is posed into a buffer.
    pub fn new(
        gpu: &mut Gpu,
        pass: &PosingPass,
        (skin, rest): (Skin, &[[f32; 6]]),
        posed: &Buffer,
    ) -> Outcome<Self> {
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let added = skin.targets.iter().flatten();
        let added = added.map(|&[[x, y, z], [u, v, w]]| [x, y, z, u, v, w]);
        let vertices: Vec<[f32; 6]> = rest.iter().copied().chain(added).collect();
        let inputs = [
            Buffer::with(gpu, "rest", &vertices, storage)?,
            Buffer::with(gpu, "influences", &skin.influences, storage)?,
        ];
        let pose = skin.rest();
        let bytes = (16 * (3 * pose.joints.len() + pose.weights.len().div_ceil(4))) as u64;
        let location = MemoryLocation::CpuToGpu;
        let poses = (0..FRAMES_IN_FLIGHT)
            .map(|_| Buffer::new(gpu, "pose", bytes, storage, location))
            .collect::<Outcome<Vec<_>>>()?;
        let sizes = [vk::DescriptorPoolSize {
            ty: vk::DescriptorType::STORAGE_BUFFER,
            descriptor_count: (BINDINGS * FRAMES_IN_FLIGHT) as u32,
        }];
        let create = vk::DescriptorPoolCreateInfo::default()
            .max_sets(FRAMES_IN_FLIGHT as u32)
            .pool_sizes(&sizes);
        // SAFETY: the device lives.
        let pool = unsafe { gpu.device.create_descriptor_pool(&create, None) }?;
        let layouts = [pass.set_layout; FRAMES_IN_FLIGHT];
        let allocate =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: the pool is as large as these sets.
        let sets = unsafe { gpu.device.allocate_descriptor_sets(&allocate) }?;
        for (&set, of_slot) in sets.iter().zip(&poses) {
            let all = [&inputs[0], &inputs[1], of_slot, posed];
            let infos = all.map(|buffer| {
                [vk::DescriptorBufferInfo::default().buffer(buffer.raw).range(vk::WHOLE_SIZE)]
            });
            let writes: Vec<_> = infos
                .iter()
                .zip(0..)
                .map(|(info, binding)| {
                    vk::WriteDescriptorSet::default()
                        .dst_set(set)
                        .dst_binding(binding)
                        .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                        .buffer_info(info)
                })
                .collect();
            // SAFETY: no frame uses the set yet, nor ever when it is written: its buffers stay the same.
            unsafe { gpu.device.update_descriptor_sets(&writes, &[]) };
        }
        let push = Push {
            vertices: rest.len() as u32,
            influences: skin.width as u32,
            joints: pose.joints.len() as u32,
            targets: pose.weights.len() as u32,
        };
        let next = pose.clone();
        Ok(Self { skin, push, inputs, poses, pool, sets, pose, next, revision: 0, moved: false })
    }

    /// Poses the mesh for the frame of a slot, whose last frame must be done, as it stands at a time. Gives the box around
    /// it where the pose is a new one.
    pub fn pose(&mut self, slot: usize, seconds: f64) -> Outcome<Option<MeshBounds>> {
        (self.skin.stands)(seconds, &mut self.next);
        self.moved = self.revision == 0 || self.next != self.pose;
        if !self.moved {
            return Ok(None);
        }
        self.revision += 1;
        self.pose.joints.copy_from_slice(&self.next.joints);
        self.pose.weights.copy_from_slice(&self.next.weights);
        self.poses[slot].write(&[
            bytemuck::cast_slice(&self.pose.joints),
            bytemuck::cast_slice(&self.pose.weights),
        ])?;
        Ok(Some(self.skin.bounds(&self.pose)))
    }

    /// Counts the poses so far: another number wherever the vertices are others.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Destroys it; no frame may use it any more.
    pub fn destroy(self, gpu: &mut Gpu) {
        // SAFETY: the caller waited for every frame that uses it.
        unsafe { gpu.device.destroy_descriptor_pool(self.pool, None) };
        for buffer in self.inputs.into_iter().chain(self.poses) {
            buffer.destroy(gpu);
        }
    }
}
