//! Only what the scene calls for: the passes of scenes made for it, and what leaving the rest out costs.

use antumbra::Omit;
use antumbra::RectangleLight;
use antumbra::effects::Outcome;
use antumbra_harness::Stage;
use antumbra_harness::cases::cases;
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent, settings};
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
