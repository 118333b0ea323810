//! A G-buffer: depth, world position, normal and role of each pixel.

use super::{HeadlessDevice, OwnedImage, SceneBuffers, View};
use crate::graph::Scope;
use crate::scene::{Instance, Scene};
use crate::shaders::{self, Module};
use crate::{Error, HostImage};
use ash::vk;

const DEPTH: vk::Format = vk::Format::D32_SFLOAT;
const VECTOR: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
/// The roles' format: 255 blocks and receives, 128 receives only, 0 receives nothing.
pub(super) const MASK: vk::Format = vk::Format::R8_UNORM;

/// The layout that the G-buffer is left in.
const DEPTH_LAYOUT: vk::ImageLayout = vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL;
const COLOR_LAYOUT: vk::ImageLayout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;

/// The images, all of one size.
pub struct GBuffer {
    /// Reversed depth, D32_SFLOAT.
    pub depth: OwnedImage,
    /// World position in metres; 0 on background.
    pub position: OwnedImage,
    /// Unit world normal; 0 on background.
    pub normal: OwnedImage,
    /// Role; 0 on background.
    pub mask: OwnedImage,
}

/// Lends an image, and takes it back to be copied out in the layout that it is kept in.
fn lend(image: &OwnedImage, before: Scope) -> HostImage {
    image.lend(before, Scope::COPIED_FROM.in_layout(before.layout))
}

impl GBuffer {
    /// Images of a size, not yet painted.
    ///
    /// # Errors
    /// As [`OwnedImage::new`].
    pub fn new(device: &HeadlessDevice, extent: [u32; 2]) -> Result<Self, Error> {
        use vk::ImageUsageFlags as Usage;
        let color = Usage::COLOR_ATTACHMENT | Usage::SAMPLED;
        let depth = Usage::DEPTH_STENCIL_ATTACHMENT | Usage::SAMPLED;
        Ok(Self {
            depth: OwnedImage::new(device, "gbuffer.depth", DEPTH, extent, depth)?,
            position: OwnedImage::new(device, "gbuffer.position", VECTOR, extent, color)?,
            normal: OwnedImage::new(device, "gbuffer.normal", VECTOR, extent, color)?,
            mask: OwnedImage::new(device, "gbuffer.mask", MASK, extent, color)?,
        })
    }

    /// The depth image as the node takes it, left by the G-buffer's render pass.
    pub fn depth_for_node(&self) -> HostImage {
        lend(&self.depth, Scope::DEPTH_DRAWN.in_layout(DEPTH_LAYOUT))
    }

    /// The mask as the node takes it.
    pub fn mask_for_node(&self) -> HostImage {
        lend(&self.mask, Scope::COLOR_DRAWN.in_layout(COLOR_LAYOUT))
    }

    /// Reads world positions, row by row.
    ///
    /// # Errors
    /// As [`OwnedImage::read`].
    pub fn positions(&self) -> Result<Vec<[f32; 4]>, Error> {
        self.position.read(COLOR_LAYOUT)
    }

    /// Reads world normals, row by row.
    ///
    /// # Errors
    /// As [`OwnedImage::read`].
    pub fn normals(&self) -> Result<Vec<[f32; 4]>, Error> {
        self.normal.read(COLOR_LAYOUT)
    }

    /// Reads roles, row by row.
    ///
    /// # Errors
    /// As [`OwnedImage::read`].
    pub fn roles(&self) -> Result<Vec<u8>, Error> {
        self.mask.read(COLOR_LAYOUT)
    }
}

/// 124 bytes of the vertex stage and 4 of the fragment stage.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Push {
    clip_from_mesh: [f32; 16],
    /// Columns of three, the fourth float of each but the last unused.
    world_from_mesh: [f32; 15],
    role: f32,
}

/// Draws G-buffers.
pub struct GBufferPainter {
    device: HeadlessDevice,
    render_pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
}

