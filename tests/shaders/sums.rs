//! Blended and gathered sums against the f64 sum of the twin, over the same depth map.

use antumbra::FramePlan;
use antumbra::graph::Pass;
use antumbra::scene::{Scene, generate};
use antumbra::techniques::soft_shadow_map::twin::{
    OccluderMap, back_or_front, backs_of_mean, occlusion, sloped_occlusion, slopes,
};
use antumbra::techniques::soft_shadow_map::{Blocks, GatherMap, GatherPixels, PatchDraw};
use antumbra_harness::{ReadbackScheme, Stage};
use antumbra_tests::measure::Setup;
use antumbra_tests::{TestDevice, device};
use glam::DVec3;

/// What both accumulations must reach.
const BOUND: f64 = 2e-5;

/// What sloped sums must reach with the default tolerance: the closed form keeps slopes to the first order alone, as of
/// planes (measured 3.1e-4).
const SERIES_OF_SLOPES: f64 = 1e-3;

/// Receiver texels that are checked, of each map.
const CHECKED: usize = 96;

fn scenes() -> Vec<(&'static str, Scene)> {
    let light = || generate::square_light(0.4).unwrap();
    vec![
        ("card", generate::card(light())),
        ("spheres", generate::spheres(light())),
        ("contact", generate::contact(light())),
        ("slats", generate::slats(light(), 24)),
        ("foliage", generate::foliage(light(), 300, 7)),
    ]
}

fn pass<'a>(plan: &'a FramePlan, name: &str) -> &'a Pass {
    plan.plan().graph.passes().iter().find(|p| p.name == name).unwrap()
}

fn push<T: bytemuck::AnyBitPattern>(pass: &Pass) -> T {
    bytemuck::pod_read_unaligned(pass.push.bytes())
}

/// Where a receiver texel lies, and where its sum is.
struct Grid {
    scale: [f32; 2],
    t_step: [f32; 2],
    t_first: [f32; 2],
    receiver_inv_near: f32,
}

fn grid_of(plan: &FramePlan, accumulate: &str) -> Grid {
    if accumulate == "gather" {
        let p: GatherMap = push(pass(plan, "soft_shadow_map.gather_front"));
        let GatherMap { scale, t_step, t_first, receiver_inv_near, .. } = p;
        Grid { scale, t_step, t_first, receiver_inv_near }
    } else {
        let p: PatchDraw = push(pass(plan, "soft_shadow_map.blend_front"));
        let PatchDraw { scale, t_step, t_first, receiver_inv_near, .. } = p;
        Grid { scale, t_step, t_first, receiver_inv_near }
    }
}

/// The largest |error| over the checked texels, relative to a sum above 1, and the largest sum; of the
/// front map, or of the back map by pairs.
fn worst_error(stage: &mut Stage, setup: &Setup, accumulate: &str, pairs: bool) -> (f64, f64) {
    let plan = stage.plan(setup.light(), None).unwrap();
    stage.run(&plan).unwrap();
    let (depth, [side, _]) = stage.inspect::<f32>(&plan, "depth_layers.front_depth").unwrap();
    let (receivers, [receiver_side, _]) =
        stage.inspect::<f32>(&plan, "depth_layers.receiver_depth").unwrap();
    let name = if pairs { "soft_shadow_map.back_map" } else { "soft_shadow_map.front_map" };
    let (sums, _) = stage.inspect::<f32>(&plan, name).unwrap();
    let blocks: Blocks = push(pass(&plan, "soft_shadow_map.blocks"));
    let grid = grid_of(&plan, accumulate);
    let w: Vec<f32> = depth.iter().map(|d| d * blocks.inv_near).collect();
    let backs = pairs.then(|| {
        let (depth, _) = stage.inspect::<f32>(&plan, "depth_layers.back_depth").unwrap();
        let w_of = |d: &f32| if *d == 1.0 { 0.0 } else { d * blocks.inv_near };
        let back: Vec<f32> = depth.iter().map(w_of).collect();
        backs_of_mean(&w, &back, side as usize)
    });

    // A low-discrepancy walk over the texels that are in some shadow, and a few that are not.
    let shadowed: Vec<usize> = (0..sums.len()).filter(|&i| sums[i] > 0.0).collect();
    assert!(shadowed.len() > CHECKED, "nothing is shadowed");
    let golden = 0.618_033_988_749_895;
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for n in 0..CHECKED {
        let share = (n as f64 * golden).fract();
        let index = if n % 16 == 15 {
            (share * sums.len() as f64) as usize
        } else {
            shadowed[(share * shadowed.len() as f64) as usize]
        };
        if receivers[index] == 0.0 {
            assert_eq!(sums[index], 0.0, "a texel without a receiver");
            continue;
        }
        let p = [index % receiver_side as usize, index / receiver_side as usize];
        let t = [0, 1].map(|i| grid.t_first[i] + p[i] as f32 * grid.t_step[i]);
        let w_r = receivers[index] * grid.receiver_inv_near;
        let paired = backs.as_ref().map(|backs| back_or_front(&w, backs, w_r));
        let w = paired.as_ref().unwrap_or(&w);
        let exact = occlusion(&OccluderMap { w, side: side as usize, scale: grid.scale }, t, w_r);
        worst = worst.max((f64::from(sums[index]) - exact).abs() / exact.max(1.0));
        largest = largest.max(exact);
    }
    (worst, largest)
}

