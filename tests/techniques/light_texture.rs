//! Lights that do not emit the same everywhere: rays and samples weigh what they emit, by color where the result is.

use antumbra::scene::{Scene, generate};
use antumbra::truth::visible_fraction_of_quad;
use antumbra::{Description, Error, Frame, Light, LightTexture, RectangleLight, Scope};
use antumbra_harness::{HeadlessDevice, OwnedImage, Stage};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent, settings};
use ash::vk;
use glam::DVec3;

const FORMAT: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// A texture of the light, row by row.
fn texture(device: &HeadlessDevice, extent: [u32; 2], texels: &[[f32; 4]]) -> OwnedImage {
    let usage = vk::ImageUsageFlags::SAMPLED;
    let image = OwnedImage::new(device, "light", FORMAT, extent, usage).unwrap();
    image.write(texels, Scope::COMPUTE_SAMPLED.layout).unwrap();
    image
}

/// A stage whose node takes a texture.
fn stage(device: &HeadlessDevice, setup: &Setup, words: &str, color: bool) -> Stage {
    let mut stage = setup.stage(device, words);
    let texture = Some(LightTexture { format: FORMAT, color });
    stage.configure_with(settings(words), |d| d.light_texture = texture).unwrap();
    stage
}

fn run(stage: &mut Stage, light: &RectangleLight, image: &OwnedImage) {
    let lent = image.lend(Scope::COMPUTE_SAMPLED, Scope::COMPUTE_SAMPLED);
    let plan = stage.plan_with(light, |frame| frame.light_texture = Some(lent)).unwrap();
    stage.run(&plan).unwrap();
}

/// The part of a light that a quadrant of its texture is.
fn quadrant(light: &RectangleLight, right: bool, bottom: bool) -> RectangleLight {
    let world = light.world_from_light();
    let [a, b] = light.half_extents();
    let half_u = world.x_axis.truncate() * (0.5 * a);
    // Light space has y against the second half-axis.
    let half_v = world.y_axis.truncate() * (-0.5 * b);
    let sign = |on: bool| if on { 1.0 } else { -1.0 };
    let centre: DVec3 = light.center() + half_u * sign(right) - half_v * sign(bottom);
    RectangleLight::new(centre, half_u, half_v).unwrap()
}

/// The exact fractions of a part of the light behind the card.
fn exact(setup: &Setup, stage: &Stage, part: &RectangleLight) -> Vec<f32> {
    let h = 0.5;
    let corners = [(-h, -h), (h, -h), (h, h), (-h, h)].map(|(x, z)| DVec3::new(x, 2.0, z));
    let fraction =
        |r: &antumbra::truth::Receiver| visible_fraction_of_quad(part, corners, r.position) as f32;
    let receivers = Setup::receivers(stage);
    assert_eq!(receivers.len(), (setup.extent[0] * setup.extent[1]) as usize);
    receivers.iter().map(fraction).collect()
}

/// All ways of the technique that tests triangles: by each number of samples, and by rays alone.
const TRACED: [&str; 4] = [
    "technique=traced",
    "technique=traced samples=256",
    "technique=traced samples=1024",
    "technique=traced leaves=1 samples=256 rays=256",
];

/// The most that their mean error may be, in percent.
const MOST: [f64; 4] = [2.5, 1.2, 0.6, 1.2];

fn card(light: RectangleLight) -> Scene {
    generate::card(light)
}

/// A texture that is white everywhere changes nothing.
#[test]
fn white_is_no_texture() {
    let device = device();
    let scene = card(generate::square_light(0.4).unwrap());
    let setup = Setup::ground(&scene, 2.2, 96);
    let white = texture(&device, [3, 5], &[[1.0; 4]; 15]);
    for words in ["technique=ray-march rays=64 filter=off"].iter().chain(&TRACED) {
        let plain = setup.visibility(&mut setup.stage(&device, words));
        let mut grey = stage(&device, &setup, words, false);
        run(&mut grey, &setup.light(), &white);
        let mut color = stage(&device, &setup, words, true);
        run(&mut color, &setup.light(), &white);
        let grey = grey.visibility().unwrap();
        let color = color.visibility_of_color().unwrap();
        assert!(plain.contains(&0.0) && plain.contains(&1.0));
        for ((v, g), c) in plain.iter().zip(&grey).zip(&color) {
            assert!((v - g).abs() < 1e-6, "{words}: {v}, {g}");
            let same = c.iter().take(3).all(|x| (x - g).abs() < 1e-6) && c[3] == 1.0;
            assert!(same, "{words}: {g}, {c:?}");
        }
    }
}

