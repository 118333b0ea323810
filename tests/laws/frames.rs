//! What holds of every frame: same bits, no allocation, bounds, nothing where nothing blocks.

use antumbra::scene::{Instance, Role, Scene, generate};
use antumbra_harness::{HeadlessDevice, Stage, View};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, settings};
use glam::{DMat4, DVec3};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Every way from settings to an image.
const WAYS: &[&str] = &[
    "receivers=pixels sides=one map=64",
    "receivers=pixels sides=bottom map=64",
    "receivers=pixels sides=two map=65",
    "receivers=pixels sides=mean map=65",
    "receivers=map sides=two map=33 receiver_map=47",
    "receivers=map sides=mean map=33 receiver_map=47",
    "receivers=map sides=two accumulate=blend map=64 receiver_map=40",
    "receivers=map sides=one accumulate=blend-fp16 map=16 receiver_map=16",
    "technique=hard map=64",
    "technique=pcss map=65",
    "technique=back-projection map=50",
    "technique=many-lights samples=30 map=33",
    "technique=ray-march map=64",
    "technique=ray-march map=50 rays=9 levels=mip layers=2 hash=md5 sampling=random",
    "technique=ray-march map=65 levels=thirds projection=orthographic filter=off",
    "technique=ray-march map=64 search=linear projection=centre sampling=low-discrepancy",
    "technique=occlusion-textures map=64",
    "technique=occlusion-textures map=65 slices=32 prefilter=n-buffer placement=uniform",
    "technique=occlusion-textures map=50 slices=5 prefilter=mip fill=on",
    "technique=occlusion-textures map=64 slices=7 combine=product placement=uniform",
    "technique=occlusion-textures map=33 slices=20 combine=sum prefilter=n-buffer",
    "technique=occlusion-textures map=64 combine=max prefilter=mip",
    "technique=linear-light map=64 lines=2 samples=4",
    "technique=linear-light map=33 samples=2 lines=1 transition=linear",
];

fn spheres() -> Scene {
    generate::spheres(generate::square_light(0.6).unwrap())
}

fn bits(image: &[f32]) -> Vec<u32> {
    image.iter().map(|v| v.to_bits()).collect()
}

/// One node a way, which sees one scene after the other: the same bits twice and from another node, within bounds and
/// up to both, nothing where nothing blocks, and nothing on what receives nothing.
#[test]
fn every_way_keeps_the_laws() {
    let device = device();
    let scene = spheres();
    let setup = Setup::ground(&scene, 2.5, 96);
    for words in WAYS {
        let mut stage = setup.stage(&device, words);
        let image = setup.visibility(&mut stage);
        let first = bits(&image);
        assert_eq!(first, bits(&setup.visibility(&mut stage)), "{words}: the same node");
        let mut other = setup.stage(&device, words);
        assert_eq!(first, bits(&setup.visibility(&mut other)), "{words}: another node");
        drop(other);
        within_bounds_and_up_to_both(words, &image);
        lit_where_nothing_blocks(words, &mut stage);
        spares_what_receives_nothing(words, &mut stage, &scene);
        // And back again.
        let keep = |i: &Instance| i.role != Role::Occluder;
        stage.show(&scene, &setup.view, keep).unwrap();
        assert_eq!(first, bits(&setup.visibility(&mut stage)), "{words}: after other scenes");
    }
}

fn within_bounds_and_up_to_both(words: &str, image: &[f32]) {
    assert!(image.iter().all(|v| (0.0..=1.0).contains(v)), "{words}");
    let (least, most) = image.iter().fold((1.0_f32, 0.0_f32), |(a, b), v| (a.min(*v), b.max(*v)));
    assert_eq!(most, 1.0, "{words}: no lit pixel");
    assert!(least < 0.3, "{words}: no shadow, at least {least}");
}

