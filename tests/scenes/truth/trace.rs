//! The tracer against the closed form, against brute force, and against the laws of visibility.

use crate::truth::random::Random;
use antumbra::RectangleLight;
use antumbra::scene::{AreaLight, Instance, Mesh, Role, Scene};
use antumbra::truth::{Receiver, Sampling, Traced, Tracer, visible_fraction_of_quad};
use glam::{DMat4, DVec3};

mod laws;

fn sampling(rays: u32) -> Sampling {
    Sampling::new(rays, 7).unwrap()
}

/// One mesh and instance a quad (two triangles each), at mesh coordinates about the first corner
/// so that f32 holds them wherever the quad is.
fn scene_of(quads: &[([DVec3; 4], Role)], light: Option<RectangleLight>) -> Scene {
    let mut scene = Scene::default();
    for &(quad, role) in quads {
        let positions = quad.map(|corner| (corner - quad[0]).as_vec3().to_array()).to_vec();
        let indices = vec![0, 1, 2, 0, 2, 3];
        scene.instances.push(Instance {
            name: format!("quad {}", scene.meshes.len()),
            mesh: scene.meshes.len(),
            world_from_mesh: DMat4::from_translation(quad[0]),
            role,
        });
        scene.meshes.push(Mesh { positions, indices, ..Mesh::default() });
    }
    scene.lights.extend(light.map(|light| AreaLight {
        name: "light".into(),
        light: light.into(),
        color: [1.0; 3],
        intensity: 1.0,
    }));
    scene
}

fn floor_quad(half: f64, y: f64) -> [DVec3; 4] {
    [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]]
        .map(|[x, z]| DVec3::new(x * half, y, z * half))
}

/// A unit light at y = 2, shining down.
fn ceiling() -> RectangleLight {
    let up = DVec3::new(0.0, 2.0, 0.0);
    RectangleLight::new(up, DVec3::X / 2.0, DVec3::NEG_Z / 2.0).unwrap()
}

/// Looks straight up from the floor.
fn on_floor(x: f64, z: f64) -> Receiver {
    Receiver { position: DVec3::new(x, 0.0, z), normal: DVec3::Y }
}

/// A random light, a random parallelogram before it, and receivers in its shadow.
struct Case {
    light: RectangleLight,
    /// The quad as f32 mesh coordinates hold it, so that both methods compute with the same one.
    quad: [DVec3; 4],
    receivers: Vec<Receiver>,
}

fn random_case(random: &mut Random, receivers: usize) -> Case {
    let [x, y, z] = random.frame();
    let center = random.vector(2.0);
    let sides = [random.within(0.2, 1.0), random.within(0.2, 1.0)];
    let light = RectangleLight::new(center, x * sides[0], y * sides[1]).unwrap();
    let middle = center - z * random.within(0.5, 1.5);
    let [u, v] = [(); 2].map(|()| random.vector(0.6));
    let first = middle - (u + v) / 2.0;
    let quad = [DVec3::ZERO, u, u + v, v].map(|p| first + p.as_vec3().as_dvec3());
    let receivers = (0..receivers)
        .map(|_| {
            // Through a point of the quad to a little past it, seen from a point near the light.
            let target = first + u * random.within(-0.2, 1.2) + v * random.within(-0.2, 1.2);
            let from = center + x * random.within(-0.5, 0.5) + y * random.within(-0.5, 0.5);
            let position = from + (target - from) * random.within(1.2, 3.0);
            Receiver { position, normal: z }
        })
        .collect();
    Case { light, quad, receivers }
}

/// Errors against the closed form, the noise that was stated, and how many receivers it is over.
fn compare(case: &Case, rays: u32) -> (Vec<f64>, Traced) {
    let scene = scene_of(&[(case.quad, Role::Occluder)], Some(case.light));
    let tracer = Tracer::new(&scene).unwrap();
    let traced = tracer.visible_fractions(case.light, &case.receivers, &sampling(rays)).unwrap();
    let exact =
        |receiver: &Receiver| visible_fraction_of_quad(&case.light, case.quad, receiver.position);
    let errors = case.receivers.iter().zip(&traced.visible);
    (errors.map(|(receiver, &v)| f64::from(v) - exact(receiver)).collect(), traced)
}

