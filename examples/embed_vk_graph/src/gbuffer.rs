//! The G-buffer: depth, normal and the role mask, drawn by one graphics command.

use crate::Outcome;
use crate::device::Gpu;
use crate::geometry::{Model, ModelNodes};
use crate::targets::TargetNodes;
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
        // Whatever is drawn is drawn from both sides, as the other hosts do it.
        let info = GraphicsPipelineInfo::builder().cull_mode(vk::CullModeFlags::NONE);
        Ok(Self(GraphicsPipeline::create(&gpu.device, info, [vertex, fragment])?))
    }

    /// Adds the command that draws the models.
    pub fn add(
        &self,
        graph: &mut Graph,
        targets: &TargetNodes,
        models: &[(&Model, ModelNodes)],
        clip_from_world: &DMat4,
    ) {
        let clear = LoadOp::CLEAR_BLACK_ALPHA_ZERO;
        let mut command = graph
            .begin_cmd()
            .debug_name("gbuffer")
            .bind_pipeline(&self.0)
            .depth_stencil(DepthStencilInfo::DEPTH_WRITE_GREATER)
            .color_attachment_image(0, targets.normal, clear, StoreOp::Store)
            .color_attachment_image(1, targets.mask, clear, StoreOp::Store)
            // Reversed depth has its background at 0.
            .depth_stencil_attachment_image(
                targets.depth,
                LoadOp::CLEAR_ZERO_STENCIL_ZERO,
                StoreOp::Store,
            );
        for (_, nodes) in models {
            command.set_resource_access(nodes.vertices, AccessType::VertexBuffer);
            command.set_resource_access(nodes.indices, AccessType::IndexBuffer);
        }
        let draws: Vec<(ModelNodes, u32, Push)> = models
            .iter()
            .map(|(model, nodes)| (*nodes, model.count, Push::new(model, clip_from_world)))
            .collect();
        command.record_cmd(move |cmd| {
            for (nodes, count, push) in &draws {
                cmd.bind_vertex_buffer(0, nodes.vertices, 0)
                    .bind_index_buffer(nodes.indices, 0, vk::IndexType::UINT32)
                    .push_constants(0, bytemuck::bytes_of(push))
                    .draw_indexed(*count, 1, 0, 0, 0);
            }
        });
    }
}
