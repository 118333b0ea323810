//! Meshes that move in the vertex shader: the node cannot know where their triangles are, so the
//! engine draws them into its depth layers, with the vertex shader that the G-buffer has too.

use crate::Outcome;
use crate::device::Gpu;
use crate::gbuffer::{self, Push};
use crate::geometry::Model;
use antumbra::{HostDraw, Layer, LayerPass, ShadowNode, TechniqueIndex};
use ash::vk;

/// A pipeline for each layer that the node's settings have.
pub struct JellyPipelines {
    layout: vk::PipelineLayout,
    layers: Vec<(Layer, vk::Pipeline)>,
}

impl JellyPipelines {
    pub fn new(gpu: &Gpu, node: &ShadowNode) -> Outcome<Self> {
        let layout = gbuffer::make_layout(gpu)?;
        let vertex = gpu.shader(include_bytes!("shaders/gbuffer.vert.spv"))?;
        let layers = [Layer::Front, Layer::Back, Layer::Receivers]
            .into_iter()
            .filter_map(|layer| Some((layer, node.layer_pass(TechniqueIndex(0), layer)?)))
            .map(|(layer, pass)| Ok((layer, make_pipeline(gpu, layout, vertex, &pass)?)))
            .collect::<Outcome<_>>();
        // SAFETY: a pipeline does not need its module once it is made.
        unsafe { gpu.device.destroy_shader_module(vertex, None) };
        Ok(Self { layout, layers: layers? })
    }

    /// Draws a jelly into the layer that the node is at.
    pub fn draw(&self, gpu: &Gpu, draw: &HostDraw, model: &Model, seconds: f64) {
        let Some((_, pipeline)) = self.layers.iter().find(|(l, _)| *l == draw.layer) else {
            return;
        };
        let push = Push { clip_from_mesh: draw.clip_from_mesh, ..model.push(seconds) };
        let (device, cmd) = (&gpu.device, draw.cmd);
        // SAFETY: `cmd` is inside the layer's render pass, for which the pipeline was made; the
        // model's buffers outlive the frame.
        unsafe {
            device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::GRAPHICS, *pipeline);
        }
        gbuffer::draw_model(gpu, cmd, self.layout, model, &push);
    }

    /// Destroys it; no frame may use it any more.
    pub fn destroy(self, gpu: &Gpu) {
        // SAFETY: the caller waited for every frame that uses it.
        unsafe {
            for (_, pipeline) in self.layers {
                gpu.device.destroy_pipeline(pipeline, None);
            }
            gpu.device.destroy_pipeline_layout(self.layout, None);
        }
    }
}

/// Depth alone, as the layer wants it. (The fragment shader's push constants are in the layout and
/// stay unread.)
fn make_pipeline(
    gpu: &Gpu,
    layout: vk::PipelineLayout,
    vertex: vk::ShaderModule,
    pass: &LayerPass,
) -> Outcome<vk::Pipeline> {
    let stages = [vk::PipelineShaderStageCreateInfo::default()
        .stage(vk::ShaderStageFlags::VERTEX)
        .module(vertex)
        .name(c"main")];
    let (bindings, attributes) = gbuffer::vertex_input();
    let input = vk::PipelineVertexInputStateCreateInfo::default()
        .vertex_binding_descriptions(&bindings)
        .vertex_attribute_descriptions(&attributes);
    let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
        .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let vk::Extent2D { width, height } = pass.extent;
    let viewports = [vk::Viewport {
        width: width as f32,
        height: height as f32,
        max_depth: 1.0,
        ..Default::default()
    }];
    let scissors = [vk::Rect2D { extent: pass.extent, ..Default::default() }];
    let viewport =
        vk::PipelineViewportStateCreateInfo::default().viewports(&viewports).scissors(&scissors);
    let raster = vk::PipelineRasterizationStateCreateInfo::default()
        .cull_mode(pass.raster.cull)
        .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
        .line_width(1.0);
    let samples = vk::PipelineMultisampleStateCreateInfo::default()
        .rasterization_samples(vk::SampleCountFlags::TYPE_1);
    let depth = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(pass.raster.compare);
    let create = [vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&raster)
        .multisample_state(&samples)
        .depth_stencil_state(&depth)
        .layout(layout)
        .render_pass(pass.render_pass)];
    // SAFETY: all that the create info points to lives until the end of this call.
    let made = unsafe { gpu.device.create_graphics_pipelines(gpu.pipeline_cache, &create, None) };
    Ok(made.map_err(|(_, e)| e)?[0])
}
