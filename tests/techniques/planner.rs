//! Only what the scene calls for: the passes of scenes made for it, and what leaving the rest out costs; and whether what
//! `auto` promises is kept where maps do not tell.

use crate::audit::moves_surfaces;
use antumbra::Omit;
use antumbra::RectangleLight;
use antumbra::auto::{Auto, Budget, Choice, Costs};
use antumbra::effects::Outcome;
use antumbra_harness::cases::cases;
use antumbra_harness::{Stage, View};
use antumbra_tests::measure::{Setup, percent, settings};
use antumbra_tests::{device, room};
use glam::DVec3;

/// The pixels of a ground's view a side.
const SIDE: u32 = 128;

/// What sums in another order may come to.
const ROUNDING: f64 = 2e-6;

#[test]
fn every_scene_runs_what_it_calls_for_and_what_is_left_out_costs_no_more_than_was_said() {
    let device = device();
    for case in cases() {
        let setup = Setup::ground(&case.scene, case.half, SIDE);
        let mut stage = setup.stage(&device, "technique=hard map=16");
        let light = setup.light();
        let image = |stage: &mut Stage, omit| {
            stage.configure_with(settings(case.words), |d| d.omit = omit).unwrap();
            let plan = stage.plan(light, None).unwrap();
            stage.run(&plan).unwrap();
            (plan, stage.visibility().unwrap())
        };
        let (_, full) = image(&mut stage, Omit::Nothing);
        // What a pixel would show that nobody writes must be another image.
        stage.configure(settings("technique=hard map=16")).unwrap();
        let other =
            RectangleLight::sun(DVec3::new(1.0, -0.7, 0.3), 0.01, DVec3::ZERO, 4.0).unwrap();
        let plan = stage.plan(other, None).unwrap();
        stage.run(&plan).unwrap();
        let (plan, pruned) = image(&mut stage, Omit::default());
        let runs: Vec<_> = plan.plan().runs().iter().map(|r| r.pass.name).collect();
        assert_eq!(runs, case.runs, "{}\n{}", case.name, plan.explain());
        let mut bound = 0.0;
        for effect in case.left_out {
            let verdict = plan.verdicts().of(*effect);
            assert_eq!(verdict.outcome, Outcome::LeftOut, "{}: {effect:?}", case.name);
            bound += verdict.bound;
        }
        // A bound is beyond what the maps' texels make of edges, in either image.
        if let Some(s) = plan.verdicts().situation()
            && runs.contains(&"hard.visibility")
        {
            bound += s.texel_pixels * s.edges_a_pixel;
        }
        let error = percent(&full, &pruned) / 100.0;
        println!("{}: {error:.5}, bound {bound:.5}", case.name);
        assert!(error <= bound + ROUNDING, "{}: {error} of {bound}", case.name);
    }
}

/// What `auto` chooses for a stage's frame under its scene's light, for at most this error.
fn chosen(stage: &mut Stage, setup: &Setup, max_error: f64) -> Choice {
    let budget = Budget { max_error: Some(max_error), max_ms: None };
    let mut auto = Auto::new(budget, Costs::default());
    stage.choose(&mut auto, setup.scene.light(None).unwrap()).unwrap()
}

/// A furnished room, where everything blocks and receives and maps are off by any amount: the error is promised, and the
/// image keeps it; where the node has no room for the triangles the choice says so, and runs.
#[test]
fn a_room_is_within_the_error_that_auto_promises() {
    let device = device();
    let (scene, extent) = (room::room(), [157, 118]);
    let view = View::of(&room::camera(), extent);
    let setup = Setup { scene: &scene, view, extent, window: None, occluders_seen: true };
    let mut stage = setup.stage(&device, "technique=hard map=256");
    let (truth, _) = setup.traced(&stage, 1024);
    let hard = percent(&truth, &setup.visibility(&mut stage)) / 100.0;
    // Pixels of a raster that moves vertices by a 32nd of them have other surfaces than the promise is made for.
    let is_moved = moves_surfaces(&device);
    for max_error in [0.03, 0.015, 0.01] {
        let choice = chosen(&mut stage, &setup, max_error);
        assert!(choice.problem.is_none() && choice.left_out.is_none(), "{choice}");
        stage.configure(choice.technique).unwrap();
        let error = percent(&truth, &setup.visibility(&mut stage)) / 100.0;
        println!("{choice}: {error:.4} found");
        let promised = choice.error.unwrap();
        assert!(promised <= max_error, "{choice}");
        assert!(error <= promised || is_moved, "{choice}: {error}");
        assert!(hard > max_error, "a wrong image is noticed: {hard}");
    }
    let few = settings("technique=hard map=256");
    stage.configure_with(few, |d| d.capacity.triangles = 100).unwrap();
    let choice = chosen(&mut stage, &setup, 0.03);
    let left_out = choice.left_out.as_ref().unwrap();
    assert!(left_out.contains("the description's capacity is 100 in"), "{choice}");
    stage.configure_with(choice.technique, |d| d.capacity.triangles = 100).unwrap();
    setup.visibility(&mut stage);
}
