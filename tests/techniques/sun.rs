//! Suns: no technique takes them for anything but a light.

use antumbra::RectangleLight;
use antumbra::scene::generate;
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, model, percent};
use glam::DVec3;

/// A sun of 0.53° and one of 3°: no technique is worse than where the light is near.
#[test]
fn a_sun_is_a_light_like_others() {
    let device = device();
    for degrees in [0.53f64, 3.0] {
        let down = DVec3::new(0.3, -1.0, 0.2);
        let sun = RectangleLight::sun(down, degrees.to_radians(), DVec3::Y * 2.0, 0.8).unwrap();
        let scene = generate::normalized(&model("bunny"), sun).unwrap();
        let setup = Setup::ground(&scene, 1.6, 160);
        let mut truth = None;
        for (words, most) in SUN {
            let mut stage = setup.stage(&device, &format!("{words} map=512"));
            let image = setup.visibility(&mut stage);
            let (truth, noise) = truth.get_or_insert_with(|| setup.traced(&stage, 256));
            let error = percent(truth, &image);
            let narrow = truth.iter().filter(|v| **v > 0.0 && **v < 1.0).count();
            println!(
                "{degrees}°, {words}: {error:.2} %, noise {:.2} points, {narrow} pixels in penumbra",
                100.0 * *noise
            );
            assert!(narrow > 100 && error < *most, "{words}: {error}");
        }
    }
}

/// Settings, and the most that the mean error may be, in percent: a third more than measured.
const SUN: &[(&str, f64)] = &[
    ("technique=occlusion-textures", 0.5),
    ("technique=occlusion-textures slices=4", 0.7),
    ("technique=ray-march rays=64", 0.9),
    ("technique=soft-shadow-map", 0.8),
    ("technique=pcss", 2.4),
    ("technique=many-lights", 0.5),
];
