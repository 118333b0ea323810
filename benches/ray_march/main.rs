//! What ray marching costs, and what its parts save.
//!
//! `cargo bench --bench ray_march` (`-- --quick` for fewer rounds, names of tables for those alone).
//! Everything is measured in one process, the things that are compared in turns, and told as medians.

// A bench tells what goes wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod forward;
#[path = "../technique/mod.rs"]
mod technique;

use antumbra::Technique;
use antumbra::scene::Scene;
use antumbra::stages::nbuffer::{Kind, Levels};
use antumbra_harness::levels::{self, BUILD, bytes, tightness};
use antumbra_harness::{FrameTimes, HeadlessDevice};
use std::time::Instant;
use technique::table::{Table, median};
use technique::{Options, Ready, Study, in_turns, make_tables, scene};

const STUDIES: [Study; 5] = [
    ("levels", kinds),
    ("search", search),
    ("classification", classification),
    ("forward", forward::forward),
    ("bandwidth", bandwidth),
];

fn main() {
    let full = Options { rounds: 7, sides: &[256, 512, 1024] };
    make_tables(&STUDIES, full, Options { rounds: 3, sides: &[256, 512] });
}

fn settings(words: &str) -> Settings {
    technique::settings(Technique::RayMarch, words)
}

fn ready(device: &HeadlessDevice, scene: &Scene, words: &str) -> Ready {
    Ready::new(device, scene, settings(words), 2.2)
}

fn ms(times: &FrameTimes, names: &[&str]) -> f64 {
    levels::ms(times.passes.iter().copied(), names)
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
                .map(|(kind, _)| ready(device, &scene, &format!("map={n} levels={kind}")))
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
                    ready(device, &scene, &format!("map={n} rays={rays} search={search}"))
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
            let mut ready = ["on", "off"]
                .map(|c| ready(device, &scene, &format!("rays={rays} classify={c} filter=off")));
            let all = in_turns(&mut ready, options.rounds);
            let frames = [0, 1].map(|i| median_of(&all[i], frame_ms));
            let [on, off] = &mut ready;
            let (a, b) = (on.visibility(), off.visibility());
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
        let mut ready = ready(device, &scene, &format!("map={n}"));
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
