//! Discs, which many-lights and ray-march take among the techniques with maps, and how far from the truth they are.

use antumbra::scene::{Scene, generate};
use antumbra::{Light, RectangleLight};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, as_measured, percent};
use glam::DVec3;

fn card(light: impl Into<Light>) -> Scene {
    generate::card(light)
}

fn disc(radius: f64) -> Light {
    Light::disc(DVec3::Y * 4.0, DVec3::NEG_Y, radius).unwrap()
}

/// The mean error in percent for 64 and 256 points, as measured on lavapipe.
const MEASURED: [f64; 2] = [1.14, 0.45];

#[test]
fn many_lights_are_a_disc() {
    let device = device();
    let scene = card(disc(0.5));
    let setup = Setup::ground(&scene, 2.2, 128);
    let mut truth = None;
    for (samples, measured) in [64, 256].into_iter().zip(MEASURED) {
        let words = format!("technique=many-lights samples={samples}");
        let mut stage = setup.stage(&device, &words);
        let image = setup.visibility(&mut stage);
        let (truth, _) = truth.get_or_insert_with(|| setup.traced(&stage, 2048));
        let error = percent(truth, &image);
        println!("{samples} points: {error:.2} %");
        assert!(as_measured(error, measured), "{samples} points: {error} %, not {measured}");
    }
}

/// Rays go to points of the disc, and what of it lies below a pixel's own plane is a segment.
#[test]
fn rays_go_to_a_disc() {
    let device = device();
    let scene = card(disc(0.5));
    let setup = Setup::ground(&scene, 2.2, 128);
    let square = RectangleLight::facing(DVec3::Y * 4.0, DVec3::NEG_Y, DVec3::X, [1.0; 2]).unwrap();
    let mut truths = None;
    for (sampling, most) in [("low-discrepancy", 0.5), ("jittered", 0.6), ("random", 1.0)] {
        let words = format!("technique=ray-march map=512 rays=64 sampling={sampling}");
        let mut stage = setup.stage(&device, &words);
        let image = setup.visibility(&mut stage);
        let traced = |light| Setup { scene: &card(light), ..setup }.traced(&stage, 2048).0;
        let truths = truths.get_or_insert_with(|| [disc(0.5), square.into()].map(traced));
        let [right, wrong] = truths.each_ref().map(|truth| percent(truth, &image));
        println!("{sampling}: {right:.2} %, of the square around it {wrong:.2} %");
        assert!(right < most && wrong > 2.0 * right, "{sampling}: {right} {wrong}");
    }
}

/// A disc a tenth too wide, and the square around the disc, are further from what many points see than the disc itself.
#[test]
fn a_wrong_disc_is_noticed() {
    let device = device();
    let scene = card(disc(0.5));
    let setup = Setup::ground(&scene, 2.2, 96);
    let mut stage = setup.stage(&device, "technique=many-lights samples=256");
    let image = setup.visibility(&mut stage);
    let square = RectangleLight::facing(DVec3::Y * 4.0, DVec3::NEG_Y, DVec3::X, [1.0; 2]).unwrap();
    let [right, wide, square] = [disc(0.5), disc(0.55), square.into()].map(|light| {
        let (truth, _) = Setup { scene: &card(light), ..setup }.traced(&stage, 2048);
        percent(&truth, &image)
    });
    println!("{right:.2} %; too wide {wide:.2} %, square {square:.2} %");
    assert!(wide > 2.0 * right && square > 2.0 * right, "{right} {wide} {square}");
}
