//! What the exact visible fraction of a line light is, whatever the scene.

use antumbra::RectangleLight;
use antumbra::scene::{Mesh, Role, Scene};
use antumbra::truth::ExactLine;
use glam::{DMat4, DQuat, DVec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// How far laws that hold but for rounding may be off.
const ROUNDING: f64 = 1e-9;

type Triangle = [DVec3; 3];

/// A line light, a receiver a few metres from it, and triangles between and round them.
#[derive(Clone, Debug)]
struct Case {
    center: DVec3,
    half: DVec3,
    emission: DVec3,
    receiver: DVec3,
    triangles: Vec<Triangle>,
}

impl Case {
    fn light(&self) -> RectangleLight {
        RectangleLight::line(self.center, self.half, self.emission).unwrap()
    }

    fn seen(&self, light: &RectangleLight) -> f64 {
        self.seen_past(&self.triangles, light)
    }

    fn seen_past(&self, triangles: &[Triangle], light: &RectangleLight) -> f64 {
        ExactLine::new(&soup(triangles)).unwrap().visible_from(light, self.receiver).unwrap()
    }

    /// All of it somewhere else.
    fn under(&self, change: &DMat4) -> Self {
        let vector = |v| change.transform_vector3(v);
        let point = |p| change.transform_point3(p);
        Self {
            center: point(self.center),
            half: vector(self.half),
            emission: vector(self.emission),
            receiver: point(self.receiver),
            triangles: self.triangles.iter().map(|t| t.map(point)).collect(),
        }
    }
}

/// Triangles in f64: each is the unit triangle under a transform of its own.
fn soup(triangles: &[Triangle]) -> Scene {
    let mut scene = Scene::default();
    for &[a, b, c] in triangles {
        let unit = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            indices: vec![0, 1, 2],
            ..Mesh::default()
        };
        let edges = [b - a, c - a, DVec3::Z].map(|edge| edge.extend(0.0));
        let place = DMat4::from_cols(edges[0], edges[1], edges[2], a.extend(1.0));
        scene.add("triangle", unit, place, Role::Both);
    }
    scene
}

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

/// The light along x, shining down and somewhat aside; whatever way it is turned is another law.
fn case() -> impl Strategy<Value = Case> {
    let triangle = (0.05..0.95, vector(0.6), prop::array::uniform3(vector(0.5)));
    let light = (vector(1.0), 0.1..1.5, -0.5..0.5, -1.0..1.0);
    let below = (-1.0..1.0, -3.0..-1.0, -1.0..1.0).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    (light, below, prop::collection::vec(triangle, 1..10)).prop_map(|(light, below, triangles)| {
        let (center, half, lean, aside) = light;
        let receiver = center + below;
        let place = |(t, at, corners): (f64, DVec3, [DVec3; 3])| {
            corners.map(|corner| receiver + (center - receiver) * t + at + corner)
        };
        Case {
            center,
            half: DVec3::X * half,
            emission: DVec3::new(aside, -1.0, lean),
            receiver,
            triangles: triangles.into_iter().map(place).collect(),
        }
    })
}

/// Runs a law on the same thousand cases each time, and says in how many the light is seen in part.
fn hold<S: Strategy>(strategy: &S, law: impl Fn(S::Value) -> Result<f64, TestCaseError>) {
    let partial = std::cell::Cell::new(0);
    let config = Config { cases: 1024, failure_persistence: None, ..Config::default() };
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let run = TestRunner::new_with_rng(config, random).run(strategy, |value| {
        let v = law(value)?;
        prop_assert!((0.0..=1.0).contains(&v), "{v}");
        partial.set(partial.get() + u32::from(v > 0.0 && v < 1.0));
        Ok(())
    });
    run.unwrap_or_else(|e| panic!("{e}"));
    assert!(partial.get() > 400, "only {} of 1024 cases were in the penumbra", partial.get());
}

fn near(a: f64, b: f64) -> Result<(), TestCaseError> {
    prop_assert!((a - b).abs() <= ROUNDING, "{a} and {b}");
    Ok(())
}