#[test]
fn agrees_with_the_closed_form_within_the_noise_it_states() {
    let mut random = Random(3);
    let (mut stated, mut actual, mut signed, mut penumbra) = (0.0, 0.0, 0.0, 0);
    for _ in 0..60 {
        let case = random_case(&mut random, 200);
        let (errors, traced) = compare(&case, 512);
        // No convex outline can do worse than this (see `Sampling`): n = 16.
        let standard_error = 16.0_f64.powf(-1.5) / 2.0_f64.sqrt();
        let worst = errors.iter().fold(0.0_f64, |worst, e| worst.max(e.abs()));
        // 12,000 receivers: five standard errors are passed once in a hundred such tests by a
        // normal law, and the bound itself is two to three times what occurs.
        assert!(worst < 5.0 * standard_error, "{worst} against {standard_error}");
        stated += traced.noise.powi(2) * traced.penumbra as f64;
        actual += errors.iter().map(|e| e * e).sum::<f64>();
        signed += errors.iter().sum::<f64>();
        penumbra += traced.penumbra;
    }
    assert!(penumbra > 4000, "only {penumbra} receivers were in the penumbra");
    // Both are means over thousands of independent receivers: 5 % is three standard deviations.
    let ratio = (actual / stated).sqrt();
    assert!((ratio - 1.0).abs() < 0.05, "the noise is {ratio} times what is stated");
    // No bias: the errors' sum is a random walk.
    assert!(signed.abs() < 4.0 * actual.sqrt(), "{signed} against {}", actual.sqrt());
}

#[test]
fn noise_falls_faster_than_that_of_unstratified_rays() {
    let mut random = Random(4);
    let cases: Vec<Case> = (0..30).map(|_| random_case(&mut random, 100)).collect();
    let noise = |rays: u32| {
        let (mut squares, mut penumbra) = (0.0, 0);
        for case in &cases {
            let (_, traced) = compare(case, rays);
            squares += traced.noise.powi(2) * traced.penumbra as f64;
            penumbra += traced.penumbra;
        }
        (squares / f64::from(u32::try_from(penumbra).unwrap())).sqrt()
    };
    let (coarse, fine) = (noise(128), noise(2048));
    // 16 times the rays: 16^(3/4) = 8 where only an outline is noisy; unstratified rays give 4.
    let gain = coarse / fine;
    assert!((6.5..9.5).contains(&gain), "{coarse} to {fine} is a factor of {gain}");
}

#[test]
fn receivers_of_one_image_have_independent_errors() {
    let mut random = Random(11);
    let mut cases = (0..20)
        .map(|_| random_case(&mut random, 1))
        .map(|case| Case { receivers: vec![case.receivers[0]; 400], ..case });
    // The first whose receiver is well inside the penumbra.
    let (errors, traced) = cases
        .by_ref()
        .map(|case| compare(&case, 128))
        .find(|(_, traced)| (0.3..0.7).contains(&traced.visible[0]))
        .unwrap();
    let mean = errors.iter().sum::<f64>() / 400.0;
    // 1 in 16,000 for a normal law; errors that were alike would not average out at all.
    assert!(mean.abs() < 4.0 * traced.noise / 20.0, "{mean} against {}", traced.noise);
    let spread = (errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / 399.0).sqrt();
    // 400 samples tell a standard deviation to 3.5 %, twice over here: 20 % is four of those.
    assert!((spread / traced.noise - 1.0).abs() < 0.2, "{spread} against {}", traced.noise);
}

/// One grid is as good as half of two, on other numbers, and says nothing of its noise.
#[test]
fn one_grid_sends_half_the_rays_and_tells_no_noise() {
    let card =
        [[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]].map(|[x, z]| DVec3::new(x, 1.0, z));
    let scene = scene_of(&[(card, Role::Occluder)], Some(ceiling()));
    let tracer = Tracer::new(&scene).unwrap();
    let receivers: Vec<_> = (0..200).map(|i| on_floor(f64::from(i) * 0.01 - 0.3, 0.2)).collect();
    for (side, rays) in [(1, 1), (2, 4), (8, 64)] {
        let sampling = Sampling::one_grid(side, 3).unwrap();
        assert_eq!(sampling.rays(), rays);
        let traced = tracer.visible_fractions(ceiling(), &receivers, &sampling).unwrap();
        assert!(traced.noise.is_nan());
        let error = |(v, r): (&f32, &Receiver)| {
            f64::from(*v) - visible_fraction_of_quad(&ceiling(), card, r.position)
        };
        let errors: Vec<f64> = traced.visible.iter().zip(&receivers).map(error).collect();
        // Unbiased: each receiver's standard error is at most ½, and the mean is over 200 of them.
        let mean = errors.iter().sum::<f64>() / 200.0;
        assert!(mean.abs() < 4.0 * 0.5 / 200f64.sqrt() / rays as f64, "{rays}: {mean}");
    }
    assert!(Sampling::one_grid(0, 1).is_err() && Sampling::one_grid(1025, 1).is_err());
}