/// Each color comes from its own quadrant of the light, and is as visible as a light of that size there.
/// Rays go to a quarter of the light each, 64 of 256: their noise is 0.3 · 64^(−0.77) = 1.2 % before the
/// filter. Of 64 samples 16 are in a quarter.
#[test]
fn a_color_is_as_visible_as_its_part_of_the_light() {
    let device = device();
    let light = generate::rectangle_light(0.8, 0.5, 0.2).unwrap();
    let scene = card(light);
    let setup = Setup::ground(&scene, 2.6, 128);
    let [red, green, blue, black] =
        [[1.0, 0.0, 0.0, 1.0], [0.0, 2.0, 0.0, 1.0], [0.0, 0.0, 0.5, 1.0], [0.0; 4]];
    let image = texture(&device, [2, 2], &[red, green, blue, black]);
    for (words, bound) in
        [("technique=ray-march rays=256", 1.0)].into_iter().chain(TRACED.into_iter().zip(MOST))
    {
        let mut stage = stage(&device, &setup, words, true);
        run(&mut stage, &setup.light(), &image);
        let seen = stage.visibility_of_color().unwrap();
        for (channel, name, right, bottom) in
            [(0, "red", false, false), (1, "green", true, false), (2, "blue", false, true)]
        {
            let channel_of: Vec<f32> = seen.iter().map(|v| v[channel]).collect();
            let own = exact(&setup, &stage, &quadrant(&light, right, bottom));
            let other = exact(&setup, &stage, &quadrant(&light, !right, bottom));
            let (error, wrong) = (percent(&own, &channel_of), percent(&other, &channel_of));
            println!("{words}, {name}: {error:.2} %, against its neighbour's part {wrong:.2} %");
            assert!(error < bound, "{words}, {name}: {error:.2} %");
            assert!(wrong > 5.0 * error, "{words}, {name}: {wrong:.2} %");
        }
    }
}

/// Luminance: what is twice as bright counts twice, and black nothing.
#[test]
fn grey_weighs_by_luminance() {
    let device = device();
    let light = generate::rectangle_light(0.8, 0.5, 0.0).unwrap();
    let scene = card(light);
    let setup = Setup::ground(&scene, 2.6, 96);
    let image = texture(&device, [2, 1], &[[2.0; 4], [1.0; 4]]);
    for (words, bound) in
        [("technique=ray-march rays=256", 0.6)].into_iter().chain(TRACED.into_iter().zip(MOST))
    {
        let mut stage = stage(&device, &setup, words, false);
        run(&mut stage, &setup.light(), &image);
        let seen = stage.visibility().unwrap();
        let half = |right| {
            let [top, bottom] =
                [false, true].map(|b| exact(&setup, &stage, &quadrant(&light, right, b)));
            top.iter().zip(bottom).map(|(a, b)| 0.5 * (a + b)).collect::<Vec<f32>>()
        };
        let (left, right) = (half(false), half(true));
        let truth: Vec<f32> = left.iter().zip(&right).map(|(l, r)| (2.0 * l + r) / 3.0).collect();
        let error = percent(&truth, &seen);
        println!("{words}: two halves, one twice as bright: {error:.2} %");
        assert!(error < bound, "{words}: {error:.2} %");
    }
}

/// A sample counts for a mean over the light, into however many texels that is cut, and for nothing where a texel is below
/// 0 or no number.
#[test]
fn samples_count_for_means_of_the_texture() {
    let device = device();
    let light = generate::rectangle_light(0.8, 0.5, 0.0).unwrap();
    let scene = card(light);
    let setup = Setup::ground(&scene, 2.6, 64);
    let seen = |extent: [u32; 2], texels: &[[f32; 4]]| {
        let mut stage = stage(&device, &setup, "technique=traced", true);
        run(&mut stage, &setup.light(), &texture(&device, extent, texels));
        stage.visibility_of_color().unwrap()
    };
    let color = |dark: [f32; 4]| {
        move |i: u8| {
            if i % 7 == 3 {
                dark
            } else {
                [f32::from(i % 6), f32::from(i / 6), f32::from(i % 5), 0.0]
            }
        }
    };
    let few: Vec<[f32; 4]> = (0..24).map(color([0.0; 4])).collect();
    // Each texel as five by three.
    let more: Vec<_> = (0..12 * 30).map(|i: usize| few[i / 30 / 3 * 6 + i % 30 / 5]).collect();
    let base = seen([6, 4], &few);
    assert!(base.iter().any(|v| v[0] > 0.1 && v[0] < 0.9));
    let most = |other: &[[f32; 4]]| {
        let differences =
            base.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f32::max)
    };
    assert!(most(&seen([30, 12], &more)) < 1e-5);
    for dark in [-1.0, f32::NAN, f32::NEG_INFINITY] {
        let texels: Vec<_> = (0..24).map(color([dark; 4])).collect();
        assert_eq!(most(&seen([6, 4], &texels)), 0.0, "{dark}");
    }
    // A light that emits nothing of a color is visible in it.
    assert!(seen([1, 1], &[[0.0, 1.0, 0.0, 0.0]]).iter().all(|v| v[0] == 1.0 && v[2] == 1.0));
}

