//! What is kept from frame to frame: maps while light and meshes stay, pixels while nothing changes.

use antumbra::scene::generate;
use antumbra::{Frame, FramePlan, RectangleLight, Technique};
use antumbra_harness::Stage;
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, metre_line};
use glam::{DMat4, DVec3};

/// A frame whose pixels lie `aside` from where the G-buffer has them, as if the camera had moved.
fn plan(
    stage: &mut Stage,
    light: &RectangleLight,
    aside: f64,
    change: impl FnOnce(&mut Frame),
) -> FramePlan {
    let moved = DMat4::from_translation(DVec3::X * aside);
    let plan = stage.plan_with(light, |frame| {
        frame.world_from_ndc = moved * frame.world_from_ndc;
        change(frame);
    });
    plan.unwrap()
}

fn run(stage: &mut Stage, plan: &FramePlan) -> Vec<f32> {
    stage.run(plan).unwrap();
    stage.visibility().unwrap()
}

/// Every technique, and those settings that have rows of their own.
fn all() -> Vec<String> {
    let plain = Technique::NAMES.iter().map(|name| format!("technique={name}"));
    let more = [
        "technique=soft-shadow-map receivers=map",
        "technique=soft-shadow-map receivers=map accumulate=blend",
        "technique=ray-march levels=mip",
        "technique=occlusion-textures prefilter=n-buffer combine=product",
        "technique=linear-light samples=3 error=0",
    ];
    plain.chain(more.into_iter().map(Into::into)).collect()
}

#[test]
fn what_is_kept_gives_the_same_pixels() {
    let device = device();
    for words in all() {
        let scene = match words.contains("linear-light") {
            true => generate::stacked_cards(metre_line()),
            false => generate::stacked_cards(generate::square_light(0.4).unwrap()),
        };
        let setup = Setup::ground(&scene, 2.2, 64);
        let light = setup.light();
        let few = if words.contains("many-lights") { " samples=4" } else { "" };
        let map = if words.contains("traced") { "" } else { " map=64" };
        let words = words + few + map;
        let mut stage = setup.stage(&device, &words);
        let numbers = |scene, view| {
            move |f: &mut Frame| (f.revision, f.view_revision) = (Some(scene), Some(view))
        };
        let first = plan(&mut stage, &light, 0.0, numbers(1, 1));
        let made = run(&mut stage, &first);

        let moved = plan(&mut stage, &light, 0.25, numbers(1, 2));
        let kept = run(&mut stage, &moved);
        let mut other = setup.stage(&device, &words);
        let fresh = plan(&mut other, &light, 0.25, |_| {});
        assert_eq!(run(&mut other, &fresh), kept, "{words}: kept maps gave other pixels");
        assert_ne!(kept, made, "{words}: the camera has not moved");
        println!(
            "{words}: {} rows, {} where maps are kept",
            fresh.plan().steps.len(),
            moved.plan().steps.len()
        );
        assert!(
            words.contains("many-lights") || moved.plan().steps.len() < fresh.plan().steps.len()
        );

        // Nothing changes: nothing runs, and the image stays.
        let idle = plan(&mut stage, &light, 0.25, numbers(1, 2));
        assert!(idle.plan().steps.is_empty(), "{words}");
        assert!(idle.plan().reasons().all(|(_, why)| !why.to_string().is_empty()));
        for _ in 0..2 {
            assert_eq!(run(&mut stage, &idle), kept, "{words}: an idle frame changed the image");
        }
        // Another number of light and meshes: everything is made anew, but for the shape of a hierarchy over the same
        // triangles.
        let next = plan(&mut stage, &light, 0.0, numbers(2, 1));
        let (steps, all) = (next.plan().steps.len(), fresh.plan().steps.len());
        let fitted = words.contains("traced") && (moved.plan().steps.len()..all).contains(&steps);
        assert!(steps == all || fitted, "{words}: {steps} of {all}");
        assert_eq!(run(&mut stage, &next), made, "{words}");
        let sentence = stage.run(&idle).unwrap_err().to_string();
        assert!(sentence.contains("plan the frame again"), "{sentence}");
    }
}
