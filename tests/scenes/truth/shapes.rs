//! The tracer under lights of every shape, against closed forms, the exact fraction of polygons, and other shapes.

use crate::truth::random::Random;
use antumbra::scene::{Mesh, Role, Scene};
use antumbra::truth::{Exact, PolygonLight, Receiver, Sampling, Tracer};
use antumbra::{Light, RectangleLight};
use glam::{DMat4, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

mod laws;
mod round;

/// Rays a receiver: two grids of 32 × 32.
const RAYS: u32 = 2048;

/// The largest standard error of an edge across a figure: n^(−3/2)/√2 (see `Sampling`), for n = 32. The maps of the
/// square bend edges, and lengthen them by no more than half.
const NOISE: f64 = 1.5 * 0.003_906_25;

/// A light of each shape, at y = 4 over the origin; the flat ones shine down, as the sun does.
fn lights() -> Vec<Light> {
    let up = DVec3::Y * 4.0;
    let corners = [[-0.5, -0.4], [0.5, -0.4], [0.5, 0.1], [0.1, 0.1], [0.1, 0.5], [-0.5, 0.5]];
    vec![
        RectangleLight::new(up, DVec3::X * 0.5, DVec3::NEG_Z * 0.3).unwrap().into(),
        RectangleLight::line(up, DVec3::X * 0.5, DVec3::NEG_Y).unwrap().into(),
        Light::polygon(&corners.map(|[x, z]| up + DVec3::new(x, 0.0, z))).unwrap(),
        Light::disc(up, DVec3::NEG_Y, 0.4).unwrap(),
        Light::sphere(up, 0.4).unwrap(),
        Light::capsule(up, DVec3::X * 0.4, 0.2).unwrap(),
        Light::point(up).unwrap(),
        RectangleLight::point(up, DVec3::NEG_Y).unwrap().into(),
        Light::sun(DVec3::NEG_Y, 0.2, DVec3::ZERO, 5.0).unwrap(),
    ]
}

/// A scene of flat polygons that block, each a fan of triangles.
fn blockers(polygons: &[Vec<DVec3>]) -> Scene {
    let mut scene = Scene::default();
    for polygon in polygons {
        let from_first = |p: &DVec3| (*p - polygon[0]).as_vec3().to_array();
        let positions = polygon.iter().map(from_first).collect();
        let fan = (1..polygon.len() as u32 - 1).flat_map(|i| [0, i, i + 1]).collect();
        let mesh = Mesh { positions, indices: fan, ..Mesh::default() };
        scene.add("blocker", mesh, DMat4::from_translation(polygon[0]), Role::Both);
    }
    scene
}

/// All of a plane across `away` that lies on one side of an edge through `at`: where `beyond` points, 100 m of it.
fn half_plane(at: DVec3, beyond: DVec3, away: DVec3) -> Tracer {
    let (beyond, along) = (beyond.normalize() * 100.0, beyond.cross(away).normalize() * 100.0);
    let corners = vec![at - along, at + along, at + along + beyond, at - along + beyond];
    Tracer::new(&blockers(&[corners])).unwrap()
}

fn seen(tracer: &Tracer, light: &Light, position: DVec3) -> f64 {
    seen_with(tracer, light, position, DVec3::Z)
}

/// The receiver is moved along its normal, by micrometres a metre of the scene.
fn seen_with(tracer: &Tracer, light: &Light, position: DVec3, normal: DVec3) -> f64 {
    let receiver = Receiver { position, normal };
    let sampling = Sampling::new(RAYS, 5).unwrap();
    tracer.visible_fraction(light, &receiver, &sampling, 3).unwrap().visible
}

/// The share of a disc of radius 1 with an x of at most `c`.
fn share_of_disc(c: f64) -> f64 {
    1.0 - (c.acos() - c * (1.0 - c * c).sqrt()) / PI
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 4.0 * NOISE, "{found}, and not {expected}");
}

/// Half way to the light, what hides all beyond an x hides all beyond twice that of a light in a plane.
#[test]
fn an_edge_hides_the_share_of_a_disc_that_is_worked_out_by_hand() {
    let light = Light::disc(DVec3::Y * 4.0, DVec3::NEG_Y, 0.6).unwrap();
    for turn in [0.0, 0.7, 2.0, 4.0] {
        let beyond = DVec3::new(f64::cos(turn), 0.0, f64::sin(turn));
        for c in [-0.9, -0.5, 0.0, 0.3, 0.8] {
            let tracer = half_plane(DVec3::Y * 2.0 + beyond * 0.3 * c, beyond, DVec3::Y);
            near(seen(&tracer, &light, DVec3::ZERO), share_of_disc(c));
        }
        for (c, share) in [(-1.01, 0.0), (1.01, 1.0)] {
            let tracer = half_plane(DVec3::Y * 2.0 + beyond * 0.3 * c, beyond, DVec3::Y);
            assert_eq!(seen(&tracer, &light, DVec3::ZERO), share);
        }
    }
}

