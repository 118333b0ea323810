//! The G-buffer: depth, albedo, normal, the role mask and the triangles' planes, drawn by one render pass.
//!
//! The render pass changes no layout on its way out. Each image is left as it was drawn
//! ([`DEPTH_DRAWN`](crate::resources::DEPTH_DRAWN), [`COLOR_DRAWN`](crate::resources::COLOR_DRAWN)),
//! and whoever reads it next places the barrier: the node for depth, mask and plane, the engine for
//! the rest.

use crate::Outcome;
use crate::device::Gpu;
use crate::geometry::{Model, STRIDE};
use crate::resources::{COLOR_DRAWN, DEPTH_DRAWN, Image};
use crate::world::Seen;
use antumbra::{NormalEncoding, Normals};
use ash::vk;

pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;
pub const MASK: vk::Format = vk::Format::R8_UNORM;
const ALBEDO: vk::Format = vk::Format::R8G8B8A8_UNORM;
const NORMAL: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
/// How the node reads the triangles' normals: world space, x, y and z as they are.
pub const NORMALS: Normals = Normals { format: NORMAL, encoding: NormalEncoding::Signed };

/// Who reads the push constants.
const STAGES: vk::ShaderStageFlags = vk::ShaderStageFlags::from_raw(
    vk::ShaderStageFlags::VERTEX.as_raw() | vk::ShaderStageFlags::FRAGMENT.as_raw(),
);

/// `gbuffer.vert` and `gbuffer.frag`
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Push {
    pub clip_from_mesh: [f32; 16],
    /// Three columns, 16 bytes apart.
    pub world_from_normal: [[f32; 4]; 3],
    pub albedo_role: [u8; 4],
    /// The distance, in metres, that a jelly swells; `phase` is where it is in its swing.
    pub swell: f32,
    pub phase: f32,
    pub unused: f32,
}

/// The objects that do not depend on the image's size.
pub struct GBufferPass {
    render_pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
}

/// The images of one size.
pub struct GBuffer {
    pub depth: Image,
    pub albedo: Image,
    pub normal: Image,
    pub mask: Image,
    /// The triangles' own normals, which the node is lent; shading takes the interpolated ones.
    pub plane: Image,
    framebuffer: vk::Framebuffer,
}

impl GBufferPass {
    pub fn new(gpu: &Gpu) -> Outcome<Self> {
        let render_pass = make_render_pass(gpu)?;
        let layout = make_layout(gpu)?;
        let vertex = gpu.shader(include_bytes!("shaders/gbuffer.vert.spv"))?;
        let fragment = gpu.shader(include_bytes!("shaders/gbuffer.frag.spv"))?;
        let pipeline = make_pipeline(gpu, render_pass, layout, vertex, fragment)?;
        // SAFETY: a pipeline does not need its modules once it is made.
        unsafe {
            gpu.device.destroy_shader_module(vertex, None);
            gpu.device.destroy_shader_module(fragment, None);
        }
        Ok(Self { render_pass, layout, pipeline })
    }

    /// Images for pictures of a size.
    pub fn images(&self, gpu: &mut Gpu, extent: [u32; 2]) -> Outcome<GBuffer> {
        use vk::ImageUsageFlags as Usage;
        let color = Usage::COLOR_ATTACHMENT | Usage::SAMPLED;
        // The node samples depth, mask and plane, so they say SAMPLED.
        let depth = Usage::DEPTH_STENCIL_ATTACHMENT | Usage::SAMPLED | Usage::TRANSFER_SRC;
        let depth = Image::new(gpu, "depth", DEPTH, extent, depth)?;
        let albedo = Image::new(gpu, "albedo", ALBEDO, extent, color)?;
        let normal = Image::new(gpu, "normal", NORMAL, extent, color)?;
        let mask = Image::new(gpu, "mask", MASK, extent, color)?;
        let plane = Image::new(gpu, "plane", NORMAL, extent, color)?;
        let views = [albedo.view, normal.view, mask.view, plane.view, depth.view];
        let create = vk::FramebufferCreateInfo::default()
            .render_pass(self.render_pass)
            .attachments(&views)
            .width(extent[0])
            .height(extent[1])
            .layers(1);
        // SAFETY: the views are new and of the render pass's formats, in its order.
        let framebuffer = unsafe { gpu.device.create_framebuffer(&create, None) }?;
        Ok(GBuffer { depth, albedo, normal, mask, plane, framebuffer })
    }

