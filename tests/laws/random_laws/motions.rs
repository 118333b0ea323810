//! Laws of a world that is elsewhere, larger, or mirrored.

use super::compare::{alike, changed, difference, differences, rounding};
use super::promises::{self, FEW_TEXELS, FEW_TEXELS_MIRRORED, Likeness};
use super::{Case, OBJECTS, Object, judge, shadows, well_conditioned};
use antumbra::Omit;
use antumbra_harness::View;
use antumbra_tests::random::{Lamp, case, magnitude, turn, vector};
use antumbra_tests::rig::Rig;
use glam::{DMat4, DVec3};
use proptest::prelude::*;

/// A scene, and where else it may be.
#[derive(Clone, Debug)]
struct Elsewhere {
    case: Case,
    doubled: i32,
    scaled: f64,
    moved: DMat4,
}

#[test]
fn a_world_scaled_and_moved_looks_the_same() {
    let moved = (turn(), vector(1e6)).prop_map(|(q, t)| DMat4::from_rotation_translation(q, t));
    let strategy =
        (case(OBJECTS).prop_map(well_conditioned), -10..=10, magnitude(-3.0, 3.0), moved);
    let strategy = strategy.prop_map(|(case, doubled, scaled, moved)| Elsewhere {
        case,
        doubled,
        scaled,
        moved,
    });
    let shots = |rig: &Rig, index: usize, e: &Elsewhere| {
        let base = rig.shot(index, &e.case);
        let scale = |s: f64| base.under(&DMat4::from_scale(DVec3::splat(s)));
        let (doubled, scaled) = (scale(2f64.powi(e.doubled)), scale(e.scaled));
        let (moved, wrong) =
            (base.under(&e.moved), base.under_lamp(e.case.lamp.moved(DVec3::X * 0.3)));
        vec![base, doubled, scaled, moved, wrong]
    };
    let law = ("scaled and moved", 4, 60);
    let tally = judge(
        law,
        Omit::default(),
        &strategy,
        |e| &e.case,
        shots,
        |settings, images, tally| {
            let [base, doubled, scaled, moved, wrong] = images else { unreachable!() };
            let bits = base.iter().zip(doubled).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            tally.add(settings, "pixels of other bits at 2ⁿ times the size", bits as f64, 0.0);
            prop_assert!(bits == 0, "{bits} pixels differ at a power of two times the size");
            let smooth = promises::smooth(settings);
            for (measure, least, other) in [
                ("pixels changed, scaled", "rounding, scaled", scaled),
                ("pixels changed, moved", "rounding, moved", moved),
            ] {
                let share = changed(base, other, smooth);
                tally.add(settings, measure, share, FEW_TEXELS);
                tally.add(settings, least, rounding(base, other, smooth), smooth);
                prop_assert!(
                    alike(base, other, smooth),
                    "{measure}: {share}, {:.1e} in the mean",
                    difference(base, other)
                );
            }
            if shadows(base) && shadows(wrong) {
                tally.notice(changed(base, wrong, smooth) > FEW_TEXELS);
            }
            Ok(())
        },
    );
    tally.check_noticed(0.95);
}

/// Coordinates are multiples of 2⁻¹⁶ m and the light's axes are the world's, so that f64 adds 2²⁰ m exactly.
#[test]
fn a_world_moved_exactly_looks_the_same_to_the_bit() {
    let grid = |x: f64| (x * 65536.0).round() / 65536.0;
    let vector = move |v: DVec3| DVec3::from_array(v.to_array().map(grid));
    let snapped = move |case: Case| {
        let place = |o: &Object| {
            let columns = o.world_from_mesh.to_cols_array().map(grid);
            Object { world_from_mesh: DMat4::from_cols_array(&columns), ..*o }
        };
        let length = |v: DVec3| grid(v.length()).max(1.0 / 65536.0);
        let (u, v) = (length(case.lamp.half_u), length(case.lamp.half_v));
        let half_v = if case.lamp.line { DVec3::NEG_Y } else { DVec3::NEG_Z * v };
        Case {
            lamp: Lamp {
                center: vector(case.lamp.center),
                half_u: DVec3::X * u,
                half_v,
                ..case.lamp
            },
            planes: case.planes.iter().map(place).collect(),
            objects: case.objects.iter().map(place).collect(),
            clip_from_world: View::map_of_ground(2.0, 8.0).clip_from_world,
        }
    };
    let far = prop::array::uniform3(-4i32..=4).prop_map(|n| n.map(|n| f64::from(n) * 1048576.0));
    let strategy = (case(OBJECTS).prop_map(snapped), far.prop_map(DVec3::from_array));
    let shots = |rig: &Rig, index: usize, (case, far): &(Case, DVec3)| {
        let base = rig.shot(index, case);
        let moved = base.under(&DMat4::from_translation(*far));
        let wrong = base.under_lamp(case.lamp.moved(DVec3::X * 0.3));
        vec![base, moved, wrong]
    };
    let law = ("moved exactly", 5, 40);
    let tally = judge(
        law,
        Omit::Invisible,
        &strategy,
        |(c, _)| c,
        shots,
        |settings, images, tally| {
            let other = |image: &[f32]| {
                images[0].iter().zip(image).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
            };
            tally.add(settings, "pixels of other bits", other(&images[1]) as f64, 0.0);
            prop_assert!(
                other(&images[1]) == 0,
                "{} pixels differ, {:.1e} in the mean",
                other(&images[1]),
                difference(&images[0], &images[1])
            );
            if shadows(&images[0]) {
                tally.notice(other(&images[2]) > 0);
            }
            Ok(())
        },
    );
    tally.check_noticed(0.95);
}

/// Mirrored, with the pixels that look at it; and the same light with its axes a quarter of a turn on.
#[test]
fn a_mirrored_world_looks_the_same_and_so_does_a_light_told_of_otherwise() {
    let strategy = case(OBJECTS).prop_map(well_conditioned);
    let shots = |rig: &Rig, index: usize, case: &Case| {
        let base = rig.shot(index, case);
        let mirrored = base.under(&DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
        let turned = base.under_lamp(case.lamp.quarter_turned());
        let wrong = mirrored.under_lamp(mirrored.lamp.moved(DVec3::Z * 0.3));
        vec![base, mirrored, turned, wrong]
    };
    let law = ("mirrored and turned", 6, 70);
    let tally = judge(
        law,
        Omit::Invisible,
        &strategy,
        |c| c,
        shots,
        |settings, images, tally| {
            let (base, smooth) = (&images[0], promises::smooth(settings));
            for other in &images[1..3] {
                match promises::turned(settings) {
                    Likeness::Rounding => {
                        let share = changed(base, other, smooth);
                        tally.add(settings, "pixels changed", share, FEW_TEXELS_MIRRORED);
                        prop_assert!(
                            alike(base, other, smooth),
                            "{share} of the pixels changed, {:.1e} in the mean",
                            difference(base, other)
                        );
                    }
                    Likeness::Noise(samples) => {
                        let [absolute, signed, touched] = differences(base, other);
                        if touched > 0.0 {
                            let most = promises::noise(samples);
                            tally.add(settings, "noise", absolute / touched, most);
                            tally.add(settings, "bias", signed / touched, 1.0);
                        }
                    }
                    Likeness::Mean(bound) => {
                        tally.add(settings, "difference", difference(base, other), bound);
                    }
                }
            }
            if shadows(base) && promises::turned(settings) == Likeness::Rounding {
                tally.notice(changed(base, &images[3], smooth) > FEW_TEXELS);
            }
            Ok(())
        },
    );
    tally.check_bias("bias", 4.0);
    tally.check_noticed(0.95);
}
