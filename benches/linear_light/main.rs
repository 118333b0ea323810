//! What lines cost, and what their samples are worth.
//!
//! `cargo bench --bench linear_light` (`-- --quick` for fewer rounds, names of tables for those alone).
//! Everything is measured in one process, the things that are compared in turns, and told as medians.

// A bench tells what goes wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../technique/mod.rs"]
mod technique;

use antumbra::scene::{Scene, generate};
use antumbra::{RectangleLight, Technique};
use antumbra_harness::{FrameTimes, HeadlessDevice};
use technique::table::Table;
use technique::{Options, Ready, Study, in_turns, make_tables, scene_under};

const STUDIES: [Study; 5] = [
    ("samples", samples),
    ("added", added),
    ("kept", kept),
    ("passes", passes),
    ("rectangles", rectangles),
];

const SCENES: [&str; 6] = ["card", "stacked", "box", "spheres", "bunny", "foliage"];

fn main() {
    let full = Options { rounds: 11, sides: &[256, 512] };
    make_tables(&STUDIES, full, Options { rounds: 5, sides: &[256] });
}

/// A line of one metre, turned out of the maps' rows.
fn metre() -> RectangleLight {
    generate::line_light(1.0, 0.4).unwrap()
}

fn ready(device: &HeadlessDevice, scene: &Scene, technique: Technique, words: &str) -> Ready {
    Ready::new(device, scene, technique::settings(technique, words), 2.2)
}

fn lines(device: &HeadlessDevice, scene: &Scene, words: &str) -> Ready {
    ready(device, scene, Technique::LinearLight, words)
}

fn points(device: &HeadlessDevice, scene: &Scene, samples: u32) -> Ready {
    ready(device, scene, Technique::ManyLights, &format!("samples={samples}"))
}

