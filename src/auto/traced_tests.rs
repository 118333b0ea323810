//! The technique that tests the triangles themselves, among the others: where it can run, what it is expected to err by
//! and to take, and that nothing is chosen that takes many times as long as what is good enough.

use super::budget::ValidBudget;
use super::candidates::techniques;
use super::costs::tree_ms;
use super::expected::{Expected, drop_the_slow, expect, share};
use super::shafts::shaft_work;
use super::tests::{CUBE, auto, description, frame, ground, mesh, over, square};
use super::*;
use crate::frame::{Capacity, Description};
use crate::lent::{Geometry, MeshInstance};
use crate::scene::Role;
use ash::vk;
use glam::DVec3;

/// A furnished room under the light: everything in it blocks and receives, so that boxes tell maps nothing.
fn room() -> Vec<MeshInstance> {
    let both = |low: [f32; 3], high: [f32; 3]| mesh([low, high], DVec3::ZERO, Role::Both, 12);
    vec![
        both([-2.0, -0.1, -2.0], [2.0, 0.0, 2.0]),
        both([-2.1, 0.0, -2.0], [-2.0, 4.1, 2.0]),
        both([-2.0, 0.0, -2.1], [2.0, 4.1, -2.0]),
        both([-0.7, 0.0, -0.4], [0.7, 0.8, 0.4]),
    ]
}

fn choose_with(description: &Description, max_error: f64, meshes: &[MeshInstance]) -> Choice {
    let mut auto = auto(Some(max_error), None);
    auto.choose(description, &frame(square(0.6), meshes)).unwrap()
}

/// Whether a choice works with the triangles themselves.
fn reads_triangles(choice: &Choice) -> bool {
    choice.technique.room().reads_triangles()
}

#[test]
fn a_room_is_traced_and_the_promise_is_kept() {
    for max_error in [0.05, 0.03, 0.02, 0.01] {
        let c = choose_with(&description(), max_error, &room());
        assert!(reads_triangles(&c) && c.problem.is_none() && c.left_out.is_none(), "{c}");
        assert!(c.error.unwrap() <= max_error, "{c}");
    }
}

#[test]
fn where_triangles_cannot_be_had_they_are_no_candidate_and_the_choice_says_why() {
    let small = Capacity { triangles: 40, meshes: 8 };
    let few = Capacity { triangles: 1 << 10, meshes: 1 };
    let with = |capacity| Description { capacity, ..description() };
    let mapped = Description { occluder_maps: Some(vk::Format::D32_SFLOAT), ..description() };
    let mut drawn = room();
    drawn[3].geometry = Geometry::HostDrawn(7);
    let mut bytes = room();
    if let Geometry::Buffers(buffers) = &mut bytes[1].geometry {
        buffers.indices = Some((buffers.positions, 0, vk::IndexType::UINT8_KHR));
    }
    let cases = [
        (
            with(small),
            room(),
            "48 triangles in 1 meshes block light, and the description's capacity is 40",
        ),
        (mapped, room(), "the host lends maps"),
        (description(), drawn, "mesh 3 blocks light and is drawn by the host; give its buffers"),
        (description(), bytes, "indices of the type"),
    ];
    for (description, meshes, why) in cases {
        let c = choose_with(&description, 0.03, &meshes);
        assert!(!reads_triangles(&c), "{c}");
        let left_out = c.left_out.as_ref().unwrap();
        assert!(left_out.starts_with("traced is left out: ") && left_out.contains(why), "{c}");
        assert!(c.to_string().ends_with(left_out), "{c}");
    }
    // Meshes with the same buffers are one, as in the hierarchy.
    assert_eq!(choose_with(&with(few), 0.03, &room()).left_out, None);
    let lit = choose_with(&with(small), 0.03, &[ground()]);
    assert_eq!(
        (lit.error, lit.left_out),
        (None, None),
        "nothing is missed where nothing is shadowed"
    );
}

