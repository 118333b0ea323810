//! A scene, a G-buffer and a node on one device: what tests, benches and the render example run.

use crate::gbuffer::MASK;
use crate::{
    GBuffer, GBufferPainter, HeadlessDevice, HostBuffer, ImageSource, Invocations, SceneBuffers,
    View, read_image,
};
use antumbra::auto::{Auto, Choice};
use antumbra::frame::{Capacity, CutOuts};
use antumbra::graph::Scope;
use antumbra::node::PlanObject;
use antumbra::scene::{AreaLight, Instance, Scene};
use antumbra::stages::visibility;
use antumbra::{
    Description, Error, Frame, FramePlan, FramePlans, Host, Light, LightIndex, MeshInstance,
    ShadowNode, Slot, Technique, Visibility, VisibilityImage,
};
use std::sync::PoisonError;
use std::time::{Duration, Instant};

/// The times of one frame of the node.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameTimes {
    /// The time from the submit to the fence.
    pub frame: Duration,
    /// The time of recording on the CPU.
    pub record: Duration,
    /// Name and milliseconds of each pass, by timestamps; empty where there are none.
    pub passes: Vec<(&'static str, f64)>,
}

/// A node and all that it is lent.
pub struct Stage {
    device: HeadlessDevice,
    /// `None` only while it is replaced or dropped.
    node: Option<ShadowNode>,
    host: Host,
    gbuffer: GBuffer,
    painter: GBufferPainter,
    view: View,
    instances: Vec<MeshInstance>,
    /// The buffers that `instances` name.
    buffers: SceneBuffers,
}

/// The layout that the visibility image is handed back in.
const RESULT: Scope = Scope::COPIED_FROM;

impl Stage {
    /// Uploads the scene, paints the G-buffer with the instances that `keep` accepts, and makes the
    /// node.
    ///
    /// # Errors
    /// Whatever [`ShadowNode::new`] and the device refuse.
    pub fn new(
        device: &HeadlessDevice,
        scene: &Scene,
        view: &View,
        extent: [u32; 2],
        settings: Technique,
        keep: impl Fn(&Instance) -> bool,
    ) -> Result<Self, Error> {
        let buffers = SceneBuffers::new(device, scene)?;
        let gbuffer = GBuffer::new(device, extent)?;
        let painter = GBufferPainter::new(device)?;
        painter.paint(&gbuffer, scene, &buffers, view, keep)?;
        // SAFETY: the stage keeps the device; everything given to the node is the stage's own, and each
        // frame is waited for before the next.
        let host = unsafe { device.host() };
        let mut stage = Self {
            device: device.clone(),
            node: None,
            host,
            gbuffer,
            painter,
            view: *view,
            instances: buffers.instances(scene),
            buffers,
        };
        stage.configure(settings)?;
        Ok(stage)
    }

    /// Shows another scene, or the same from elsewhere, to the node as it is.
    ///
    /// # Errors
    /// Whatever the device refuses; what was shown before then stays with the node, and the G-buffer may be
    /// half painted.
    pub fn show(
        &mut self,
        scene: &Scene,
        view: &View,
        keep: impl Fn(&Instance) -> bool,
    ) -> Result<(), Error> {
        let buffers = SceneBuffers::new(&self.device, scene)?;
        self.painter.paint(&self.gbuffer, scene, &buffers, view, keep)?;
        self.view = *view;
        self.instances = buffers.instances(scene);
        self.buffers = buffers;
        Ok(())
    }

    /// Makes the node anew with other settings.
    ///
    /// # Errors
    /// See [`ShadowNode::new`]; the stage then has no node until settings that work are given.
    pub fn configure(&mut self, settings: Technique) -> Result<(), Error> {
        self.configure_with(settings, |_| {})
    }

    /// Makes the stage's node anew for a technique, with a description that `change` has changed.
    ///
    /// # Errors
    /// See [`ShadowNode::new`]; the stage then has no node until settings that work are given.
    pub fn configure_with(
        &mut self,
        settings: Technique,
        change: impl FnOnce(&mut Description),
    ) -> Result<(), Error> {
        self.drop_node();
        let mut description = Description {
            technique: settings,
            frames_in_flight: 1,
            mask_format: Some(MASK),
            capacity: Capacity::of(&self.instances),
            cut_outs: CutOuts::of(&self.instances),
            inspect: true,
            ..Description::new(self.gbuffer.depth.extent())
        };
        change(&mut description);
        let mut allocator = self.device.allocator().lock().unwrap_or_else(PoisonError::into_inner);
        self.node = Some(ShadowNode::new(self.host.clone(), &mut *allocator, description)?);
        Ok(())
    }

