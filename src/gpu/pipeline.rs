//! The pipelines, the layouts and, for draws, the render pass of a kind of pass.

use super::host::Host;
use super::layouts::{LayoutsInfo, OfMesh, PassLayouts};
use super::maker::Maker;
use super::objects::{Objects, name};
use super::owner::ObjectOwner;
use crate::Error;
use crate::frame::Faces;
use crate::graph::{Draw, Graph, Pass, ResourceId, Shape, Target, Work};
use crate::shaders::Module;
use crate::stages::depth_layers::DepthPush;
use crate::stages::hierarchy::{CutOutPush, MeshPush};
use ash::vk;

/// The objects that record the passes of one kind.
#[derive(Default)]
pub(crate) struct PassObjects {
    pub layouts: PassLayouts,
    pub push_stages: vk::ShaderStageFlags,
    /// The pipelines: one for compute and indirect draws; for meshes one for each stride and each of [`Faces`].
    pub pipelines: Vec<vk::Pipeline>,
    /// The pipelines for meshes that textures cut out, in the same order; empty where the description has none.
    pub cut_pipelines: Vec<vk::Pipeline>,
    pub render_pass: vk::RenderPass,
    pub framebuffer: vk::Framebuffer,
    pub extent: vk::Extent2D,
    /// The number of color attachments of a draw.
    pub colors: usize,
}

/// The index of the pipeline that draws a mesh, among those of its pass.
pub(crate) fn variant(stride: usize, faces: Faces) -> usize {
    stride * 3 + faces as usize
}

impl PassObjects {
    /// Creates all objects for a kind of pass but the framebuffer, which needs images: see [`Self::attach`].
    pub fn new(
        maker: &mut Maker,
        graph: &Graph,
        pass: &Pass,
        strides: &[u32],
    ) -> Result<Self, Error> {
        let host = maker.host;
        let bindings: Vec<_> = pass
            .uses
            .iter()
            .filter_map(|u| {
                Some(
                    vk::DescriptorSetLayoutBinding::default()
                        .binding(u.binding?.into())
                        .descriptor_type(u.access.descriptor()?)
                        .descriptor_count(1)
                        .stage_flags(u.access.shader_stage()),
                )
            })
            .collect();
        let (stages, push_bytes) = match pass.work {
            Work::Dispatch { .. } | Work::Indirect { .. } => {
                (vk::ShaderStageFlags::COMPUTE, pass.push.bytes().len())
            }
            Work::EachMesh { .. } => (vk::ShaderStageFlags::COMPUTE, size_of::<MeshPush>()),
            Work::EachCutOut { .. } => (vk::ShaderStageFlags::COMPUTE, size_of::<CutOutPush>()),
            // A command writes them into a buffer, and no shader sees them pushed.
            Work::Constants { .. } | Work::FrameNumber | Work::CutOuts => {
                (vk::ShaderStageFlags::COMPUTE, 0)
            }
            Work::Raster { draw: Draw::Layer { .. }, .. } => {
                // Each mesh pushes its matrix and origin; the pass's own push constants follow it.
                (vk::ShaderStageFlags::VERTEX, pass.push.bytes().len().max(size_of::<DepthPush>()))
            }
            Work::Raster { .. } => (
                vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT,
                pass.push.bytes().len(),
            ),
        };
        let info = LayoutsInfo {
            bindings: &bindings,
            push_stages: stages,
            push_bytes: push_bytes as u32,
            of_mesh: match pass.work {
                Work::EachMesh { .. } => OfMesh::Triangles,
                Work::EachCutOut { .. } => OfMesh::CutOut,
                _ if pass.draws_cut_outs() => OfMesh::CutOut,
                _ => OfMesh::Nothing,
            },
        };
        let layouts = match &host.layouts {
            Some(shared) => shared.find(&host.device, &info, pass.name)?,
            None => PassLayouts::new(&mut maker.owner, &host.device, &info, pass.name)?,
        };
        let mut made = Self { layouts, push_stages: stages, ..Self::default() };
        match pass.work {
            Work::Constants { .. } | Work::FrameNumber | Work::CutOuts => {}
            Work::Dispatch { shader, .. }
            | Work::Indirect { shader, .. }
            | Work::EachMesh { shader }
            | Work::EachCutOut { shader, .. } => {
                let pipeline = made.compute(host, pass, shader)?;
                made.pipelines.push(maker.keep(pipeline));
            }
            Work::Raster { target, .. } => {
                made.attachments(maker, graph, pass, target)?;
                made.rasters(maker, pass, strides)?;
            }
        }
        for &pipeline in made.pipelines.iter().chain(&made.cut_pipelines) {
            name(host, pipeline, pass.name);
        }
        Ok(made)
    }

