//! One pipeline that draws into one image: a render pass, a framebuffer, at most one fetched image.

use crate::{HeadlessDevice, OwnedImage};
use antumbra::Error;
use antumbra::shaders::Module;
use ash::vk;

/// What is drawn into.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Attachment {
    /// Depth, cleared to 0, the greater kept.
    Depth,
    /// One color channel, cleared to 0, fragments added.
    Add,
}

/// What a pipeline is made of.
pub(crate) struct RasterInfo<'a> {
    pub target: &'a OwnedImage,
    pub attachment: Attachment,
    pub vertex: Module,
    pub fragment: Option<Module>,
    /// Offset and floats of each vertex attribute, and the bytes of a vertex.
    pub attributes: &'a [(u32, u32)],
    pub stride: u32,
    /// An image that the fragment shader fetches, and its binding.
    pub fetched: Option<(u32, &'a OwnedImage)>,
    /// Bytes of push constants, for both stages.
    pub push: u32,
}

/// A pipeline and its framebuffer. The target is left in the layout of its attachment.
pub(crate) struct Raster {
    device: HeadlessDevice,
    attachment: Attachment,
    extent: vk::Extent2D,
    render_pass: vk::RenderPass,
    framebuffer: vk::Framebuffer,
    set_layout: vk::DescriptorSetLayout,
    pool: vk::DescriptorPool,
    set: Option<vk::DescriptorSet>,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    stages: vk::ShaderStageFlags,
}

/// The layout that fetched images must be in.
pub(crate) const FETCHED: vk::ImageLayout = vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL;

