//! Compose: visibility × unshadowed irradiance, into the picture.

use crate::Outcome;
use crate::device::Gpu;
use crate::frames::FRAMES_IN_FLIGHT;
use crate::gbuffer::GBuffer;
use crate::resources::{COMPOSE_READS, COMPOSE_WRITES, Image};
use antumbra::{RectangleLight, VisibilityImage};
use ash::vk;
use glam::{DMat4, DVec3};

/// The picture's format, which every device can write from a compute shader.
const PICTURE: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// Fetched images; the picture is the binding after them.
const INPUTS: usize = 4;

/// `compose.comp`
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Push {
    world_from_ndc: [f32; 16],
    center: [f32; 4],
    half_u: [f32; 4],
    half_v: [f32; 4],
}

impl Push {
    /// The camera and the light as the shader takes them.
    pub fn new(world_from_ndc: &DMat4, light: &RectangleLight, radiance: f32) -> Self {
        let frame = light.world_from_light();
        let [a, b] = light.half_extents();
        // Light space has its z along the emission, which is half_v × half_u: v is against y.
        let u = frame.transform_vector3(DVec3::X * a);
        let v = frame.transform_vector3(DVec3::NEG_Y * b);
        Self {
            world_from_ndc: world_from_ndc.as_mat4().to_cols_array(),
            center: light.center().as_vec3().extend(radiance).to_array(),
            half_u: u.as_vec3().extend(0.0).to_array(),
            half_v: v.as_vec3().extend(0.0).to_array(),
        }
    }
}

/// The pipeline, and a descriptor set for each frame in flight.
pub struct ComposePass {
    set_layout: vk::DescriptorSetLayout,
    pool: vk::DescriptorPool,
    sets: Vec<vk::DescriptorSet>,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
}

impl ComposePass {
    pub fn new(gpu: &Gpu) -> Outcome<Self> {
        let device = &gpu.device;
        let kind = |binding: usize| match binding {
            INPUTS => vk::DescriptorType::STORAGE_IMAGE,
            _ => vk::DescriptorType::SAMPLED_IMAGE,
        };
        let bindings: Vec<_> = (0..=INPUTS)
            .map(|binding| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(binding as u32)
                    .descriptor_type(kind(binding))
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device lives.
        let set_layout = unsafe { device.create_descriptor_set_layout(&create, None) }?;
        let frames = FRAMES_IN_FLIGHT as u32;
        let size = |ty, count| vk::DescriptorPoolSize { ty, descriptor_count: count * frames };
        let sizes = [size(kind(0), INPUTS as u32), size(kind(INPUTS), 1)];
        let create = vk::DescriptorPoolCreateInfo::default().max_sets(frames).pool_sizes(&sizes);
        // SAFETY: as above.
        let pool = unsafe { device.create_descriptor_pool(&create, None) }?;
        let layouts = [set_layout; FRAMES_IN_FLIGHT];
        let allocate =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: the pool is as large as these sets.
        let sets = unsafe { device.allocate_descriptor_sets(&allocate) }?;
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
        let module = gpu.shader(include_bytes!("shaders/compose.comp.spv"))?;
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
        Ok(Self { set_layout, pool, sets, layout, pipeline })
    }

    /// The image that pictures of a size are composed into.
    pub fn picture(gpu: &mut Gpu, extent: [u32; 2]) -> Outcome<Image> {
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::TRANSFER_SRC;
        Image::new(gpu, "picture", PICTURE, extent, usage)
    }

    /// Composes; every image must be ready for it, and the frame that last had `slot` done.
    pub fn record(
        &self,
        gpu: &Gpu,
        cmd: vk::CommandBuffer,
        slot: usize,
        inputs: (&GBuffer, &VisibilityImage),
        picture: &Image,
        push: &Push,
    ) {
        let (gbuffer, visibility) = inputs;
        let fetched = [
            gbuffer.depth.view,
            gbuffer.albedo.view,
            gbuffer.normal.view,
            // Another view after each resize of the node: this is why the sets are written each frame.
            visibility.view,
        ];
        let fetched = fetched.map(|view| {
            let layout = COMPOSE_READS.layout;
            [vk::DescriptorImageInfo::default().image_view(view).image_layout(layout)]
        });
        let written = [vk::DescriptorImageInfo::default()
            .image_view(picture.view)
            .image_layout(COMPOSE_WRITES.layout)];
        let set = self.sets[slot];
        let write = |binding: usize, info, kind| {
            vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(binding as u32)
                .descriptor_type(kind)
                .image_info(info)
        };
        let writes: Vec<_> = fetched
            .iter()
            .enumerate()
            .map(|(binding, info)| write(binding, info, vk::DescriptorType::SAMPLED_IMAGE))
            .chain([write(INPUTS, &written, vk::DescriptorType::STORAGE_IMAGE)])
            .collect();
        let [width, height] = picture.extent;
        let device = &gpu.device;
        let point = vk::PipelineBindPoint::COMPUTE;
        let stage = vk::ShaderStageFlags::COMPUTE;
        // SAFETY: no running frame uses the slot's set; `cmd` is recording outside a render pass.
        unsafe {
            device.update_descriptor_sets(&writes, &[]);
            device.cmd_bind_pipeline(cmd, point, self.pipeline);
            device.cmd_bind_descriptor_sets(cmd, point, self.layout, 0, &[set], &[]);
            device.cmd_push_constants(cmd, self.layout, stage, 0, bytemuck::bytes_of(push));
            device.cmd_dispatch(cmd, width.div_ceil(8), height.div_ceil(8), 1);
        }
    }

    /// Destroys it; no frame may use it any more.
    pub fn destroy(self, gpu: &Gpu) {
        // SAFETY: the caller waited for every frame that uses it.
        unsafe {
            gpu.device.destroy_pipeline(self.pipeline, None);
            gpu.device.destroy_pipeline_layout(self.layout, None);
            gpu.device.destroy_descriptor_pool(self.pool, None);
            gpu.device.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}
