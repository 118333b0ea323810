//! Suns: no technique takes them for anything but a light.

use antumbra::scene::{Scene, generate};
use antumbra::{Light, RectangleLight};
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

/// Many lights go to the directions of a sun's disc, and not of the square around it, however large the sphere is that it
/// is said to shine on: a rectangle as far away as that would be lost in rounding.
#[test]
fn many_lights_are_a_suns_disc() {
    let device = device();
    let down = DVec3::new(0.2, -1.0, 0.1);
    let under = |light: Light| -> Scene { generate::card(light) };
    let mut images = Vec::new();
    for radius in [3.0, 3e5] {
        let scene = under(Light::sun(down, 0.2, DVec3::ZERO, radius).unwrap());
        let setup = Setup::ground(&scene, 2.2, 96);
        let mut stage = setup.stage(&device, "technique=many-lights samples=256 map=512");
        let image = setup.visibility(&mut stage);
        let square = under(RectangleLight::sun(down, 0.2, DVec3::ZERO, 3.0).unwrap().into());
        let [right, wrong] = [&scene, &square].map(|scene| {
            let (truth, _) = Setup { scene, ..setup }.traced(&stage, 2048);
            percent(&truth, &image)
        });
        println!("{radius:e} m: {right:.2} %, of the square {wrong:.2} %");
        assert!(right < 0.7 && wrong > 2.0 * right, "{radius}: {right} {wrong}");
        images.push(image);
    }
    let differ = percent(&images[0], &images[1]);
    assert!(differ < 0.01, "{differ} %");
}
