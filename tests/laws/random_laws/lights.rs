//! Laws of lights: halves, and none to speak of.

use super::compare::{beyond_edges, difference, differences, mean_of};
use super::{Case, OBJECTS, judge, judge_through, promises};
use antumbra::Omit;
use antumbra_tests::random::{case, case_under, lamp_of};
use antumbra_tests::rig::Rig;

/// Lights of 3 cm to 1.5 m, cut across their longer side.
#[test]
fn the_halves_of_a_light_average_to_the_whole() {
    let strategy = case_under(lamp_of((-1.5, 0.18), (0.0, 1.0), 0.1), OBJECTS);
    let shots = |rig: &Rig, index: usize, case: &Case| {
        let whole = rig.shot(index, case);
        let [one, other] = case.lamp.halves().map(|lamp| whole.under_lamp(lamp));
        vec![whole, one, other]
    };
    let law = ("halves of a light", 7, 80);
    let tally = judge(
        law,
        Omit::Nothing,
        &strategy,
        |c| c,
        shots,
        |settings, images, tally| {
            let [whole, one, other] = images else { unreachable!() };
            let mean = mean_of(one, other);
            let [absolute, signed, touched] = differences(&mean, whole);
            if touched > 0.0 {
                tally.add(settings, "difference", absolute / touched, promises::halves(settings));
                tally.add(settings, "signed difference", signed / touched, promises::BRIGHTER);
                // One half instead of both.
                if settings.room().shows().penumbra {
                    tally.add(settings, "difference of one half", difference(one, whole), 1.0);
                }
            }
            Ok(())
        },
    );
    let (both, one) = (tally.mean("difference"), tally.mean("difference of one half"));
    assert!(
        one > 1.25 * both,
        "one half alone is off by {one}, both by {both}: the law tells nothing"
    );
}

const DIFFER: &str = "pixels beyond edges that differ";

#[test]
fn a_light_that_shrinks_casts_a_hard_shadow() {
    let strategy = case(OBJECTS);
    let shots = |rig: &Rig, index: usize, case: &Case| {
        let small = rig.shot(index, case).under_lamp(case.lamp.as_small_as(1e-4));
        let aside = case.lamp.light().world_from_light().x_axis.truncate();
        let wrong = small.under_lamp(small.lamp.moved(aside));
        // The first settings are those of hard shadows; maps are of the technique's own size.
        vec![small.with_settings(0), small, wrong]
    };
    let law = ("a light of 0.1 mm", 8, 70);
    // The texels of both must be alike, and some techniques have one view.
    let tally = judge_through(
        [1, 1],
        law,
        Omit::Nothing,
        &strategy,
        |c| c,
        shots,
        |settings, images, tally| {
            let share = beyond_edges(&images[0], &images[1]);
            tally.add(settings, DIFFER, share, promises::shrunk(settings));
            // A light a metre aside.
            let wrong = beyond_edges(&images[0], &images[2]);
            tally.add(settings, "the same of a light aside", wrong, 1.0);
            Ok(())
        },
    );
    let (right, wrong) = (tally.mean(DIFFER), tally.mean("the same of a light aside"));
    assert!(
        wrong > 4.0 * right,
        "{right} differ, and {wrong} under another light: the law tells nothing"
    );
}
