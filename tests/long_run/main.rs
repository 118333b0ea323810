//! Ten thousand frames in one process: lights, scenes, sizes, settings and techniques change, frames overlap, and
//! nothing grows.
//!
//! A program of its own: it measures the memory of its process.
//!
//! `ANTUMBRA_CASES=10` runs ten times as many frames.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

mod engine;

use antumbra_harness::HeadlessDevice;
use antumbra_tests::device::{device, unwatched};
use antumbra_tests::random::times;
use antumbra_tests::{say, validating};
use engine::Engine;

/// Frames without the validation layer, and then so many under it: it takes two to four times as long, and remembers
/// so much of what it saw that the process grows by megabytes every thousand frames.
const FRAMES: u64 = 10_000;
const WATCHED: u64 = 3_000;

/// The engine comes back to the same settings and size this often, and what it holds is compared.
const LAP: u64 = 1_000;

/// How much a process may grow over the laps after the first, each taken as the median lap. Resident memory goes up and
/// down by up to 10 MiB between laps on lavapipe, and in some runs it rises by 8 MiB at one lap and stays there, while
/// objects and allocations stay the same: neither a single lap nor the first and the last tell a leak. Measured: less
/// than 2 MiB. A leak of 1 KiB a frame is 8.
const BREATH: u64 = 6 << 20;

/// A piece of memory counts as it lies: with what its alignment leaves before it.
const PADDING: u64 = 256;

/// What is held when the engine is back where it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Held {
    /// The node's Vulkan objects.
    objects: usize,
    /// Pieces of device memory that are given out.
    blocks: usize,
    /// Bytes of device memory that the allocator holds.
    reserved: u64,
}

/// The same with what may differ a little.
#[derive(Clone, Copy, Debug)]
struct Lap {
    held: Held,
    given_out: u64,
    resident: u64,
}

/// The process's resident bytes.
fn resident() -> u64 {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap();
    let pages = pages.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap();
    pages * 4096
}

/// What is held at the end of each lap.
fn run(device: &HeadlessDevice, frames: u64) -> Vec<Lap> {
    let mut engine = Engine::new(device, 1);
    let mut laps = Vec::new();
    for frame in 0..frames {
        engine.frame();
        if frame % LAP == LAP / 2 {
            engine.compare_with_a_fresh_node();
        }
        if frame % LAP == LAP - 1 {
            engine.home();
            let (objects, blocks, given_out, reserved) = engine.held();
            let held = Held { objects, blocks, reserved };
            let lap = Lap { held, given_out, resident: resident() };
            println!("frame {}: {lap:?}", frame + 1);
            laps.push(lap);
        }
    }
    engine.compare_with_a_fresh_node();
    println!("{}", engine.report());
    engine.finish();
    laps
}

/// The first lap loads what drivers and allocators keep.
fn check(laps: &[Lap]) {
    let [_, first, .., last] = laps else { return assert!(times() < 1.0, "{laps:?}") };
    assert!(laps[1..].iter().all(|lap| lap.held == first.held), "{laps:?}");
    let most = first.given_out + first.held.blocks as u64 * PADDING;
    assert!(last.given_out <= most, "{} bytes given out, then {}", first.given_out, last.given_out);
}

/// The median growth from one value to the next, which single steps do not move.
fn typical_growth(values: &[f64]) -> f64 {
    let mut growths: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    growths.sort_by(f64::total_cmp);
    growths[growths.len() / 2]
}

/// A steady leak of 1 KiB a frame is told from a step of 8 MiB.
#[test]
fn a_leak_is_told_from_a_step() {
    let at =
        |lap: usize, leak: f64, step: f64| 1.7e8 + leak * lap as f64 + step * f64::from(lap > 3);
    let grown = |leak, step| {
        let values: Vec<f64> = (0..9).map(|lap| at(lap, leak, step)).collect();
        8.0 * typical_growth(&values)
    };
    let step = 8.0 * f64::from(1 << 20);
    assert!(grown(0.0, step) <= BREATH as f64 && grown(1024.0 * LAP as f64, 0.0) > BREATH as f64);
}

#[test]
fn ten_thousand_frames_leave_nothing_behind() {
    let frames = |of: u64| (of as f64 * times()) as u64;
    let device = unwatched();
    let laps = run(&device, frames(FRAMES));
    check(&laps);
    if laps.len() >= 7 {
        let resident: Vec<f64> = laps[1..].iter().map(|lap| lap.resident as f64).collect();
        let grown = typical_growth(&resident) * (resident.len() - 1) as f64;
        assert!(grown <= BREATH as f64, "resident memory grew by {grown} bytes: {resident:?}");
    }
    device.finish();
    // Whatever the layer says fails the test.
    let device = device_under_the_layer();
    check(&run(&device, frames(WATCHED)));
    device.finish();
}

fn device_under_the_layer() -> antumbra_tests::TestDevice {
    if !validating() {
        say("long_run: without the validation layer, which ANTUMBRA_VALIDATE=1 asks for");
    }
    device()
}
