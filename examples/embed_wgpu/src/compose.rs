//! Compose: visibility × unshadowed irradiance, into the picture.

use crate::device::{Gpu, Target};
use crate::world::{View, World};
use crate::{Outcome, Seen, Targets};
use glam::DVec3;
use wgpu::{TextureFormat, TextureUsages};

const PICTURE: TextureFormat = TextureFormat::Rgba8Unorm;

/// `compose.wgsl`
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Uniforms {
    world_from_ndc: [f32; 16],
    center: [f32; 4],
    half_u: [f32; 4],
    half_v: [f32; 4],
    radiance: [f32; 4],
}

impl Uniforms {
    fn new(world: &World, view: &View) -> Self {
        let light = world.rectangle();
        let frame = light.world_from_light();
        let [a, b] = light.half_extents();
        // Light space has its z along the emission, which is half_v × half_u: v is against y.
        let u = frame.transform_vector3(DVec3::X * a);
        let v = frame.transform_vector3(DVec3::NEG_Y * b);
        let four = |v: DVec3| v.as_vec3().extend(0.0).to_array();
        Self {
            world_from_ndc: view.world_from_ndc().as_mat4().to_cols_array(),
            center: four(light.center()),
            half_u: four(u),
            half_v: four(v),
            radiance: four(world.radiance()),
        }
    }
}

/// The pipeline and the shader's uniforms.
pub struct ComposePass {
    pipeline: wgpu::ComputePipeline,
    uniforms: wgpu::Buffer,
}

impl ComposePass {
    pub fn new(gpu: &Gpu) -> Self {
        let device = &gpu.device;
        let shader = device.create_shader_module(wgpu::include_wgsl!("shaders/compose.wgsl"));
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("compose"),
            layout: None,
            module: &shader,
            entry_point: Some("compose"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("compose"),
            size: size_of::<Uniforms>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { pipeline, uniforms }
    }

    /// The image that pictures of a size are composed into.
    pub fn picture(gpu: &Gpu, extent: [u32; 2]) -> Outcome<Target> {
        let usage = TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC;
        gpu.target("picture", PICTURE, extent, usage)
    }

    /// Composes.
    pub fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, seen: &Seen) {
        let uniforms = Uniforms::new(seen.world, &seen.view);
        gpu.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(&uniforms));
        let Targets { gbuffer, visibility, picture } = seen.targets;
        fn image(binding: u32, target: &Target) -> wgpu::BindGroupEntry<'_> {
            let resource = wgpu::BindingResource::TextureView(&target.view);
            wgpu::BindGroupEntry { binding, resource }
        }
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("compose"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.uniforms.as_entire_binding() },
                image(1, &gbuffer.depth),
                image(2, &gbuffer.normal),
                image(3, visibility),
                image(4, picture),
            ],
        });
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("compose"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        let [width, height] = picture.extent();
        pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
    }
}
