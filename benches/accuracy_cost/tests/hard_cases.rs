//! The table of hard cases on a device, and that it sees what is wrong.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra_bench::hard_cases::cases::{self, HardCase};
use antumbra_bench::hard_cases::judge::{Row, Verdict};
use antumbra_bench::hard_cases::set::{Block, Set};
use antumbra_bench::hard_cases::{run, table, techniques};
use antumbra_harness::{HeadlessDevice, HeadlessOptions};
use glam::{DMat4, DVec3};

/// Runs cases under the validation layer where the environment asks for it.
fn rows(cases: &[HardCase]) -> Vec<Row> {
    let validation = std::env::var("ANTUMBRA_VALIDATE").is_ok_and(|value| value == "1");
    let device = HeadlessDevice::new(&HeadlessOptions { validation, ..Default::default() })
        .unwrap_or_else(|e| panic!("{e}"));
    let log = device.message_log();
    let rows = run::run(&device, cases).unwrap_or_else(|e| panic!("{e}"));
    drop(device);
    assert!(log.messages().is_empty(), "{:?}", log.messages());
    rows
}

#[test]
fn every_row_is_held_or_a_known_fault_that_shows() {
    let rows = rows(&cases::all());
    println!("{}", table::counts(&rows));
    let wrong: Vec<_> = rows.iter().filter(|row| !row.is_good()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!(rows.len(), cases::all().len() * techniques::ALL.len());
}

/// What is exact behind a card tells the right card from one a fifth to the side, one a tenth larger, and none.
#[test]
fn wrong_occluders_are_beyond_the_bounds() {
    let right = cases::all().remove(0);
    let blocks = &right.set.blocks;
    let moved = |by: DMat4| blocks.iter().map(|b| Block { at: b.at * by, ..b.clone() }).collect();
    let wrong: [(&str, Vec<Block>); 4] = [
        ("right", blocks.clone()),
        ("aside", moved(DMat4::from_translation(DVec3::X * 0.2))),
        ("larger", moved(DMat4::from_scale(DVec3::splat(1.1)))),
        ("none", Vec::new()),
    ];
    let cases = wrong.map(|(name, blocks)| HardCase {
        name: name.into(),
        set: Set { blocks, ..right.set.clone() },
        // What is expected is what the right ones hide.
        seen: Some(right.set.blocks.clone()),
        ..right.clone()
    });
    let rows = rows(&cases);
    for technique in ["soft-shadow-map", "back-projection"] {
        let verdicts: Vec<_> =
            rows.iter().filter(|row| row.technique == technique).map(|row| &row.verdict).collect();
        let broken = &Verdict::Broken;
        assert_eq!(verdicts, [&Verdict::Held, broken, broken, broken], "{technique}");
    }
}
