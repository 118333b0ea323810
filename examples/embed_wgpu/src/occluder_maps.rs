//! `--own-shadow-map`: what the light sees, drawn here, as programs that have shadow maps already
//! do. Ordinary shadow maps: depth runs from 0 at the near plane to 1 at the far plane.

use crate::Outcome;
use crate::device::{Gpu, Target};
use crate::gbuffer::DEPTH;
use crate::geometry::{Object, PerObject, vertex_layout};
use crate::world::{World, down_from_up};
use glam::{DMat4, DVec4};
use wgpu::{CompareFunction as Compare, Face, FrontFace, TextureUsages};

/// What the light sees, and the matrix it was drawn with.
pub struct LightView {
    /// The nearest faces of what casts shadows; 1 where there are none.
    pub front: Target,
    /// The furthest back faces; 0 where there are none.
    pub back: Target,
    /// As Vulkan counts: y down.
    pub clip_from_world: DMat4,
}

impl LightView {
    /// Maps of `side` texels a side around everything that casts shadows.
    ///
    /// They stand at the light's centre, parallel to it, x along its first axis: one light's
    /// ordinary shadow map, had it been a point.
    pub fn new(gpu: &Gpu, world: &World, side: u32) -> Outcome<Self> {
        let light_from_world = world.rectangle().light_from_world();
        let positions = || {
            let positions = world.scene.world_positions(|i| i.role.blocks());
            positions.map(|p| light_from_world.transform_point3(p)) // z: away from the light
        };
        let far = 1.01 * positions().map(|p| p.z).fold(0.0, f64::max);
        let least = positions().map(|p| p.z).fold(far, f64::min);
        if far <= 0.0 {
            return Err("nothing that casts shadows is in front of the light".into());
        }
        let near = (0.99 * least).max(0.01 * far);
        // The window: every tangent under which the light's centre sees something.
        let (mut min, mut max) = ([f64::MAX; 2], [f64::MIN; 2]);
        for p in positions().filter(|p| p.z >= near) {
            for (i, tangent) in [p.x / p.z, p.y / p.z].into_iter().enumerate() {
                min[i] = min[i].min(tangent);
                max[i] = max[i].max(tangent);
            }
        }
        // A texel of room on each side.
        let half =
            [0, 1].map(|i| (0.5 * (max[i] - min[i])).max(1e-6) * (1.0 + 2.0 / f64::from(side)));
        let middle = [0, 1].map(|i| 0.5 * (max[i] + min[i]));
        let share = far / (far - near);
        let clip_from_light = DMat4::from_cols(
            DVec4::new(1.0 / half[0], 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / half[1], 0.0, 0.0),
            DVec4::new(-middle[0] / half[0], -middle[1] / half[1], share, 1.0),
            DVec4::new(0.0, 0.0, -share * near, 0.0),
        );
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let map = |name| gpu.target(name, DEPTH, [side; 2], usage);
        Ok(Self {
            front: map("occluders.front"),
            back: map("occluders.back"),
            clip_from_world: clip_from_light * light_from_world,
        })
    }
}

/// Which faces of an object a pipeline draws.
#[derive(Clone, Copy)]
enum Faces {
    All,
    Backs(FrontFace),
}

/// Draws both maps.
pub struct OccluderPass {
    uniforms: PerObject<[f32; 16]>,
    front: wgpu::RenderPipeline,
    /// Where fronts are counter-clockwise, clockwise, and where every face is a back.
    backs: [wgpu::RenderPipeline; 3],
}

impl OccluderPass {
    /// The pipelines, and room for what they are told of `objects` objects.
    pub fn new(gpu: &Gpu, objects: usize) -> Self {
        let uniforms = PerObject::new(gpu, objects);
        let shader = wgpu::include_wgsl!("shaders/occluders.wgsl");
        let shader = gpu.device.create_shader_module(shader);
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("occluders"),
            bind_group_layouts: &[Some(&uniforms.layout)],
            immediate_size: 0,
        });
        let pipeline = |faces, compare| {
            let primitive = match faces {
                Faces::All => wgpu::PrimitiveState::default(),
                Faces::Backs(front_face) => wgpu::PrimitiveState {
                    front_face,
                    cull_mode: Some(Face::Front),
                    ..Default::default()
                },
            };
            gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("occluders"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some("vertex"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[Some(vertex_layout(1))],
                },
                primitive,
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(compare),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: None,
                multiview_mask: None,
                cache: None,
            })
        };
        let backs = [Faces::Backs(FrontFace::Ccw), Faces::Backs(FrontFace::Cw), Faces::All];
        Self {
            front: pipeline(Faces::All, Compare::Less),
            backs: backs.map(|faces| pipeline(faces, Compare::Greater)),
            uniforms,
        }
    }

    /// Draws everything that casts shadows.
    pub fn record<'a>(
        &'a self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        maps: &LightView,
        objects: &[Object],
    ) {
        let clip_from_world = down_from_up() * maps.clip_from_world;
        let uniforms = objects
            .iter()
            .map(|object| (clip_from_world * object.world_from_mesh).as_mat4().to_cols_array());
        self.uniforms.write(gpu, uniforms);
        let mut draw =
            |target: &Target, clear, pipeline: &dyn Fn(&Object) -> &'a wgpu::RenderPipeline| {
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("occluders"),
                    depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                        view: &target.view,
                        depth_ops: Some(wgpu::Operations {
                            load: wgpu::LoadOp::Clear(clear),
                            store: wgpu::StoreOp::Store,
                        }),
                        stencil_ops: None,
                    }),
                    ..Default::default()
                });
                for (index, object) in objects.iter().enumerate().filter(|(_, o)| o.role.blocks()) {
                    pass.set_pipeline(pipeline(object));
                    self.uniforms.bind(&mut pass, index);
                    object.draw(&mut pass);
                }
            };
        draw(&maps.front, 1.0, &|_| &self.front);
        draw(&maps.back, 0.0, &|object| match object.double_sided {
            true => &self.backs[2],
            false => &self.backs[usize::from(object.world_from_mesh.determinant() < 0.0)],
        });
    }
}