/// What is kept out is what a plan refuses.
#[test]
fn a_plan_takes_what_is_chosen() {
    let technique = "traced".parse().unwrap();
    for triangles in [46, 47, 48, 49] {
        let capacity = Capacity { triangles, meshes: 1 };
        let d = Description { technique, capacity, ..description() };
        let c = choose_with(&d, 0.03, &room());
        let meshes = room();
        let planned = crate::frame::plan(&d, Default::default(), &frame(square(0.6), &meshes));
        let refused = planned.err().map(|e| e.to_string());
        assert_eq!(c.left_out.is_some(), refused.is_some(), "{triangles}: {c}; {refused:?}");
        let Some((left_out, refused)) = c.left_out.zip(refused) else { continue };
        assert!(refused.contains(left_out.strip_prefix("traced is left out: ").unwrap()));
    }
}

/// The error of a technique that tests triangles is that of the light's samples, wherever the situation lies; the error of
/// one with maps grows with the distance from the table.
#[test]
fn no_scene_makes_the_error_of_samples_larger_than_the_tables_worst() {
    let table = Table::own();
    let unlike = Features::from_values([12.0, 8.0, 16.0, 1.0, 1.0, 1.0, 1.0]);
    let all = expect(table, &Costs::default(), &unlike, PIXELS, 1e5);
    let mut errors = Vec::new();
    for e in &all {
        let worst = table.views.iter().map(|v| v.measured[e.candidate].error).fold(0.0, f64::max);
        if techniques()[e.candidate].room().reads_triangles() {
            assert!(e.error <= 1.051 * worst, "{e:?} {worst}");
            errors.push(e.error);
        } else {
            assert!(e.error > worst.min(0.99), "{e:?} {worst}");
        }
    }
    assert!(errors.len() >= 2 && errors.windows(2).all(|pair| pair[1] < pair[0]), "{errors:?}");
    assert!(errors[0] < 0.03, "{errors:?}");
}

#[test]
fn time_grows_with_the_triangles_in_a_shaft() {
    let work = |size: f64, penumbra: f64, edges: f64| {
        let [penumbra, edges] = [penumbra, edges].map(|x| (1.0 + x).log2());
        shaft_work(&Features::from_values([size, penumbra, edges, 1.0, 1.0, 0.0, 1.0]))
    };
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    // As wide as the occluders, lit from half way: half of a face's width, a quarter of its triangles.
    let edges = |triangles: f64| 4.0 * triangles.sqrt();
    near(work(0.0, 1.0, edges(4.0 * 32.0)), 2.0);
    near(work(0.0, 1.0, edges(16.0 * 32.0)), 3.0);
    // A light half as wide, its penumbra too.
    near(work(1.0, 0.5, edges(16.0 * 32.0)), 2.0);
    // A sun's shaft is as narrow as its penumbra, however far and large its square is.
    assert!(work(-3.0, 0.001, edges(1e4)) < 1.02);
    assert_eq!(work(12.0, 0.0, edges(1e6)), 1.0);
    // Denser shafts send rays.
    assert_eq!(work(0.0, 1.0, edges(1e6)), work(0.0, 1.0, edges(1e5)));
    // More triangles than in the table take longer in the hierarchy, and denser ones in the shafts.
    let of = |edges, triangles| {
        let unlike = Features::from_values([1.0, 1.0, edges, 1.0, 1.0, 0.0, 1.0]);
        let all = expect(Table::own(), &Costs::default(), &unlike, PIXELS, triangles);
        let mut traced = all.iter().filter(|e| techniques()[e.candidate].room().reads_triangles());
        traced.next().unwrap().ms
    };
    near(of(8.0, 1e5) - of(8.0, 2e4), tree_ms(8e4));
    assert!(of(9.0, 1e5) > 1.5 * of(6.0, 1e5));
}

fn budget(max_error: f64, max_ms: f64) -> ValidBudget {
    ValidBudget { max_error, max_ms, problem: None }
}

fn left(all: &[[f64; 2]], budget: &ValidBudget) -> Vec<usize> {
    let of = |(candidate, [error, ms]): (usize, &[f64; 2])| Expected {
        candidate,
        error: *error,
        ms: *ms,
    };
    let mut expected: Vec<_> = all.iter().enumerate().map(of).collect();
    drop_the_slow(&mut expected, budget);
    expected.iter().map(|e| e.candidate).collect()
}