fn lit_where_nothing_blocks(words: &str, stage: &mut Stage) {
    // Occluders behind the light, and none at all.
    let light = || generate::square_light(0.5).unwrap();
    let mut above = generate::card(light());
    above.instances[1].world_from_mesh = DMat4::from_translation(DVec3::new(0.0, 9.0, 0.0));
    let none = generate::stage(light());
    // What is lit already, and stays so, takes no pass.
    let cases: [(_, _, &[&str]); 2] =
        [("behind the light", &above, &["visibility.lit"]), ("no occluder", &none, &[])];
    for (name, scene, runs) in cases {
        let setup = Setup::ground(scene, 3.0, 96);
        stage.show(scene, &setup.view, |i| i.role != Role::Occluder).unwrap();
        let plan = stage.plan(setup.light(), None).unwrap();
        let ran: Vec<_> =
            plan.plan().steps.iter().map(|s| plan.plan().graph.passes()[s.pass].name).collect();
        assert_eq!(ran, runs, "{name}, {words}: nothing is drawn");
        assert!(setup.visibility(stage).iter().all(|v| *v == 1.0), "{name}, {words}");
    }
}

/// Pixels of a mesh that is only an occluder receive nothing, and neither does the background.
fn spares_what_receives_nothing(words: &str, stage: &mut Stage, scene: &Scene) {
    let camera = antumbra::scene::Camera::framing(scene, 1.0);
    let extent = [96, 96];
    let view = View::of(&camera, extent);
    let setup = Setup { scene, view, extent, window: None, occluders_seen: true };
    stage.show(scene, &view, |_| true).unwrap();
    let image = setup.visibility(stage);
    let roles = stage.gbuffer().roles().unwrap();
    let spared = image.iter().zip(&roles).filter(|(_, r)| **r == 0);
    let (mut count, mut wrong) = (0, 0);
    for (v, _) in spared {
        count += 1;
        wrong += usize::from(*v != 1.0);
    }
    assert!(count > 100 && wrong == 0, "{words}: {wrong} of {count}");
}

/// A scene moved 20 km away looks as it does at the origin: everything on the GPU is relative to the
/// light. World positions of vertices are exact here, so only matrices in f64 carry the distance.
#[test]
fn a_scene_far_from_the_origin_looks_the_same() {
    let device = device();
    let near = generate::card(generate::square_light(0.5).unwrap());
    let offset = DVec3::new(20_000.0, -3_000.0, 11_000.0);
    let mut far = near.clone();
    for instance in &mut far.instances {
        instance.world_from_mesh = DMat4::from_translation(offset) * instance.world_from_mesh;
    }
    let l = *near.light(None).unwrap().light.rectangle();
    let [a, b] = l.half_extents();
    let frame = l.world_from_light();
    let (x, y) = (frame.x_axis.truncate() * a, frame.y_axis.truncate() * b);
    let moved = antumbra::RectangleLight::new(l.center() + offset, x, -y).unwrap();
    far.lights[0].light = moved.into();
    for words in ["receivers=pixels map=128", "receivers=map map=128 receiver_map=128"] {
        let here = Setup::ground(&near, 2.5, 96);
        let mut there = Setup::ground(&far, 2.5, 96);
        there.view =
            View { clip_from_world: here.view.clip_from_world * DMat4::from_translation(-offset) };
        let first = here.visibility(&mut here.stage(&device, words));
        let second = there.visibility(&mut there.stage(&device, words));
        let worst = first.iter().zip(&second).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // f64 holds 2e4 m to 4e-12 m: after the subtraction that is far under a float's own step.
        assert!(worst < 1e-5, "{words}: {worst:.1e}");
    }
}