impl GBufferPainter {
    /// Makes the render pass and the pipeline; viewports are set while drawing.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn new(device: &HeadlessDevice) -> Result<Self, Error> {
        let mut new = Self {
            device: device.clone(),
            render_pass: vk::RenderPass::null(),
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
        };
        new.make_render_pass()?;
        let raw = device.device();
        let ranges = [vk::PushConstantRange {
            stage_flags: vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT,
            offset: 0,
            size: size_of::<Push>() as u32,
        }];
        let create = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&ranges);
        // SAFETY: the device lives; 128 bytes are what Vulkan guarantees.
        new.layout = unsafe { raw.create_pipeline_layout(&create, None) }
            .map_err(Error::vulkan("creating the G-buffer's pipeline layout"))?;
        let vertex = new.module(shaders::GBUFFER_VERT)?;
        let fragment = new.module(shaders::GBUFFER_FRAG);
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

    fn make_render_pass(&mut self) -> Result<(), Error> {
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
            attachment(VECTOR, COLOR_LAYOUT),
            attachment(VECTOR, COLOR_LAYOUT),
            attachment(MASK, COLOR_LAYOUT),
            attachment(DEPTH, DEPTH_LAYOUT),
        ];
        let color = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let colors =
            [0, 1, 2].map(|attachment| vk::AttachmentReference { attachment, layout: color });
        let depth = vk::AttachmentReference {
            attachment: 3,
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
            .map_err(Error::vulkan("creating the G-buffer's render pass"))?;
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
            .vertex_binding_descriptions(&bindings)
            .vertex_attribute_descriptions(&attributes);
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
        let attachments = [all; 3];
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
        let (raw, cache) = (self.device.device(), vk::PipelineCache::null());
        // SAFETY: every state that the create info points to lives until the end of this call.
        self.pipeline = unsafe { raw.create_graphics_pipelines(cache, &create, None) }
            .map_err(|(_, e)| Error::vulkan("creating the G-buffer's pipeline")(e))?[0];
        Ok(())
    }

    /// Paints the instances that `keep` accepts, submits and waits.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn paint(
        &self,
        gbuffer: &GBuffer,
        scene: &Scene,
        buffers: &SceneBuffers,
        view: &View,
        keep: impl Fn(&Instance) -> bool,
    ) -> Result<(), Error> {
        let [width, height] = gbuffer.depth.extent();
        let images = [&gbuffer.position, &gbuffer.normal, &gbuffer.mask, &gbuffer.depth];
        let views = images.map(OwnedImage::view);
        let create = vk::FramebufferCreateInfo::default()
            .render_pass(self.render_pass)
            .attachments(&views)
            .width(width)
            .height(height)
            .layers(1);
        let raw = self.device.device();
        // SAFETY: the views have the render pass's formats and this size.
        let framebuffer = unsafe { raw.create_framebuffer(&create, None) }
            .map_err(Error::vulkan("creating the G-buffer's framebuffer"))?;
        let painted = self.device.submit_and_wait(|cmd| {
            self.record(cmd, framebuffer, [width, height], scene, buffers, view, keep);
            Ok(())
        });
        // SAFETY: the commands that use it are done.
        unsafe { raw.destroy_framebuffer(framebuffer, None) };
        painted
    }

    #[expect(clippy::too_many_arguments, reason = "the parts of one draw, used in one place")]
    fn record(
        &self,
        cmd: vk::CommandBuffer,
        framebuffer: vk::Framebuffer,
        [width, height]: [u32; 2],
        scene: &Scene,
        buffers: &SceneBuffers,
        view: &View,
        keep: impl Fn(&Instance) -> bool,
    ) {
        let raw = self.device.device();
        let area = vk::Rect2D { extent: vk::Extent2D { width, height }, ..Default::default() };
        // All zero: background.
        let clear = [vk::ClearValue::default(); 4];
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
        for instance in scene.instances.iter().filter(|i| keep(i)) {
            let Some((positions, normals, indices, count)) = buffers.draw(instance.mesh) else {
                continue;
            };
            let push = push_of(instance, view);
            let stages = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
            let bytes = bytemuck::bytes_of(&push);
            // SAFETY: as above; the range is the layout's.
            unsafe { raw.cmd_push_constants(cmd, self.layout, stages, 0, bytes) };
            // SAFETY: as above; the scene's buffers outlive the submit, which is waited for.
            unsafe { raw.cmd_bind_vertex_buffers(cmd, 0, &[positions, normals], &[0, 0]) };
            // SAFETY: as above.
            unsafe { raw.cmd_bind_index_buffer(cmd, indices, 0, vk::IndexType::UINT32) };
            // SAFETY: as above; the loader keeps indices within the mesh.
            unsafe { raw.cmd_draw_indexed(cmd, count, 1, 0, 0, 0) };
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

impl Drop for GBufferPainter {
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
