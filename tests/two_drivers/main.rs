//! The same numbers through two drivers: what compute passes make of them, bit by bit or within a few of the last ones.
//!
//! Rasters place edges differently in the last digits, so both drivers get the depth layers and the G-buffer
//! of one of them.
//!
//! A program of its own: it opens both drivers by their names whatever `ANTUMBRA_DRIVER` says, and so runs once.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra::scene::{Scene, generate};
use antumbra::stages::depth_layers::fit_occluders;
use antumbra::{OccluderMaps, Scope};
use antumbra_harness::{HeadlessDevice, HeadlessOptions, OwnedImage};
use antumbra_tests::measure::{Setup, settings};
use antumbra_tests::skip;
use ash::vk;

const MAP: u32 = 96;

/// Depth as one driver drew it: the layers, and what the pixels show.
struct Drawn {
    layers: [Vec<f32>; 2],
    pixels: Vec<f32>,
}

fn open(driver: &str) -> Result<HeadlessDevice, antumbra::Error> {
    HeadlessDevice::new(&HeadlessOptions { driver: Some(driver.into()), ..Default::default() })
}

fn draw(device: &HeadlessDevice, setup: &Setup) -> Drawn {
    let mut stage = setup.stage(device, &format!("technique=ray-march layers=2 map={MAP}"));
    let plan = stage.plan(setup.light(), None).unwrap();
    stage.run(&plan).unwrap();
    let layers = ["depth_layers.front_depth", "depth_layers.back_depth"]
        .map(|name| stage.inspect::<f32>(&plan, name).unwrap().0);
    let layout = Scope::DEPTH_DRAWN.layout;
    Drawn { layers, pixels: stage.gbuffer().depth.read(layout).unwrap() }
}

/// The visible fraction by the settings, from what was drawn.
fn computed(device: &HeadlessDevice, setup: &Setup, drawn: &Drawn, words: &str) -> Vec<f32> {
    let words = format!("{words} map={MAP}");
    let mut stage = setup.stage(device, &words);
    let light = setup.light();
    let blockers: Vec<_> = stage
        .instances()
        .iter()
        .filter(|m| m.role.blocks())
        .map(|m| (m.bounds, m.world_from_mesh))
        .collect();
    let view = fit_occluders(&light, &blockers, None, MAP).unwrap();
    let read = Scope::COMPUTE_SAMPLED;
    let image = |texels: &[f32], extent| {
        let (format, usage) = (vk::Format::D32_SFLOAT, vk::ImageUsageFlags::SAMPLED);
        let image = OwnedImage::new(device, "depth", format, extent, usage).unwrap();
        image.write(texels, read.layout).unwrap();
        image
    };
    let maps = drawn.layers.each_ref().map(|layer| image(layer, [MAP; 2]));
    let pixels = image(&drawn.pixels, setup.extent);
    let maps = OccluderMaps {
        front: maps[0].lend(read, read),
        back: Some(maps[1].lend(read, read)),
        clip_from_world: view.clip_from_light() * light.light_from_world(),
    };
    stage
        .configure_with(settings(&words), |d| d.occluder_maps = Some(vk::Format::D32_SFLOAT))
        .unwrap();
    let plan = stage
        .plan_with(light, |f| {
            f.occluder_maps = Some(maps);
            f.depth = pixels.lend(read, read);
        })
        .unwrap();
    stage.run(&plan).unwrap();
    stage.visibility().unwrap()
}

/// What technique and settings may differ by. Rays are stopped or not by comparisons, and not one is otherwise.
/// The filter weighs pixels by `exp`, whose last digits are each driver's own; divisions may be 2.5 units of
/// the last place off, which shows in the last digit of few sums of micro-patches and in no ray.
const CASES: [(&str, f32); 5] = [
    ("technique=ray-march filter=off", 0.0),
    ("technique=ray-march filter=off sampling=jittered hash=md5", 0.0),
    ("technique=ray-march filter=off levels=mip sampling=random", 0.0),
    ("technique=ray-march", 4e-6),
    ("technique=soft-shadow-map", 4e-6),
];

#[test]
fn rays_give_the_same_bits_on_both_drivers_and_sums_differ_in_the_last_ones() {
    let drivers = ["llvmpipe", "SwiftShader"];
    let [a, b] = match drivers.map(open) {
        [Ok(a), Ok(b)] => [a, b],
        [a, b] => {
            let missing: Vec<String> =
                [a.err(), b.err()].into_iter().flatten().map(|error| error.to_string()).collect();
            return skip(&missing.join("; "));
        }
    };
    let light = || generate::square_light(0.4).unwrap();
    let scenes: [(&str, Scene); 2] =
        [("spheres", generate::spheres(light())), ("foliage", generate::foliage(light(), 100, 3))];
    for (name, scene) in &scenes {
        let setup = Setup::ground(scene, 2.2, 96);
        let drawn = draw(&a, &setup);
        for (words, bound) in CASES {
            let images = [&a, &b].map(|device| computed(device, &setup, &drawn, words));
            let pairs = || images[0].iter().zip(&images[1]);
            let differ = pairs().filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            let most = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(images[0].iter().any(|v| *v < 0.9), "{name}, {words}: nothing is shadowed");
            println!(
                "{name}, {words}: {differ} of {} differ, by up to {most:.1e}",
                images[0].len()
            );
            assert!(most <= bound, "{name}, {words}: {most}");
        }
    }
}
