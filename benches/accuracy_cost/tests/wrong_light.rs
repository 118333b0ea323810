//! A report that cannot tell right from wrong is worth nothing.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra_bench::groups::{Group, Stage};
use antumbra_bench::measure::Bench;
use antumbra_bench::options::{QUICK, Scale};
use antumbra_bench::scenes::{SceneSpec, Source};
use antumbra_bench::store::{Outcome, Row};
use antumbra_bench::sweeps;
use antumbra_harness::{HeadlessDevice, HeadlessOptions};
use std::path::PathBuf;

const SMALL: Scale = Scale { grid: 64, rounds: 1, ..QUICK };

fn measure(group: &Group) -> Vec<Row> {
    let device = HeadlessDevice::new(&HeadlessOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let cache = std::env::temp_dir().join(format!("antumbra-bench-test-{}", std::process::id()));
    std::fs::create_dir_all(&cache).unwrap();
    Bench { device: &device, scale: SMALL, cache: &cache }.measure(group, &|_| {})
}

/// A light 10 % too big widens the card's penumbra by 10 %: its rim is off by up to 5 % of the light,
/// where the right one is off by half a texel at most.
#[test]
fn a_light_10_percent_too_big_is_seen() {
    let rows = measure(&sweeps::wrong(&SMALL));
    let [right, wrong] = [0, 1].map(|i| rows[i].mean().unwrap());
    println!("right {right:.4}, wrong {wrong:.4}");
    assert!(right < 0.005, "{right}");
    assert!(wrong > 3.0 * right, "{wrong} beside {right}");
}

/// What cannot be read is one row with its reason, and no panic.
#[test]
fn a_scene_that_fails_is_a_row_that_says_why() {
    let source = Source::File(PathBuf::from("no/such/scene.glb"));
    let spec = SceneSpec { name: "scene.glb".into(), source };
    let group = Group { stage: Stage::Seen(spec, "its own".into()), ..sweeps::wrong(&SMALL) };
    let rows = measure(&group);
    assert_eq!(rows.len(), 1);
    let Outcome::Failed(why) = &rows[0].outcome else { panic!("{:?}", rows[0].outcome) };
    assert!(why.contains("no/such/scene.glb"), "{why}");
}