#[test]
fn another_occluder_never_shows_more() {
    hold(&case(), |case| {
        let mut before = 1.0;
        for n in 1..=case.triangles.len() {
            let now = case.seen_past(&case.triangles[..n], &case.light());
            // The scene's centre moves with what is in it, and rounding with that.
            prop_assert!(now <= before + ROUNDING, "{before} to {now}");
            before = now;
        }
        Ok(before)
    });
}

#[test]
fn the_parts_of_a_line_average_to_the_whole() {
    hold(&(case(), 0.05..0.95), |(case, share)| {
        let part = |from: f64, to: f64| {
            let center = case.center + case.half * (from + to - 1.0);
            let half = case.half * (to - from);
            case.seen(&RectangleLight::line(center, half, case.emission).unwrap())
        };
        let whole = case.seen(&case.light());
        near(0.5 * (part(0.0, 0.5) + part(0.5, 1.0)), whole)?;
        near(share * part(0.0, share) + (1.0 - share) * part(share, 1.0), whole)?;
        Ok(whole)
    });
}

#[test]
fn a_world_turned_moved_and_scaled_looks_the_same() {
    let change = (vector(3.0), vector(100.0), -2.0..2.0);
    hold(&(case(), change), |(case, (turn, shift, scale))| {
        let scale = DVec3::splat(10f64.powf(scale));
        let turn = DQuat::from_scaled_axis(turn);
        let there = case.under(&DMat4::from_scale_rotation_translation(scale, turn, shift));
        let v = case.seen(&case.light());
        // Centimetres 100 m away are rounded to 10⁻¹² of themselves; edges that all but lie in the
        // receiver's plane multiply that.
        let other = there.seen(&there.light());
        prop_assert!((v - other).abs() < 1e-7, "{v} and {other}");
        Ok(v)
    });
}

#[test]
fn neither_windings_nor_copies_nor_cuts_nor_the_lights_direction_matter() {
    hold(&(case(), 0.1..0.9), |(case, t)| {
        let v = case.seen(&case.light());
        let turned: Vec<Triangle> = case.triangles.iter().map(|&[a, b, c]| [c, b, a]).collect();
        near(case.seen_past(&turned, &case.light()), v)?;
        near(case.seen_past(&[turned, case.triangles.clone()].concat(), &case.light()), v)?;
        let cut = |&[a, b, c]: &Triangle| [[a, b, b.lerp(c, t)], [a, b.lerp(c, t), c]];
        let cut: Vec<Triangle> = case.triangles.iter().flat_map(cut).collect();
        near(case.seen_past(&cut, &case.light()), v)?;
        let back = RectangleLight::line(case.center, -case.half, case.emission).unwrap();
        near(case.seen(&back), v)?;
        Ok(v)
    });
}

/// The laws above are of no use where a wrong line passes them: one an inch longer, or an inch aside.
#[test]
fn another_line_is_seen_otherwise() {
    let (mut runner, mut changed, mut partial) = (TestRunner::deterministic(), [0; 2], 0);
    for _ in 0..300 {
        let case = proptest::strategy::ValueTree::current(&case().new_tree(&mut runner).unwrap());
        let v = case.seen(&case.light());
        if v == 0.0 || v == 1.0 {
            continue;
        }
        partial += 1;
        let longer = case.half + DVec3::X * 0.0254;
        let longer = RectangleLight::line(case.center, longer, case.emission).unwrap();
        let aside = case.center + DVec3::Z * 0.0254;
        let aside = RectangleLight::line(aside, case.half, case.emission).unwrap();
        for (changed, wrong) in changed.iter_mut().zip([longer, aside]) {
            *changed += usize::from((case.seen(&wrong) - v).abs() > 1e-4);
        }
    }
    println!("{changed:?} of {partial}");
    assert!(
        partial > 100 && changed.iter().all(|c| 10 * c > 9 * partial),
        "{changed:?} of {partial}"
    );
}
