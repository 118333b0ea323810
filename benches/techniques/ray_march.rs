//! What ray marching costs, and what its parts save.

use crate::ready::{Ready, frame_ms, in_turns, median_of, scene};
use crate::table::Table;
use crate::{Bench, Scale, forward};
use antumbra::scene::Scene;
use antumbra::stages::nbuffer::{Kind, Levels};
use antumbra_bench::stats::median;
use antumbra_harness::levels::{self, BUILD, bytes, tightness};
use antumbra_harness::{FrameTimes, HeadlessDevice};
use std::time::Instant;

pub const BENCH: Bench = Bench {
    name: "ray_march",
    about: "Ray marching: kinds of levels, the search, classification, rays at fragments",
    studies: &[
        ("levels", kinds),
        ("search", search),
        ("classification", classification),
        ("forward", forward::forward),
        ("bandwidth", bandwidth),
    ],
    full: Scale { rounds: 7, sides: &[256, 512, 1024], quick: false },
    quick: Scale { rounds: 3, sides: &[256, 512], quick: true },
};

fn ready(device: &HeadlessDevice, scene: &Scene, words: &str) -> Ready {
    Ready::new(device, scene, &format!("ray-march {words}"))
}

/// Milliseconds of the technique's passes of these names.
pub fn ms(times: &FrameTimes, names: &[&str]) -> f64 {
    levels::ms(times.passes.iter().copied(), names)
}

/// The kinds of windows: memory, how long they take to make, what the search makes of them, and how many texels they
/// hold for each of the window that a search wants. N-buffers have shaders of their own, without the branches of the
/// others.
fn kinds(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|N|levels|MB|build ms|classify|trace|sum|held");
    for name in ["bunny", "foliage"] {
        let scene = scene(name, 0.4);
        for &n in scale.sides {
            let mut ready: Vec<_> = Kind::ALL
                .iter()
                .map(|kind| ready(device, &scene, &format!("map={n} levels={}", kind.name())))
                .collect();
            let all = in_turns(&mut ready, scale.rounds);
            for (kind, times) in Kind::ALL.iter().zip(&all) {
                let parts = [&BUILD[..], &["classify"], &["trace"]];
                let [build, classify, trace] = parts.map(|p| median_of(times, |t| ms(t, p)));
                let mb = bytes(Levels { map: n, kind: *kind }) as f64 / 1e6;
                let (sum, held) = (build + classify + trace, tightness(*kind));
                let parts = format!("{build:.1}|{classify:.1}|{trace:.1}|{sum:.1}");
                table.row(format!("{name}|{n}|{}|{mb:.1}|{parts}|{held:.2}", kind.name()));
            }
        }
    }
}

/// Hierarchical against linear search: the same rays, so the same error but for what each misses.
fn search(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|N|rays|hier. ms|linear ms|ratio|error %|error %");
    for (name, side) in [("bunny", 0.4), ("suzanne", 1.0), ("slats", 0.4), ("foliage", 0.4)] {
        let scene = scene(name, side);
        let mut truth = None;
        for &n in &scale.sides[..2] {
            for rays in [4, 16] {
                let mut ready = ["hierarchical", "linear"].map(|search| {
                    ready(device, &scene, &format!("map={n} rays={rays} search={search}"))
                });
                let truth = truth.get_or_insert_with(|| ready[0].truth(&scene));
                let all = in_turns(&mut ready, scale.rounds);
                let [a, b] = [0, 1].map(|i| median_of(&all[i], |t| ms(t, &["trace"])));
                let [of_a, of_b] = ready.each_mut().map(|r| r.error(truth));
                let ratio = a / b;
                table
                    .row(format!("{name}|{n}|{rays}|{a:.1}|{b:.1}|{ratio:.2}|{of_a:.2}|{of_b:.2}"));
            }
        }
    }
}

/// With and without classification and early outs.
fn classification(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|L|rays|on ms|off ms|ratio|differ by");
    for (name, side) in [("bunny", 0.1), ("bunny", 0.4), ("bunny", 1.0), ("foliage", 0.4)] {
        let scene = scene(name, side);
        for rays in [4, 16, 64] {
            let mut ready = ["on", "off"]
                .map(|c| ready(device, &scene, &format!("rays={rays} classify={c} filter=off")));
            let all = in_turns(&mut ready, scale.rounds);
            let [on, off] = [0, 1].map(|i| median_of(&all[i], frame_ms));
            let [a, b] = ready.each_mut().map(Ready::visibility);
            let worst = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            let ratio = on / off;
            table.row(format!("{name}|{side}|{rays}|{on:.1}|{off:.1}|{ratio:.2}|{worst:.1e}"));
        }
    }
}

/// Making the levels beside copying as many bytes, by the processor's two cores as the driver has them.
fn bandwidth(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("N|MB|build ms|copy ms|ratio");
    let scene = scene("bunny", 0.4);
    for &n in scale.sides {
        let mut ready = ready(device, &scene, &format!("map={n}"));
        let bytes = bytes(Levels { map: n, kind: Kind::NBuffer }) as usize;
        let source = vec![1u8; bytes];
        let mut target = vec![0u8; bytes];
        let (mut builds, mut copies) = (Vec::new(), Vec::new());
        for _ in 0..scale.rounds {
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
        let (mb, build, copy) = (bytes as f64 / 1e6, median(&builds), median(&copies));
        table.row(format!("{n}|{mb:.1}|{build:.1}|{copy:.2}|{:.1}", build / copy));
    }
}
