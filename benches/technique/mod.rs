//! What the benches of single techniques share: their command line, scenes, and a stage that runs a plan.

#![allow(dead_code, reason = "each bench uses a part")]

use antumbra::scene::{Instance, Role, Scene, from_gltf, generate};
use antumbra::truth::{ErrorSummary, ExactLine, Receiver, Sampling, Tracer};
use antumbra::{FramePlan, RectangleLight, Technique};
use antumbra_harness::{FrameTimes, HeadlessDevice, HeadlessOptions, Stage, View};
use glam::DVec3;
use std::path::Path;

#[path = "../soft_shadow_map/table.rs"]
pub mod table;

use table::Table;

pub struct Options {
    pub rounds: usize,
    /// Of maps, in texels.
    pub sides: &'static [u32],
}

/// A table by its name on the command line.
pub type Study = (&'static str, fn(&HeadlessDevice, &Options) -> Table);

/// Makes the tables that the command line names, or all: `full`, or with `--quick` the other one.
pub fn make_tables(studies: &[Study], full: Options, quick: Options) {
    let mut options = full;
    let mut quick = Some(quick);
    let mut asked = Vec::new();
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--quick" => options = quick.take().unwrap_or(options),
            // What cargo itself passes.
            "--bench" => {}
            table if studies.iter().any(|(name, _)| *name == table) => asked.push(argument),
            other => {
                let names: Vec<_> = studies.iter().map(|(name, _)| *name).collect();
                panic!("{other}: the options are --quick and tables: {}", names.join(", "))
            }
        }
    }
    let device = HeadlessDevice::new(&HeadlessOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    println!("{}", device.name());
    for (name, make) in studies {
        if asked.is_empty() || asked.iter().any(|a| a == name) {
            make(&device, &options);
        }
    }
}

/// A model under a light of a width in metres, or one of the generated scenes.
pub fn scene(name: &str, side: f64) -> Scene {
    scene_under(name, generate::square_light(side).unwrap())
}

/// The same under any light.
pub fn scene_under(name: &str, light: RectangleLight) -> Scene {
    match name {
        "card" => generate::card(light),
        "spheres" => generate::spheres(light),
        "stacked" => generate::stacked_cards(light),
        "box" => generate::tall_box(light),
        "slats" => generate::slats(light, 24),
        "foliage" => generate::foliage(light, 300, 7),
        model => {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{model}.glb"));
            generate::normalized(&from_gltf(&path).unwrap(), light).unwrap()
        }
    }
}

/// A technique's settings from the words of a command line.
pub fn settings(technique: Technique, words: &str) -> Settings {
    let mut settings = Settings { technique, ..Technique::default() };
    for (key, value) in words.split_whitespace().filter_map(|w| w.split_once('=')) {
        settings.set(key, value).unwrap_or_else(|e| panic!("{e}"));
    }
    settings
}

/// A stage with its plan: 480² pixels of the ground.
pub struct Ready {
    stage: Stage,
    plan: FramePlan,
    light: RectangleLight,
}

impl Ready {
    /// The pixels over |x|, |z| ≤ `half` metres.
    pub fn new(device: &HeadlessDevice, scene: &Scene, settings: Technique, half: f64) -> Self {
        Self::seen(device, scene, settings, &View::map_of_ground(half, 8.0), [480; 2])
    }

    /// The pixels of a view.
    pub fn seen(
        device: &HeadlessDevice,
        scene: &Scene,
        settings: Technique,
        view: &View,
        extent: [u32; 2],
    ) -> Self {
        let keep = |i: &Instance| i.role != Role::Occluder;
        let mut stage = Stage::new(device, scene, view, extent, settings, keep).unwrap();
        let light = scene.light(None).unwrap().light;
        let plan = stage.plan(&light, None).unwrap();
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

    /// One of the node's own images behind the frame that was run last.
    pub fn inspect<T: bytemuck::AnyBitPattern>(&mut self, name: &str) -> (Vec<T>, [u32; 2]) {
        self.stage.inspect(&self.plan, name).unwrap()
    }

    pub fn run(&mut self) -> FrameTimes {
        self.stage.run(&self.plan).unwrap()
    }

    pub fn visibility(&mut self) -> Vec<f32> {
        self.stage.visibility().unwrap()
    }

    /// Mean error in percent.
    pub fn error(&mut self, truth: &[f32]) -> f64 {
        100.0 * ErrorSummary::between(truth, &self.visibility(), None).unwrap().mean_abs_error
    }

    /// Of 256 rays a pixel; exact under a line.
    pub fn truth(&self, scene: &Scene) -> Vec<f32> {
        let wide = |a: &[f32; 4]| DVec3::new(a[0].into(), a[1].into(), a[2].into());
        let gbuffer = self.stage.gbuffer();
        let (positions, normals) = (gbuffer.positions().unwrap(), gbuffer.normals().unwrap());
        let receivers: Vec<Receiver> = positions
            .iter()
            .zip(&normals)
            .map(|(p, n)| Receiver { position: wide(p), normal: wide(n) })
            .collect();
        if self.light.is_line() {
            let exact = ExactLine::new(scene).unwrap();
            let visible = exact.visible_fractions(&self.light, &receivers).unwrap();
            return visible.iter().map(|&v| v as f32).collect();
        }
        let sampling = Sampling::new(256, 1).unwrap();
        let tracer = Tracer::new(scene).unwrap();
        tracer.visible_fractions(&self.light, &receivers, &sampling).unwrap().visible
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
