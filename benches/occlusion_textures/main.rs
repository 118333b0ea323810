//! What occlusion textures cost, and what their parts are worth.
//!
//! `cargo bench --bench occlusion_textures` (`-- --quick` for fewer rounds, names of tables for those alone).
//! Everything is measured in one process, the things that are compared in turns, and told as the least of the
//! rounds: on a machine with other work to do that is nearest to what the work itself takes.

// A bench tells what goes wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../soft_shadow_map/table.rs"]
#[allow(dead_code, reason = "another bench uses the rest")]
mod table;

use antumbra::gpu::headless::{FrameTimes, HeadlessDevice, HeadlessOptions, Stage, View};
use antumbra::scene::{Role, Scene, from_gltf, generate};
use antumbra::truth::{ErrorSummary, Receiver, Sampling, Tracer};
use antumbra::{FramePlan, RectangleLight, Settings, Technique};
use glam::DVec3;
use std::path::Path;
use table::{Table, line};

struct Options {
    rounds: usize,
    sides: &'static [u32],
}

type Study = (&'static str, fn(&HeadlessDevice, &Options) -> Table);

const STUDIES: [Study; 4] = [
    ("prefilters", prefilters),
    ("light", light_sizes),
    ("combination", combination),
    ("exponents", exponents),
];

const PUBLISHED: &str = "combine=product placement=uniform";

fn main() {
    let mut options = Options { rounds: 11, sides: &[256, 512, 1024] };
    let mut asked = Vec::new();
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--quick" => options = Options { rounds: 5, sides: &[256, 512] },
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
        "stacked" => generate::stacked_cards(light),
        "box" => generate::tall_box(light),
        "foliage" => generate::foliage(light, 300, 7),
        model => {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{model}.glb"));
            generate::normalized(&from_gltf(&path).unwrap(), light).unwrap()
        }
    }
}

/// A stage with its plan, of 480² pixels, and the least that each of its passes took.
struct Ready {
    stage: Stage,
    plan: FramePlan,
    light: RectangleLight,
    least: Vec<(&'static str, f64)>,
}

impl Ready {
    fn new(device: &HeadlessDevice, scene: &Scene, words: &str) -> Self {
        Self::over(device, scene, words, 2.2)
    }

    /// The pixels over |x|, |z| ≤ `half` metres.
    fn over(device: &HeadlessDevice, scene: &Scene, words: &str, half: f64) -> Self {
        let technique = Technique::OcclusionTextures;
        let mut settings = Settings { technique, ..Settings::default() };
        for (key, value) in words.split_whitespace().filter_map(|w| w.split_once('=')) {
            settings.set(key, value).unwrap_or_else(|e| panic!("{e}"));
        }
        let keep = |i: &antumbra::scene::Instance| i.role != Role::Occluder;
        let view = View::map_of_ground(half, 8.0);
        let mut stage = Stage::new(device, scene, &view, [480; 2], settings, keep).unwrap();
        let light = scene.light(None).unwrap().light;
        let plan = stage.plan(&light, None).unwrap();
        stage.run(&plan).unwrap();
        Self { stage, plan, light, least: Vec::new() }
    }

    fn run(&mut self) {
        let times: FrameTimes = self.stage.run(&self.plan).unwrap();
        let passes: Vec<_> = times.passes.iter().map(|(name, ms)| (*name, *ms)).collect();
        if self.least.is_empty() {
            self.least = passes;
        } else {
            for (least, now) in self.least.iter_mut().zip(passes) {
                least.1 = least.1.min(now.1);
            }
        }
    }