/// A texture on a disc counts where the disc is: that of the rectangle around it where it is white within.
#[test]
fn textures_lie_on_flat_lights() {
    let device = device();
    let light = generate::square_light(0.6).unwrap();
    let scene = card(light);
    let setup = Setup::ground(&scene, 2.2, 96);
    let place = setup.light();
    let white = texture(&device, [1, 1], &[[1.0; 4]]);
    let mut textured = stage(&device, &setup, "technique=traced", false);
    let mut plain = setup.stage(&device, "technique=traced");
    let disc = Light::disc(place.center(), place.emission(), 0.3).unwrap();
    let lent = white.lend(Scope::COMPUTE_SAMPLED, Scope::COMPUTE_SAMPLED);
    let plan = textured.plan_with(disc, |frame| frame.light_texture = Some(lent)).unwrap();
    textured.run(&plan).unwrap();
    let plan = plain.plan_with(disc, |_| ()).unwrap();
    plain.run(&plan).unwrap();
    let (textured_disc, plain) = (textured.visibility().unwrap(), plain.visibility().unwrap());
    let same = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-5;
    assert!(
        plain.iter().zip(&textured_disc).all(same) && plain.iter().any(|v| *v > 0.1 && *v < 0.9)
    );
    // Half of it emits: rays go to the disc's points, and the texture's texels lie where these are.
    let half = texture(&device, [2, 1], &[[1.0; 4], [0.0; 4]]);
    let lent = half.lend(Scope::COMPUTE_SAMPLED, Scope::COMPUTE_SAMPLED);
    let outline = [[-0.3, -0.3], [0.3, -0.3], [0.3, 0.0], [-0.3, 0.3]];
    let polygon = Light::with_outline(place, &outline).unwrap();
    for light in [disc, polygon] {
        let [truth, image] =
            ["technique=traced samples=1024", "technique=ray-march map=512 rays=256"].map(
                |words| {
                    let mut stage = stage(&device, &setup, words, false);
                    let plan = stage.plan_with(light, |f| f.light_texture = Some(lent)).unwrap();
                    stage.run(&plan).unwrap();
                    stage.visibility().unwrap()
                },
            );
        let error = percent(&truth, &image);
        println!("half a {}: {error:.2} %", light.shape().name());
        assert!(error < 1.0, "{}: {error}", light.shape().name());
    }
    let ball = Light::sphere(place.center(), 0.3).unwrap();
    let problem =
        textured.plan_with(ball, |frame| frame.light_texture = Some(lent)).unwrap_err().to_string();
    assert!(problem.contains("the light is a sphere, which is not flat"), "{problem}");
}

#[test]
fn what_cannot_be_weighed_is_refused() {
    let device = device();
    let scene = card(generate::square_light(0.4).unwrap());
    let setup = Setup::ground(&scene, 2.2, 32);
    let described = |words: &str, format| Description {
        technique: settings(words),
        light_texture: Some(LightTexture { format, color: true }),
        ..Description::new([32, 32])
    };
    let refused = |d: Description| d.check().unwrap_err().to_string();
    assert!(refused(described("map=64", FORMAT)).contains("choose ray-march or traced"));
    let depth = described("technique=ray-march", vk::Format::D32_SFLOAT);
    assert!(refused(depth).contains("holds no color"));
    let mut stage = stage(&device, &setup, "technique=ray-march", true);
    let missing = |frame: &mut Frame| frame.light_texture = None;
    let problem: Error = stage.plan_with(setup.light(), missing).unwrap_err();
    assert!(problem.to_string().contains("a light texture must be lent"), "{problem}");
}