    fn compute(&self, host: &Host, pass: &Pass, shader: Module) -> Result<vk::Pipeline, Error> {
        with_modules(host, &[(shader, vk::ShaderStageFlags::COMPUTE)], |stages| {
            let create = [vk::ComputePipelineCreateInfo::default()
                .flags(host.pipeline_flags)
                .stage(stages[0])
                .layout(self.layouts.pipeline)];
            // SAFETY: the stage's module and the layout are alive for this call.
            unsafe { host.device.create_compute_pipelines(host.pipeline_cache, &create, None) }
                .map(|p| p[0])
                .map_err(|(_, e)| Error::vulkan(format!("creating {}", pass.name))(e))
        })
    }

    /// Creates the render pass for the attachments of a pass.
    fn attachments(
        &mut self,
        maker: &mut Maker,
        graph: &Graph,
        pass: &Pass,
        target: Target,
    ) -> Result<(), Error> {
        let device = &maker.host.device;
        let targets = attachments_of(graph, pass)?;
        let Some(&(_, _, extent)) = targets.first() else {
            return Err(Error::Frame(format!("{} has no image to draw into", pass.name)));
        };
        self.extent = extent;
        self.colors = if matches!(target, Target::Add) { targets.len() } else { 0 };
        let layout = match target {
            Target::Depth { .. } => vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
            Target::Add => vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        };
        // The barriers in front of the pass put the image into this layout and order it against
        // everything else, so the render pass itself changes and orders nothing.
        let description = |format| {
            vk::AttachmentDescription::default()
                .format(format)
                .samples(vk::SampleCountFlags::TYPE_1)
                .load_op(vk::AttachmentLoadOp::CLEAR)
                .store_op(vk::AttachmentStoreOp::STORE)
                .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
                .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
                .initial_layout(layout)
                .final_layout(layout)
        };
        let attachments: Vec<_> =
            targets.iter().map(|(_, format, _)| description(*format)).collect();
        let references: Vec<_> = (0..targets.len() as u32)
            .map(|attachment| vk::AttachmentReference { attachment, layout })
            .collect();
        let subpass =
            vk::SubpassDescription::default().pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS);
        let subpasses = [match target {
            Target::Depth { .. } => subpass.depth_stencil_attachment(&references[0]),
            Target::Add => subpass.color_attachments(&references),
        }];
        let create =
            vk::RenderPassCreateInfo::default().attachments(&attachments).subpasses(&subpasses);
        // SAFETY: one subpass, which uses every attachment; a test holds their number to four.
        let render_pass = unsafe { device.create_render_pass(&create, None) }
            .map_err(Error::vulkan(format!("creating the render pass of {}", pass.name)))?;
        self.render_pass = maker.keep(render_pass);
        Ok(())
    }

    /// Creates the framebuffer of a pass that draws, from the images that it draws into.
    pub fn attach(
        &mut self,
        maker: &mut Maker,
        graph: &Graph,
        pass: &Pass,
        objects: &Objects,
    ) -> Result<(), Error> {
        if !matches!(pass.work, Work::Raster { .. }) {
            return Ok(());
        }
        let targets = attachments_of(graph, pass)?;
        let views: Vec<_> = targets.iter().map(|(id, ..)| objects.get(*id).image().1).collect();
        let create = vk::FramebufferCreateInfo::default()
            .render_pass(self.render_pass)
            .attachments(&views)
            .width(self.extent.width)
            .height(self.extent.height)
            .layers(1);
        // SAFETY: the views have the render pass's formats and, a test says, this size.
        let framebuffer = unsafe { maker.host.device.create_framebuffer(&create, None) }
            .map_err(Error::vulkan(format!("creating the framebuffer of {}", pass.name)))?;
        self.framebuffer = maker.keep(framebuffer);
        Ok(())
    }

    fn rasters(&mut self, maker: &mut Maker, pass: &Pass, strides: &[u32]) -> Result<(), Error> {
        let Work::Raster { vertex, fragment, cut, cull, draw, .. } = pass.work else {
            return Ok(());
        };
        let stages = |vertex, fragment: Option<Module>| {
            let mut modules = vec![(vertex, vk::ShaderStageFlags::VERTEX)];
            modules.extend(fragment.map(|f| (f, vk::ShaderStageFlags::FRAGMENT)));
            modules
        };
        let variants: Vec<(Option<u32>, vk::CullModeFlags, vk::FrontFace)> = match draw {
            Draw::Indirect { .. } => vec![(None, cull, vk::FrontFace::COUNTER_CLOCKWISE)],
            // In the order of `variant`.
            Draw::Layer { .. } => strides
                .iter()
                .flat_map(|&s| {
                    [
                        (Some(s), cull, vk::FrontFace::COUNTER_CLOCKWISE),
                        (Some(s), cull, vk::FrontFace::CLOCKWISE),
                        (Some(s), vk::CullModeFlags::NONE, vk::FrontFace::COUNTER_CLOCKWISE),
                    ]
                })
                .collect(),
        };
        let mut all = |modules: &[_]| {
            with_modules(maker.host, modules, |stages| {
                let mut pipelines = Vec::with_capacity(variants.len());
                for &(stride, cull, front) in &variants {
                    let pipeline = self.raster(maker.host, pass, stages, stride, cull, front)?;
                    pipelines.push(maker.keep(pipeline));
                }
                Ok(pipelines)
            })
        };
        let whole = all(&stages(vertex, fragment))?;
        let cut = match cut.filter(|_| pass.draws_cut_outs()) {
            Some([vertex, fragment]) => all(&stages(vertex, Some(fragment)))?,
            None => Vec::new(),
        };
        (self.pipelines, self.cut_pipelines) = (whole, cut);
        Ok(())
    }

    fn raster(
        &self,
        host: &Host,
        pass: &Pass,
        stages: &[vk::PipelineShaderStageCreateInfo],
        stride: Option<u32>,
        cull: vk::CullModeFlags,
        front: vk::FrontFace,
    ) -> Result<vk::Pipeline, Error> {
        let bindings = stride.map(|stride| {
            vk::VertexInputBindingDescription::default()
                .stride(stride)
                .input_rate(vk::VertexInputRate::VERTEX)
        });
        let attributes = stride.map(|_| {
            vk::VertexInputAttributeDescription::default().format(vk::Format::R32G32B32_SFLOAT)
        });
        let input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(bindings.as_slice())
            .vertex_attribute_descriptions(attributes.as_slice());
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        // A frame may use a part of the attachments: its own size decides.
        let states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
        let viewport =
            vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(cull)
            .front_face(front)
            .line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let add = vk::PipelineColorBlendAttachmentState::default()
            .blend_enable(true)
            .src_color_blend_factor(vk::BlendFactor::ONE)
            .dst_color_blend_factor(vk::BlendFactor::ONE)
            .color_blend_op(vk::BlendOp::ADD)
            .src_alpha_blend_factor(vk::BlendFactor::ONE)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE)
            .alpha_blend_op(vk::BlendOp::ADD)
            .color_write_mask(vk::ColorComponentFlags::RGBA);
        // All attachments blend in the same way: independent blending is an optional feature.
        let add = vec![add; self.colors];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&add);
        let mut depth = vk::PipelineDepthStencilStateCreateInfo::default();
        let mut create = vk::GraphicsPipelineCreateInfo::default()
            .flags(host.pipeline_flags)
            .stages(stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .dynamic_state(&dynamic)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .layout(self.layouts.pipeline)
            .render_pass(self.render_pass);
        if let Work::Raster { target: Target::Depth { compare, .. }, .. } = pass.work {
            depth =
                depth.depth_test_enable(true).depth_write_enable(true).depth_compare_op(compare);
            create = create.depth_stencil_state(&depth);
        } else {
            create = create.color_blend_state(&blend);
        }
        // SAFETY: every state that the create info points to lives until the end of this call.
        unsafe { host.device.create_graphics_pipelines(host.pipeline_cache, &[create], None) }
            .map(|p| p[0])
            .map_err(|(_, e)| Error::vulkan(format!("creating {}", pass.name))(e))
    }
}