/// Triangles strewn round the origin, and receivers below them.
fn set_up(random: &mut Random) -> (Scene, Vec<Receiver>) {
    let triangle = |i: usize, random: &mut Random| {
        let (at, size) = (random.vector(1.0), [0.1, 0.5][i % 2]);
        [(); 3].map(|()| at + random.vector(size)).to_vec()
    };
    let triangles: Vec<_> = (0..60).map(|i| triangle(i, random)).collect();
    let scene = blockers(&triangles);
    let position = |random: &mut Random| random.vector(1.5) - DVec3::Y * 3.0;
    let receiver = |_| Receiver { position: position(random), normal: DVec3::Y };
    (scene, (0..120).map(receiver).collect())
}

/// The root mean square of the errors over the noise that was stated, and their mean in standard errors of a mean.
fn deviation(errors: &[f64], noise: f64) -> (f64, f64) {
    let count = errors.len() as f64;
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / count).sqrt();
    (rms / noise, errors.iter().sum::<f64>() / count.sqrt() / rms)
}

/// The tracer's errors against exact fractions are the noise that it states, without a bias.
#[track_caller]
fn agrees(
    tracer: &Tracer,
    light: &Light,
    receivers: &[Receiver],
    exact: impl Fn(&Receiver) -> f64,
) {
    let mut errors = Vec::new();
    let (mut squares, mut penumbra) = (0.0, 0);
    for seed in 0..4 {
        let sampling = Sampling::new(RAYS, seed).unwrap();
        let traced = tracer.visible_fractions(light, receivers, &sampling).unwrap();
        squares += traced.noise.powi(2) * traced.penumbra as f64;
        penumbra += traced.penumbra;
        let pairs = traced.visible.iter().zip(receivers);
        let within = pairs.filter(|(v, _)| **v > 0.0 && **v < 1.0);
        errors.extend(within.map(|(&v, r)| f64::from(v) - exact(r)));
    }
    assert!(penumbra > 200, "{penumbra} receivers in the penumbra");
    let (ratio, bias) = deviation(&errors, (squares / penumbra as f64).sqrt());
    println!("{penumbra} in the penumbra, {ratio:.3} times the stated noise, bias {bias:.2}");
    // Each of the two is known to about 1/√(2 · 400), 4 %, and four times that is allowed.
    assert!((ratio - 1.0).abs() < 0.16, "the noise is {ratio} times what is stated");
    assert!(bias.abs() < 4.0, "a bias of {bias} standard errors");
}

/// Corners of a circle's polygon with as much area: the part of one that is not in the other is 10⁻⁵ of it.
fn circle(center: DVec3, [u, v]: [DVec3; 2]) -> Vec<DVec3> {
    let corners = 720;
    let step = TAU / f64::from(corners);
    let grown = (step / step.sin()).sqrt();
    let corner = |i: u32| DVec2::from_angle(f64::from(i) * step) * grown;
    (0..corners).map(|i| center + u * corner(i).x + v * corner(i).y).collect()
}

#[test]
fn a_disc_is_the_exact_fraction_of_a_polygon_of_720_corners() {
    let mut random = Random(21);
    let (scene, receivers) = set_up(&mut random);
    let up = DVec3::Y * 3.0;
    let light = Light::disc(up, DVec3::NEG_Y, 0.8).unwrap();
    let polygon = PolygonLight::new(&circle(up, [DVec3::X * 0.8, DVec3::Z * 0.8])).unwrap();
    let exact = Exact::new(&scene).unwrap();
    agrees(&Tracer::new(&scene).unwrap(), &light, &receivers, |r| {
        exact.visible_fraction(&polygon, r).unwrap()
    });
}