    /// Draws the models as they stand at a time.
    pub fn record(&self, gpu: &Gpu, cmd: vk::CommandBuffer, seen: &Seen) {
        let Seen { gbuffer: images, models, clip_from_world, seconds, .. } = *seen;
        let [width, height] = images.depth.extent;
        let area = vk::Rect2D { extent: vk::Extent2D { width, height }, ..Default::default() };
        let viewport = vk::Viewport {
            width: width as f32,
            height: height as f32,
            max_depth: 1.0,
            ..Default::default()
        };
        // All zero: reversed depth has its background at 0.
        let clear = [vk::ClearValue::default(); 5];
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(self.render_pass)
            .framebuffer(images.framebuffer)
            .render_area(area)
            .clear_values(&clear);
        let device = &gpu.device;
        // SAFETY: `cmd` is recording outside a render pass; pipeline and framebuffer belong to this
        // one.
        unsafe {
            device.cmd_begin_render_pass(cmd, &begin, vk::SubpassContents::INLINE);
            device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::GRAPHICS, self.pipeline);
            device.cmd_set_viewport(cmd, 0, &[viewport]);
            device.cmd_set_scissor(cmd, 0, &[area]);
        }
        for model in models {
            let world_from_mesh = model.world_from_mesh(seconds);
            let clip_from_mesh = (*clip_from_world * world_from_mesh).as_mat4().to_cols_array();
            let push = Push { clip_from_mesh, ..model.push(seconds) };
            draw_model(gpu, cmd, self.layout, model, &push);
        }
        // SAFETY: the render pass was begun above.
        unsafe { device.cmd_end_render_pass(cmd) };
    }

    /// Destroys it; no frame may use it any more.
    pub fn destroy(self, gpu: &Gpu) {
        // SAFETY: the caller waited for every frame that uses it.
        unsafe {
            gpu.device.destroy_pipeline(self.pipeline, None);
            gpu.device.destroy_pipeline_layout(self.layout, None);
            gpu.device.destroy_render_pass(self.render_pass, None);
        }
    }
}

impl GBuffer {
    /// Destroys it; no frame may use it any more.
    pub fn destroy(self, gpu: &mut Gpu) {
        // SAFETY: the caller waited for every frame that uses it.
        unsafe { gpu.device.destroy_framebuffer(self.framebuffer, None) };
        for image in [self.depth, self.albedo, self.normal, self.mask, self.plane] {
            image.destroy(gpu);
        }
    }
}

/// Draws a model with the bound pipeline; viewport, scissor and render pass are the caller's.
pub fn draw_model(
    gpu: &Gpu,
    cmd: vk::CommandBuffer,
    layout: vk::PipelineLayout,
    model: &Model,
    push: &Push,
) {
    let device = &gpu.device;
    // SAFETY: inside a render pass with a pipeline of this layout bound; the model's buffers outlive
    // the frame, and its indices are within its vertices.
    unsafe {
        device.cmd_push_constants(cmd, layout, STAGES, 0, bytemuck::bytes_of(push));
        device.cmd_bind_vertex_buffers(cmd, 0, &[model.vertices.raw], &[0]);
        device.cmd_bind_index_buffer(cmd, model.indices.raw, 0, vk::IndexType::UINT32);
        device.cmd_draw_indexed(cmd, model.count, 1, 0, 0, 0);
    }
}

/// The layout of everything that draws models.
pub fn make_layout(gpu: &Gpu) -> Outcome<vk::PipelineLayout> {
    let ranges =
        [vk::PushConstantRange { stage_flags: STAGES, offset: 0, size: size_of::<Push>() as u32 }];
    let create = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&ranges);
    // SAFETY: the device lives; every device has 128 bytes of push constants.
    Ok(unsafe { gpu.device.create_pipeline_layout(&create, None) }?)
}

/// Positions and normals, as the vertex shader takes them.
pub fn vertex_input()
-> ([vk::VertexInputBindingDescription; 1], [vk::VertexInputAttributeDescription; 2]) {
    let binding = vk::VertexInputBindingDescription {
        binding: 0,
        stride: STRIDE,
        input_rate: vk::VertexInputRate::VERTEX,
    };
    let attributes = [0, 1].map(|location| vk::VertexInputAttributeDescription {
        location,
        binding: 0,
        format: vk::Format::R32G32B32_SFLOAT,
        offset: location * 12,
    });
    ([binding], attributes)
}

