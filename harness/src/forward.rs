//! Ray marching without a G-buffer, for what it costs: the rays of every fragment, as it is drawn.
//!
//! The map and its levels are the node's, left by the last frame; the rays' push constants are those of its
//! own pass, so that they are the same rays. What differs from the node's image:
//! * a pixel whose last fragment is what the G-buffer holds has the same place, and its plane by the
//!   fragment's derivatives instead of its neighbours' depths: the same but for rounding within a facet, and
//!   the right one where those neighbours show another facet (creases, silhouettes, triangles smaller than
//!   pixels);
//! * there is no filter, no eye layer, which would take the depth of all pixels, and no light's texture.

use crate::painter::{DEPTH, Painter, SceneDraw, draws};
use crate::shaders::FORWARD_FRAG;
use crate::{FrameTimes, GBufferPainter, HeadlessDevice, HostBuffer, OwnedImage, Stage};
use antumbra::graph::{Access, Work};
use antumbra::node::PlanObject;
use antumbra::scene::{Instance, Scene};
use antumbra::stages::visibility;
use antumbra::{Error, FramePlan, shaders};
use ash::vk;
use std::time::Duration;

/// The bindings of `forward.frag`: the node's push constants, and its windows.
const BINDINGS: [(u32, vk::DescriptorType); 2] =
    [(0, vk::DescriptorType::UNIFORM_BUFFER), (2, vk::DescriptorType::SAMPLED_IMAGE)];

/// Forward evaluation of a frame of a stage, which it keeps: it draws the stage's buffers by an image of the
/// stage's node.
pub struct Forward {
    device: HeadlessDevice,
    stage: Stage,
    plan: FramePlan,
    /// `None` only while it is made.
    painter: Option<Painter>,
    gbuffer_painter: GBufferPainter,
    set_layout: vk::DescriptorSetLayout,
    pool: vk::DescriptorPool,
    set: vk::DescriptorSet,
    draws: Vec<SceneDraw>,
    visible: OwnedImage,
    depth: OwnedImage,
    push: HostBuffer,
}

impl Forward {
    /// For frames of `plan` on `stage`, whose scene this is; `keep` as the stage's. Runs one.
    ///
    /// # Errors
    /// [`Error::Frame`] where the plan is not the stage's, or has no rays of the usual settings: hierarchical search of an
    /// N-buffer, no eye layer, no texture. Otherwise as [`Stage::new`].
    pub fn new(
        device: &HeadlessDevice,
        mut stage: Stage,
        plan: FramePlan,
        scene: &Scene,
        keep: impl Fn(&Instance) -> bool,
    ) -> Result<Self, Error> {
        use vk::ImageUsageFlags as Usage;
        let pass = plan.plan.steps.iter().map(|s| &plan.plan.graph.passes()[s.pass]);
        let is_trace = |work: &Work| matches!(work, Work::Indirect { shader, .. } if *shader == shaders::TRACE);
        let trace = pass.into_iter().find(|p| is_trace(&p.work)).ok_or_else(|| {
            Error::Frame(
                "forward evaluation needs a plan that traces rays by technique=ray-march \
                 search=hierarchical levels=n-buffer, without layers=3 or a light texture"
                    .into(),
            )
        })?;
        // Refuses another node's plan.
        stage.run(&plan)?;
        let push = HostBuffer::with_data(
            device,
            "forward.push",
            trace.push.bytes(),
            vk::BufferUsageFlags::UNIFORM_BUFFER,
        )?;
        let extent = stage.gbuffer().depth.extent();
        let image = |name, format, usage| OwnedImage::new(device, name, format, extent, usage);
        let draws = draws(scene, stage.buffers(), stage.view(), keep);
        let mut new = Self {
            device: device.clone(),
            stage,
            plan,
            painter: None,
            gbuffer_painter: GBufferPainter::new(device)?,
            set_layout: vk::DescriptorSetLayout::null(),
            pool: vk::DescriptorPool::null(),
            set: vk::DescriptorSet::null(),
            draws,
            visible: image(
                "forward.visible",
                visibility::FORMAT,
                Usage::COLOR_ATTACHMENT | Usage::SAMPLED,
            )?,
            depth: image("forward.depth", DEPTH, Usage::DEPTH_STENCIL_ATTACHMENT)?,
            push,
        };
        new.make_set()?;
        let (formats, layout) = ([visibility::FORMAT], Some(new.set_layout));
        new.painter = Some(Painter::new(device, &formats, 1.0, FORWARD_FRAG, false, layout)?);
        Ok(new)
    }

