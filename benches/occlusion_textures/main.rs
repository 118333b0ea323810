//! What occlusion textures cost, and what their parts are worth.
//!
//! `cargo bench --bench occlusion_textures` (`-- --quick` for fewer rounds, names of tables for those alone).
//! Everything is measured in one process, the things that are compared in turns, and told as the least of the
//! rounds: on a machine with other work to do that is nearest to what the work itself takes.

// A bench tells what goes wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../technique/mod.rs"]
mod technique;

use antumbra::Technique;
use antumbra::scene::Scene;
use antumbra_harness::{FrameTimes, HeadlessDevice};
use technique::table::{Table, line};
use technique::{Options, Ready, Study, in_turns, make_tables, scene};

const STUDIES: [Study; 4] = [
    ("prefilters", prefilters),
    ("light", light_sizes),
    ("combination", combination),
    ("exponents", exponents),
];

const PUBLISHED: &str = "combine=product placement=uniform";

fn main() {
    let full = Options { rounds: 11, sides: &[256, 512, 1024] };
    make_tables(&STUDIES, full, Options { rounds: 5, sides: &[256, 512] });
}

fn ready(device: &HeadlessDevice, scene: &Scene, words: &str) -> Ready {
    ready_over(device, scene, words, 2.2)
}

/// The pixels over |x|, |z| ≤ `half` metres.
fn ready_over(device: &HeadlessDevice, scene: &Scene, words: &str, half: f64) -> Ready {
    Ready::new(device, scene, technique::settings(Technique::OcclusionTextures, words), half)
}

/// The least milliseconds that passes took, by their names' ends; all of them without names.
fn ms(times: &[FrameTimes], names: &[&str]) -> f64 {
    let of = |name: &str| {
        names.is_empty() || names.iter().any(|n| name == format!("occlusion_textures.{n}"))
    };
    let least = |i: usize| times.iter().map(|t| t.passes[i].1).fold(f64::INFINITY, f64::min);
    let passes = times[0].passes.iter().enumerate();
    passes.filter(|(_, (name, _))| of(name)).map(|(i, _)| least(i)).sum()
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
            ready(device, &scene, &words)
        });
        let all = in_turns(&mut ready, options.rounds);
        for ((name, one), times) in names.iter().zip(&mut ready).zip(&all) {
            let truth = truth.get_or_insert_with(|| one.truth(&scene));
            let (build, pixels) = (ms(times, &BUILD), ms(times, &["visibility"]));
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
            kinds.map(|(words, half)| ready_over(device, &scene("bunny", side), words, half))
        })
        .collect();
    let all = in_turns(&mut ready, options.rounds);
    for (side, all) in sides.iter().zip(all.chunks(kinds.len())) {
        let mut row = vec![side.to_string()];
        row.extend(all.iter().map(|times| format!("{:.1}", ms(times, &[]))));
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
            .map(|words| ready(device, &scene, &words));
            let all = in_turns(&mut ready, options.rounds);
            let truth = truth.get_or_insert_with(|| ready[0].truth(&scene));
            let errors = [0, 1, 2].map(|i| ready[i].error(truth));
            let (published, ours) = (ms(&all[0], &[]), ms(&all[2], &[]));
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
                steps.map(|x| ready(device, &scene, &format!("{words} {more} {what}={x}")));
            let all = in_turns(&mut ready, options.rounds);
            let times: Vec<_> = all.iter().map(|times| ms(times, &[])).collect();
            let points: Vec<_> =
                steps.iter().zip(&times).map(|(x, ms)| (f64::ln(*x), ms.ln())).collect();
            let (_, exponent, r2) = line(&points);
            table.row(vec![
                what.into(),
                if words.is_empty() { "correlated" } else { "published" }.into(),
                times.iter().map(|ms| format!("{ms:.0}")).collect::<Vec<_>>().join(" "),
                format!("{exponent:.2}"),
                format!("{r2:.2}"),
            ]);
        }
    }
    table
}
