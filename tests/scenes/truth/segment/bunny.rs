//! A scanned model under a line: the tracer against the exact fraction.

use super::*;
use crate::truth::exact::bunny::{Bunny, Deviation, deviation, stated_noise};

/// The model's own light without its height, three times as long.
fn under_a_line() -> Bunny {
    let bunny = Bunny::new();
    let light = line(&bunny.light, 3.0);
    Bunny { light, ..bunny }
}

/// The middle of a light along its x, of that length times `longer`.
fn line(light: &RectangleLight, longer: f64) -> RectangleLight {
    let half = DVec3::X * light.half_extents()[0] * longer;
    let half = light.world_from_light().transform_vector3(half);
    RectangleLight::line(light.center(), half, light.emission()).unwrap()
}

fn exact(bunny: &Bunny, light: &RectangleLight) -> Vec<f64> {
    let exact = ExactLine::new(&bunny.scene).unwrap();
    exact.visible_fractions(light, &bunny.receivers).unwrap()
}

#[test]
fn traced_is_exact_within_the_noise_it_states_on_a_thousand_points() {
    let bunny = under_a_line();
    let exact = exact(&bunny, &bunny.light);
    let noise = [128, 2048].map(|rays| {
        let traced = bunny.traced(rays);
        let noise = stated_noise(&traced);
        let Deviation { worst, rms, mean, penumbra } = deviation(&traced, &exact);
        println!(
            "{rays} rays, {penumbra} in the penumbra, noise {noise:.2e}: worst {worst:.2}, \
             rms {rms:.3}, mean {mean:+.3} standard errors"
        );
        assert!(penumbra > 250, "only {penumbra} receivers were in the penumbra");
        assert!((rms - 1.0).abs() < 0.1, "the noise is {rms} times what is stated");
        assert!(worst < 6.0, "{worst} standard errors");
        let errors = penumbra as f64 * 4.0;
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
    // 16 times the rays are 16 times the parts of the length, and each end of an interval is noisy in one of them.
    let gain = noise[0] / noise[1];
    assert!((14.0..18.0).contains(&gain), "{noise:?}");
}

#[test]
fn a_wrong_light_is_noticed() {
    let bunny = under_a_line();
    let traced = bunny.traced(8192);
    let longer = line(&bunny.light, 1.01);
    let world = bunny.light.world_from_light();
    let half = world.transform_vector3(DVec3::X * bunny.light.half_extents()[0]);
    let there = world.transform_point3(DVec3::Y * 0.003);
    let aside = RectangleLight::line(there, half, bunny.light.emission()).unwrap();
    for wrong in [longer, aside] {
        let off = deviation(&traced, &exact(&bunny, &wrong));
        println!("{:.2} standard errors", off.rms);
        assert!(off.rms > 1.5, "{} standard errors", off.rms);
    }
}
