//! What holds of every scene, whatever it is: laws on random scenes, lights and settings.
//!
//! A case is one random scene under one light with one random choice of settings, evaluated to images that a law
//! judges. `ANTUMBRA_CASES=10` runs ten times as many. What fails is shrunk to the smallest scene that fails.
//! docs/laws.md has the laws, their bounds and why.

mod compare;
mod lights;
mod motions;
mod occluders;
mod promises;
mod tally;

use antumbra::Omit;
use antumbra::Technique;
use antumbra::scene::Role;
use antumbra_tests::device::unwatched;
use antumbra_tests::random::{Case, Object, Shape, hold};
use antumbra_tests::rig::{Random, Rig, Shot, random_settings, words};
use compare::{alike, beyond_edges, changed, differences, not_lit, out_of_bounds, rise};
use proptest::prelude::*;
use std::cell::RefCell;
use tally::Tally;

/// A law's own random settings: one of each technique with so many views at most, and one with so many.
const VIEWS: [u32; 2] = [1, 4];

/// The most objects in a scene.
const OBJECTS: usize = 12;

type Verdict = Result<(), TestCaseError>;

/// Evaluates every case with each of some random settings, holds each image between 0 and 1, and lets the law
/// judge them; what it measured.
fn judge<S: Strategy>(
    law: (&'static str, u8, u32),
    omit: Omit,
    strategy: &S,
    pixels: impl Fn(&S::Value) -> &Case,
    shots: impl Fn(&Rig, usize, &S::Value) -> Vec<Shot>,
    verdict: impl Fn(&Technique, &[Vec<f32>], &mut Tally) -> Verdict,
) -> Tally {
    judge_through(VIEWS, law, omit, strategy, pixels, shots, verdict)
}

/// The same with so many views at most in either set of settings.
fn judge_through<S: Strategy>(
    views: [u32; 2],
    (law, seed, cases): (&'static str, u8, u32),
    omit: Omit,
    strategy: &S,
    pixels: impl Fn(&S::Value) -> &Case,
    shots: impl Fn(&Rig, usize, &S::Value) -> Vec<Shot>,
    verdict: impl Fn(&Technique, &[Vec<f32>], &mut Tally) -> Verdict,
) -> Tally {
    let device = unwatched();
    // Its pipelines alone take half of the time.
    let slow = device.leaves_to_others("half of the cases");
    let cases = if slow { cases / 2 } else { cases };
    let tally = RefCell::new(Tally::new(law));
    let mut random = Random(u64::from(seed) << 32);
    for (set, views) in (0..).zip(views) {
        // A technique that came later draws from numbers of its own, so that the others' settings stay those whose
        // bounds were measured.
        let mut later = Random(u64::from(seed) << 32 | u64::from(set) << 1 | 1);
        let all = Technique::all().into_iter().map(|t| match t {
            Technique::Traced(_) => random_settings(t, views, &mut later),
            _ => random_settings(t, views, &mut random),
        });
        let settings: Vec<_> = all.collect();
        let rig = RefCell::new(Rig::new(&device, &settings, omit));
        hold(cases, seed.wrapping_mul(2).wrapping_add(set), strategy, |value| {
            let (mut rig, mut tally) = (rig.borrow_mut(), tally.borrow_mut());
            let case = pixels(&value);
            rig.look(case);
            for (index, settings) in settings.iter().enumerate() {
                if !settings.room().takes().shapes.hold(&case.lamp.light().into()) {
                    continue;
                }
                let shots = shots(&rig, index, &value);
                let images = rig.images(&shots);
                tally.judged(images.len());
                for image in &images {
                    let bad = out_of_bounds(image);
                    prop_assert!(bad.is_none(), "{}: {bad:?}", words(settings));
                }
                verdict(settings, &images, &mut tally)
                    .map_err(|e| TestCaseError::fail(format!("{}: {e}", words(settings))))?;
            }
            Ok(())
        });
    }
    let tally = tally.into_inner();
    tally.check();
    tally
}

/// The same scene, all of its objects occluders alone: its pixels show planes that block nothing.
fn blocking_only(case: Case) -> Case {
    let objects = case.objects.iter().map(|o| Object { role: Role::Occluder, ..*o }).collect();
    Case { objects, ..case }
}

/// The same scene without what rounding alone decides: whether a raster shows a triangle whose corners lie on a line,
/// and where one begins that a near plane cuts which stands 10⁻⁴ of all distances before the light, as it does through
/// what is nearer than 10 cm or crosses the light's plane.
fn well_conditioned(case: Case) -> Case {
    let light = case.lamp.light();
    let sound = |o: &&Object| {
        let [least, most] = o.seen_by(&light);
        o.shape != Shape::Line && (least.z > 0.1 || most.z < 0.0)
    };
    Case { objects: case.objects.iter().filter(sound).copied().collect(), ..case }
}

/// Whether there is a shadow worth looking at.
fn shadows(image: &[f32]) -> bool {
    image.iter().filter(|v| **v < 0.9).count() * 50 > image.len()
}

/// The comparators see what is wrong with an image.
#[test]
fn wrong_images_are_noticed() {
    let lit = [1.0; 64];
    let with = |v: f32| {
        let mut image = lit;
        image[17] = v;
        image
    };
    for v in [f32::NAN, f32::INFINITY, f32::from_bits(1f32.to_bits() + 1), -f32::from_bits(1)] {
        assert!(out_of_bounds(&with(v)).is_some(), "{v}");
        assert_eq!(not_lit(&with(v)), 1, "{v}");
    }
    assert!(out_of_bounds(&with(0.0)).is_none() && out_of_bounds(&lit).is_none());
    assert_eq!(not_lit(&with(1.0 - f32::EPSILON / 2.0)), 1);
    assert!(changed(&lit, &with(0.999), 5e-4) > 0.0 && changed(&lit, &with(f32::NAN), 5e-4) > 0.0);
    assert!(alike(&lit, &lit, 0.0) && !alike(&lit, &[0.9; 64], 5e-4));
    assert_eq!(rise(&with(0.5), &lit)[0], 0.5);
    assert_eq!(rise(&lit, &with(0.5))[0], 0.0);
    assert!(beyond_edges(&lit, &with(0.9)) > 0.0 && beyond_edges(&with(0.5), &lit) == 0.0);
    assert_eq!(differences(&with(0.5), &lit), [0.5, -0.5, 1.0]);
}
