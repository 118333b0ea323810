//! What ray marching costs, and what its parts save.
//!
//! `cargo bench --bench ray_march` (`-- --quick` for fewer rounds, names of tables for those alone).
//! Everything is measured in one process, the things that are compared in turns, and told as medians.

// A bench tells what goes wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod forward;
mod levels;
#[path = "../soft_shadow_map/table.rs"]
#[allow(dead_code, reason = "another bench uses the rest")]
mod table;

use antumbra::gpu::headless::{FrameTimes, HeadlessDevice, HeadlessOptions, Stage, View};
use antumbra::nbuffer::{Kind, Levels};
use antumbra::scene::{Role, Scene, from_gltf, generate};
use antumbra::truth::{ErrorSummary, Receiver, Sampling, Tracer};
use antumbra::{FramePlan, RectangleLight, Settings, Technique};
use glam::DVec3;
use levels::{BUILD, bytes, tightness};
use std::path::Path;
use std::time::Instant;
use table::{Table, median};

struct Options {
    rounds: usize,
    sides: &'static [u32],
}

type Study = (&'static str, fn(&HeadlessDevice, &Options) -> Table);

const STUDIES: [Study; 5] = [
    ("levels", kinds),
    ("search", search),
    ("classification", classification),
    ("forward", forward::forward),
    ("bandwidth", bandwidth),
];

fn main() {
    let mut options = Options { rounds: 7, sides: &[256, 512, 1024] };
    let mut asked = Vec::new();
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--quick" => options = Options { rounds: 3, sides: &[256, 512] },
            // What cargo itself passes.
            "--bench" => {}
            table if STUDIES.iter().any(|(name, _)| *name == table) => asked.push(argument),
            other => {
                let names = STUDIES.map(|(name, _)| name).join(", ");
                panic!("{other}: the options are --quick and tables: {names}")
            }
        }
    }
    let device = HeadlessDevice::new(&HeadlessOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    println!("{}", device.name());
    for (name, make) in STUDIES {
        if asked.is_empty() || asked.iter().any(|a| a == name) {
            make(&device, &options);
        }
    }
}

/// A model under a light of a width in metres, or one of the generated scenes.
fn scene(name: &str, side: f64) -> Scene {
    let light = generate::square_light(side).unwrap();
    match name {
        "slats" => generate::slats(light, 24),
        "foliage" => generate::foliage(light, 300, 7),
        model => {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{model}.glb"));
            generate::normalized(&from_gltf(&path).unwrap(), light).unwrap()
        }
    }
}

/// Ray marching's settings from the words of a command line.
fn settings(words: &str) -> Settings {
    let mut settings = Settings { technique: Technique::RayMarch, ..Settings::default() };
    for (key, value) in words.split_whitespace().filter_map(|w| w.split_once('=')) {
        settings.set(key, value).unwrap_or_else(|e| panic!("{e}"));
    }
    settings
}

/// A stage with its plan: 480² pixels of the ground.
struct Ready {
    stage: Stage,
    plan: FramePlan,
    light: RectangleLight,
}

impl Ready {
    fn new(device: &HeadlessDevice, scene: &Scene, words: &str) -> Self {
        let keep = |i: &antumbra::scene::Instance| i.role != Role::Occluder;
        let view = View::map_of_ground(2.2, 8.0);
        let mut stage = Stage::new(device, scene, &view, [480; 2], settings(words), keep).unwrap();
        let light = scene.light(None).unwrap().light;
        let plan = stage.plan(&light, None).unwrap();
        stage.run(&plan).unwrap();
        Self { stage, plan, light }
    }

    fn run(&mut self) -> FrameTimes {
        self.stage.run(&self.plan).unwrap()
    }

    /// Mean error in percent.
    fn error(&mut self, truth: &[f32]) -> f64 {
        let seen = self.stage.visibility().unwrap();
        100.0 * ErrorSummary::between(truth, &seen, None).unwrap().mean_abs_error
    }

    fn truth(&self, scene: &Scene) -> Vec<f32> {
        let wide = |a: &[f32; 4]| DVec3::new(a[0].into(), a[1].into(), a[2].into());
        let gbuffer = self.stage.gbuffer();
        let (positions, normals) = (gbuffer.positions().unwrap(), gbuffer.normals().unwrap());
        let receivers: Vec<Receiver> = positions
            .iter()
            .zip(&normals)
            .map(|(p, n)| Receiver { position: wide(p), normal: wide(n) })
            .collect();
        let sampling = Sampling::new(256, 1).unwrap();
        let tracer = Tracer::new(scene).unwrap();
        tracer.visible_fractions(&self.light, &receivers, &sampling).unwrap().visible
    }
}

fn ms(times: &FrameTimes, names: &[&str]) -> f64 {
    levels::ms(times.passes.iter().copied(), names)
}

/// Runs several in turns; each one's frames.
fn in_turns(ready: &mut [Ready], rounds: usize) -> Vec<Vec<FrameTimes>> {
    let mut all: Vec<Vec<FrameTimes>> = ready.iter().map(|_| Vec::new()).collect();
    for _ in 0..rounds {
        for (one, times) in ready.iter_mut().zip(&mut all) {
            times.push(one.run());
        }
    }
    all
}

fn median_of(times: &[FrameTimes], of: impl Fn(&FrameTimes) -> f64) -> f64 {
    median(&times.iter().map(of).collect::<Vec<_>>())
}