/// Sides of the maps: the largest in two scenes of far and near occluders.
fn sides_of(device: &TestDevice, scene: &str) -> &'static [u32] {
    // SwiftShader blends 512² maps for minutes; the sums are the same additions.
    let fewer = device.leaves_to_others("sums of maps of 512²");
    if fewer || !["spheres", "foliage"].contains(&scene) {
        &[64, 100, 256]
    } else {
        &[64, 100, 256, 512]
    }
}

#[test]
fn gathered_sums_are_the_exact_sums() {
    let device = device();
    for (name, scene) in scenes() {
        let setup = Setup::ground(&scene, 2.2, 32);
        for &side in sides_of(&device, name) {
            let words =
                format!("receivers=map map={side} receiver_map={side} tolerance=0 sides=one");
            let mut stage = setup.stage(&device, &words);
            let (worst, largest) = worst_error(&mut stage, &setup, "gather", false);
            println!("{name}, N = {side}: gather {worst:.1e} of sums up to {largest:.3}");
            assert!(worst <= BOUND, "{name}, N = {side}: {worst:.2e}");
        }
    }
}

/// Each texel's back face where it lies before the receiver, its front face where not.
#[test]
fn pairs_are_gathered_exactly() {
    let device = device();
    let light = || generate::square_light(0.4).unwrap();
    let mut scenes = scenes();
    scenes.push(("tall box", generate::tall_box(light())));
    for (name, scene) in scenes {
        let setup = Setup::ground(&scene, 2.2, 32);
        for (side, tolerance) in [(64, 0.0), (100, 0.0), (128, 1e-3)] {
            let words = format!(
                "receivers=map map={side} receiver_map={side} tolerance={tolerance} sides=mean"
            );
            let mut stage = setup.stage(&device, &words);
            let (worst, largest) = worst_error(&mut stage, &setup, "gather", true);
            println!("{name}, N = {side}, {tolerance}: pairs {worst:.1e} of up to {largest:.3}");
            assert!(worst <= tolerance + BOUND, "{name}, N = {side}: {worst:.2e}");
        }
    }
}

