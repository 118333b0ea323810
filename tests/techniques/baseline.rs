//! What users would pick instead: their laws, and how far from the truth each is.

use antumbra::RectangleLight;
use antumbra::scene::{Role, generate};
use antumbra_harness::View;
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, as_measured, model, percent, summary};
use glam::{DMat4, DVec3};

/// Many lights against the closed form. Two errors: the points, whose stratified mean is off by at most
/// n^(−3/4)/√2 in its standard error for a convex outline (see `truth::Sampling`), about 0.8 of that in
/// the mean |error|; and the map, whose texel moves an edge by up to half its width, evenly and apart
/// from point to point, which the mean over the points takes out but for what is the same in all of
/// them.
#[test]
fn many_lights_come_to_the_closed_form() {
    let device = device();
    let lights: [(&str, RectangleLight); 3] = [
        ("square", generate::square_light(0.4).unwrap()),
        ("4:1", generate::rectangle_light(0.8, 0.2, 0.0).unwrap()),
        ("tilted 20°", generate::rectangle_light(0.5, 0.3, 20f64.to_radians()).unwrap()),
    ];
    for (name, light) in lights {
        let scene = generate::card(light);
        let setup = Setup::ground(&scene, 3.5, 96);
        // Many more tell whether it comes closer, which is the same for any outline.
        let counts: &[u32] = if name == "square" { &[64, 256, 1024] } else { &[64, 256] };
        for &n in counts {
            let words = format!("technique=many-lights samples={n} map=256");
            let mut stage = setup.stage(&device, &words);
            let truth = setup.closed_form_of_card(&stage);
            let error = percent(&truth, &setup.visibility(&mut stage));
            let points = 80.0 * 0.5f64.sqrt() * f64::from(n).powf(-0.75);
            println!("card, {name} light, {n} points: {error:.3} %, points allow {points:.3}");
            assert!(error <= points + 0.2, "{name}, {n}: {error:.3} %");
        }
    }
}

