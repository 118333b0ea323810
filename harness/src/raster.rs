//! A render pass of color attachments and depth, a pipeline that draws triangles in it, and the framebuffers
//! that it draws into.

use crate::module::ShaderModule;
use crate::set::BoundSet;
use crate::{HeadlessDevice, OwnedImage};
use antumbra::Error;
use antumbra::shaders::Module;
use ash::vk;

/// The depth attachment's format.
pub(crate) const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// The layouts that the attachments are left in.
pub(crate) const DEPTH_LAYOUT: vk::ImageLayout = vk::ImageLayout::DEPTH_STENCIL_READ_ONLY_OPTIMAL;
pub(crate) const COLOR_LAYOUT: vk::ImageLayout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;

/// The description of a raster.
pub(crate) struct RasterInfo<'a> {
    /// Formats of the color attachments.
    pub colors: &'a [vk::Format],
    /// The value that every channel of the color attachments is cleared to.
    pub background: f32,
    /// Whether a fragment's red is added to what is there, instead of its color taking its place.
    pub adds: bool,
    /// Whether there is depth behind the color attachments: cleared to 0, the greater kept.
    pub depth: bool,
    pub vertex: Module,
    pub fragment: Option<Module>,
    /// Vertex buffers: the floats of each attribute, as they lie one behind the other in a vertex.
    pub vertices: &'a [&'a [u32]],
    /// The descriptor set that the fragment shader reads.
    pub set: Option<BoundSet>,
    /// The layout of sets that draws bind themselves, where there is no such set.
    pub set_layout: Option<vk::DescriptorSetLayout>,
    /// Bytes of push constants, which all stages see.
    pub push: u32,
}

/// A pipeline and its render pass.
pub(crate) struct Raster {
    device: HeadlessDevice,
    clear: Vec<vk::ClearValue>,
    stages: vk::ShaderStageFlags,
    render_pass: vk::RenderPass,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    set: Option<BoundSet>,
}

/// The images that a raster draws into.
pub(crate) struct Target {
    device: HeadlessDevice,
    framebuffer: vk::Framebuffer,
    extent: vk::Extent2D,
}

/// Triangles: vertex buffers with their offsets, indices and their number.
pub(crate) struct Triangles<'a> {
    pub vertices: &'a [vk::Buffer],
    pub offsets: &'a [vk::DeviceSize],
    pub indices: (vk::Buffer, vk::DeviceSize, vk::IndexType),
    pub count: u32,
}