/// Median milliseconds of frames.
fn ms(times: &[FrameTimes]) -> f64 {
    let mut all: Vec<_> = times.iter().map(|t| 1e3 * t.frame.as_secs_f64()).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

/// Median milliseconds of the passes whose names end so.
fn of_passes(times: &[FrameTimes], ends: &[&str]) -> f64 {
    let sum = |t: &FrameTimes| {
        let passes = t.passes.iter().filter(|(name, _)| ends.iter().any(|e| name.ends_with(e)));
        passes.map(|(_, ms)| ms).sum::<f64>()
    };
    let mut all: Vec<f64> = times.iter().map(sum).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

/// How many samples each line has got.
fn counts(ready: &mut Ready) -> Vec<u32> {
    let (texels, [width, height]) = ready.inspect::<[f32; 4]>("linear_light.places");
    (0..height).map(|row| texels[(row * width + 3) as usize][0] as u32).collect()
}

/// Error against evenly spaced samples, beside many lights with as many maps and with 200 (Fig. 9), and how many of
/// those are as good as eight.
fn samples(device: &HeadlessDevice, _: &Options) -> Table {
    let columns = ["scene", "n", "linear %", "rational %", "hard %", "hard 200 %", "as good as 8"];
    let mut table = Table::new("samples", &columns);
    for name in SCENES {
        let scene = scene_under(name, metre());
        let truth = lines(device, &scene, "samples=2").truth(&scene);
        let hard: Vec<(u32, f64)> = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 200, 256, 400]
            .into_iter()
            .map(|n| (n, points(device, &scene, n).error(&truth)))
            .collect();
        let hard_of = |n| hard.iter().find(|(m, _)| *m == n).unwrap().1;
        let mut eight = 0.0;
        for n in [2, 3, 4, 8, 16] {
            let error = |transition: &str| {
                let words = format!("samples={n} error=0 transition={transition}");
                lines(device, &scene, &words).error(&truth)
            };
            let rational = error("rational");
            eight = if n == 8 { rational } else { eight };
            let as_good = hard.iter().find(|(_, e)| *e <= eight);
            table.row(vec![
                name.into(),
                n.to_string(),
                format!("{:.2}", error("linear")),
                format!("{rational:.2}"),
                format!("{:.2}", hard_of(n)),
                format!("{:.2}", hard_of(200)),
                match (n, as_good) {
                    (16, Some((m, _))) => m.to_string(),
                    (16, None) => "over 400".into(),
                    _ => String::new(),
                },
            ]);
        }
    }
    table
}

/// Error and samples by the error asked for.
fn added(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["scene", "asked %", "samples", "error %", "ms", "even 2 %", "even 16 %"];
    let mut table = Table::new("added", &columns);
    for name in SCENES {
        let scene = scene_under(name, metre());
        let asked = [0.05, 0.02, 0.01, 0.005, 0.002];
        let mut all: Vec<Ready> = asked
            .iter()
            .map(|e| lines(device, &scene, &format!("samples=16 error={e}")))
            .chain([2, 16].map(|n| lines(device, &scene, &format!("samples={n} error=0"))))
            .collect();
        let times = in_turns(&mut all, options.rounds);
        let truth = all[0].truth(&scene);
        let even: Vec<_> = all[asked.len()..].iter_mut().map(|r| r.error(&truth)).collect();
        for ((asked, one), times) in asked.iter().zip(&mut all).zip(&times) {
            table.row(vec![
                name.into(),
                format!("{:.1}", 100.0 * asked),
                counts(one)[0].to_string(),
                format!("{:.2}", one.error(&truth)),
                format!("{:.1}", ms(times)),
                format!("{:.2}", even[0]),
                format!("{:.2}", even[1]),
            ]);
        }
    }
    table
}

/// A frame with kept maps against hard shadows with as many points, whose maps are drawn too.
fn kept(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = [
        "scene",
        "n",
        "kept ms",
        "hard ms",
        "ratio",
        "hard's pixels ms",
        "ratio",
        "all made ms",
        "hard all ms",
    ];
    let mut table = Table::new("kept", &columns);
    for name in ["bunny", "foliage"] {
        let scene = scene_under(name, metre());
        for n in [2, 4, 8, 16] {
            let words = format!("samples={n} error=0");
            let mut all = [
                lines(device, &scene, &words),
                points(device, &scene, n),
                lines(device, &scene, &words),
            ];
            all[0].keep();
            let times = in_turns(&mut all, options.rounds);
            let kept = ms(&times[0]);
            let pixels = of_passes(&times[1], &["receivers", "add_point", "average"]);
            table.row(vec![
                name.into(),
                n.to_string(),
                format!("{kept:.1}"),
                format!("{:.1}", ms(&times[1])),
                format!("{:.2}", kept / ms(&times[1])),
                format!("{pixels:.1}"),
                format!("{:.2}", of_passes(&times[0], &["visibility"]) / pixels),
                format!("{:.1}", ms(&times[2])),
                format!("{:.1}", ms(&times[1])),
            ]);
        }
    }
    table
}

/// Where a frame's time goes.
fn passes(device: &HeadlessDevice, options: &Options) -> Table {
    let mut table = Table::new("passes", &["map", "words", "pass", "ms"]);
    let scene = scene_under("bunny", metre());
    for side in options.sides {
        for words in ["samples=4 error=0", "samples=8"] {
            let words = format!("{words} map={side}");
            let mut one = [lines(device, &scene, &words)];
            let times = &in_turns(&mut one, options.rounds)[0];
            for (name, _) in &times[0].passes {
                let ms = of_passes(times, &[name]);
                table.row(vec![
                    side.to_string(),
                    words.clone(),
                    (*name).into(),
                    format!("{ms:.2}"),
                ]);
            }
            table.row(vec![side.to_string(), words, "frame".into(), format!("{:.1}", ms(times))]);
        }
    }
    table
}

/// A square of 0.4 m as lines, beside the other techniques.
fn rectangles(device: &HeadlessDevice, options: &Options) -> Table {
    let mut table = Table::new("rectangles", &["scene", "technique", "words", "error %", "ms"]);
    let kinds = [
        (Technique::LinearLight, "lines=1 samples=4 error=0"),
        (Technique::LinearLight, "lines=4 samples=2 error=0"),
        (Technique::LinearLight, "lines=4 samples=4 error=0"),
        (Technique::LinearLight, "lines=8 samples=4 error=0"),
        (Technique::LinearLight, "lines=16 samples=4 error=0"),
        (Technique::LinearLight, ""),
        (Technique::ManyLights, "samples=16"),
        (Technique::ManyLights, "samples=64"),
        (Technique::RayMarch, "rays=16"),
        (Technique::SoftShadowMap, ""),
        (Technique::OcclusionTextures, ""),
        (Technique::Pcss, ""),
    ];
    for name in ["card", "box", "bunny", "foliage"] {
        let scene = scene_under(name, generate::square_light(0.4).unwrap());
        let mut all: Vec<_> = kinds.iter().map(|(t, w)| ready(device, &scene, *t, w)).collect();
        let times = in_turns(&mut all, options.rounds);
        let truth = all[0].truth(&scene);
        for (((technique, words), one), times) in kinds.iter().zip(&mut all).zip(&times) {
            table.row(vec![
                name.into(),
                technique.name().into(),
                (*words).into(),
                format!("{:.2}", one.error(&truth)),
                format!("{:.1}", ms(times)),
            ]);
        }
    }
    table
}
