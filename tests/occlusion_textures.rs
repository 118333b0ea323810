//! Occlusion textures.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra::scene::{Role, Scene, generate};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, model, percent, summary};

fn light(side: f64) -> antumbra::RectangleLight {
    generate::square_light(side).unwrap()
}

fn seen(scene: &Scene) -> Setup<'_> {
    use antumbra::gpu::headless::View;
    let extent = [320, 240];
    let view = View::perspective(&scene.camera.unwrap(), extent);
    Setup { scene, view, extent, window: None, occluders_seen: true }
}

fn scenes() -> Vec<(&'static str, Scene, bool)> {
    let normalized = |name, side| generate::normalized(&model(name), light(side)).unwrap();
    vec![
        ("card", generate::card(light(0.4)), false),
        ("stacked", generate::stacked_cards(light(1.0)), false),
        ("slats", generate::slats(light(0.4), 24), false),
        ("tall box, 1 m", generate::tall_box(light(1.0)), false),
        ("spheres", generate::spheres(light(1.0)), false),
        ("bunny", normalized("bunny", 0.4), false),
        ("bunny, 1 m", normalized("bunny", 1.0), false),
        ("suzanne, 1 m", normalized("suzanne", 1.0), false),
        ("foliage", generate::foliage(light(0.4), 300, 7), false),
        ("foliage, 1 m", generate::foliage(light(1.0), 300, 7), false),
        ("bunny, both", model("bunny"), true),
        ("suzanne, both", model("suzanne").with_occluders_as(Role::Both), true),
    ]
}

#[test]
#[ignore]
fn explore() {
    let device = device();
    let all = std::env::var("OT_WORDS").unwrap();
    let only = std::env::var("OT_SCENES").unwrap_or_default();
    for (name, scene, both) in scenes().iter() {
        if !only.is_empty() && !only.split(';').any(|o| o == *name) {
            continue;
        }
        let setup = if *both {
            seen(scene)
        } else {
            Setup::ground(scene, if name.contains("1 m") { 3.5 } else { 2.2 }, 160)
        };
        let mut truth = None;
        let mut line = format!("{name:14}");
        for words in all.split(';') {
            let mut stage = setup.stage(&device, &format!("technique=occlusion-textures {words}"));
            let image = setup.visibility(&mut stage);
            let (truth, _) = truth.get_or_insert_with(|| setup.traced(&stage, std::env::var("OT_RAYS").map_or(256, |r| r.parse().unwrap())));
            let s = summary(truth, &image);
            line += &format!(" | {:5.2} {:+5.1} {:.2}", percent(truth, &image), 100.0 * s.bias, 100.0*s.lit_error);
        }
        println!("{line} | noise {:.2}", 100.0 * truth.unwrap().1);
    }
}

#[test]
#[ignore]
fn timing() {
    let device = device();
    let all = std::env::var("OT_WORDS").unwrap();
    let scene = generate::normalized(&model("bunny"), light(1.0)).unwrap();
    let setup = Setup::ground(&scene, 2.2, 480);
    let mut stages: Vec<_> = all.split(';').map(|words| {
        let mut stage = setup.stage(&device, &format!("technique=occlusion-textures {words}"));
        let plan = stage.plan(&setup.light(), None).unwrap();
        (words, stage, plan, std::collections::BTreeMap::<String, f64>::new(), f64::MAX)
    }).collect();
    for _ in 0..15 {
        for (_, stage, plan, best, frame) in &mut stages {
            let t = stage.run(plan).unwrap();
            *frame = frame.min(t.frame.as_secs_f64() * 1e3);
            for (n, ms) in &t.passes {
                let b = best.entry(n.replace("occlusion_textures.", "")).or_insert(f64::MAX);
                *b = b.min(*ms);
            }
        }
    }
    for (words, _, _, best, frame) in &stages {
        println!("{words}: {frame:.1} ms: {}", best.iter().map(|(n, ms)| format!("{n} {ms:.1}")).collect::<Vec<_>>().join(", "));
    }
}
