//! The G-buffer: depth, normal, the role mask and the triangles' planes, drawn by one graphics command.

use crate::Outcome;
use crate::device::Gpu;
use crate::geometry::Model;
use crate::shot::Shot;
use ash::vk;
use glam::DMat4;
use vk_graph::Graph;
use vk_graph::cmd::{LoadOp, StoreOp};
use vk_graph::driver::graphics::{DepthStencilInfo, GraphicsPipeline, GraphicsPipelineInfo};
use vk_graph::driver::shader::Shader;
use vk_graph::driver::sync::AccessType;

/// `gbuffer.vert` and `gbuffer.frag`
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Push {
    clip_from_mesh: [f32; 16],
    /// Three columns, 16 bytes apart.
    world_from_normal: [[f32; 4]; 3],
    role: f32,
}

impl Push {
    fn new(model: &Model, clip_from_world: &DMat4) -> Self {
        let instance = &model.instance;
        let turn = instance.world_from_normal().as_mat3();
        Self {
            clip_from_mesh: (*clip_from_world * instance.world_from_mesh).as_mat4().to_cols_array(),
            world_from_normal: [turn.x_axis, turn.y_axis, turn.z_axis]
                .map(|c| c.extend(0.0).to_array()),
            role: f32::from(instance.role.mask()) / 255.0,
        }
    }
}

/// Draws G-buffers.
pub struct GBufferPass(GraphicsPipeline);

impl GBufferPass {
    /// vk-graph reads the layout of vertices and push constants from the shaders.
    pub fn new(gpu: &Gpu) -> Outcome<Self> {
        let vertex = Shader::new_vertex(include_bytes!("shaders/gbuffer.vert.spv").as_slice());
        let fragment = Shader::new_fragment(include_bytes!("shaders/gbuffer.frag.spv").as_slice());
        // Models of glTF are single-sided unless they say otherwise, which those here do not.
        let info = GraphicsPipelineInfo::builder()
            .cull_mode(vk::CullModeFlags::BACK)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE);
        Ok(Self(GraphicsPipeline::create(&gpu.device, info, [vertex, fragment])?))
    }

    /// Adds the command that draws the models. (Binding what the graph has already gives the same
    /// node again; the graph keeps it alive until its commands are done.)
    pub fn add(&self, graph: &mut Graph, shot: &Shot) {
        let depth = graph.bind_resource(&shot.targets.depth);
        let normal = graph.bind_resource(&shot.targets.normal);
        let mask = graph.bind_resource(&shot.targets.mask);
        let plane = graph.bind_resource(&shot.targets.plane);
        let draws: Vec<_> = shot
            .models
            .iter()
            .map(|model| {
                let vertices = graph.bind_resource(&model.vertices);
                let indices = graph.bind_resource(&model.indices);
                (vertices, indices, model.count, Push::new(model, &shot.clip_from_world))
            })
            .collect();
        let clear = LoadOp::CLEAR_BLACK_ALPHA_ZERO;
        // Reversed depth has its background at 0.
        let clear_depth = LoadOp::CLEAR_ZERO_STENCIL_ZERO;
        let mut command = graph
            .begin_cmd()
            .debug_name("gbuffer")
            .bind_pipeline(&self.0)
            .depth_stencil(DepthStencilInfo::DEPTH_WRITE_GREATER)
            .color_attachment_image(0, normal, clear, StoreOp::Store)
            .color_attachment_image(1, mask, clear, StoreOp::Store)
            .color_attachment_image(2, plane, clear, StoreOp::Store)
            .depth_stencil_attachment_image(depth, clear_depth, StoreOp::Store);
        for (vertices, indices, ..) in &draws {
            command.set_resource_access(*vertices, AccessType::VertexBuffer);
            command.set_resource_access(*indices, AccessType::IndexBuffer);
        }
        command.record_cmd(move |cmd| {
            for (vertices, indices, count, push) in &draws {
                cmd.bind_vertex_buffer(0, *vertices, 0)
                    .bind_index_buffer(*indices, 0, vk::IndexType::UINT32)
                    .push_constants(0, bytemuck::bytes_of(push))
                    .draw_indexed(*count, 1, 0, 0, 0);
            }
        });
    }
}