fn frame_ms(times: &FrameTimes) -> f64 {
    times.frame.as_secs_f64() * 1e3
}

/// The kinds of windows: memory, how long they take to make, what the search makes of them, and how many
/// texels they hold for each that is asked for. N-buffers have shaders of their own, without the branches
/// of the others.
fn kinds(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["scene", "N", "levels", "MB", "build ms", "classify", "trace", "sum", "held"];
    let mut table = Table::new("levels", &columns);
    for name in ["bunny", "foliage"] {
        let scene = scene(name, 0.4);
        for &n in options.sides {
            let mut ready: Vec<_> = Kind::ALL
                .iter()
                .map(|(kind, _)| Ready::new(device, &scene, &format!("map={n} levels={kind}")))
                .collect();
            let all = in_turns(&mut ready, options.rounds);
            for ((kind_name, kind), times) in Kind::ALL.iter().zip(&all) {
                let [build, classify, trace] =
                    [&BUILD[..], &["classify"], &["trace"]].map(|p| median_of(times, |t| ms(t, p)));
                table.row(vec![
                    name.into(),
                    n.to_string(),
                    (*kind_name).into(),
                    format!("{:.1}", bytes(Levels { map: n, kind: *kind }) as f64 / 1e6),
                    format!("{build:.1}"),
                    format!("{classify:.1}"),
                    format!("{trace:.1}"),
                    format!("{:.1}", build + classify + trace),
                    format!("{:.2}", tightness(*kind)),
                ]);
            }
        }
    }
    table
}

/// Hierarchical against linear search: the same rays, so the same error but for what each misses.
fn search(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["scene", "N", "rays", "hier. ms", "linear ms", "ratio", "error %", "error %"];
    let mut table = Table::new("search", &columns);
    for (name, side) in [("bunny", 0.4), ("suzanne", 1.0), ("slats", 0.4), ("foliage", 0.4)] {
        let scene = scene(name, side);
        let mut truth = None;
        for &n in &options.sides[..2] {
            for rays in [4, 16] {
                let mut ready = ["hierarchical", "linear"].map(|search| {
                    Ready::new(device, &scene, &format!("map={n} rays={rays} search={search}"))
                });
                let truth = truth.get_or_insert_with(|| ready[0].truth(&scene));
                let all = in_turns(&mut ready, options.rounds);
                let trace = [0, 1].map(|i| median_of(&all[i], |t| ms(t, &["trace"])));
                let errors = [0, 1].map(|i| ready[i].error(truth));
                table.row(vec![
                    name.into(),
                    n.to_string(),
                    rays.to_string(),
                    format!("{:.1}", trace[0]),
                    format!("{:.1}", trace[1]),
                    format!("{:.2}", trace[0] / trace[1]),
                    format!("{:.2}", errors[0]),
                    format!("{:.2}", errors[1]),
                ]);
            }
        }
    }
    table
}

/// With and without classification and early outs.
fn classification(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["scene", "L", "rays", "on ms", "off ms", "ratio", "differ by"];
    let mut table = Table::new("classification", &columns);
    for (name, side) in [("bunny", 0.1), ("bunny", 0.4), ("bunny", 1.0), ("foliage", 0.4)] {
        let scene = scene(name, side);
        for rays in [4, 16, 64] {
            let mut ready = ["on", "off"].map(|c| {
                Ready::new(device, &scene, &format!("rays={rays} classify={c} filter=off"))
            });
            let all = in_turns(&mut ready, options.rounds);
            let frames = [0, 1].map(|i| median_of(&all[i], frame_ms));
            let [on, off] = &mut ready;
            let (a, b) = (on.stage.visibility().unwrap(), off.stage.visibility().unwrap());
            let worst = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            table.row(vec![
                name.into(),
                side.to_string(),
                rays.to_string(),
                format!("{:.1}", frames[0]),
                format!("{:.1}", frames[1]),
                format!("{:.2}", frames[0] / frames[1]),
                format!("{worst:.1e}"),
            ]);
        }
    }
    table
}

/// Making the levels beside copying as many bytes, by the processor's two cores as the driver has them.
fn bandwidth(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["N", "MB", "build ms", "copy ms", "ratio"];
    let mut table = Table::new("bandwidth", &columns);
    let scene = scene("bunny", 0.4);
    for &n in options.sides {
        let mut ready = Ready::new(device, &scene, &format!("map={n}"));
        let bytes = bytes(Levels { map: n, kind: Kind::NBuffer }) as usize;
        let source = vec![1u8; bytes];
        let mut target = vec![0u8; bytes];
        let (mut builds, mut copies) = (Vec::new(), Vec::new());
        for _ in 0..options.rounds {
            builds.push(ms(&ready.run(), &BUILD));
            let started = Instant::now();
            let half = bytes / 2;
            std::thread::scope(|scope| {
                let (a, b) = target.split_at_mut(half);
                scope.spawn(|| a.copy_from_slice(&source[..half]));
                b.copy_from_slice(&source[half..]);
            });
            copies.push(started.elapsed().as_secs_f64() * 1e3);
            std::hint::black_box(&target);
        }
        let (build, copy) = (median(&builds), median(&copies));
        table.row(vec![
            n.to_string(),
            format!("{:.1}", bytes as f64 / 1e6),
            format!("{build:.1}"),
            format!("{copy:.2}"),
            format!("{:.1}", build / copy),
        ]);
    }
    table
}
