//! Ray marching without a G-buffer, for what it costs: the rays of every fragment, as it is drawn.
//!
//! The map and its levels are the node's, left by the last frame; the rays' push constants are those of its
//! own pass, so that they are the same rays. What differs from the node's image:
//! * a pixel whose last fragment is what the G-buffer holds has the same place, and its plane by the
//!   fragment's derivatives instead of its neighbours' depths: the same but for rounding within a facet, and
//!   the right one where those neighbours show another facet (creases, silhouettes, triangles smaller than
//!   pixels);
//! * there is no filter, no eye layer, which would take the depth of all pixels, and no light's texture.

use crate::painter::{Painter, SceneDraw, draws};
use crate::raster::{COLOR_LAYOUT, DEPTH};
use crate::set::{Bound, BoundSet};
use crate::shaders::FORWARD_FRAG;
use crate::{FrameTimes, GBufferPainter, HeadlessDevice, HostBuffer, OwnedImage, Stage};
use antumbra::graph::{Access, Graph, Shape, Work};
use antumbra::node::PlanObject;
use antumbra::scene::{Instance, Scene};
use antumbra::stages::visibility;
use antumbra::{Error, FramePlan, shaders};
use ash::vk;
use std::time::Duration;

/// Forward evaluation of a frame of a stage, which it keeps: it draws the stage's buffers by an image of the
/// stage's node.
pub struct Forward {
    stage: Stage,
    plan: FramePlan,
    /// The painter, with the node's push constants and its windows bound.
    painter: Painter,
    gbuffer_painter: GBufferPainter,
    draws: Vec<SceneDraw>,
    visible: OwnedImage,
    depth: OwnedImage,
    /// The buffers that the painter's set reads.
    _constants: [HostBuffer; 2],
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
        const UNIFORM: vk::BufferUsageFlags = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let pass = plan.plan().steps.iter().map(|s| &plan.plan().graph.passes()[s.pass]);
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
        let push = trace.push.bytes();
        let push = HostBuffer::with_data(device, "forward.push", push, UNIFORM)?;
        let constants = constants_of(&plan.plan().graph)?;
        let constants = HostBuffer::with_data(device, "forward.constants", &constants, UNIFORM)?;
        let extent = stage.gbuffer().depth.extent();
        let image = |name, format, usage| OwnedImage::new(device, name, format, extent, usage);
        let draws = draws(scene, stage.buffers(), stage.view(), keep);
        let visible =
            image("forward.visible", visibility::FORMAT, Usage::COLOR_ATTACHMENT | Usage::SAMPLED)?;
        let windows = stage.node()?.object(&plan, "ray_march.windows");
        let Some(PlanObject::Image { view, .. }) = windows else {
            return Err(Error::Frame("the plan has no windows".into()));
        };
        // As the node's rays leave it.
        let left = Access::SampledCompute.scope().layout;
        // The bindings of `forward.frag`. Nobody changes the node's images while this keeps the stage.
        let bound = [
            (0, Bound::Uniform(&push)),
            (2, Bound::Fetched(view, left)),
            (19, Bound::Uniform(&constants)),
        ];
        let set = BoundSet::new(device, vk::ShaderStageFlags::FRAGMENT, &bound)?;
        let formats = [visibility::FORMAT];
        Ok(Self {
            painter: Painter::new(device, &formats, 1.0, FORWARD_FRAG, false, Some(set))?,
            gbuffer_painter: GBufferPainter::new(device)?,
            draws,
            visible,
            depth: image("forward.depth", DEPTH, Usage::DEPTH_STENCIL_ATTACHMENT)?,
            _constants: [push, constants],
            stage,
            plan,
        })
    }

    /// Runs a frame of the node for its map and levels, and then draws the scene with its rays. The times are those of
    /// the passes that forward evaluation needs, and `frame` is their sum: what the node does at the G-buffer's pixels
    /// is left out.
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
    /// See [`Stage::run`].
    pub fn run_deferred(&mut self) -> Result<FrameTimes, Error> {
        self.stage.run(&self.plan)
    }

    /// Draws the scene with its rays by the map and levels that are there.
    fn draw(&self) -> Result<Duration, Error> {
        self.painter.paint(&[&self.visible, &self.depth], &self.draws)
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
    /// See [`Stage::visibility`].
    pub fn deferred_visibility(&mut self) -> Result<Vec<f32>, Error> {
        self.stage.visibility()
    }

    /// Name and bytes of everything the node holds.
    ///
    /// # Errors
    /// See [`Stage::node`].
    pub fn memory(&mut self) -> Result<Vec<(&'static str, u64)>, Error> {
        Ok(self.stage.node()?.memory().into_iter().map(|r| (r.name, r.bytes)).collect())
    }

    /// Reads the visible fraction of every pixel's last fragment, row by row; 1 on background.
    ///
    /// # Errors
    /// See [`OwnedImage::read`].
    pub fn visibility(&self) -> Result<Vec<f32>, Error> {
        self.visible.read(COLOR_LAYOUT)
    }
}

/// The constants of the G-buffer, as long as their buffer is: what the frame does not write of them is zero.
fn constants_of(graph: &Graph) -> Result<Vec<u8>, Error> {
    let pass = graph.passes().iter().find(|p| p.name == "gbuffer.constants");
    let buffer = graph.resources().iter().find(|r| r.name == "gbuffer.constants");
    let (Some(pass), Some(Shape::Buffer { bytes })) = (pass, buffer.map(|r| r.shape)) else {
        return Err(Error::Frame("the plan has no constants".into()));
    };
    let mut constants = pass.push.bytes().to_vec();
    constants.resize(bytes as usize, 0);
    Ok(constants)
}
