//! Occluder maps that the host drew: whatever their depth convention, window and format, they give
//! what the node's own layers give.

use antumbra::scene::{Scene, generate};
use antumbra::stages::depth_layers::{MapView, fit_occluders};
use antumbra::{HostImage, OccluderMaps, Scope};
use antumbra_harness::{HeadlessDevice, OwnedImage, Stage};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, settings};
use ash::vk;
use glam::{DMat4, DVec4};

const SIDE: u32 = 64;

/// How a host keeps depth: what it stores is a + b·w.
struct Convention {
    name: &'static str,
    format: vk::Format,
    /// a, and b over the near plane's distance, for a near and a far distance.
    depth: fn(f64, f64) -> [f64; 2],
    /// Signs of x and y.
    axes: [f64; 2],
}

const CONVENTIONS: [Convention; 4] = [
    Convention {
        name: "reversed, infinite: the node's own",
        format: vk::Format::D32_SFLOAT,
        depth: |_, _| [0.0, 1.0],
        axes: [1.0, 1.0],
    },
    Convention {
        name: "reversed, finite, y up",
        format: vk::Format::D32_SFLOAT,
        depth: |near, far| [1.0 - far / (far - near), far / (far - near)],
        axes: [1.0, -1.0],
    },
    Convention {
        name: "standard, finite, both mirrored",
        format: vk::Format::D32_SFLOAT,
        depth: |near, far| [far / (far - near), -far / (far - near)],
        axes: [-1.0, -1.0],
    },
    Convention {
        name: "standard, finite, 16 bits",
        format: vk::Format::D16_UNORM,
        depth: |near, far| [far / (far - near), -far / (far - near)],
        axes: [1.0, -1.0],
    },
];

/// A layer of the node's as a host of this convention would have drawn it.
fn as_drawn(
    device: &HeadlessDevice,
    layer: &[f32],
    (a, b): (f64, f64),
    nothing: f32,
    convention: &Convention,
) -> OwnedImage {
    let near_or_far = if (b > 0.0) == (nothing == 0.0) { 0.0 } else { 1.0 };
    let stored = |&near_w: &f32| {
        if near_w == nothing { near_or_far } else { a + b * f64::from(near_w) }
    };
    let n = SIDE as usize;
    let flipped = |i: usize, sign: f64| if sign > 0.0 { i } else { n - 1 - i };
    let [x, y] = convention.axes;
    let texels: Vec<f64> =
        (0..n * n).map(|i| stored(&layer[flipped(i / n, y) * n + flipped(i % n, x)])).collect();
    let usage = vk::ImageUsageFlags::SAMPLED;
    let image = OwnedImage::new(device, "map", convention.format, [SIDE; 2], usage).unwrap();
    let layout = Scope::COMPUTE_SAMPLED.layout;
    if convention.format == vk::Format::D16_UNORM {
        let texels: Vec<u16> = texels.iter().map(|s| (s * 65535.0).round() as u16).collect();
        image.write(&texels, layout).unwrap();
    } else {
        let texels: Vec<f32> = texels.iter().map(|s| *s as f32).collect();
        image.write(&texels, layout).unwrap();
    }
    image
}

/// The matrix that such a host draws with.
fn camera(view: &MapView, (a, b): (f64, f64), convention: &Convention) -> DMat4 {
    let mut clip = view.clip_from_light();
    clip.z_axis.z = a;
    clip.w_axis.z = b * view.near;
    DMat4::from_diagonal(DVec4::new(convention.axes[0], convention.axes[1], 1.0, 1.0)) * clip
}

fn own_layers(stage: &mut Stage, setup: &Setup) -> (Vec<f32>, [Vec<f32>; 2]) {
    let plan = stage.plan(setup.light(), None).unwrap();
    stage.run(&plan).unwrap();
    let layer =
        |stage: &mut Stage, name| stage.inspect::<f32>(&plan, name).map(|(texels, _)| texels);
    let front = layer(stage, "depth_layers.front_depth").unwrap();
    // Where no back layer is drawn none is read either.
    let back = layer(stage, "depth_layers.back_depth").unwrap_or_else(|_| front.clone());
    (stage.visibility().unwrap(), [front, back])
}

fn difference(a: &[f32], b: &[f32]) -> (f64, f32) {
    let all = || a.iter().zip(b).map(|(a, b)| (a - b).abs());
    (all().map(f64::from).sum::<f64>() / a.len() as f64, all().fold(0.0, f32::max))
}

fn compare(scene: &Scene, words: &str, bounds: [f64; 4]) {
    let device = device();
    let setup = Setup::ground(scene, 2.5, 96);
    let words = format!("{words} map={SIDE}");
    let mut stage = setup.stage(&device, &words);
    let (own, layers) = own_layers(&mut stage, &setup);
    assert!(own.iter().any(|&v| v < 0.5), "{words}: nothing is shadowed");
    let light = setup.light();
    let blockers: Vec<_> = stage
        .instances()
        .iter()
        .filter(|m| m.role.blocks())
        .map(|m| (m.bounds, m.world_from_mesh))
        .collect();
    let view = fit_occluders(&light, &blockers, None, SIDE).unwrap();
    for (convention, bound) in CONVENTIONS.iter().zip(bounds) {
        let [a, b] = (convention.depth)(view.near, 1.1 * view.far);
        let map = |layer: &[f32], nothing| as_drawn(&device, layer, (a, b), nothing, convention);
        let images = [map(&layers[0], 0.0), map(&layers[1], 1.0)];
        let read = Scope::COMPUTE_SAMPLED;
        let [front, back]: [HostImage; 2] = [0, 1].map(|i: usize| images[i].lend(read, read));
        let maps = OccluderMaps {
            front,
            back: Some(back),
            clip_from_world: camera(&view, (a, b), convention) * light.light_from_world(),
        };
        stage
            .configure_with(settings(&words), |d| d.occluder_maps = Some(convention.format))
            .unwrap();
        let plan = stage.plan_with(light, |f| f.occluder_maps = Some(maps)).unwrap();
        stage.run(&plan).unwrap();
        let (mean, most) = difference(&own, &stage.visibility().unwrap());
        println!("{words}: {}: mean {mean:.1e}, most {most:.1e}", convention.name);
        assert!(mean <= bound, "{}: {mean}", convention.name);
    }
}

/// The same numbers in the same order give the same bits. Standard depth is coarser far away, so the
/// bias is larger; 16 bits are coarser by far, and lose what lies close to its receiver.
#[test]
fn at_the_pixels() {
    let spheres = generate::spheres(generate::square_light(0.6).unwrap());
    // Slopes are differences of neighbours, rounded to 1/256, which a last digit of depth may change.
    compare(&spheres, "receivers=pixels sides=two", [0.0, 1e-6, 1e-5, 1e-4]);
}

/// One comparison that comes out otherwise is a whole tap; none does here.
#[test]
fn by_comparison() {
    let spheres = generate::spheres(generate::square_light(0.6).unwrap());
    for technique in ["hard", "pcss", "back-projection"] {
        compare(&spheres, &format!("technique={technique}"), [0.0, 1e-8, 1e-7, 1e-5]);
    }
}

/// The soft shadow map takes no bias: occluders and receivers are apart.
#[test]
fn on_the_soft_shadow_map() {
    let spheres = generate::spheres(generate::square_light(0.6).unwrap());
    compare(&spheres, "receivers=map sides=two receiver_map=64", [0.0, 1e-8, 1e-7, 1e-5]);
}
