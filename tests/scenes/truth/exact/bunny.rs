//! A scanned model: the tracer against exact, on the ground and on the model itself.

use super::*;
use antumbra::scene::from_gltf;
use antumbra::truth::{Sampling, Traced, Tracer};
use std::path::Path;

/// The number of receivers, half of them on the ground.
const POINTS: usize = 1000;

/// The number of times that each receiver is traced.
const SEEDS: u64 = 4;

pub struct Bunny {
    pub scene: Scene,
    pub light: RectangleLight,
    pub receivers: Vec<Receiver>,
}

impl Bunny {
    pub fn new() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
        let scene = from_gltf(&root.join("bunny.glb")).unwrap();
        let light = *scene.lights[0].light.rectangle();
        let mut random = Random(61);
        // The part of the ground that its shadow is on.
        let ground = (0..POINTS / 2).map(|_| Receiver {
            position: DVec3::new(random.within(-1.4, 0.6), 0.0, random.within(-0.6, 1.5)),
            normal: DVec3::Y,
        });
        let mut receivers: Vec<Receiver> = ground.collect();
        let mut surface = Surface::of(&scene);
        while receivers.len() < POINTS {
            let receiver = surface.random_receiver(&mut random);
            // The others are in their own shadow, whatever else there is.
            if receiver.normal.dot(light.center() - receiver.position) > 0.0 {
                receivers.push(receiver);
            }
        }
        Self { scene, light, receivers }
    }

    fn exact(&self, light: &RectangleLight) -> Vec<f64> {
        let exact = Exact::new(&self.scene).unwrap();
        exact.visible_fractions(&PolygonLight::from(light), &self.receivers).unwrap()
    }

    /// The fractions of the receivers, traced a few times with independent random numbers.
    pub fn traced(&self, rays: u32) -> Vec<Traced> {
        let tracer = Tracer::new(&self.scene).unwrap();
        let sampling = |seed| Sampling::new(rays, seed).unwrap();
        let of = |seed| tracer.visible_fractions(self.light, &self.receivers, &sampling(seed));
        (0..SEEDS).map(|seed| of(seed).unwrap()).collect()
    }
}

/// The triangles of the mesh that both blocks and receives.
struct Surface {
    triangles: Vec<[DVec3; 3]>,
    largest: f64,
}

impl Surface {
    fn of(scene: &Scene) -> Self {
        let instance = scene.instances.iter().find(|i| i.role == Role::Both).unwrap();
        let corners: Vec<DVec3> = scene.world_positions(|i| i.role == Role::Both).collect();
        let corner = |&i: &u32| corners[i as usize];
        let triangles: Vec<[DVec3; 3]> = scene.meshes[instance.mesh]
            .indices
            .chunks_exact(3)
            .map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])])
            .collect();
        let largest = triangles.iter().map(|t| Self::normal(t).length()).fold(0.0, f64::max);
        Self { triangles, largest }
    }

    fn normal([a, b, c]: &[DVec3; 3]) -> DVec3 {
        (b - a).cross(c - a)
    }

    /// A receiver on a random triangle, each as likely as its area, by rejection.
    fn random_receiver(&mut self, random: &mut Random) -> Receiver {
        loop {
            let i = random.within(0.0, self.triangles.len() as f64) as usize;
            let [a, b, c] = self.triangles[i];
            let normal = Self::normal(&[a, b, c]);
            if normal.length() >= random.within(0.0, self.largest) {
                let [u, v] = [(); 2].map(|()| random.within(0.0, 1.0));
                let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
                return Receiver { position: a + (b - a) * u + (c - a) * v, normal };
            }
        }
    }
}

/// Traced − exact in units of the noise that the tracer states.
pub struct Deviation {
    pub worst: f64,
    pub rms: f64,
    pub mean: f64,
    /// The number of receivers in the exact penumbra, which the figures are over.
    pub penumbra: usize,
}

pub fn deviation(traced: &[Traced], exact: &[f64]) -> Deviation {
    let penumbra = |v: f64| v > 0.0 && v < 1.0;
    let noise = stated_noise(traced);
    let errors: Vec<f64> = traced
        .iter()
        .flat_map(|traced| traced.visible.iter().zip(exact))
        .filter(|(_, exact)| penumbra(**exact))
        .map(|(traced, exact)| (f64::from(*traced) - exact) / noise)
        .collect();
    let mean = |sum: f64| sum / errors.len() as f64;
    Deviation {
        worst: errors.iter().fold(0.0, |worst, e| worst.max(e.abs())),
        rms: mean(errors.iter().map(|e| e * e).sum()).sqrt(),
        mean: mean(errors.iter().sum()),
        penumbra: errors.len() / traced.len(),
    }
}

/// The root mean square of what each image states.
pub fn stated_noise(traced: &[Traced]) -> f64 {
    (traced.iter().map(|traced| traced.noise.powi(2)).sum::<f64>() / traced.len() as f64).sqrt()
}

#[test]
fn traced_is_exact_within_the_noise_it_states_on_a_thousand_points() {
    let bunny = Bunny::new();
    let exact = bunny.exact(&bunny.light);
    let noise = [128, 512, 2048].map(|rays| {
        let traced = bunny.traced(rays);
        let noise = stated_noise(&traced);
        let Deviation { worst, rms, mean, penumbra } = deviation(&traced, &exact);
        println!(
            "{rays} rays, {penumbra} in the penumbra, noise {noise:.2e}: worst {worst:.2}, \
             rms {rms:.3}, mean {mean:+.3} standard errors"
        );
        assert!(penumbra > 250, "only {penumbra} receivers were in the penumbra");
        // A thousand errors of unlike outlines tell their root mean square, and a thousand half
        // differences the noise, to some 3 % each.
        assert!((rms - 1.0).abs() < 0.1, "the noise is {rms} times what is stated");
        // The noise is a mean over outlines; few are three times as long as that, and few errors
        // are above three of their own standard errors.
        assert!(worst < 6.0, "{worst} standard errors");
        let errors = penumbra as f64 * SEEDS as f64;
        assert!(mean.abs() < 4.0 * rms / errors.sqrt(), "a bias of {mean}");
        // Full light and full umbra have no noise, and no slack either.
        for traced in &traced {
            let pairs = traced.visible.iter().zip(&exact);
            for (&traced, &exact) in pairs.filter(|(_, exact)| [0.0, 1.0].contains(*exact)) {
                assert_eq!(f64::from(traced), exact);
            }
        }
        noise
    });
    // Four times the rays: 4^(3/4) = 2.8 where outlines are long beside the strata, 2 without any.
    for gain in noise.windows(2).map(|pair| pair[0] / pair[1]) {
        assert!((2.4..3.3).contains(&gain), "{noise:?}");
    }
}

#[test]
fn a_light_a_hundredth_too_big_is_noticed() {
    let bunny = Bunny::new();
    let [width, height] = bunny.light.half_extents();
    let axes = bunny.light.world_from_light();
    let [x, y] = [DVec3::X * width, DVec3::Y * height].map(|v| axes.transform_vector3(v) * 1.01);
    // Emission is −(u × v).
    let bigger = RectangleLight::new(bunny.light.center(), x, -y).unwrap();
    assert!((bigger.emission() - bunny.light.emission()).length() < 1e-12);
    let off = deviation(&bunny.traced(8192), &bunny.exact(&bigger));
    assert!(off.rms > 1.5, "{} standard errors", off.rms);
}