    /// The meshes as the node takes them.
    pub fn instances(&self) -> &[MeshInstance] {
        &self.instances
    }

    /// The G-buffer.
    pub fn gbuffer(&self) -> &GBuffer {
        &self.gbuffer
    }

    /// The camera of the stage's image.
    pub(crate) fn view(&self) -> &View {
        &self.view
    }

    /// The scene's buffers.
    pub(crate) fn buffers(&self) -> &SceneBuffers {
        &self.buffers
    }

    /// The node.
    ///
    /// # Errors
    /// [`Error::Frame`] where the last [`Self::configure`] failed.
    pub fn node(&mut self) -> Result<&mut ShadowNode, Error> {
        self.node.as_mut().ok_or_else(|| Error::Frame("the stage has no node".into()))
    }

    /// Plans a frame under a light; `window` fixes the occluder map's tangents.
    ///
    /// # Errors
    /// See [`ShadowNode::plan`].
    pub fn plan(
        &mut self,
        light: impl Into<Light>,
        window: Option<[[f64; 2]; 2]>,
    ) -> Result<FramePlan, Error> {
        self.plan_with(light, |frame| frame.window = window)
    }

    /// Plans a frame under a scene's light.
    ///
    /// # Errors
    /// See [`ShadowNode::plan`].
    pub fn plan_under(
        &mut self,
        light: &AreaLight,
        window: Option<[[f64; 2]; 2]>,
    ) -> Result<FramePlan, Error> {
        self.plan(light.light, window)
    }

    /// Plans a frame that `change` has changed.
    ///
    /// # Errors
    /// See [`ShadowNode::plan`].
    pub fn plan_with<'f>(
        &'f mut self,
        light: impl Into<Light>,
        change: impl FnOnce(&mut Frame<'f>),
    ) -> Result<FramePlan, Error> {
        let mut frame = self.frame(light);
        change(&mut frame);
        let node =
            self.node.as_ref().ok_or_else(|| Error::Frame("the stage has no node".into()))?;
        node.plan(&frame)
    }

    /// Plans the frames of all lights together; `change` changes each frame, by the light's index.
    ///
    /// # Errors
    /// See [`ShadowNode::plan_all`].
    pub fn plan_all_with<'f>(
        &'f mut self,
        lights: &[impl Into<Light> + Copy],
        change: impl Fn(usize, &mut Frame<'f>),
        plans: &mut FramePlans,
    ) -> Result<(), Error> {
        let mut frames: Vec<_> = lights.iter().map(|&light| self.frame(light)).collect();
        frames.iter_mut().enumerate().for_each(|(place, frame)| change(place, frame));
        let node =
            self.node.as_ref().ok_or_else(|| Error::Frame("the stage has no node".into()))?;
        node.plan_all(&frames, plans)
    }