#[test]
fn what_takes_ten_times_as_long_as_what_is_good_enough_is_no_candidate() {
    let forever = f64::INFINITY;
    let all = [[0.2, 8.0], [0.02, 40.0], [0.019, 399.0], [0.01, 401.0], [0.001, 2000.0]];
    assert_eq!(left(&all, &budget(0.02, forever)), [0, 1, 2]);
    assert_eq!(left(&all, &budget(0.02, 1e4)), [0, 1, 2]);
    // Another error, another one that is the fastest.
    assert_eq!(left(&all, &budget(0.3, forever)), [0, 1]);
    assert_eq!(left(&all, &budget(0.01, forever)), [0, 1, 2, 3, 4]);
    // Where none is good enough, what comes near to the best counts.
    assert_eq!(left(&[[0.2, 8.0], [0.06, 50.0], [0.05, 501.0]], &budget(0.01, forever)), [0, 1]);
    assert_eq!(left(&[[0.2, 8.0], [0.11, 50.0], [0.05, 501.0]], &budget(0.01, forever)), [0, 1, 2]);
    // A time alone may be spent, and an error of 0 without a time is no leave to.
    assert_eq!(left(&all, &budget(0.0, 3000.0)), [0, 1, 2, 3, 4]);
    assert_eq!(left(&[[0.019, 8.0], [0.01, 81.0]], &budget(0.0, forever)), [0]);
}

/// Every place where features lie, with and without the triangles, and any error: many lights at seconds a frame least.
#[test]
fn no_choice_takes_ten_times_the_fastest_that_keeps_the_promise() {
    let values = |i: u32| {
        let part = |of: u32, parts: u32| f64::from(i / of % parts) / f64::from(parts - 1);
        let flag = |of: u32| f64::from(i / of % 2);
        let size = 12.0 * part(1, 5) - 2.0;
        [size, 8.0 * part(5, 3), 4.0 + 8.0 * part(15, 3), flag(45), flag(90), flag(180), flag(360)]
    };
    for i in 0..720 {
        let features = Features::from_values(values(i));
        let all = expect(Table::own(), &Costs::default(), &features, PIXELS, 2e4);
        for triangles in [true, false] {
            for max_error in [0.05, 0.03, 0.02, 0.01, 1e-9] {
                let can = |e: &&Expected| {
                    triangles || !techniques()[e.candidate].room().reads_triangles()
                };
                let can: Vec<_> = all.iter().filter(can).copied().collect();
                let mut kept = can.clone();
                drop_the_slow(&mut kept, &budget(max_error, f64::INFINITY));
                let chosen = share(&[kept], &budget(max_error, f64::INFINITY))[0].unwrap();
                let least = can.iter().map(|e| e.error).fold(f64::INFINITY, f64::min);
                let good = |e: &&Expected| e.error <= max_error.max(2.0 * least);
                let fastest = can.iter().filter(good).map(|e| e.ms).fold(f64::INFINITY, f64::min);
                assert!(
                    chosen.ms <= 10.0 * fastest,
                    "{features:?} {max_error}: {chosen:?} {fastest}"
                );
                let name = CANDIDATES[chosen.candidate].technique;
                assert!(
                    !triangles || name != "many-lights",
                    "{features:?} {max_error}: {chosen:?}"
                );
            }
        }
    }
}

/// A light that has had a slow candidate, one that is good enough too, loses it in the frame in which a fast one can be
/// had, and not after the frames that another choice waits.
#[test]
fn a_slow_choice_does_not_stay() {
    let small = Description { capacity: Capacity { triangles: 1, meshes: 1 }, ..description() };
    let meshes = over(CUBE, 2.0);
    let frame = frame(square(0.4), &meshes);
    // Maps take long here, and what looks most exactly needs the largest.
    let budget = Budget { max_error: None, max_ms: Some(1e6) };
    let mut auto = Auto::new(budget, Costs::new(20.0, 1.0));
    let slow = auto.choose(&small, &frame).unwrap();
    auto.set_budget(Budget { max_error: Some(0.05), max_ms: None });
    let fast = auto.choose(&small, &frame).unwrap();
    assert!(slow.error.unwrap() <= 0.05 && slow.ms.unwrap() > 10.0 * fast.ms.unwrap(), "{slow}");
    assert!(fast.changed && fast.error.unwrap() <= 0.05, "{fast}");
}

#[test]
fn maps_are_still_chosen_where_they_are_good_enough_and_faster() {
    let c = choose_with(&description(), 0.05, &over(CUBE, 2.0));
    assert!(!reads_triangles(&c) && c.left_out.is_none() && c.error.unwrap() <= 0.05, "{c}");
}
