//! What the benches measure on: scenes, and a stage with its plan.

use antumbra::scene::{Instance, Role, Scene, generate};
use antumbra::truth::{ErrorSummary, ExactLine, Sampling, Tracer};
use antumbra::{FramePlan, MeshInstance, RectangleLight};
use antumbra_bench::scenes::made;
use antumbra_bench::stats::median;
use antumbra_bench::truth::receivers;
use antumbra_harness::{DeviceTree, FrameTimes, HeadlessDevice, Stage, View, technique};

/// A model, or one of the generated scenes, under a square light whose side is in metres.
pub fn scene(name: &str, side: f64) -> Scene {
    scene_under(name, generate::square_light(side).unwrap())
}

/// A model, or one of the generated scenes, under a light.
pub fn scene_under(name: &str, light: RectangleLight) -> Scene {
    match name {
        "slats" => generate::slats(light, 24),
        "foliage" => generate::foliage(light, 300, 7),
        name => made(name, light).unwrap(),
    }
}

/// A stage with its plan, whose first frame was run.
pub struct Ready {
    stage: Stage,
    plan: FramePlan,
    light: RectangleLight,
}

impl Ready {
    /// 480² pixels of the ground over |x|, |z| ≤ 2.2 m.
    pub fn new(device: &HeadlessDevice, scene: &Scene, words: &str) -> Self {
        Self::over(device, scene, words, 2.2, 480)
    }

    /// `side`² pixels of the ground over |x|, |z| ≤ `half` metres.
    pub fn over(device: &HeadlessDevice, scene: &Scene, words: &str, half: f64, side: u32) -> Self {
        Self::seen(device, scene, words, &View::map_of_ground(half, 8.0), [side; 2])
    }

    /// The pixels of a view.
    pub fn seen(
        device: &HeadlessDevice,
        scene: &Scene,
        words: &str,
        view: &View,
        extent: [u32; 2],
    ) -> Self {
        let keep = |i: &Instance| i.role != Role::Occluder;
        let mut stage = Stage::new(device, scene, view, extent, technique(words), keep).unwrap();
        let light = *scene.light(None).unwrap().light.rectangle();
        let plan = stage.plan(light, None).unwrap();
        stage.run(&plan).unwrap();
        Self { stage, plan, light }
    }

    /// From now on the maps of the frame that was run last are kept, where the technique keeps them.
    pub fn keep(&mut self) {
        let planned = |stage: &mut Stage, light: &RectangleLight| {
            stage.plan_with(light, |frame| frame.revision = Some(1)).unwrap()
        };
        let first = planned(&mut self.stage, &self.light);
        self.stage.run(&first).unwrap();
        self.plan = planned(&mut self.stage, &self.light);
    }

    /// From now on frames have meshes that `change` has changed, at a revision of their places.
    pub fn with_meshes(
        &mut self,
        revision: Option<u64>,
        change: impl FnOnce(&mut [MeshInstance]),
    ) -> &mut Self {
        let mut meshes = self.stage.instances().to_vec();
        change(&mut meshes);
        let planned = self.stage.plan_with(self.light, |frame| {
            (frame.meshes, frame.mesh_revision) = (&meshes, revision);
        });
        self.plan = planned.unwrap();
        self
    }

    /// The hierarchy of the frame that was run last, which has `leaves` leaves.
    pub fn tree(&mut self, leaves: usize) -> DeviceTree {
        DeviceTree::read(&mut self.stage, &self.plan, leaves).unwrap()
    }

    /// One of the node's own images after the frame that was run last.
    pub fn inspect<T: bytemuck::AnyBitPattern>(&mut self, name: &str) -> (Vec<T>, [u32; 2]) {
        self.stage.inspect(&self.plan, name).unwrap()
    }

    /// Runs one frame.
    pub fn run(&mut self) -> FrameTimes {
        self.stage.run(&self.plan).unwrap()
    }

    /// Microseconds that planning the frame once takes.
    pub fn plan_us(&mut self) -> f64 {
        let started = std::time::Instant::now();
        let plan = self.stage.plan(self.light, None).unwrap();
        let us = started.elapsed().as_secs_f64() * 1e6;
        drop(plan);
        us
    }

    /// The visible fractions that the last frame computed.
    pub fn visibility(&mut self) -> Vec<f32> {
        self.stage.visibility().unwrap()
    }

    /// The last frame's mean error in percent.
    pub fn error(&mut self, truth: &[f32]) -> f64 {
        100.0 * ErrorSummary::between(truth, &self.visibility(), None).unwrap().mean_abs_error
    }

    /// The truth by 256 rays a pixel; exact under a line.
    pub fn truth(&self, scene: &Scene) -> Vec<f32> {
        if self.light.is_line() {
            let receivers = receivers(self.stage.gbuffer()).unwrap();
            let exact = ExactLine::new(scene).unwrap();
            let visible = exact.visible_fractions(&self.light, &receivers).unwrap();
            return visible.iter().map(|&v| v as f32).collect();
        }
        self.traced(scene, 256).0
    }

    /// The traced truth, and the standard error of one of its penumbra pixels.
    pub fn traced(&self, scene: &Scene, rays: u32) -> (Vec<f32>, f64) {
        let receivers = receivers(self.stage.gbuffer()).unwrap();
        let sampling = Sampling::new(rays, 1).unwrap();
        let tracer = Tracer::new(scene).unwrap();
        let traced = tracer.visible_fractions(self.light, &receivers, &sampling).unwrap();
        (traced.visible, traced.noise)
    }
}

/// Runs several in turns; each one's frames.
pub fn in_turns(ready: &mut [Ready], rounds: usize) -> Vec<Vec<FrameTimes>> {
    let mut all: Vec<Vec<FrameTimes>> = ready.iter().map(|_| Vec::new()).collect();
    for _ in 0..rounds {
        for (one, times) in ready.iter_mut().zip(&mut all) {
            times.push(one.run());
        }
    }
    all
}

/// Milliseconds of a frame from submit to fence.
pub fn frame_ms(times: &FrameTimes) -> f64 {
    times.frame.as_secs_f64() * 1e3
}

/// Milliseconds of the passes that are kept.
pub fn passes_ms(times: &FrameTimes, keep: impl Fn(&str) -> bool) -> f64 {
    times.passes.iter().filter(|(name, _)| keep(name)).map(|(_, ms)| ms).sum()
}

/// The median of what each frame took.
pub fn median_of(times: &[FrameTimes], of: impl Fn(&FrameTimes) -> f64) -> f64 {
    median(&times.iter().map(of).collect::<Vec<_>>())
}

/// Median milliseconds of the passes whose names end so.
pub fn ending_ms(times: &[FrameTimes], ends: &[&str]) -> f64 {
    median_of(times, |t| passes_ms(t, |name| ends.iter().any(|end| name.ends_with(end))))
}