/// The largest map is within what every device binds, its blocks without prefix sums included: it and
/// one of half the side agree but for the texels' size. The pixels lie as close as an image's do: four
/// that are far apart open more of the map than Mesa's loop limit lets through at this size.
#[test]
fn the_largest_map_works() {
    let device = device();
    let scene = spheres();
    let setup = Setup::ground(&scene, 0.1, 24);
    let image = |side: u32| {
        let mut stage = setup.stage(&device, &format!("receivers=pixels sides=one map={side}"));
        let plan = stage.plan(setup.light(), None).unwrap();
        for resource in plan.plan().graph.resources() {
            if let antumbra::graph::Shape::Buffer { bytes } = resource.shape {
                assert!(bytes <= 1 << 27, "{}: {bytes} bytes", resource.name);
            }
        }
        setup.visibility(&mut stage)
    };
    let (large, half) = (image(4096), image(2048));
    let mean =
        large.iter().zip(&half).map(|(a, b)| (a - b).abs()).sum::<f32>() / large.len() as f32;
    let seen = half.iter().sum::<f32>() / half.len() as f32;
    println!("N = 4096 against 2048: {mean:.1e} where {seen:.2} of the light is seen");
    assert!(seen < 0.95, "nothing is shadowed there");
    assert!(mean < 2e-3, "{mean}");
}

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// Counts the thread's allocations.
struct Counting;

// SAFETY: every call is passed on to the system's allocator as it came.
#[expect(unsafe_code, reason = "counting allocations takes an allocator")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|a| a.set(a.get() + 1));
        // SAFETY: the caller's promise, passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// `record` allocates nothing of its own. A driver may allocate for the commands; that is counted by
/// recording the same commands with nothing of the node's in between, which no test can do, so the
/// count is taken inside the process: drivers in C and C++ do not come through Rust's allocator.
#[test]
fn recording_allocates_nothing_and_makes_no_object() {
    // Without the validation layer: its messages are Rust strings of the test's own.
    let device: HeadlessDevice = HeadlessDevice::new(&Default::default()).unwrap();
    let scene = spheres();
    let setup = Setup::ground(&scene, 2.5, 64);
    for words in WAYS {
        let mut stage: Stage = setup.stage(&device, words);
        let plan = stage.plan(setup.light(), None).unwrap();
        stage.run(&plan).unwrap();
        let objects = stage.node().unwrap().object_count();
        let mut counted = 0;
        device
            .submit_and_wait(|cmd| {
                let before = ALLOCATIONS.with(Cell::get);
                stage.node()?.record(cmd, &plan)?;
                counted = ALLOCATIONS.with(Cell::get) - before;
                Ok(())
            })
            .unwrap();
        assert_eq!(counted, 0, "{words}: allocations while recording");
        assert_eq!(stage.node().unwrap().object_count(), objects);
    }
    // The counter counts.
    let before = ALLOCATIONS.with(Cell::get);
    drop(std::hint::black_box(vec![1u8; 100]));
    assert_eq!(ALLOCATIONS.with(Cell::get) - before, 1);
}

#[test]
fn bad_frames_are_refused_before_anything_is_recorded() {
    let device = device();
    let scene = spheres();
    let setup = Setup::ground(&scene, 2.5, 64);
    let mut stage = setup.stage(&device, "map=32");
    let plan = stage.plan(setup.light(), None).unwrap();
    // A window the wrong way round.
    let error = stage.plan(setup.light(), Some([[1.0; 2], [-1.0; 2]])).unwrap_err().to_string();
    assert!(error.contains("least first"), "{error}");
    // A plan of other settings.
    stage.configure(settings("receivers=map map=32")).unwrap();
    let error = stage.run(&plan).unwrap_err().to_string();
    assert!(error.contains("plan the frame again"), "{error}");
    let good = stage.plan(setup.light(), None).unwrap();
    stage.run(&good).unwrap();
}

/// A mirrored occluder casts what its unmirrored twin casts: its faces are told apart right.
#[test]
fn a_mirrored_mesh_casts_the_same_shadow() {
    let device = device();
    let scene = generate::tall_box(generate::square_light(1.0).unwrap());
    let mut mirrored = scene.clone();
    for instance in mirrored.instances.iter_mut().filter(|i| i.role == Role::Occluder) {
        instance.world_from_mesh *= DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    }
    let words = "receivers=pixels sides=two map=64";
    let image = |scene: &Scene| {
        let setup = Setup::ground(scene, 2.0, 64);
        setup.visibility(&mut setup.stage(&device, words))
    };
    let (a, b) = (image(&scene), image(&mirrored));
    let worst = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    // The box is its own mirror image; what is left is how a raster rounds mirrored edges.
    assert!(worst < 0.02, "{worst}");
}
