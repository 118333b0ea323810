//! Ray marching at fragments as they are drawn, beside the node's at the G-buffer's pixels.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra::gpu::headless::{Forward, HeadlessDevice, View};
use antumbra::scene::{Instance, Role, Scene, generate};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, model};

fn seen(scene: &Scene) -> Setup<'_> {
    let extent = [320, 240];
    let view = View::perspective(&scene.camera.unwrap(), extent);
    Setup { scene, view, extent, window: None, occluders_seen: true }
}

/// The images of both.
fn images(device: &HeadlessDevice, setup: &Setup, words: &str) -> [Vec<f32>; 2] {
    let mut stage = setup.stage(device, words);
    let plan = stage.plan(&setup.light(), setup.window).unwrap();
    let keep = |i: &Instance| setup.occluders_seen || i.role != Role::Occluder;
    let forward = Forward::new(device, &mut stage, &plan, setup.scene, keep).unwrap();
    forward.run(&mut stage, &plan).unwrap();
    [stage.visibility().unwrap(), forward.visibility().unwrap()]
}

#[test]
fn forward_and_deferred_images_agree() {
    let device = device();
    let spheres = generate::spheres(generate::square_light(0.4).unwrap());
    let (bunny, suzanne) = (model("bunny"), model("suzanne"));
    let setups = [
        ("spheres", Setup::ground(&spheres, 2.2, 160)),
        ("bunny", seen(&bunny)),
        ("suzanne", seen(&suzanne)),
    ];
    for (name, setup) in &setups {
        for more in ["", "classify=off", "layers=2 sampling=jittered hash=md5"] {
            let words = format!("technique=ray-march map=128 filter=off {more}");
            let [a, b] = images(&device, setup, &words);
            let differ: Vec<f32> =
                a.iter().zip(&b).map(|(a, b)| (a - b).abs()).filter(|d| *d > 1e-3).collect();
            let worst = differ.iter().copied().fold(0.0, f32::max);
            let sum: f32 = differ.iter().sum();
            let shadowed = a.iter().zip(&b).filter(|(a, b)| **a < 1.0 || **b < 1.0).count();
            println!(
                "{name} {more}: {} of {shadowed} differ, worst {worst}, mean {:.1e}",
                differ.len(),
                sum / shadowed as f32
            );
        }
    }
}