impl Raster {
    /// Makes the render pass and the pipeline; viewports are set while drawing.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn new(device: &HeadlessDevice, mut info: RasterInfo) -> Result<Self, Error> {
        let mut stages = vk::ShaderStageFlags::VERTEX;
        if info.fragment.is_some() {
            stages |= vk::ShaderStageFlags::FRAGMENT;
        }
        let color = vk::ClearColorValue { float32: [info.background; 4] };
        let mut clear = vec![vk::ClearValue { color }; info.colors.len()];
        // Reversed, infinitely far.
        clear.extend(info.depth.then(vk::ClearValue::default));
        // Dropping it cleans up from here on; null handles are legal to destroy.
        let mut new = Self {
            device: device.clone(),
            clear,
            stages,
            render_pass: vk::RenderPass::null(),
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
            set: info.set.take(),
        };
        new.make_render_pass(&info)?;
        let set_layouts: Vec<_> =
            new.set.iter().map(BoundSet::layout).chain(info.set_layout).collect();
        let ranges = [vk::PushConstantRange { stage_flags: stages, offset: 0, size: info.push }];
        let create = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(&ranges);
        // SAFETY: the device and the set's layout live; callers push no more than the 128 bytes that
        // Vulkan guarantees.
        new.layout = unsafe { device.device().create_pipeline_layout(&create, None) }
            .map_err(Error::vulkan("creating a raster's pipeline layout"))?;
        new.make_pipeline(&info)?;
        Ok(new)
    }

    fn make_render_pass(&mut self, info: &RasterInfo) -> Result<(), Error> {
        let attachment = |format, layout| {
            vk::AttachmentDescription::default()
                .format(format)
                .samples(vk::SampleCountFlags::TYPE_1)
                .load_op(vk::AttachmentLoadOp::CLEAR)
                .store_op(vk::AttachmentStoreOp::STORE)
                .initial_layout(vk::ImageLayout::UNDEFINED)
                .final_layout(layout)
        };
        let colors = info.colors.iter().map(|format| attachment(*format, COLOR_LAYOUT));
        let depth = info.depth.then(|| attachment(DEPTH, DEPTH_LAYOUT));
        let attachments: Vec<_> = colors.chain(depth).collect();
        let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let places = 0..info.colors.len() as u32;
        let colors: Vec<_> =
            places.map(|attachment| vk::AttachmentReference { attachment, layout }).collect();
        let depth = vk::AttachmentReference {
            attachment: info.colors.len() as u32,
            layout: vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        };
        let mut subpass = vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&colors);
        if info.depth {
            subpass = subpass.depth_stencil_attachment(&depth);
        }
        let subpasses = [subpass];
        // Whoever touched the images before is done before they are drawn to anew, and whoever comes next
        // waits by a barrier of its own.
        let all = vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
        let dependencies = [vk::SubpassDependency {
            src_subpass: vk::SUBPASS_EXTERNAL,
            dst_subpass: 0,
            src_stage_mask: vk::PipelineStageFlags::ALL_COMMANDS,
            dst_stage_mask: vk::PipelineStageFlags::ALL_GRAPHICS,
            src_access_mask: all,
            dst_access_mask: all,
            dependency_flags: vk::DependencyFlags::empty(),
        }];
        let create = vk::RenderPassCreateInfo::default()
            .attachments(&attachments)
            .subpasses(&subpasses)
            .dependencies(&dependencies);
        // SAFETY: the device lives; the references are within the attachments.
        self.render_pass = unsafe { self.device.device().create_render_pass(&create, None) }
            .map_err(Error::vulkan("creating a render pass"))?;
        Ok(())
    }

    fn make_pipeline(&mut self, info: &RasterInfo) -> Result<(), Error> {
        let load = |module: Module| ShaderModule::new(&self.device, &module.words(), module.path);
        let vertex = load(info.vertex)?;
        let fragment = info.fragment.map(load).transpose()?;
        let mut stages = vec![vertex.stage(vk::ShaderStageFlags::VERTEX)];
        stages.extend(fragment.iter().map(|f| f.stage(vk::ShaderStageFlags::FRAGMENT)));
        let (mut bindings, mut attributes) = (Vec::new(), Vec::new());
        for (binding, floats) in (0..).zip(info.vertices) {
            let mut stride = 0;
            for &count in *floats {
                attributes.push(vk::VertexInputAttributeDescription {
                    location: attributes.len() as u32,
                    binding,
                    format: match count {
                        2 => vk::Format::R32G32_SFLOAT,
                        _ => vk::Format::R32G32B32_SFLOAT,
                    },
                    offset: stride,
                });
                stride += 4 * count;
            }
            bindings.push(vk::VertexInputBindingDescription {
                binding,
                stride,
                input_rate: vk::VertexInputRate::VERTEX,
            });
        }
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
            .depth_test_enable(info.depth)
            .depth_write_enable(info.depth)
            .depth_compare_op(vk::CompareOp::GREATER);
        let color = vk::PipelineColorBlendAttachmentState::default();
        let color = match info.adds {
            true => color
                .blend_enable(true)
                .src_color_blend_factor(vk::BlendFactor::ONE)
                .dst_color_blend_factor(vk::BlendFactor::ONE)
                .color_write_mask(vk::ColorComponentFlags::R),
            false => color.color_write_mask(vk::ColorComponentFlags::RGBA),
        };
        let colors = vec![color; info.colors.len()];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&colors);
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
            .map_err(|(_, e)| Error::vulkan("creating a raster's pipeline")(e))?[0];
        Ok(())
    }

    /// A framebuffer of these images, the color attachments in order and then depth; all have one size.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn target(&self, images: &[&OwnedImage]) -> Result<Target, Error> {
        let [width, height] = images.first().map_or([0; 2], |image| image.extent());
        let views: Vec<_> = images.iter().map(|image| image.view()).collect();
        let create = vk::FramebufferCreateInfo::default()
            .render_pass(self.render_pass)
            .attachments(&views)
            .width(width)
            .height(height)
            .layers(1);
        // SAFETY: the views have the render pass's formats and this size.
        let framebuffer = unsafe { self.device.device().create_framebuffer(&create, None) }
            .map_err(Error::vulkan("creating a framebuffer"))?;
        let extent = vk::Extent2D { width, height };
        Ok(Target { device: self.device.clone(), framebuffer, extent })
    }

    /// Records the render pass and draws what `draw` draws by [`Self::draw`] into one of its targets.
    pub fn record(&self, cmd: vk::CommandBuffer, target: &Target, draw: impl FnOnce()) {
        let raw = self.device.device();
        let area = vk::Rect2D { extent: target.extent, ..Default::default() };
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(self.render_pass)
            .framebuffer(target.framebuffer)
            .render_area(area)
            .clear_values(&self.clear);
        let viewport = vk::Viewport {
            width: target.extent.width as f32,
            height: target.extent.height as f32,
            max_depth: 1.0,
            ..Default::default()
        };
        let point = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: the caller's cmd is recording outside a render pass; the framebuffer fits this one.
        unsafe { raw.cmd_begin_render_pass(cmd, &begin, vk::SubpassContents::INLINE) };
        // SAFETY: as above; the pipeline was made for this render pass.
        unsafe { raw.cmd_bind_pipeline(cmd, point, self.pipeline) };
        // SAFETY: as above.
        unsafe { raw.cmd_set_viewport(cmd, 0, &[viewport]) };
        // SAFETY: as above.
        unsafe { raw.cmd_set_scissor(cmd, 0, &[area]) };
        if let Some(set) = &self.set {
            // SAFETY: as above; the layout was made for this set.
            unsafe { set.bind(cmd, point, self.layout) };
        }
        draw();
        // SAFETY: the render pass was begun above.
        unsafe { raw.cmd_end_render_pass(cmd) };
    }

    /// Draws the next triangles by this pipeline inside another raster's [`Self::record`], whose attachments have the same
    /// formats; `set` is of the layout that this one was made for.
    pub fn take_over(&self, cmd: vk::CommandBuffer, set: vk::DescriptorSet) {
        let raw = self.device.device();
        let point = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: inside a render pass that is compatible with this one's; the set was written.
        unsafe { raw.cmd_bind_pipeline(cmd, point, self.pipeline) };
        // SAFETY: as above.
        unsafe { raw.cmd_bind_descriptor_sets(cmd, point, self.layout, 0, &[set], &[]) };
    }

    /// Draws triangles inside [`Self::record`].
    pub fn draw(&self, cmd: vk::CommandBuffer, push: &[u8], triangles: &Triangles) {
        let raw = self.device.device();
        let (vertices, offsets) = (triangles.vertices, triangles.offsets);
        let (indices, offset, kind) = triangles.indices;
        // SAFETY: inside the render pass; callers push the bytes that the layout was made for.
        unsafe { raw.cmd_push_constants(cmd, self.layout, self.stages, 0, push) };
        // SAFETY: as above; the buffers outlive the submit, which is waited for.
        unsafe { raw.cmd_bind_vertex_buffers(cmd, 0, vertices, offsets) };
        // SAFETY: as above.
        unsafe { raw.cmd_bind_index_buffer(cmd, indices, offset, kind) };
        // SAFETY: as above; the loader keeps indices within the mesh.
        unsafe { raw.cmd_draw_indexed(cmd, triangles.count, 1, 0, 0, 0) };
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
        unsafe { raw.destroy_render_pass(self.render_pass, None) };
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        // SAFETY: made from this device; every submit that draws into it is waited for.
        unsafe { self.device.device().destroy_framebuffer(self.framebuffer, None) };
    }
}
