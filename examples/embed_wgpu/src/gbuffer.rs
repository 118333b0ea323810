//! The G-buffer: depth, normal, role and triangle's plane of each pixel.

use crate::Outcome;
use crate::device::{Gpu, Target};
use crate::geometry::{Object, PerObject, vertex_layout};
use crate::world::View;
use antumbra::{NormalEncoding, Normals};
use ash::vk;
use wgpu::{TextureFormat, TextureUsages};

pub const DEPTH: TextureFormat = TextureFormat::Depth32Float;
const NORMAL: TextureFormat = TextureFormat::Rgba16Float;
/// How the node reads the triangles' normals: world space, x, y and z as they are.
pub const NORMALS: Normals =
    Normals { format: vk::Format::R16G16B16A16_SFLOAT, encoding: NormalEncoding::Signed };
const MASK: TextureFormat = TextureFormat::R8Unorm;

/// The images, all of one size.
pub struct GBuffer {
    /// Reversed: 1 at the near plane, 0 where nothing is drawn.
    pub depth: Target,
    /// Unit normals of the world.
    pub normal: Target,
    /// Whether a pixel blocks and receives light: see [`antumbra::Role::mask`].
    pub mask: Target,
    /// The triangles' own normals, which the node is lent; shading takes the interpolated ones.
    pub plane: Target,
}

/// `gbuffer.wgsl`
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Uniforms {
    clip_from_mesh: [f32; 16],
    world_from_normal: [[f32; 4]; 3],
    role: f32,
    padding: [f32; 3],
}

/// Draws G-buffers.
pub struct GBufferPass {
    uniforms: PerObject<Uniforms>,
    pipeline: wgpu::RenderPipeline,
}

impl GBufferPass {
    /// The pipeline, with uniforms for `objects` objects.
    pub fn new(gpu: &Gpu, objects: usize) -> Self {
        let device = &gpu.device;
        let uniforms = PerObject::new(gpu, objects);
        let shader = device.create_shader_module(wgpu::include_wgsl!("shaders/gbuffer.wgsl"));
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("gbuffer"),
            bind_group_layouts: &[Some(&uniforms.layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("gbuffer"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(vertex_layout(2))],
            },
            // Models of glTF are single-sided unless they say otherwise, which those here do not.
            primitive: wgpu::PrimitiveState {
                cull_mode: Some(wgpu::Face::Back),
                ..wgpu::PrimitiveState::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(NORMAL.into()), Some(MASK.into()), Some(NORMAL.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { uniforms, pipeline }
    }

    /// Images of a size, not yet drawn.
    pub fn images(&self, gpu: &Gpu, extent: [u32; 2]) -> Outcome<GBuffer> {
        use TextureUsages as Usage;
        // The node needs SAMPLED usage of the images that it is lent.
        let drawn = Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING;
        Ok(GBuffer {
            depth: gpu.target("gbuffer.depth", DEPTH, extent, drawn | Usage::COPY_SRC)?,
            normal: gpu.target("gbuffer.normal", NORMAL, extent, drawn)?,
            mask: gpu.target("gbuffer.mask", MASK, extent, drawn)?,
            plane: gpu.target("gbuffer.plane", NORMAL, extent, drawn)?,
        })
    }

    /// Draws every object.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        gbuffer: &GBuffer,
        objects: &[Object],
        view: &View,
    ) {
        let uniforms = objects.iter().map(|object| {
            let clip_from_mesh = view.clip_from_world * object.world_from_mesh;
            Uniforms {
                clip_from_mesh: clip_from_mesh.as_mat4().to_cols_array(),
                world_from_normal: object.world_from_normal,
                role: f32::from(object.role.mask()) / 255.0,
                padding: [0.0; 3],
            }
        });
        self.uniforms.write(gpu, uniforms);
        let cleared = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("gbuffer"),
            color_attachments: &[&gbuffer.normal, &gbuffer.mask, &gbuffer.plane]
                .map(|target| cleared(&target.view)),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &gbuffer.depth.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        for (index, object) in objects.iter().enumerate() {
            self.uniforms.bind(&mut pass, index);
            object.draw(&mut pass);
        }
    }
}