    /// Milliseconds of passes by their names' ends; of all without names.
    fn ms(&self, names: &[&str]) -> f64 {
        let of = |name: &str| {
            names.is_empty() || names.iter().any(|n| name == format!("occlusion_textures.{n}"))
        };
        self.least.iter().filter(|(name, _)| of(name)).map(|(_, ms)| ms).sum()
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

/// Runs several in turns.
fn in_turns(ready: &mut [Ready], rounds: usize) {
    for _ in 0..rounds {
        ready.iter_mut().for_each(Ready::run);
    }
}

const BUILD: [&str; 4] = ["sum_rows", "sum_columns", "first_level", "next_level"];

/// Fig. 2: what it takes to filter one texture of four slices, and what one that is asked for is worth.
fn prefilters(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["N", "prefilter", "build ms", "pixels ms", "sum ms", "error %"];
    let mut table = Table::new("prefilters", &columns);
    let scene = scene("suzanne", 1.0);
    let mut truth = None;
    for &n in options.sides {
        let names = ["mip", "sat", "n-buffer"];
        let mut ready = names.map(|prefilter| {
            let words = format!("{PUBLISHED} slices=4 map={n} prefilter={prefilter}");
            Ready::new(device, &scene, &words)
        });
        in_turns(&mut ready, options.rounds);
        for (name, one) in names.iter().zip(&mut ready) {
            let truth = truth.get_or_insert_with(|| one.truth(&scene));
            let (build, pixels) = (one.ms(&BUILD), one.ms(&["visibility"]));
            table.row(vec![
                n.to_string(),
                (*name).into(),
                format!("{build:.1}"),
                format!("{pixels:.1}"),
                format!("{:.1}", build + pixels),
                format!("{:.2}", one.error(truth)),
            ]);
        }
    }
    table
}

/// Cost against the light's size, in sizes of the object: of pixels that are all behind it, and of a view that
/// a larger light shadows more of, as pixels whose kernels meet nothing cost next to nothing.
fn light_sizes(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["L", "published", "correlated", "n-buffer", "whole view", "correlated"];
    let mut table = Table::new("light", &columns);
    let sides = [0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 1.4, 2.0];
    let n_buffer = "combine=product placement=uniform prefilter=n-buffer";
    let kinds = [(PUBLISHED, 0.3), ("", 0.3), (n_buffer, 0.3), (PUBLISHED, 2.2), ("", 2.2)];
    // All in turns, so that what else the machine does is the same for all.
    let mut ready: Vec<_> = sides
        .iter()
        .flat_map(|&side| {
            kinds.map(|(words, half)| Ready::over(device, &scene("bunny", side), words, half))
        })
        .collect();
    in_turns(&mut ready, options.rounds);
    for (side, ready) in sides.iter().zip(ready.chunks(kinds.len())) {
        let mut row = vec![side.to_string()];
        row.extend(ready.iter().map(|r| format!("{:.1}", r.ms(&[]))));
        table.row(row);
    }
    table
}

/// The published product against what slices have in common: error and time.
fn combination(device: &HeadlessDevice, options: &Options) -> Table {
    let columns =
        ["scene", "slices", "error %", "filled", "ours", "of it", "ms", "ours ms", "ratio"];
    let mut table = Table::new("combination", &columns);
    for (name, side) in [
        ("box", 1.0),
        ("bunny", 0.4),
        ("bunny", 1.0),
        ("suzanne", 1.0),
        ("foliage", 0.4),
        ("stacked", 1.0),
    ] {
        let scene = scene(name, side);
        let mut truth = None;
        for slices in [4, 8, 16] {
            let words = format!("slices={slices}");
            let mut ready = [
                format!("{PUBLISHED} {words}"),
                format!("{PUBLISHED} fill=on {words}"),
                words.clone(),
            ]
            .map(|words| Ready::new(device, &scene, &words));
            in_turns(&mut ready, options.rounds);
            let truth = truth.get_or_insert_with(|| ready[0].truth(&scene));
            let errors = [0, 1, 2].map(|i| ready[i].error(truth));
            let (published, ours) = (ready[0].ms(&[]), ready[2].ms(&[]));
            table.row(vec![
                format!("{name} {side}"),
                slices.to_string(),
                format!("{:.2}", errors[0]),
                format!("{:.2}", errors[1]),
                format!("{:.2}", errors[2]),
                format!("{:.2}", errors[2] / errors[0]),
                format!("{published:.1}"),
                format!("{ours:.1}"),
                format!("{:.2}", ours / published),
            ]);
        }
    }
    table
}

/// Cost against slices and against the map's side, as exponents.
fn exponents(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["against", "words", "ms", "exponent", "R2"];
    let mut table = Table::new("exponents", &columns);
    let scene = scene("bunny", 0.4);
    let slices = [4.0, 8.0, 16.0, 32.0];
    let maps = [128.0, 256.0, 512.0, 1024.0];
    for (what, more, steps) in [("slices", "map=256", slices), ("map", "slices=16", maps)] {
        for words in [PUBLISHED, ""] {
            let mut ready =
                steps.map(|x| Ready::new(device, &scene, &format!("{words} {more} {what}={x}")));
            in_turns(&mut ready, options.rounds);
            let ms = ready.each_ref().map(|r| r.ms(&[]));
            let points: Vec<_> =
                steps.iter().zip(ms).map(|(x, ms): (&f64, f64)| (x.ln(), ms.ln())).collect();
            let (_, exponent, r2) = line(&points);
            table.row(vec![
                what.into(),
                if words.is_empty() { "correlated" } else { "published" }.into(),
                ms.map(|ms| format!("{ms:.0}")).join(" "),
                format!("{exponent:.2}"),
                format!("{r2:.2}"),
            ]);
        }
    }
    table
}
