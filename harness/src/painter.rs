//! Scenes drawn into color attachments and reversed depth: G-buffers, and whatever a fragment shader makes
//! of the same fragments.

use crate::shaders::GBUFFER_VERT;
use crate::{HeadlessDevice, OwnedImage, SceneBuffers, View};
use antumbra::Error;
use antumbra::scene::{Instance, Scene};
use antumbra::shaders::{DEPTH_VERT, Module};
use ash::vk;
use std::time::Duration;

/// The depth attachment's format.
pub(crate) const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// The layouts that the attachments are left in.
pub(crate) const DEPTH_LAYOUT: vk::ImageLayout = vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL;
pub(crate) const COLOR_LAYOUT: vk::ImageLayout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;

/// 124 bytes of the vertex stage and 4 of the fragment stage.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Push {
    clip_from_mesh: [f32; 16],
    /// Columns of three, the fourth float of each but the last unused.
    world_from_mesh: [f32; 15],
    role: f32,
}

/// A mesh ready to be drawn. Its buffers are the [`SceneBuffers`]' that it was made of, which must live as
/// long.
pub(crate) struct SceneDraw {
    push: Push,
    positions: vk::Buffer,
    normals: vk::Buffer,
    indices: vk::Buffer,
    count: u32,
}

/// The instances that `keep` accepts, as a view sees them.
pub(crate) fn draws(
    scene: &Scene,
    buffers: &SceneBuffers,
    view: &View,
    keep: impl Fn(&Instance) -> bool,
) -> Vec<SceneDraw> {
    let draw = |instance: &Instance| {
        let (positions, normals, indices, count) = buffers.draw(instance.mesh)?;
        Some(SceneDraw { push: push_of(instance, view), positions, normals, indices, count })
    };
    scene.instances.iter().filter(|i| keep(i)).filter_map(draw).collect()
}

/// A render pass, and a pipeline of a vertex and a fragment shader.
pub(crate) struct Painter {
    device: HeadlessDevice,
    colors: usize,
    /// What color attachments begin as, in every channel.
    background: f32,
    /// Whether the vertex shader reads normals and writes what is interpolated.
    normals: bool,
    render_pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
}

