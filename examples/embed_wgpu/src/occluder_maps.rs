//! `--own-shadow-map`: what the light sees, drawn here, as programs that have shadow maps already
//! do. Ordinary shadow maps: depth runs from 0 at the near plane to 1 at the far plane.

use crate::Outcome;
use crate::device::{Gpu, Target};
use crate::gbuffer::DEPTH;
use crate::geometry::{Object, PerObject, vertex_layout};
use crate::world::{World, down_from_up};
use glam::{DMat4, DVec2, DVec3, DVec4, Vec3Swizzles as _};
use wgpu::{CompareFunction as Compare, Face, FrontFace, TextureUsages};

/// The occluder maps from the light, and the matrix they were drawn with.
pub struct LightView {
    /// The occluders' nearest faces; 1 where there are none.
    pub front: Target,
    /// The furthest back faces; 0 where there are none.
    pub back: Target,
    /// The matrix with Vulkan's y, which runs down.
    pub clip_from_world: DMat4,
}

impl LightView {
    /// Maps of `side` texels a side around everything that casts shadows.
    ///
    /// They stand at the light's centre, parallel to it, x along its first axis: the shadow map of a
    /// light that is a point. What is behind its near plane is not seen.
    pub fn new(gpu: &Gpu, world: &World, objects: &[Object], side: u32) -> Outcome<Self> {
        let light_from_world = world.rectangle().light_from_world();
        let corners: Vec<DVec3> = objects
            .iter()
            .filter(|object| object.role.blocks())
            .flat_map(Object::corners)
            .map(|corner| light_from_world.transform_point3(corner)) // z: away from the light
            .collect();
        let far = 1.01 * corners.iter().map(|p| p.z).fold(0.0, f64::max);
        if far <= 0.0 {
            return Err("nothing that casts shadows is in front of the light".into());
        }
        let near = (0.99 * corners.iter().map(|p| p.z).fold(far, f64::min)).max(0.001 * far);
        let tangents = corners.iter().filter(|p| p.z >= near).map(|p| p.xy() / p.z);
        let (min, max) = tangents.fold((DVec2::MAX, DVec2::MIN), |(a, b), t| (a.min(t), b.max(t)));
        let middle = 0.5 * (max + min);
        // A texel of room on each side.
        let half =
            0.5 * (max - min).max(DVec2::splat(1e-6)) * f64::from(side) / f64::from(side - 2);
        let share = far / (far - near);
        let clip_from_light = DMat4::from_cols(
            DVec4::new(1.0 / half.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / half.y, 0.0, 0.0),
            DVec4::new(-middle.x / half.x, -middle.y / half.y, share, 1.0),
            DVec4::new(0.0, 0.0, -share * near, 0.0),
        );
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let map = |name| gpu.target(name, DEPTH, [side; 2], usage);
        Ok(Self {
            front: map("occluders.front")?,
            back: map("occluders.back")?,
            clip_from_world: clip_from_light * light_from_world,
        })
    }
}

/// Draws both maps.
pub struct OccluderPass {
    uniforms: PerObject<[f32; 16]>,
    front: wgpu::RenderPipeline,
    /// The pipelines for counter-clockwise front faces, for clockwise ones, and for double-sided meshes.
    backs: [wgpu::RenderPipeline; 3],
}

impl OccluderPass {
    /// The pipelines, with uniforms for `objects` objects.
    pub fn new(gpu: &Gpu, objects: usize) -> Self {
        let uniforms = PerObject::new(gpu, objects);
        let shader = wgpu::include_wgsl!("shaders/occluders.wgsl");
        let shader = gpu.device.create_shader_module(shader);
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("occluders"),
            bind_group_layouts: &[Some(&uniforms.layout)],
            immediate_size: 0,
        });
        // Culls fronts, where it is said which those are.
        let pipeline = |fronts: Option<FrontFace>, compare| {
            let primitive = wgpu::PrimitiveState {
                front_face: fronts.unwrap_or_default(),
                cull_mode: fronts.map(|_| Face::Front),
                ..Default::default()
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
        let backs = [Some(FrontFace::Ccw), Some(FrontFace::Cw), None];
        Self {
            front: pipeline(None, Compare::Less),
            backs: backs.map(|fronts| pipeline(fronts, Compare::Greater)),
            uniforms,
        }
    }

    /// Draws everything that casts shadows.
    pub fn record(
        &self,
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
        self.draw(encoder, (&maps.front, 1.0), objects, |_| &self.front);
        self.draw(encoder, (&maps.back, 0.0), objects, |object| {
            let mirrored = object.world_from_mesh.determinant() < 0.0;
            &self.backs[if object.double_sided { 2 } else { usize::from(mirrored) }]
        });
    }

    /// Draws into one map, cleared to a depth, each object by its pipeline.
    fn draw<'a>(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (map, clear): (&Target, f32),
        objects: &[Object],
        pipeline: impl Fn(&Object) -> &'a wgpu::RenderPipeline,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("occluders"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &map.view,
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
    }
}