    fn make_set(&mut self) -> Result<(), Error> {
        let windows = self.stage.node()?.object(&self.plan, "ray_march.windows");
        let Some(PlanObject::Image { view, .. }) = windows else {
            return Err(Error::Frame("the plan has no windows".into()));
        };
        let raw = self.device.device();
        let bindings = BINDINGS.map(|(binding, kind)| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::FRAGMENT)
        });
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device lives; the bindings are distinct.
        self.set_layout = unsafe { raw.create_descriptor_set_layout(&create, None) }
            .map_err(Error::vulkan("creating a descriptor set layout"))?;
        let sizes = BINDINGS.map(|(_, ty)| vk::DescriptorPoolSize { ty, descriptor_count: 1 });
        let create = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: as above.
        self.pool = unsafe { raw.create_descriptor_pool(&create, None) }
            .map_err(Error::vulkan("creating a descriptor pool"))?;
        let layouts = [self.set_layout];
        let allocate = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool was made for this one set.
        self.set = unsafe { raw.allocate_descriptor_sets(&allocate) }
            .map_err(Error::vulkan("allocating a descriptor set"))?[0];
        let push =
            [vk::DescriptorBufferInfo::default().buffer(self.push.raw()).range(vk::WHOLE_SIZE)];
        // As the node's rays leave it.
        let layout = Access::SampledCompute.scope().layout;
        let windows = [vk::DescriptorImageInfo::default().image_view(view).image_layout(layout)];
        let [write_push, write_windows] = BINDINGS.map(|(binding, kind)| {
            vk::WriteDescriptorSet::default()
                .dst_set(self.set)
                .dst_binding(binding)
                .descriptor_type(kind)
        });
        let writes = [write_push.buffer_info(&push), write_windows.image_info(&windows)];
        // SAFETY: the set is new; buffer and view are this object's own, the node's images being changed
        // by nobody while it keeps the stage.
        unsafe { raw.update_descriptor_sets(&writes, &[]) };
        Ok(())
    }

    /// A frame of the node for its map and levels, and then the scene with its rays. Told are the passes
    /// that forward evaluation needs, and a frame that is their sum: what the node does at the
    /// G-buffer's pixels is left out.
    ///
    /// # Errors
    /// [`Error::Frame`] where the device has no timestamps; otherwise as [`Stage::run`].
    pub fn run(&mut self) -> Result<FrameTimes, Error> {
        let mut times = self.run_deferred()?;
        let start = times.passes.iter().position(|(name, _)| *name == "ray_march.start");
        let start = start.ok_or_else(|| Error::Frame("the device has no timestamps".into()))?;
        times.passes.truncate(start);
        let drawn = self.draw()?;
        times.passes.push(("forward.draw", drawn.as_secs_f64() * 1e3));
        let ms: f64 = times.passes.iter().map(|(_, ms)| ms).sum();
        times.frame = Duration::from_secs_f64(ms * 1e-3);
        Ok(times)
    }

    /// A frame of the node alone.
    ///
    /// # Errors
    /// As [`Stage::run`].
    pub fn run_deferred(&mut self) -> Result<FrameTimes, Error> {
        self.stage.run(&self.plan)
    }

    /// Draws the scene with its rays by the map and levels that are there.
    fn draw(&self) -> Result<Duration, Error> {
        let painter = self.painter.as_ref();
        let painter = painter.ok_or_else(|| Error::Frame("it was not made".into()))?;
        painter.paint(&[&self.visible, &self.depth], Some(self.set), &self.draws)
    }

    /// Paints the stage's G-buffer anew, as deferred evaluation needs it each frame; how long that takes.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn paint_gbuffer(&self) -> Result<Duration, Error> {
        self.gbuffer_painter.paint_draws(self.stage.gbuffer(), &self.draws)
    }

    /// Reads what the node's last frame computed.
    ///
    /// # Errors
    /// As [`Stage::visibility`].
    pub fn deferred_visibility(&mut self) -> Result<Vec<f32>, Error> {
        self.stage.visibility()
    }

    /// Name and bytes of everything the node holds.
    ///
    /// # Errors
    /// As [`Stage::node`].
    pub fn memory(&mut self) -> Result<Vec<(&'static str, u64)>, Error> {
        Ok(self.stage.node()?.memory())
    }

    /// Reads the visible fraction of every pixel's last fragment, row by row; 1 on background.
    ///
    /// # Errors
    /// As [`OwnedImage::read`].
    pub fn visibility(&self) -> Result<Vec<f32>, Error> {
        self.visible.read(crate::painter::COLOR_LAYOUT)
    }
}

impl Drop for Forward {
    fn drop(&mut self) {
        let raw = self.device.device();
        // SAFETY: made from this device; every submit is waited for; null is allowed.
        unsafe { raw.destroy_descriptor_pool(self.pool, None) };
        // SAFETY: as above; the painter's pipeline layout may outlive its set layouts.
        unsafe { raw.destroy_descriptor_set_layout(self.set_layout, None) };
    }
}