impl Painter {
    /// Makes the render pass and the pipeline; viewports are set while drawing. The fragment shader writes
    /// color attachments of these formats and may read one set. It gets world positions and normals, or with
    /// `inputs` off nothing: what is written and not read is worth a warning to the validation layer.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn new(
        device: &HeadlessDevice,
        colors: &[vk::Format],
        background: f32,
        fragment: Module,
        inputs: bool,
        set_layout: Option<vk::DescriptorSetLayout>,
    ) -> Result<Self, Error> {
        let mut new = Self {
            device: device.clone(),
            colors: colors.len(),
            background,
            normals: inputs,
            render_pass: vk::RenderPass::null(),
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
        };
        new.make_render_pass(colors)?;
        let raw = device.device();
        let ranges = [vk::PushConstantRange {
            stage_flags: vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT,
            offset: 0,
            size: size_of::<Push>() as u32,
        }];
        let create = vk::PipelineLayoutCreateInfo::default()
            .push_constant_ranges(&ranges)
            .set_layouts(set_layout.as_slice());
        // SAFETY: the device lives, as does the caller's set layout; 128 bytes are what Vulkan
        // guarantees.
        new.layout = unsafe { raw.create_pipeline_layout(&create, None) }
            .map_err(Error::vulkan("creating a painter's pipeline layout"))?;
        // Both put a vertex where the other does.
        let vertex = if inputs { GBUFFER_VERT } else { DEPTH_VERT };
        let vertex = new.module(vertex)?;
        let fragment = new.module(fragment);
        let made = match fragment {
            Ok(fragment) => {
                let made = new.make_pipeline(vertex, fragment);
                // SAFETY: pipelines do not need their modules once they are made.
                unsafe { raw.destroy_shader_module(fragment, None) };
                made
            }
            Err(e) => Err(e),
        };
        // SAFETY: as above.
        unsafe { raw.destroy_shader_module(vertex, None) };
        made?;
        Ok(new)
    }

    fn module(&self, module: Module) -> Result<vk::ShaderModule, Error> {
        let words = module.words();
        let create = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the device lives; tests validate the module.
        unsafe { self.device.device().create_shader_module(&create, None) }
            .map_err(Error::vulkan(format!("loading {}", module.path)))
    }

    fn make_render_pass(&mut self, formats: &[vk::Format]) -> Result<(), Error> {
        let attachment = |format, layout| {
            vk::AttachmentDescription::default()
                .format(format)
                .samples(vk::SampleCountFlags::TYPE_1)
                .load_op(vk::AttachmentLoadOp::CLEAR)
                .store_op(vk::AttachmentStoreOp::STORE)
                .initial_layout(vk::ImageLayout::UNDEFINED)
                .final_layout(layout)
        };
        let colors = formats.iter().map(|format| attachment(*format, COLOR_LAYOUT));
        let attachments: Vec<_> = colors.chain([attachment(DEPTH, DEPTH_LAYOUT)]).collect();
        let color = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let colors: Vec<_> = (0..)
            .zip(formats)
            .map(|(attachment, _)| vk::AttachmentReference { attachment, layout: color })
            .collect();
        let depth = vk::AttachmentReference {
            attachment: formats.len() as u32,
            layout: vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        };
        let subpasses = [vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&colors)
            .depth_stencil_attachment(&depth)];
        // Whoever touched the images before is done before they are drawn, and whoever comes next
        // waits by a barrier of its own.
        let any = vk::PipelineStageFlags::ALL_GRAPHICS;
        let dependencies = [vk::SubpassDependency {
            src_subpass: vk::SUBPASS_EXTERNAL,
            dst_subpass: 0,
            src_stage_mask: any,
            dst_stage_mask: any,
            src_access_mask: vk::AccessFlags::MEMORY_WRITE,
            dst_access_mask: vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE,
            dependency_flags: vk::DependencyFlags::empty(),
        }];
        let create = vk::RenderPassCreateInfo::default()
            .attachments(&attachments)
            .subpasses(&subpasses)
            .dependencies(&dependencies);
        // SAFETY: the device lives; the references are within the attachments.
        self.render_pass = unsafe { self.device.device().create_render_pass(&create, None) }
            .map_err(Error::vulkan("creating a painter's render pass"))?;
        Ok(())
    }

    fn make_pipeline(
        &mut self,
        vertex: vk::ShaderModule,
        fragment: vk::ShaderModule,
    ) -> Result<(), Error> {
        let stage = |stage, module| {
            vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(c"main")
        };
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, vertex),
            stage(vk::ShaderStageFlags::FRAGMENT, fragment),
        ];
        let count = if self.normals { 2 } else { 1 };
        let bindings = [0, 1].map(|binding| vk::VertexInputBindingDescription {
            binding,
            stride: 12,
            input_rate: vk::VertexInputRate::VERTEX,
        });
        let attributes = [0, 1].map(|location| vk::VertexInputAttributeDescription {
            location,
            binding: location,
            format: vk::Format::R32G32B32_SFLOAT,
            offset: 0,
        });
        let input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&bindings[..count])
            .vertex_attribute_descriptions(&attributes[..count]);
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport =
            vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(true)
            .depth_write_enable(true)
            .depth_compare_op(vk::CompareOp::GREATER);
        let all = vk::PipelineColorBlendAttachmentState::default()
            .color_write_mask(vk::ColorComponentFlags::RGBA);
        let attachments = vec![all; self.colors];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&attachments);
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
            .layout(self.layout)
            .render_pass(self.render_pass)];
        let (raw, cache) = (self.device.device(), self.device.pipeline_cache());
        // SAFETY: every state that the create info points to lives until the end of this call.
        self.pipeline = unsafe { raw.create_graphics_pipelines(cache, &create, None) }
            .map_err(|(_, e)| Error::vulkan("creating a painter's pipeline")(e))?[0];
        Ok(())
    }

    /// Paints into the images, the color attachments in order and then depth, submits and waits; how long
    /// that took. All have one size.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn paint(
        &self,
        images: &[&OwnedImage],
        set: Option<vk::DescriptorSet>,
        draws: &[SceneDraw],
    ) -> Result<Duration, Error> {
        let [width, height] = images.first().map_or([0; 2], |image| image.extent());
        let views: Vec<_> = images.iter().map(|image| image.view()).collect();
        let create = vk::FramebufferCreateInfo::default()
            .render_pass(self.render_pass)
            .attachments(&views)
            .width(width)
            .height(height)
            .layers(1);
        let raw = self.device.device();
        // SAFETY: the views have the render pass's formats and this size.
        let framebuffer = unsafe { raw.create_framebuffer(&create, None) }
            .map_err(Error::vulkan("creating a painter's framebuffer"))?;
        let painted = self.device.submit_timed(|cmd| {
            self.record(cmd, framebuffer, [width, height], set, draws);
            Ok(())
        });
        // SAFETY: the commands that use it are done.
        unsafe { raw.destroy_framebuffer(framebuffer, None) };
        Ok(painted?.1)
    }

    fn record(
        &self,
        cmd: vk::CommandBuffer,
        framebuffer: vk::Framebuffer,
        [width, height]: [u32; 2],
        set: Option<vk::DescriptorSet>,
        draws: &[SceneDraw],
    ) {
        let raw = self.device.device();
        let area = vk::Rect2D { extent: vk::Extent2D { width, height }, ..Default::default() };
        let color = vk::ClearColorValue { float32: [self.background; 4] };
        let mut clear = vec![vk::ClearValue { color }; self.colors];
        // Reversed, infinitely far.
        clear.push(vk::ClearValue::default());
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(self.render_pass)
            .framebuffer(framebuffer)
            .render_area(area)
            .clear_values(&clear);
        let viewport = vk::Viewport {
            width: width as f32,
            height: height as f32,
            max_depth: 1.0,
            ..Default::default()
        };
        // SAFETY: cmd is recording; the framebuffer fits the render pass.
        unsafe { raw.cmd_begin_render_pass(cmd, &begin, vk::SubpassContents::INLINE) };
        // SAFETY: recording inside the render pass, with a pipeline made for it.
        unsafe { raw.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::GRAPHICS, self.pipeline) };
        // SAFETY: as above.
        unsafe { raw.cmd_set_viewport(cmd, 0, &[viewport]) };
        // SAFETY: as above.
        unsafe { raw.cmd_set_scissor(cmd, 0, &[area]) };
        if let Some(set) = set {
            let point = vk::PipelineBindPoint::GRAPHICS;
            // SAFETY: as above; the set has the layout's one set layout.
            unsafe { raw.cmd_bind_descriptor_sets(cmd, point, self.layout, 0, &[set], &[]) };
        }
        for draw in draws {
            let stages = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
            let bytes = bytemuck::bytes_of(&draw.push);
            let vertices = [draw.positions, draw.normals];
            // SAFETY: as above; the range is the layout's.
            unsafe { raw.cmd_push_constants(cmd, self.layout, stages, 0, bytes) };
            // SAFETY: as above; the scene's buffers outlive the submit, which is waited for.
            unsafe { raw.cmd_bind_vertex_buffers(cmd, 0, &vertices, &[0, 0]) };
            // SAFETY: as above.
            unsafe { raw.cmd_bind_index_buffer(cmd, draw.indices, 0, vk::IndexType::UINT32) };
            // SAFETY: as above; the loader keeps indices within the mesh.
            unsafe { raw.cmd_draw_indexed(cmd, draw.count, 1, 0, 0, 0) };
        }
        // SAFETY: the render pass was begun above.
        unsafe { raw.cmd_end_render_pass(cmd) };
    }
}

fn push_of(instance: &Instance, view: &View) -> Push {
    let m = instance.world_from_mesh;
    let mut world_from_mesh = [0.0; 15];
    for (column, c) in [m.x_axis, m.y_axis, m.z_axis, m.w_axis].iter().enumerate() {
        for (row, value) in c.truncate().to_array().into_iter().enumerate() {
            world_from_mesh[column * 4 + row] = value as f32;
        }
    }
    Push {
        clip_from_mesh: (view.clip_from_world * m).as_mat4().to_cols_array(),
        world_from_mesh,
        role: f32::from(instance.role.mask()) / 255.0,
    }
}

impl Drop for Painter {
    fn drop(&mut self) {
        let raw = self.device.device();
        // SAFETY: made from this device; `paint` waits, so nothing uses them; null is allowed.
        unsafe { raw.destroy_pipeline(self.pipeline, None) };
        // SAFETY: as above.
        unsafe { raw.destroy_pipeline_layout(self.layout, None) };
        // SAFETY: as above.
        unsafe { raw.destroy_render_pass(self.render_pass, None) };
    }
}