/// Settings, and the mean error in percent on the card, the spheres and the bunny.
type Row = (&'static str, [f64; 3]);

/// Measured on lavapipe. What explains them:
/// * a hard shadow has no penumbra at all, and a finer map does not help;
/// * with few taps PCSS has their noise, which n^(−1/2) … n^(−3/4) takes away: on the card, whose blockers
///   lie all at one distance, that is all it has, on the others it comes to the error of one distance for
///   all blockers, 4 %;
/// * back-projection has none where all texels lie at one distance; elsewhere its texels overlap, which
///   it leaves: 2 % too dark in the mean, at any side of the map;
/// * many lights have the points' noise, and on the bunny pixels on creases and edges, whose plane the
///   G-buffer's depth does not tell: with 256 points and N = 2048 they err by 1.00 % in 320×240 and by
///   0.52 % in 960×720, where those are a third of the pixels they were.
const TABLE: &[Row] = &[
    ("technique=hard", [12.05, 15.05, 12.38]),
    ("technique=hard map=1024", [13.31, 16.71, 13.12]),
    ("technique=pcss taps=8", [2.85, 6.21, 6.05]),
    ("technique=pcss taps=16", [1.54, 4.88, 4.99]),
    ("technique=pcss taps=32", [0.87, 4.28, 4.46]),
    ("technique=pcss taps=64 map=512", [0.51, 4.05, 4.20]),
    ("technique=back-projection map=64", [0.20, 2.90, 4.50]),
    ("technique=back-projection map=128", [0.20, 2.26, 3.63]),
    ("technique=back-projection map=256", [0.20, 2.04, 3.61]),
    ("technique=many-lights samples=64", [0.80, 1.18, 1.86]),
    ("technique=many-lights samples=256", [0.38, 0.52, 1.42]),
    // Beside them, the node's own.
    ("technique=soft-shadow-map map=128", [0.20, 0.76, 2.16]),
    ("technique=soft-shadow-map map=256", [0.20, 0.46, 1.74]),
    ("technique=ray-march", [0.49, 1.44, 2.03]),
    ("technique=ray-march rays=64", [0.30, 0.88, 1.62]),
    ("technique=ray-march rays=256", [0.23, 0.60, 1.48]),
    ("technique=occlusion-textures slices=4", [0.20, 2.50, 4.56]),
    ("technique=occlusion-textures", [0.20, 1.96, 2.13]),
    ("technique=occlusion-textures slices=32", [0.20, 1.03, 1.99]),
];

#[test]
fn errors_are_what_they_were_measured_to_be() {
    let device = device();
    let light = || generate::square_light(0.4).unwrap();
    let scenes = [generate::card(light()), generate::spheres(light()), model("bunny")];
    let mut problems = Vec::new();
    for (n, (scene, name)) in scenes.iter().zip(["card", "spheres", "bunny"]).enumerate() {
        let setup = if name == "bunny" {
            let extent = [320, 240];
            let view = View::of(&scene.camera.unwrap(), extent);
            Setup { scene, view, extent, window: None, occluders_seen: true }
        } else {
            Setup::ground(scene, 2.2, 160)
        };
        let mut truth = None;
        for (words, measured) in TABLE {
            let mut stage = setup.stage(&device, words);
            let image = setup.visibility(&mut stage);
            let (truth, noise) = truth.get_or_insert_with(|| setup.traced(&stage, 512));
            let s = summary(truth, &image);
            let line = format!(
                "{name}, {words}: mean {:.2} %, bias {:.2}, p99 {:.3}, on lit pixels {:.3} % \
                 (truth's noise {:.2} points)",
                100.0 * s.mean_abs_error,
                100.0 * s.bias,
                s.p99,
                100.0 * s.lit_error,
                100.0 * *noise
            );
            println!("{line}");
            // Acne would show on the lit pixels.
            if !as_measured(100.0 * s.mean_abs_error, measured[n]) || s.lit_error > 0.001 {
                problems.push(line);
            }
        }
    }
    assert!(problems.is_empty(), "not as measured:\n{}", problems.join("\n"));
}

/// A wall beside the ground that reaches up to the light's plane is nearer than all other blockers, and hides none of the
/// light from the ground: PCSS looks for blockers no further aside than those that are there can lie, so that it misses
/// none for the wall.
#[test]
fn pcss_finds_blockers_whatever_stands_beside_the_light() {
    let device = device();
    let light = generate::square_light(0.4).unwrap();
    let alone = generate::card(light);
    let height = light.center().y;
    let mut beside = alone.clone();
    let at = DMat4::from_translation(DVec3::new(3.2, 0.5 * height, 0.0));
    beside.add("wall", generate::cuboid(DVec3::new(0.1, height, 1.0)), at, Role::Both);
    let setups = [&alone, &beside].map(|scene| Setup::ground(scene, 2.2, 160));
    for words in ["technique=pcss taps=64 map=1024", "technique=pcss taps=64 map=1024 classify=off"]
    {
        let mut stages = setups.each_ref().map(|setup| setup.stage(&device, words));
        // The closed form is the card's; the wall's shadow falls beside the image.
        let truth = setups[0].closed_form_of_card(&stages[0]);
        let [plain, other] =
            [0, 1].map(|i: usize| percent(&truth, &setups[i].visibility(&mut stages[i])));
        println!("{words}: {plain:.2} %, beside a wall {other:.2} %");
        assert!(plain < 0.6 && other < 2.0, "{words}: {plain:.2} %, {other:.2} %");
    }
}

/// A light of a two-thousandth of the occluders' size is a point to all of them. What is left is how each
/// draws an edge: a filter of three texels is off by ¾ of a texel along it, a comparison with one texel by
/// up to ½ more. A sphere spans a quarter of the map, so its outline is 4/64 of its area a texel at N = 256:
/// 1¼ · 4/64 = 8 %, and a quarter of that at four times N.
#[test]
fn all_come_to_the_hard_shadow_as_the_light_shrinks() {
    let device = device();
    let scene = generate::spheres(generate::square_light(0.0005).unwrap());
    let setup = Setup::ground(&scene, 2.2, 160);
    for map in [256, 1024] {
        let image = |words: &str| {
            setup.visibility(&mut setup.stage(&device, &format!("{words} map={map}")))
        };
        let hard = image("technique=hard");
        for words in SMALL {
            let other = image(words);
            let apart = hard.iter().zip(&other).map(|(a, b)| (a - b).abs()).sum::<f32>();
            let shadow = hard.iter().map(|v| 1.0 - v).sum::<f32>();
            let share = 100.0 * apart / shadow;
            println!("{words}, N = {map}: {share:.2} % of the hard shadow");
            assert!(share < 8.0 * 256.0 / map as f32, "{words}, N = {map}: {share:.2} %");
        }
    }
}

const SMALL: &[&str] = &[
    "technique=pcss",
    "technique=back-projection",
    "technique=many-lights samples=16",
    "receivers=pixels",
];

/// One point in the middle of the light and a hard shadow map see the same: they differ where the filter
/// mixes texels, and nowhere else.
#[test]
fn one_light_is_the_hard_shadow() {
    let device = device();
    let scene = generate::spheres(generate::square_light(0.6).unwrap());
    let setup = Setup::ground(&scene, 2.2, 160);
    let image = |words: &str| setup.visibility(&mut setup.stage(&device, words));
    let hard = image("technique=hard");
    let one = image("technique=many-lights samples=1 seed=0");
    let sharp = hard.iter().zip(&one).filter(|(h, _)| **h == 0.0 || **h == 1.0);
    let (mut count, mut wrong) = (0, 0);
    for (h, o) in sharp {
        count += 1;
        wrong += usize::from(h != o);
    }
    assert!(count > 160 * 150 && wrong == 0, "{wrong} of {count}");
}