/// At the pixels of a ground that blocks nothing, the visible fraction is what the sloped patches leave.
#[test]
fn sloped_sums_at_the_pixels_are_the_exact_sums() {
    let device = device();
    let (half, pixels_a_side) = (2.2, 48);
    // Not the G-buffer's positions: SwiftShader interpolates them with a relative error of 2.6e-4.
    let centre =
        |pixel: u32| (f64::from(pixel) + 0.5) * 2.0 * half / f64::from(pixels_a_side) - half;
    for (name, scene) in scenes() {
        let setup = Setup::ground(&scene, half, pixels_a_side);
        let to_light = setup.light().light_from_world();
        for (side, tolerance) in [(64, 0.0), (100, 0.0), (128, 1e-4)] {
            let words = format!("map={side} tolerance={tolerance} sides=one");
            let mut stage = setup.stage(&device, &words);
            let plan = stage.plan(setup.light(), None).unwrap();
            stage.run(&plan).unwrap();
            let visible = stage.visibility().unwrap();
            let (depth, _) = stage.inspect::<f32>(&plan, "depth_layers.front_depth").unwrap();
            let blocks: Blocks = push(pass(&plan, "soft_shadow_map.blocks"));
            let pixels: GatherPixels = push(pass(&plan, "soft_shadow_map.gather_pixels"));
            let w: Vec<f32> = depth.iter().map(|d| d * blocks.inv_near).collect();
            let slopes = slopes(&w, side);
            let map = OccluderMap { w: &w, side, scale: pixels.scale };
            let (mut worst, mut sloped) = (0.0f64, 0.0f64);
            for (v, pixel) in visible.iter().zip(0..).step_by(7) {
                let [x, z] = [pixel % pixels_a_side, pixel / pixels_a_side].map(centre);
                let p = to_light.transform_point3(DVec3::new(x, 0.0, z));
                let w_r = (1.0 / p.z) as f32;
                let place = |i: usize, x: f64| {
                    (x / p.z * f64::from(pixels.texels_per_uv[i]) + f64::from(pixels.first[i]))
                        as f32
                };
                let t = [place(0, p.x), place(1, p.y)];
                let exact = sloped_occlusion(&map, &slopes, t, w_r);
                let flat = occlusion(&map, t, w_r);
                worst = worst.max((f64::from(*v) - (1.0 - exact.clamp(0.0, 1.0))).abs());
                sloped = sloped.max((exact.clamp(0.0, 1.0) - flat.clamp(0.0, 1.0)).abs());
            }
            println!(
                "{name}, N = {side}, {tolerance}: {worst:.1e}; slopes make up to {sloped:.1e}"
            );
            let bound = if tolerance == 0.0 { BOUND } else { SERIES_OF_SLOPES };
            assert!(worst <= bound, "{name}, N = {side}: {worst:.2e}");
            let curved = ["spheres", "contact"].contains(&name);
            assert!(!curved || sloped > 0.01, "{name}, N = {side}: slopes do nothing");
        }
    }
}

#[test]
fn the_tolerance_is_kept() {
    let device = device();
    for (name, scene) in scenes() {
        let setup = Setup::ground(&scene, 2.2, 32);
        for tolerance in [1e-5, 1e-4, 1e-3, 1e-2, 1e-1] {
            let words =
                format!("receivers=map map=128 receiver_map=128 sides=one tolerance={tolerance}");
            let mut stage = setup.stage(&device, &words);
            let (worst, _) = worst_error(&mut stage, &setup, "gather", false);
            println!("{name}, tolerance {tolerance}: {worst:.1e}");
            assert!(worst <= tolerance + BOUND, "{name}, {tolerance}: {worst:.2e}");
        }
    }
}

#[test]
fn blended_sums_are_the_exact_sums() {
    let device = device();
    for (name, scene) in scenes() {
        let setup = Setup::ground(&scene, 2.2, 32);
        for &side in sides_of(&device, name) {
            let words =
                format!("receivers=map map={side} receiver_map={side} sides=one accumulate=blend");
            let mut stage = setup.stage(&device, &words);
            let (worst, largest) = worst_error(&mut stage, &setup, "blend", false);
            println!("{name}, N = {side}: blend {worst:.1e} of sums up to {largest:.3}");
            assert!(worst <= BOUND, "{name}, N = {side}: {worst:.2e}");
        }
    }
}

/// The paper's own scheme, its rectangles made by the processor from the depth that it read back,
/// gives the sums of the scheme that leaves all of that to the device.
#[test]
fn rectangles_of_the_processor_give_the_same_sums() {
    let device = device();
    for (name, scene) in scenes() {
        let setup = Setup::ground(&scene, 2.5, 16);
        for (map, receiver_map) in [(64, 64), (100, 77)] {
            let words = format!(
                "receivers=map sides=one accumulate=blend map={map} receiver_map={receiver_map}"
            );
            let mut stage = setup.stage(&device, &words);
            let plan = stage.plan(setup.light(), None).unwrap();
            stage.run(&plan).unwrap();
            let (blended, _) = stage.inspect::<f32>(&plan, "soft_shadow_map.front_map").unwrap();
            let mut scheme = ReadbackScheme::new(&device, &scene, map, receiver_map).unwrap();
            let times = scheme.run(&setup.light(), None).unwrap();
            assert!(times.patches > 0 && blended.iter().any(|&o| o > 0.5), "{name}: no shadow");
            let read_back = scheme.occlusion().unwrap();
            for (&own, &other) in blended.iter().zip(&read_back) {
                // Sums up to 1 are exact in any order. Where patches overlap to more than that, a
                // thousand additions round to 2^-23 each, blocks here and rows there.
                let bound = if own <= 1.0 { 0.0 } else { 1000.0f32.sqrt() * f32::EPSILON };
                let difference = (own - other).abs();
                assert!(difference <= bound, "{name}, {words}: {difference:e} at {own}");
            }
        }
    }
}
