//! What lines cost, and what their samples are worth.

use crate::ready::{Ready, ending_ms, frame_ms, in_turns, median_of, scene, scene_under};
use crate::table::Table;
use crate::{Bench, Scale};
use antumbra::RectangleLight;
use antumbra::scene::{Scene, generate};
use antumbra_harness::{FrameTimes, HeadlessDevice};

pub const BENCH: Bench = Bench {
    name: "linear_light",
    about: "Linear lights: samples, added samples, kept maps, passes, rectangles as lines",
    studies: &[
        ("samples", samples),
        ("added", added),
        ("kept", kept),
        ("passes", passes),
        ("rectangles", rectangles),
    ],
    full: Scale { rounds: 11, sides: &[256, 512], quick: false },
    quick: Scale { rounds: 5, sides: &[256], quick: true },
};

const SCENES: [&str; 6] = ["card", "stacked cards", "tall box", "spheres", "bunny", "foliage"];

/// A line of one metre, turned out of the maps' rows.
fn metre() -> RectangleLight {
    generate::line_light(1.0, 0.4).unwrap()
}

fn lines(device: &HeadlessDevice, scene: &Scene, words: &str) -> Ready {
    Ready::new(device, scene, &format!("linear-light {words}"))
}

fn points(device: &HeadlessDevice, scene: &Scene, samples: u32) -> Ready {
    Ready::new(device, scene, &format!("many-lights samples={samples}"))
}

/// Median milliseconds of frames.
fn ms(times: &[FrameTimes]) -> f64 {
    median_of(times, frame_ms)
}

/// How many samples each line has got.
fn counts(ready: &mut Ready) -> Vec<u32> {
    let (texels, [width, height]) = ready.inspect::<[f32; 4]>("linear_light.places");
    (0..height).map(|row| texels[(row * width + 3) as usize][0] as u32).collect()
}

/// Error against evenly spaced samples, beside many lights with as many maps and with 200 (Fig. 9), and how many of
/// those are as good as eight.
fn samples(device: &HeadlessDevice, _: &Scale, table: &mut Table) {
    table.head("scene|n|linear %|rational %|hard %|hard 200 %|as good as 8");
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
            let [linear, rational] = ["linear", "rational"].map(|transition| {
                let words = format!("samples={n} error=0 transition={transition}");
                lines(device, &scene, &words).error(&truth)
            });
            eight = if n == 8 { rational } else { eight };
            let as_good = match (n, hard.iter().find(|(_, e)| *e <= eight)) {
                (16, Some((m, _))) => m.to_string(),
                (16, None) => "over 400".into(),
                _ => String::new(),
            };
            let hard = format!("{:.2}|{:.2}", hard_of(n), hard_of(200));
            table.row(format!("{name}|{n}|{linear:.2}|{rational:.2}|{hard}|{as_good}"));
        }
    }
}

/// Error and samples by the setting `error`.
fn added(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|asked %|samples|error %|ms|even 2 %|even 16 %");
    for name in SCENES {
        let scene = scene_under(name, metre());
        let goals = [0.05, 0.02, 0.01, 0.005, 0.002];
        let mut all: Vec<Ready> = goals
            .iter()
            .map(|e| lines(device, &scene, &format!("samples=16 error={e}")))
            .chain([2, 16].map(|n| lines(device, &scene, &format!("samples={n} error=0"))))
            .collect();
        let times = in_turns(&mut all, scale.rounds);
        let truth = all[0].truth(&scene);
        let even: Vec<_> = all[goals.len()..].iter_mut().map(|r| r.error(&truth)).collect();
        let even = format!("{:.2}|{:.2}", even[0], even[1]);
        for ((goal, one), times) in goals.iter().zip(&mut all).zip(&times) {
            let (goal, ms) = (100.0 * goal, ms(times));
            let (count, error) = (counts(one)[0], one.error(&truth));
            table.row(format!("{name}|{goal:.1}|{count}|{error:.2}|{ms:.1}|{even}"));
        }
    }
}

/// A frame with kept maps against hard shadows with as many points, whose maps are drawn too.
fn kept(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    let columns = "scene|n|kept ms|hard ms|ratio|hard's pixels ms|ratio|all made ms|hard all ms";
    table.head(columns);
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
            let times = in_turns(&mut all, scale.rounds);
            let [kept, hard, made] = [0, 1, 2].map(|i| ms(&times[i]));
            let pixels = ending_ms(&times[1], &["receivers", "add_point", "average"]);
            let ratios = [kept / hard, ending_ms(&times[0], &["visibility"]) / pixels];
            let pixels = format!("{pixels:.1}|{:.2}", ratios[1]);
            let whole = format!("{kept:.1}|{hard:.1}|{:.2}", ratios[0]);
            table.row(format!("{name}|{n}|{whole}|{pixels}|{made:.1}|{hard:.1}"));
        }
    }
}

/// Where a frame's time goes.
fn passes(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("map|words|pass|ms");
    let scene = scene_under("bunny", metre());
    for side in scale.sides {
        for words in ["samples=4 error=0", "samples=8"] {
            let words = format!("{words} map={side}");
            let mut one = [lines(device, &scene, &words)];
            let times = &in_turns(&mut one, scale.rounds)[0];
            for (name, _) in &times[0].passes {
                table.row(format!("{side}|{words}|{name}|{:.2}", ending_ms(times, &[name])));
            }
            table.row(format!("{side}|{words}|frame|{:.1}", ms(times)));
        }
    }
}

/// A square of 0.4 m as lines, beside the other techniques.
fn rectangles(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|technique|words|error %|ms");
    let kinds = [
        ("linear-light", "lines=1 samples=4 error=0"),
        ("linear-light", "lines=4 samples=2 error=0"),
        ("linear-light", "lines=4 samples=4 error=0"),
        ("linear-light", "lines=8 samples=4 error=0"),
        ("linear-light", "lines=16 samples=4 error=0"),
        ("linear-light", ""),
        ("many-lights", "samples=16"),
        ("many-lights", "samples=64"),
        ("ray-march", "rays=16"),
        ("soft-shadow-map", ""),
        ("occlusion-textures", ""),
        ("pcss", ""),
    ];
    for name in ["card", "tall box", "bunny", "foliage"] {
        let scene = scene(name, 0.4);
        let mut all = kinds.map(|(t, words)| Ready::new(device, &scene, &format!("{t} {words}")));
        let times = in_turns(&mut all, scale.rounds);
        let truth = all[0].truth(&scene);
        for (((technique, words), one), times) in kinds.iter().zip(&mut all).zip(&times) {
            let (error, ms) = (one.error(&truth), ms(times));
            table.row(format!("{name}|{technique}|{words}|{error:.2}|{ms:.1}"));
        }
    }
}
