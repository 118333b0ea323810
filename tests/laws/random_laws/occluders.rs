//! Laws of what blocks: nothing, and one thing more.

use super::compare::{changed, not_lit, rise};
use super::promises::{self, HIDES, Rise};
use super::{Case, OBJECTS, Object, blocking_only, judge};
use antumbra::MeshInstance;
use antumbra::Omit;
use antumbra::scene::Role;
use antumbra_tests::random::{case, object};
use antumbra_tests::rig::Rig;
use proptest::prelude::*;

/// None at all, or all behind the light: what the planner tells by their boxes, and what each technique must find
/// itself where a host gives boxes that are far too large.
#[test]
fn where_nothing_blocks_all_is_lit_to_the_last_bit() {
    let far_too_large = |m: MeshInstance| MeshInstance { bounds: [[-30.0; 3], [30.0; 3]], ..m };
    let shots = |rig: &Rig, index: usize, case: &Case| {
        let light = case.lamp.light();
        let behind = |o: &Object| {
            // A millimetre.
            let past = o.seen_by(&light)[1].z + 1e-3;
            rig.mesh(&o.moved(-past * light.emission()))
        };
        let planes = Case { objects: Vec::new(), ..case.clone() };
        let none = rig.shot(index, &planes);
        let mut told = none.clone();
        told.meshes.extend(case.objects.iter().map(behind));
        let mut found = none.clone();
        found.meshes.extend(case.objects.iter().map(|o| far_too_large(behind(o))));
        vec![none, told, found, rig.shot(index, case)]
    };
    let strategy = case(OBJECTS).prop_map(blocking_only);
    let law = ("nothing blocks", 1, 60);
    let tally = judge(
        law,
        Omit::default(),
        &strategy,
        |c| c,
        shots,
        |settings, images, tally| {
            for image in &images[..3] {
                let wrong = not_lit(image);
                tally.add(settings, "pixels not lit", wrong as f64, 0.0);
                prop_assert!(wrong == 0, "{wrong} pixels are not lit");
            }
            tally.notice(not_lit(&images[3]) > 0);
            Ok(())
        },
    );
    tally.check_noticed(0.5);
}

/// The maps' texels stay: what is compared with has the new occluder's box, with nothing in it.
#[test]
fn another_occluder_never_shows_more() {
    let strategy = (case(OBJECTS), object());
    let shots = |rig: &Rig, index: usize, (case, (t, new)): &(Case, (f64, Object))| {
        let new = Object { role: Role::Occluder, ..new.moved(case.lamp.center * *t) };
        let base = rig.shot(index, case);
        vec![base.and(rig.ghost(&new)), base.and(rig.mesh(&new))]
    };
    let law = ("another occluder", 2, 120);
    let tally = judge(
        law,
        Omit::Nothing,
        &strategy,
        |(c, _)| c,
        shots,
        |settings, images, tally| {
            let [most, mean] = rise(&images[0], &images[1]);
            match promises::with_another(settings) {
                Rise::By(bound) => {
                    tally.add(settings, "highest rise", most, bound);
                    prop_assert!(most <= bound, "another occluder raised a pixel by {most}");
                    // The other way round it falls, where it does anything.
                    let [fall, _] = rise(&images[1], &images[0]);
                    if changed(&images[0], &images[1], bound) > 0.0 {
                        tally.notice(fall > bound);
                    }
                }
                Rise::Hides => tally.add(settings, "mean rise, by its model", mean, HIDES),
            }
            Ok(())
        },
    );
    tally.check_noticed(0.99);
}

/// The same from one side of a plane through the light to the other: no texel has both.
#[test]
fn another_occluder_elsewhere_never_shows_more() {
    let strategy = (case(6).prop_map(blocking_only), object());
    let shots = |rig: &Rig, index: usize, (case, (t, new)): &(Case, (f64, Object))| {
        let light = case.lamp.light();
        let x = light.world_from_light().x_axis.truncate();
        let aside = |o: &Object, side: f64| {
            let [least, most] = o.seen_by(&light);
            // Two texels and more from the plane.
            let gap = promises::APART * most.z.abs().max(0.1);
            o.moved(x * if side > 0.0 { gap - least.x } else { -gap - most.x })
        };
        let planes = Case { objects: Vec::new(), ..case.clone() };
        let mut base = rig.shot(index, &planes);
        base.meshes.extend(case.objects.iter().map(|o| rig.mesh(&aside(o, 1.0))));
        let new = Object { role: Role::Occluder, ..new.moved(case.lamp.center * *t) };
        let new = aside(&new, -1.0);
        vec![base.and(rig.ghost(&new)), base.and(rig.mesh(&new))]
    };
    let law = ("another occluder elsewhere", 3, 80);
    let tally = judge(
        law,
        Omit::Nothing,
        &strategy,
        |(c, _)| c,
        shots,
        |settings, images, tally| {
            let [most, mean] = rise(&images[0], &images[1]);
            match promises::with_another_elsewhere(settings) {
                Some(bound) => {
                    tally.add(settings, "highest rise", most, bound);
                    prop_assert!(
                        most <= bound,
                        "another occluder elsewhere raised a pixel by {most}"
                    );
                    let [fall, _] = rise(&images[1], &images[0]);
                    if changed(&images[0], &images[1], bound) > 0.0 {
                        tally.notice(fall > bound);
                    }
                }
                None => {
                    tally.add(settings, "mean rise, by its model", mean, promises::HIDES_ELSEWHERE);
                }
            }
            Ok(())
        },
    );
    tally.check_noticed(0.9);
}
