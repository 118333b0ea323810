//! What occlusion textures cost, and what their parts are worth.
//!
//! Times are the least of the rounds: on a machine with other work to do that is nearest to what the work itself
//! takes.

use crate::ready::{Ready, in_turns, scene};
use crate::table::Table;
use crate::{Bench, Scale};
use antumbra::scene::Scene;
use antumbra_bench::stats::line;
use antumbra_harness::{FrameTimes, HeadlessDevice};

pub const BENCH: Bench = Bench {
    name: "occlusion_textures",
    about: "Occlusion textures: prefilters, lights, the published product, slices and maps",
    studies: &[
        ("prefilters", prefilters),
        ("light", light_sizes),
        ("combination", combination),
        ("exponents", exponents),
    ],
    full: Scale { rounds: 11, sides: &[256, 512, 1024], quick: false },
    quick: Scale { rounds: 5, sides: &[256, 512], quick: true },
};

const PUBLISHED: &str = "combine=product placement=uniform";

fn ready(device: &HeadlessDevice, scene: &Scene, words: &str) -> Ready {
    Ready::new(device, scene, &format!("occlusion-textures {words}"))
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

/// Fig. 2: what it takes to filter one texture of four slices, and the error that is left.
fn prefilters(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("N|prefilter|build ms|pixels ms|sum ms|error %");
    let scene = scene("suzanne", 1.0);
    let mut truth = None;
    for &n in scale.sides {
        let names = ["mip", "sat", "n-buffer"];
        let mut ready = names.map(|prefilter| {
            ready(device, &scene, &format!("{PUBLISHED} slices=4 map={n} prefilter={prefilter}"))
        });
        let all = in_turns(&mut ready, scale.rounds);
        for ((name, one), times) in names.iter().zip(&mut ready).zip(&all) {
            let truth = truth.get_or_insert_with(|| one.truth(&scene));
            let (build, pixels) = (ms(times, &BUILD), ms(times, &["visibility"]));
            let (sum, error) = (build + pixels, one.error(truth));
            table.row(format!("{n}|{name}|{build:.1}|{pixels:.1}|{sum:.1}|{error:.2}"));
        }
    }
}

/// Cost against the light's size, in sizes of the object: of pixels that are all behind it, and of a view that
/// a larger light shadows more of, as pixels whose kernels meet nothing cost next to nothing.
fn light_sizes(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("L|published|correlated|n-buffer|whole view|correlated");
    let sides = [0.05, 0.1, 0.2, 0.4, 0.7, 1.0, 1.4, 2.0];
    let n_buffer = format!("{PUBLISHED} prefilter=n-buffer");
    let kinds =
        [(PUBLISHED, 0.3), ("", 0.3), (n_buffer.as_str(), 0.3), (PUBLISHED, 2.2), ("", 2.2)];
    // All in turns, so that what else the machine does is the same for all.
    let of = |&side: &f64| {
        kinds.map(|(words, half)| {
            let words = format!("occlusion-textures {words}");
            Ready::over(device, &scene("bunny", side), &words, half, 480)
        })
    };
    let mut ready: Vec<_> = sides.iter().flat_map(of).collect();
    let all = in_turns(&mut ready, scale.rounds);
    for (side, all) in sides.iter().zip(all.chunks(kinds.len())) {
        let cells: String = all.iter().map(|times| format!("|{:.1}", ms(times, &[]))).collect();
        table.row(format!("{side}{cells}"));
    }
}

/// The published product against what slices have in common: error and time.
fn combination(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|slices|error %|filled|ours|of it|ms|ours ms|ratio");
    let bunnies = [("bunny", 0.4), ("bunny", 1.0)];
    let others = [("tall box", 1.0), ("suzanne", 1.0), ("foliage", 0.4), ("stacked cards", 1.0)];
    for (name, side) in bunnies.into_iter().chain(others) {
        let scene = scene(name, side);
        let mut truth = None;
        for slices in [4, 8, 16] {
            let mut ready = [PUBLISHED, &format!("{PUBLISHED} fill=on"), ""]
                .map(|words| ready(device, &scene, &format!("{words} slices={slices}")));
            let all = in_turns(&mut ready, scale.rounds);
            let truth = truth.get_or_insert_with(|| ready[0].truth(&scene));
            let [error, filled, ours] = ready.each_mut().map(|r| r.error(truth));
            let (ms, our_ms) = (ms(&all[0], &[]), ms(&all[2], &[]));
            let errors = format!("{error:.2}|{filled:.2}|{ours:.2}|{:.2}", ours / error);
            let times = format!("{ms:.1}|{our_ms:.1}|{:.2}", our_ms / ms);
            table.row(format!("{name} {side}|{slices}|{errors}|{times}"));
        }
    }
}

/// Cost against slices and against the map's side, as exponents.
fn exponents(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("against|words|ms|exponent|R2");
    let scene = scene("bunny", 0.4);
    let slices = [4.0, 8.0, 16.0, 32.0];
    let maps = [128.0, 256.0, 512.0, 1024.0];
    for (what, more, steps) in [("slices", "map=256", slices), ("map", "slices=16", maps)] {
        for (kind, words) in [("published", PUBLISHED), ("correlated", "")] {
            let mut ready =
                steps.map(|x| ready(device, &scene, &format!("{words} {more} {what}={x}")));
            let all = in_turns(&mut ready, scale.rounds);
            let times: Vec<_> = all.iter().map(|times| ms(times, &[])).collect();
            let points: Vec<_> =
                steps.iter().zip(&times).map(|(x, ms)| (f64::ln(*x), ms.ln())).collect();
            let fit = line(&points).unwrap();
            let times = times.iter().map(|ms| format!("{ms:.0}")).collect::<Vec<_>>().join(" ");
            table.row(format!("{what}|{kind}|{times}|{:.2}|{:.2}", fit.slope, fit.r2));
        }
    }
}