/// The attachments of a pass in the order of its uses: resources, formats and sizes.
fn attachments_of(
    graph: &Graph,
    pass: &Pass,
) -> Result<Vec<(ResourceId, vk::Format, vk::Extent2D)>, Error> {
    pass.writes()
        .map(|id| match graph.resource(id).shape {
            Shape::Image { format, width, height, .. } => {
                Ok((id, format, vk::Extent2D { width, height }))
            }
            Shape::Buffer { .. } => {
                Err(Error::Frame(format!("{} draws into what is no image", pass.name)))
            }
        })
        .collect()
}

/// Runs `make` with shader stages whose modules are destroyed afterwards.
fn with_modules<T>(
    host: &Host,
    shaders: &[(Module, vk::ShaderStageFlags)],
    make: impl FnOnce(&[vk::PipelineShaderStageCreateInfo]) -> Result<T, Error>,
) -> Result<T, Error> {
    let mut modules = ObjectOwner::default();
    let stages = shaders.iter().map(|(shader, stage)| {
        let words = shader.words();
        let create = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are a module that tests validate.
        let module = unsafe { host.device.create_shader_module(&create, None) }
            .map_err(Error::vulkan(format!("loading {}", shader.path)))?;
        let stage = vk::PipelineShaderStageCreateInfo::default().stage(*stage).name(c"main");
        Ok(stage.module(modules.keep(module)))
    });
    let made = stages.collect::<Result<Vec<_>, _>>().and_then(|stages| make(&stages));
    // Pipelines do not need their modules once they are made, and modules have no memory.
    modules.destroy(&host.device, |_| {});
    made
}
