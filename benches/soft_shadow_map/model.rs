//! Models, and stages to measure them on.

use antumbra::scene::{Role, Scene, from_gltf};
use antumbra::truth::{Receiver, Sampling, Tracer};
use antumbra::{FramePlan, Technique};
use antumbra_harness::{FrameTimes, HeadlessDevice, Stage, View};
use glam::DVec3;
use std::path::Path;

/// A model of the project's own scenes.
pub fn committed(name: &str) -> Scene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    from_gltf(&root.join(format!("{name}.glb"))).unwrap()
}

/// Settings from the words of a command line.
pub fn settings(words: &str) -> Settings {
    let mut settings = Technique::default();
    for word in words.split_whitespace() {
        let (key, value) = word.split_once('=').unwrap();
        settings.set(key, value).unwrap_or_else(|e| panic!("{e}"));
    }
    settings
}

/// A stage with its plan.
pub struct Ready {
    stage: Stage,
    plan: FramePlan,
    light: antumbra::RectangleLight,
}

impl Ready {
    /// A grid of `side`² pixels on the ground over |x|, |z| ≤ 2.2; one frame to warm up.
    pub fn new(device: &HeadlessDevice, scene: &Scene, side: u32, words: &str) -> Self {
        let view = View::map_of_ground(2.2, 8.0);
        let keep = |i: &antumbra::scene::Instance| i.role != Role::Occluder;
        let mut stage = Stage::new(device, scene, &view, [side; 2], settings(words), keep).unwrap();
        let light = scene.light(None).unwrap().light;
        let plan = stage.plan(&light, None).unwrap();
        stage.run(&plan).unwrap();
        Self { stage, plan, light }
    }

    /// One frame.
    pub fn run(&mut self) -> FrameTimes {
        self.stage.run(&self.plan).unwrap()
    }

    /// Microseconds of planning the frame once.
    pub fn plan_us(&mut self) -> f64 {
        let started = std::time::Instant::now();
        let plan = self.stage.plan(&self.light, None).unwrap();
        let us = started.elapsed().as_secs_f64() * 1e6;
        drop(plan);
        us
    }

    /// What the last frame computed.
    pub fn image(&mut self) -> Vec<f32> {
        self.stage.visibility().unwrap()
    }

    /// The traced truth of the same pixels, and its noise a penumbra pixel.
    pub fn truth(&self, scene: &Scene, rays: u32) -> (Vec<f32>, f64) {
        let wide = |a: &[f32; 4]| DVec3::new(a[0].into(), a[1].into(), a[2].into());
        let gbuffer = self.stage.gbuffer();
        let (positions, normals) = (gbuffer.positions().unwrap(), gbuffer.normals().unwrap());
        let receivers: Vec<Receiver> = positions
            .iter()
            .zip(&normals)
            .map(|(p, n)| Receiver { position: wide(p), normal: wide(n) })
            .collect();
        let traced = Tracer::new(scene)
            .unwrap()
            .visible_fractions(&self.light, &receivers, &Sampling::new(rays, 1).unwrap())
            .unwrap();
        (traced.visible, traced.noise)
    }
}

/// Milliseconds of the passes that add up: everything of the technique between layers and resolve.
pub fn accumulation_ms(times: &FrameTimes) -> f64 {
    times.passes.iter().filter(|p| p.0.starts_with("soft_shadow_map")).map(|p| p.1).sum()
}
