//! Linear lights: skins against the exact visible fraction of a line.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra::scene::generate;
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent};

#[test]
fn a_card_under_a_line() {
    let device = device();
    for length in [0.4, 1.0] {
        let scene = generate::card(generate::line_light(length, 0.0).unwrap());
        let setup = Setup::ground(&scene, 2.2, 160);
        let mut truth = None;
        for samples in [2, 3, 5, 9] {
            for transition in ["linear", "rational"] {
                let words =
                    format!("technique=linear-light samples={samples} transition={transition}");
                let mut stage = setup.stage(&device, &words);
                let image = setup.visibility(&mut stage);
                let (truth, _) = truth.get_or_insert_with(|| setup.traced(&stage, 16));
                println!("{length} m, {words}: {:.2} %", percent(truth, &image));
            }
        }
    }
}
