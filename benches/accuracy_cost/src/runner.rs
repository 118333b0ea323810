//! What computes one row's image, whatever the technique.

use crate::Problem;
use crate::groups::{Entry, Group, Ready};
use crate::scenes::scaled;
use crate::techniques::Method;
use crate::truth;
use antumbra::scene::Instance;
use antumbra::truth::Receiver;
use antumbra::{FramePlan, Light, RectangleLight};
use antumbra_harness::rays::RayTracer;
use antumbra_harness::{Forward, FrameTimes, HeadlessDevice, ReadbackScheme, Stage};
use std::time::{Duration, Instant};

/// What computes one row's image.
pub enum Runner<'a> {
    /// The node, its stage and its frame.
    Node { stage: Box<Stage>, plan: Box<FramePlan> },
    /// Rays by the processor.
    Rays {
        tracer: &'a RayTracer,
        receivers: &'a [Receiver],
        light: RectangleLight,
        width: usize,
        rays: u32,
    },
    /// Rays of the fragments as they are drawn, by the maps of the stage within.
    Forward(Box<Forward>),
    /// The paper's scheme ends with its map. Its image is that of blending, whose sums are the same
    /// (a test of the crate's holds that), and its frame takes that one's last pass on top.
    Readback {
        scheme: Box<ReadbackScheme>,
        light: RectangleLight,
        /// The occluder map's tangents.
        window: Option<[[f64; 2]; 2]>,
        stage: Box<Stage>,
        plan: Box<FramePlan>,
    },
}

impl<'a> Runner<'a> {
    /// What a method takes to run; nothing where the crate does not have it.
    pub fn new(
        device: &HeadlessDevice,
        ready: &Ready,
        group: &Group,
        entry: &Entry,
        method: Result<Option<Method>, Problem>,
        light: &Light,
        (tracer, receivers): (Option<&'a RayTracer>, &'a [Receiver]),
    ) -> Result<Option<Self>, Problem> {
        let lit = match entry.light_scale {
            1.0 => Ok(*light),
            by => scaled(light.rectangle(), by).map(Light::from),
        };
        let stage = |settings| ready.stage(device, group.extent, settings).map(Box::new);
        Ok(match method? {
            None => None,
            Some(Method::Rays(rays)) => {
                let tracer = tracer.ok_or("its tree was not built")?;
                let (width, light) = (group.extent[0] as usize, *lit?.rectangle());
                Some(Self::Rays { tracer, receivers, light, width, rays })
            }
            Some(Method::Readback(side)) => {
                let words = "soft-shadow-map receivers=map accumulate=blend sides=one";
                let words = format!("{words} map={side} receiver_map={side}");
                let mut stage = stage(words.parse()?)?;
                let plan = stage.plan(light, ready.window)?;
                let scheme = Box::new(ReadbackScheme::new(device, &ready.scene, side, side)?);
                stage.run(&plan)?;
                let (light, window, plan) = (*lit?.rectangle(), ready.window, Box::new(plan));
                Some(Self::Readback { scheme, light, window, stage, plan })
            }
            Some(Method::Node(settings)) => {
                let mut stage = stage(*settings)?;
                let plan = stage.plan(lit?, ready.window)?;
                Some(Self::Node { stage, plan: Box::new(plan) })
            }
            Some(Method::Forward(settings)) => {
                let mut stage = stage(*settings)?;
                let plan = stage.plan(light, ready.window)?;
                let keep = |i: &Instance| ready.keeps(i);
                let forward = Forward::new(device, *stage, plan, &ready.scene, keep)?;
                Some(Self::Forward(Box::new(forward)))
            }
        })
    }

    /// One frame; its image where that comes with it.
    pub fn run(&mut self) -> Result<(FrameTimes, Option<Vec<f32>>), Problem> {
        match self {
            Self::Node { stage, plan } => Ok((stage.run(plan)?, None)),
            Self::Forward(forward) => Ok((forward.run()?, None)),
            Self::Readback { scheme, light, window, stage, plan } => {
                let times = scheme.run(light, *window)?;
                let resolve = stage.run(plan)?.passes;
                let (name, ms) = resolve.last().copied().ok_or("the device has no timestamps")?;
                let pass = |name, time: Duration| (name, time.as_secs_f64() * 1e3);
                let times = FrameTimes {
                    frame: times.frame + Duration::from_secs_f64(ms / 1e3),
                    record: Duration::ZERO,
                    passes: vec![
                        pass("readback.depth", times.depth),
                        pass("readback.rectangles", times.rectangles),
                        pass("readback.blend", times.blend),
                        (name, ms),
                    ],
                };
                Ok((times, None))
            }
            Self::Rays { tracer, receivers, light, width, rays } => {
                let error = truth::position_error(receivers);
                let started = Instant::now();
                let visible = tracer.visible_fractions(light, receivers, *width, *rays, error)?;
                let frame = started.elapsed();
                let ms = |time: Duration| time.as_secs_f64() * 1e3;
                // The tree outlives the frame, whose time it is no part of.
                let passes = vec![
                    ("rays.trace", ms(frame)),
                    ("rays.tree_built_once", ms(tracer.build_time())),
                ];
                Ok((FrameTimes { frame, record: Duration::ZERO, passes }, Some(visible)))
            }
        }
    }

    /// The last frame's image, where the device has it.
    pub fn image(&mut self) -> Result<Option<Vec<f32>>, Problem> {
        Ok(match self {
            Self::Node { stage, .. } | Self::Readback { stage, .. } => Some(stage.visibility()?),
            Self::Forward(forward) => Some(forward.visibility()?),
            Self::Rays { .. } => None,
        })
    }

    /// Bytes of the node's memory.
    pub fn bytes(&mut self) -> Result<u64, Problem> {
        Ok(match self {
            Self::Rays { .. } => 0,
            Self::Forward(forward) => forward.memory()?.iter().map(|(_, bytes)| bytes).sum(),
            Self::Node { stage, .. } | Self::Readback { stage, .. } => {
                stage.node()?.memory().iter().map(|r| r.bytes).sum()
            }
        })
    }
}