fn make_render_pass(gpu: &Gpu) -> Outcome<vk::RenderPass> {
    let attachment = |format, layout| {
        vk::AttachmentDescription::default()
            .format(format)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .initial_layout(vk::ImageLayout::UNDEFINED)
            .final_layout(layout)
    };
    let attachments = [
        attachment(ALBEDO, COLOR_DRAWN.layout),
        attachment(NORMAL, COLOR_DRAWN.layout),
        attachment(MASK, COLOR_DRAWN.layout),
        attachment(NORMAL, COLOR_DRAWN.layout),
        attachment(DEPTH, DEPTH_DRAWN.layout),
    ];
    let colors = [0, 1, 2, 3]
        .map(|attachment| vk::AttachmentReference { attachment, layout: COLOR_DRAWN.layout });
    let depth = vk::AttachmentReference { attachment: 4, layout: DEPTH_DRAWN.layout };
    let subpasses = [vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&colors)
        .depth_stencil_attachment(&depth)];
    // There is one G-buffer for all frames in flight. The frame before has been composed, in compute
    // shaders, before this one draws over it.
    use vk::{AccessFlags as Access, PipelineStageFlags as Stage};
    let dependencies = [vk::SubpassDependency {
        src_subpass: vk::SUBPASS_EXTERNAL,
        dst_subpass: 0,
        src_stage_mask: Stage::COMPUTE_SHADER,
        src_access_mask: Access::empty(),
        dst_stage_mask: Stage::EARLY_FRAGMENT_TESTS | Stage::COLOR_ATTACHMENT_OUTPUT,
        dst_access_mask: Access::DEPTH_STENCIL_ATTACHMENT_READ
            | Access::DEPTH_STENCIL_ATTACHMENT_WRITE
            | Access::COLOR_ATTACHMENT_WRITE,
        dependency_flags: vk::DependencyFlags::empty(),
    }];
    let create = vk::RenderPassCreateInfo::default()
        .attachments(&attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies);
    // SAFETY: the device lives; the references are within the attachments.
    Ok(unsafe { gpu.device.create_render_pass(&create, None) }?)
}

fn make_pipeline(
    gpu: &Gpu,
    render_pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    vertex: vk::ShaderModule,
    fragment: vk::ShaderModule,
) -> Outcome<vk::Pipeline> {
    let stage = |stage, module| {
        vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(c"main")
    };
    let stages = [
        stage(vk::ShaderStageFlags::VERTEX, vertex),
        stage(vk::ShaderStageFlags::FRAGMENT, fragment),
    ];
    let (bindings, attributes) = vertex_input();
    let input = vk::PipelineVertexInputStateCreateInfo::default()
        .vertex_binding_descriptions(&bindings)
        .vertex_attribute_descriptions(&attributes);
    let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
        .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
    let viewport =
        vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
    let raster = vk::PipelineRasterizationStateCreateInfo::default()
        // Models of glTF are single-sided unless they say otherwise, which those here do not.
        .cull_mode(vk::CullModeFlags::BACK)
        .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
        .line_width(1.0);
    let samples = vk::PipelineMultisampleStateCreateInfo::default()
        .rasterization_samples(vk::SampleCountFlags::TYPE_1);
    let depth = vk::PipelineDepthStencilStateCreateInfo::default()
        .depth_test_enable(true)
        .depth_write_enable(true)
        .depth_compare_op(vk::CompareOp::GREATER);
    let opaque = [vk::PipelineColorBlendAttachmentState::default()
        .color_write_mask(vk::ColorComponentFlags::RGBA); 4];
    let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&opaque);
    let states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
    let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
    let create = [vk::GraphicsPipelineCreateInfo::default()
        .stages(&stages)
        .vertex_input_state(&input)
        .input_assembly_state(&assembly)
        .viewport_state(&viewport)
        .rasterization_state(&raster)
        .multisample_state(&samples)
        .depth_stencil_state(&depth)
        .color_blend_state(&blend)
        .dynamic_state(&dynamic)
        .layout(layout)
        .render_pass(render_pass)];
    // SAFETY: all that the create info points to lives until the end of this call.
    let made = unsafe { gpu.device.create_graphics_pipelines(gpu.pipeline_cache, &create, None) };
    Ok(made.map_err(|(_, e)| e)?[0])
}