impl Raster {
    pub fn new(device: &HeadlessDevice, info: &RasterInfo) -> Result<Self, Error> {
        let [width, height] = info.target.extent();
        let mut stages = vk::ShaderStageFlags::VERTEX;
        if info.fragment.is_some() {
            stages |= vk::ShaderStageFlags::FRAGMENT;
        }
        // Dropping it cleans up from here on; null handles are legal to destroy.
        let mut new = Self {
            device: device.clone(),
            attachment: info.attachment,
            extent: vk::Extent2D { width, height },
            render_pass: vk::RenderPass::null(),
            framebuffer: vk::Framebuffer::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            pool: vk::DescriptorPool::null(),
            set: None,
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
            stages,
        };
        new.make_target(info)?;
        new.make_set(info)?;
        let set_layouts = [new.set_layout];
        let ranges = [vk::PushConstantRange { stage_flags: stages, offset: 0, size: info.push }];
        let mut create = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&ranges);
        if new.set.is_some() {
            create = create.set_layouts(&set_layouts);
        }
        // SAFETY: the device lives, and the set layout was made from it.
        new.layout = unsafe { device.device().create_pipeline_layout(&create, None) }
            .map_err(Error::vulkan("creating a pipeline layout"))?;
        new.make_pipeline(info)?;
        Ok(new)
    }

    fn own_layout(&self) -> vk::ImageLayout {
        match self.attachment {
            Attachment::Depth => vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
            Attachment::Add => vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        }
    }

    fn make_target(&mut self, info: &RasterInfo) -> Result<(), Error> {
        let layout = self.own_layout();
        let attachments = [vk::AttachmentDescription::default()
            .format(info.target.format())
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .initial_layout(vk::ImageLayout::UNDEFINED)
            .final_layout(layout)];
        let reference = [vk::AttachmentReference { attachment: 0, layout }];
        let subpass =
            vk::SubpassDescription::default().pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS);
        let subpasses = [match self.attachment {
            Attachment::Depth => subpass.depth_stencil_attachment(&reference[0]),
            Attachment::Add => subpass.color_attachments(&reference),
        }];
        // Whoever touched the image before is done before it is drawn to anew.
        let any = vk::PipelineStageFlags::ALL_COMMANDS;
        let all = vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
        let dependencies = [vk::SubpassDependency {
            src_subpass: vk::SUBPASS_EXTERNAL,
            dst_subpass: 0,
            src_stage_mask: any,
            dst_stage_mask: vk::PipelineStageFlags::ALL_GRAPHICS,
            src_access_mask: all,
            dst_access_mask: all,
            dependency_flags: vk::DependencyFlags::empty(),
        }];
        let create = vk::RenderPassCreateInfo::default()
            .attachments(&attachments)
            .subpasses(&subpasses)
            .dependencies(&dependencies);
        let raw = self.device.device();
        // SAFETY: one attachment, one subpass that uses it.
        self.render_pass = unsafe { raw.create_render_pass(&create, None) }
            .map_err(Error::vulkan("creating a render pass"))?;
        let views = [info.target.view()];
        let create = vk::FramebufferCreateInfo::default()
            .render_pass(self.render_pass)
            .attachments(&views)
            .width(self.extent.width)
            .height(self.extent.height)
            .layers(1);
        // SAFETY: the view has the render pass's format and this size.
        self.framebuffer = unsafe { raw.create_framebuffer(&create, None) }
            .map_err(Error::vulkan("creating a framebuffer"))?;
        Ok(())
    }

    fn make_set(&mut self, info: &RasterInfo) -> Result<(), Error> {
        let Some((binding, image)) = info.fetched else { return Ok(()) };
        let raw = self.device.device();
        let kind = vk::DescriptorType::SAMPLED_IMAGE;
        let bindings = [vk::DescriptorSetLayoutBinding::default()
            .binding(binding)
            .descriptor_type(kind)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::FRAGMENT)];
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device lives.
        self.set_layout = unsafe { raw.create_descriptor_set_layout(&create, None) }
            .map_err(Error::vulkan("creating a descriptor set layout"))?;
        let sizes = [vk::DescriptorPoolSize { ty: kind, descriptor_count: 1 }];
        let create = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: as above.
        self.pool = unsafe { raw.create_descriptor_pool(&create, None) }
            .map_err(Error::vulkan("creating a descriptor pool"))?;
        let layouts = [self.set_layout];
        let allocate = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool was made for this one set.
        let set = unsafe { raw.allocate_descriptor_sets(&allocate) }
            .map_err(Error::vulkan("allocating a descriptor set"))?[0];
        let infos =
            [vk::DescriptorImageInfo::default().image_view(image.view()).image_layout(FETCHED)];
        let write = [vk::WriteDescriptorSet::default()
            .dst_set(set)
            .dst_binding(binding)
            .descriptor_type(kind)
            .image_info(&infos)];
        // SAFETY: the set is new, and the view outlives it.
        unsafe { raw.update_descriptor_sets(&write, &[]) };
        self.set = Some(set);
        Ok(())
    }

    fn make_pipeline(&mut self, info: &RasterInfo) -> Result<(), Error> {
        let shaders = [
            Some((info.vertex, vk::ShaderStageFlags::VERTEX)),
            info.fragment.map(|f| (f, vk::ShaderStageFlags::FRAGMENT)),
        ];
        let mut modules = Vec::new();
        let raw = self.device.device().clone();
        for (module, stage) in shaders.into_iter().flatten() {
            let words = module.words();
            let create = vk::ShaderModuleCreateInfo::default().code(&words);
            // SAFETY: tests validate the module.
            match unsafe { raw.create_shader_module(&create, None) } {
                Ok(made) => modules.push((made, stage)),
                Err(e) => {
                    destroy(&raw, &modules);
                    return Err(Error::vulkan(format!("loading {}", module.path))(e));
                }
            }
        }
        let made = self.make_from(info, &modules);
        destroy(&raw, &modules);
        self.pipeline = made?;
        Ok(())
    }

    fn make_from(
        &self,
        info: &RasterInfo,
        modules: &[(vk::ShaderModule, vk::ShaderStageFlags)],
    ) -> Result<vk::Pipeline, Error> {
        let stages: Vec<_> = modules
            .iter()
            .map(|&(module, stage)| {
                let info = vk::PipelineShaderStageCreateInfo::default();
                info.stage(stage).module(module).name(c"main")
            })
            .collect();
        let bindings = [vk::VertexInputBindingDescription::default().stride(info.stride)];
        let format = |floats| match floats {
            2 => vk::Format::R32G32_SFLOAT,
            _ => vk::Format::R32G32B32_SFLOAT,
        };
        let attributes: Vec<_> = info
            .attributes
            .iter()
            .zip(0..)
            .map(|(&(offset, floats), location)| vk::VertexInputAttributeDescription {
                location,
                binding: 0,
                format: format(floats),
                offset,
            })
            .collect();
        let input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&bindings)
            .vertex_attribute_descriptions(&attributes);
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewports = [vk::Viewport {
            width: self.extent.width as f32,
            height: self.extent.height as f32,
            max_depth: 1.0,
            ..Default::default()
        }];
        let scissors = [vk::Rect2D { extent: self.extent, ..Default::default() }];
        let viewport = vk::PipelineViewportStateCreateInfo::default()
            .viewports(&viewports)
            .scissors(&scissors);
        let raster = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let is_depth = self.attachment == Attachment::Depth;
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(is_depth)
            .depth_write_enable(is_depth)
            .depth_compare_op(vk::CompareOp::GREATER);
        let add = [vk::PipelineColorBlendAttachmentState::default()
            .blend_enable(true)
            .src_color_blend_factor(vk::BlendFactor::ONE)
            .dst_color_blend_factor(vk::BlendFactor::ONE)
            .color_write_mask(vk::ColorComponentFlags::R)];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(if is_depth {
            &[]
        } else {
            &add
        });
        let create = [vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .layout(self.layout)
            .render_pass(self.render_pass)];
        let (raw, cache) = (self.device.device(), self.device.pipeline_cache());
        // SAFETY: every state that the create info points to lives until the end of this call.
        unsafe { raw.create_graphics_pipelines(cache, &create, None) }
            .map(|made| made[0])
            .map_err(|(_, e)| Error::vulkan("creating a pipeline")(e))
    }

    /// Begins the render pass and binds everything but geometry.
    pub fn begin(&self, cmd: vk::CommandBuffer) {
        let raw = self.device.device();
        let clear = [vk::ClearValue::default()];
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(self.render_pass)
            .framebuffer(self.framebuffer)
            .render_area(vk::Rect2D { extent: self.extent, ..Default::default() })
            .clear_values(&clear);
        let point = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: the caller's cmd is recording outside a render pass.
        unsafe { raw.cmd_begin_render_pass(cmd, &begin, vk::SubpassContents::INLINE) };
        // SAFETY: as above; the pipeline was made for this render pass.
        unsafe { raw.cmd_bind_pipeline(cmd, point, self.pipeline) };
        if let Some(set) = self.set {
            // SAFETY: as above; the set has the layout's one set layout.
            unsafe { raw.cmd_bind_descriptor_sets(cmd, point, self.layout, 0, &[set], &[]) };
        }
    }

    /// Draws indexed triangles inside [`Self::begin`] and [`Self::end`].
    pub fn draw(
        &self,
        cmd: vk::CommandBuffer,
        push: &[u8],
        vertices: (vk::Buffer, u64),
        indices: (vk::Buffer, u64, vk::IndexType),
        count: u32,
    ) {
        let raw = self.device.device();
        // SAFETY: inside the render pass; callers push the bytes that the layout was made for.
        unsafe { raw.cmd_push_constants(cmd, self.layout, self.stages, 0, push) };
        // SAFETY: as above; the buffers outlive the submit, which is waited for.
        unsafe { raw.cmd_bind_vertex_buffers(cmd, 0, &[vertices.0], &[vertices.1]) };
        // SAFETY: as above.
        unsafe { raw.cmd_bind_index_buffer(cmd, indices.0, indices.1, indices.2) };
        // SAFETY: as above.
        unsafe { raw.cmd_draw_indexed(cmd, count, 1, 0, 0, 0) };
    }

    /// Ends the render pass.
    pub fn end(&self, cmd: vk::CommandBuffer) {
        // SAFETY: `begin` began it.
        unsafe { self.device.device().cmd_end_render_pass(cmd) };
    }
}

fn destroy(raw: &ash::Device, modules: &[(vk::ShaderModule, vk::ShaderStageFlags)]) {
    for &(module, _) in modules {
        // SAFETY: pipelines do not need their modules once they are made.
        unsafe { raw.destroy_shader_module(module, None) };
    }
}

impl Drop for Raster {
    fn drop(&mut self) {
        let raw = self.device.device();
        // SAFETY: made from this device; every submit is waited for; null is allowed.
        unsafe { raw.destroy_pipeline(self.pipeline, None) };
        // SAFETY: as above.
        unsafe { raw.destroy_pipeline_layout(self.layout, None) };
        // SAFETY: as above.
        unsafe { raw.destroy_descriptor_pool(self.pool, None) };
        // SAFETY: as above.
        unsafe { raw.destroy_descriptor_set_layout(self.set_layout, None) };
        // SAFETY: as above.
        unsafe { raw.destroy_framebuffer(self.framebuffer, None) };
        // SAFETY: as above.
        unsafe { raw.destroy_render_pass(self.render_pass, None) };
    }
}