/// Ears are cut off an L, a comb and a spiral.
#[test]
fn a_polygon_is_its_exact_fraction() {
    let l = [[-0.5, -0.5], [0.5, -0.5], [0.5, -0.2], [-0.1, -0.2], [-0.1, 0.5], [-0.5, 0.5]];
    let comb = [
        [-0.8, -0.8],
        [0.8, -0.8],
        [0.8, 0.8],
        [0.6, 0.8],
        [0.5, -0.4],
        [0.2, 0.7],
        [-0.2, 0.6],
        [-0.4, -0.5],
        [-0.5, 0.8],
        [-0.8, 0.8],
    ];
    let spiral = [
        [-0.7, -0.7],
        [0.7, -0.7],
        [0.7, 0.7],
        [-0.4, 0.7],
        [-0.4, -0.3],
        [0.3, -0.3],
        [0.3, 0.3],
        [0.0, 0.3],
        [0.0, 0.0],
        [-0.1, 0.0],
        [-0.1, 0.5],
        [0.5, 0.5],
        [0.5, -0.5],
        [-0.7, -0.5],
    ];
    let mut random = Random(22);
    let (scene, receivers) = set_up(&mut random);
    let (tracer, exact) = (Tracer::new(&scene).unwrap(), Exact::new(&scene).unwrap());
    for outline in [&l[..], &comb, &spiral] {
        let corners: Vec<DVec3> = outline.iter().map(|&[x, z]| DVec3::new(x, 3.0, z)).collect();
        let light = Light::polygon(&corners).unwrap();
        assert!(light.emission().y < 0.0, "{}", light.emission());
        let polygon = PolygonLight::new(&corners).unwrap();
        agrees(&tracer, &light, &receivers, |r| exact.visible_fraction(&polygon, r).unwrap());
    }
}

/// A sun's disc is seen under its angle: an edge at a share of the angle's tangent hides the share of a disc.
#[test]
fn an_edge_hides_the_share_of_a_sun_that_is_worked_out_by_hand() {
    let size = 0.3_f64;
    for emission in [DVec3::NEG_Y, DVec3::new(0.3, -1.0, -0.4)] {
        let z = -emission.normalize();
        let light = Light::sun(emission, size, DVec3::ZERO, 1.0).unwrap();
        let beyond = z.any_orthonormal_vector();
        for c in [-0.7, 0.0, 0.4, 0.9] {
            // However near or far the edge is.
            for away in [0.5, 40.0] {
                let at = (z + beyond * c * (0.5 * size).tan()) * away;
                near(seen(&half_plane(at, beyond, z), &light, DVec3::ZERO), share_of_disc(c));
            }
        }
    }
}

/// So far away that rays are parallel but for a ten-thousandth, a disc is a sun.
#[test]
fn a_sun_is_a_disc_far_away() {
    let mut random = Random(23);
    let (scene, receivers) = set_up(&mut random);
    let sun = Light::sun(DVec3::NEG_Y, 0.3, DVec3::ZERO, 5.0).unwrap();
    let far = 1e5;
    let radius = far * 0.15_f64.tan();
    let exact = Exact::new(&scene).unwrap();
    let [u, v] = [DVec3::X, DVec3::Z].map(|axis| axis * radius);
    let disc = PolygonLight::new(&circle(DVec3::Y * far, [u, v])).unwrap();
    // From the point that the tracer's offset makes of a receiver.
    let tracer = Tracer::new(&scene).unwrap();
    let sampling = Sampling::new(RAYS, 1).unwrap();
    let offset = |r: &Receiver| r.normal * tracer.offset(sun, r.position, &sampling);
    assert!(offset(&receivers[0]).length() < 1e-4, "a sun's distance is no coordinate");
    agrees(&tracer, &sun, &receivers, |r| {
        exact.visible_from(&disc, r.position + offset(r)).unwrap()
    });
}

/// The shadow of a point's only ray ends where the line from the point past the edge does.
#[test]
fn a_point_is_seen_or_not() {
    let light = Light::point(DVec3::Y * 4.0).unwrap();
    let tracer = half_plane(DVec3::new(0.3, 3.0, 0.0), DVec3::X, DVec3::Y);
    let receivers: Vec<Receiver> = (0..400)
        .map(|i| Receiver { position: DVec3::X * f64::from(i) * 0.01, normal: DVec3::Y })
        .collect();
    let sampling = Sampling::new(RAYS, 1).unwrap();
    let traced = tracer.visible_fractions(light, &receivers, &sampling).unwrap();
    for (v, r) in traced.visible.iter().zip(&receivers) {
        // 0.3 m at a metre from the light are 1.2 m at four.
        assert_eq!(*v, if r.position.x < 1.2 - 1e-4 { 1.0 } else { 0.0 }, "{}", r.position.x);
    }
    assert_eq!((traced.noise, traced.penumbra, traced.rays), (0.0, 0, 400));
}