    /// A frame under a light, with the G-buffer's normals where the node is described with them.
    fn frame(&self, light: impl Into<Light>) -> Frame<'_> {
        let world_from_ndc = self.view.clip_from_world.inverse();
        let depth = self.gbuffer.depth_for_node();
        let described = self.node.as_ref().and_then(|node| node.description().normals);
        let normals = described.map(|_| self.gbuffer.normals_for_node());
        Frame {
            background: Some(0.0),
            mask: Some(self.gbuffer.mask_for_node()),
            normals,
            visibility: Visibility::Own { before: RESULT, after: RESULT },
            ..Frame::new(Slot(0), light, world_from_ndc, &self.instances, depth)
        }
    }

    /// The node's own result.
    fn result(&mut self) -> Result<VisibilityImage, Error> {
        let own = self.node()?.visibility();
        own.ok_or_else(|| {
            Error::Frame("the visibility image is lent, and not the node's to read".into())
        })
    }

    /// The choice of `auto` for a scene's light; the node stays as it is.
    ///
    /// # Errors
    /// See [`Auto::choose`].
    pub fn choose(&mut self, auto: &mut Auto, light: &AreaLight) -> Result<Choice, Error> {
        let frame = self.frame(light.light);
        let node =
            self.node.as_ref().ok_or_else(|| Error::Frame("the stage has no node".into()))?;
        auto.choose(node.description(), &frame)
    }

    /// The choices of `auto` for some of a scene's lights, which share its time; the node stays as it is.
    ///
    /// # Errors
    /// See [`Auto::choose_all`].
    pub fn choose_all(
        &mut self,
        auto: &mut Auto,
        lights: &[&AreaLight],
    ) -> Result<Vec<Choice>, Error> {
        let frames: Vec<_> = lights.iter().map(|light| self.frame(light.light)).collect();
        let node =
            self.node.as_ref().ok_or_else(|| Error::Frame("the stage has no node".into()))?;
        auto.choose_all(node.description(), &frames)
    }

    /// Records a plan, submits it and waits.
    ///
    /// # Errors
    /// See [`ShadowNode::record`] and [`HeadlessDevice::submit_and_wait`].
    pub fn run(&mut self, plan: &FramePlan) -> Result<FrameTimes, Error> {
        self.run_all(std::slice::from_ref(plan))
    }

    /// Records plans one behind the other into one command buffer, submits it and waits.
    ///
    /// # Errors
    /// See [`Self::run`].
    pub fn run_all(&mut self, plans: &[FramePlan]) -> Result<FrameTimes, Error> {
        let device = self.device.clone();
        let node = self.node()?;
        let (record, frame) = device.submit_timed(|cmd| {
            let started = Instant::now();
            plans.iter().try_for_each(|plan| node.record(cmd, plan))?;
            Ok(started.elapsed())
        })?;
        let passes = plans.iter().filter_map(|p| node.timings(p.slot(), p.light_index()));
        let passes = passes.flatten().map(|pass| (pass.name, pass.ms)).collect();
        Ok(FrameTimes { frame, record, passes })
    }

    /// Runs a plan and counts what its shaders do; none where [`HeadlessDevice::count`] counts nothing.
    ///
    /// # Errors
    /// See [`Self::run`].
    pub fn count(&mut self, plan: &FramePlan) -> Result<Option<Invocations>, Error> {
        let device = self.device.clone();
        let node = self.node()?;
        device.count(|cmd| node.record(cmd, plan))
    }

    /// Reads the visible fraction of every pixel, row by row, under light 0.
    ///
    /// # Errors
    /// See [`read_image`].
    pub fn visibility(&mut self) -> Result<Vec<f32>, Error> {
        self.visibility_under(LightIndex(0))
    }

    /// Reads the visible fraction of every pixel, row by row, under any of the description's lights.
    ///
    /// # Errors
    /// See [`read_image`].
    pub fn visibility_under(&mut self, light: LightIndex) -> Result<Vec<f32>, Error> {
        let result = self.result()?;
        let source = ImageSource {
            image: result.image,
            format: visibility::FORMAT,
            extent: result.extent,
            layer: light.0,
        };
        read_image(&self.device, &source, RESULT.layout)
    }

    /// Reads the visible fraction of every pixel's red, green and blue, and 1, where the description asks
    /// for color.
    ///
    /// # Errors
    /// See [`read_image`].
    pub fn visibility_of_color(&mut self) -> Result<Vec<[f32; 4]>, Error> {
        let result = self.result()?;
        let (format, extent) = (visibility::COLOR_FORMAT, result.extent);
        read_image(
            &self.device,
            &ImageSource { image: result.image, format, extent, layer: 0 },
            RESULT.layout,
        )
    }

    /// Reads one of the node's own images behind a frame of `plan`: its texels and its side.
    ///
    /// # Errors
    /// [`Error::Frame`] where the plan writes no image of that name; otherwise as [`read_image`].
    pub fn inspect<T: bytemuck::AnyBitPattern>(
        &mut self,
        plan: &FramePlan,
        name: &str,
    ) -> Result<(Vec<T>, [u32; 2]), Error> {
        let image = self.node()?.inspect(plan).into_iter().find(|i| i.name == name);
        let image = image.ok_or_else(|| Error::Frame(format!("the plan writes no {name}")))?;
        let source = ImageSource {
            image: image.image,
            format: image.format,
            extent: image.extent,
            layer: 0,
        };
        Ok((read_image(&self.device, &source, image.layout)?, image.extent))
    }

    /// Reads one of the node's own buffers that a plan uses.
    ///
    /// # Errors
    /// [`Error::Frame`] where the plan has no buffer of that name; otherwise as [`HostBuffer::new`].
    pub fn inspect_buffer<T: bytemuck::AnyBitPattern>(
        &mut self,
        plan: &FramePlan,
        name: &str,
    ) -> Result<Vec<T>, Error> {
        match self.node()?.object(plan, name) {
            Some(PlanObject::Buffer { buffer, bytes }) => {
                Ok(HostBuffer::copy_of(&self.device, name, buffer, bytes)?.read())
            }
            _ => Err(Error::Frame(format!("the plan has no buffer {name}"))),
        }
    }

    fn drop_node(&mut self) {
        if let Some(node) = self.node.take() {
            let mut allocator =
                self.device.allocator().lock().unwrap_or_else(PoisonError::into_inner);
            node.destroy(&mut *allocator);
        }
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.drop_node();
    }
}
