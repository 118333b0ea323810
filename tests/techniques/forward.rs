//! Ray marching at fragments as they are drawn, beside the node's at the G-buffer's pixels.

use antumbra::scene::{Instance, Role, Scene, generate};
use antumbra_harness::{Forward, HeadlessDevice, View};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, model, percent};

fn seen(scene: &Scene) -> Setup<'_> {
    let extent = [320, 240];
    let view = View::of(&scene.camera.unwrap(), extent);
    Setup { scene, view, extent, window: None, occluders_seen: true }
}

/// The images of both.
fn images(device: &HeadlessDevice, setup: &Setup, words: &str) -> [Vec<f32>; 2] {
    let mut stage = setup.stage(device, words);
    let plan = stage.plan(setup.light(), setup.window).unwrap();
    let keep = |i: &Instance| setup.occluders_seen || i.role != Role::Occluder;
    let mut forward = Forward::new(device, stage, plan, setup.scene, keep).unwrap();
    forward.run().unwrap();
    [forward.deferred_visibility().unwrap(), forward.visibility().unwrap()]
}

/// By how much pixels differ that are in shadow in either image: the worst, the mean, and how many by more
/// than rounding.
fn apart([a, b]: &[Vec<f32>; 2]) -> (f32, f32, usize) {
    let pairs = || a.iter().zip(b).filter(|(a, b)| **a < 1.0 || **b < 1.0);
    let differences = || pairs().map(|(a, b)| (a - b).abs());
    let worst = differences().fold(0.0, f32::max);
    let mean = differences().sum::<f32>() / pairs().count().max(1) as f32;
    (worst, mean, differences().filter(|d| *d > 1e-5).count())
}

/// The planes of flat receivers are the same by a fragment's derivatives and by its neighbours' depths, and
/// so are then the rays, but for some that graze a column: of those a pixel of 16 has no more than one.
#[test]
fn forward_and_deferred_images_agree_on_flat_receivers() {
    let device = device();
    let spheres = generate::spheres(generate::square_light(0.4).unwrap());
    let suzanne = model("suzanne");
    for (name, setup) in
        [("spheres", Setup::ground(&spheres, 2.2, 160)), ("suzanne", seen(&suzanne))]
    {
        for more in
            ["", "classify=off", "layers=2 sampling=jittered hash=md5", "projection=orthographic"]
        {
            let words = format!("technique=ray-march map=128 rays=16 filter=off {more}");
            let (worst, mean, differ) = apart(&images(&device, &setup, &words));
            println!("{name} {more}: {differ} differ, worst {worst:.1e}, mean {mean:.1e}");
            assert!(worst <= 1.0 / 16.0 + 1e-5 && mean <= 1e-4, "{name} {more}: {worst}, {mean}");
        }
    }
}

/// Where a box shadows itself, what differs is beside an edge: where the facet that a pixel shows goes on for
/// two pixels around it, which is as far as the G-buffer's plane is looked for, the images are the same but for
/// the planes' rounding, which the part of the light above a plane passes on.
#[test]
fn forward_and_deferred_images_differ_beside_edges_alone() {
    let device = device();
    let light = generate::square_light(1.0).unwrap();
    let scene = generate::tall_box(light).with_occluders_as(Role::Both);
    let extent = [320, 240];
    let camera = antumbra::scene::Camera::framing(&scene, 4.0 / 3.0);
    let view = View::of(&camera, extent);
    let setup = Setup { scene: &scene, view, extent, window: None, occluders_seen: true };
    let words = "technique=ray-march map=128 rays=16 filter=off";
    let both = images(&device, &setup, words);
    let stage = setup.stage(&device, words);
    let (normals, roles) = (stage.gbuffer().normals().unwrap(), stage.gbuffer().roles().unwrap());
    let (width, height) = (extent[0] as i32, extent[1] as i32);
    let at = |x: i32, y: i32| (y * width + x) as usize;
    let within = |x: i32, y: i32| {
        let own = at(x, y);
        (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (x + dx, y + dy))).all(|(x, y)| {
            (0..width).contains(&x)
                && (0..height).contains(&y)
                && normals[at(x, y)] == normals[own]
                && roles[at(x, y)] == roles[own]
        })
    };
    let inner: Vec<usize> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .filter(|(x, y)| within(*x, *y))
        .map(|(x, y)| at(x, y))
        .collect();
    let chosen = [0, 1].map(|i: usize| inner.iter().map(|p| both[i][*p]).collect::<Vec<f32>>());
    let shadowed = chosen[0].iter().filter(|v| **v < 1.0).count();
    let (worst, mean, differ) = apart(&chosen);
    println!("{differ} of {shadowed} within facets, worst {worst:.1e}; in all {:?}", apart(&both));
    assert!(shadowed > 2000 && worst <= 1.0 / 16.0 + 1e-5 && mean <= 1e-4, "{worst} {mean}");
}

/// The bunny's facets are as small as pixels, and the G-buffer's depth often does not tell a pixel's plane.
/// A fragment knows its own, so that the forward image is the nearer one to the truth. How far they are apart
/// is what the deferred one loses by that, and more than rays at random would make of it is a fault.
#[test]
fn forward_is_no_further_from_the_truth() {
    let device = device();
    let bunny = model("bunny");
    let setup = seen(&bunny);
    let words = "technique=ray-march map=256 rays=64 filter=off";
    let both = images(&device, &setup, words);
    let (truth, _) = setup.traced(&setup.stage(&device, words), 256);
    let errors = [0, 1].map(|i: usize| percent(&truth, &both[i]));
    let (_, mean, differ) = apart(&both);
    println!(
        "deferred {:.2} %, forward {:.2} %; {differ} differ, mean {mean:.4}",
        errors[0], errors[1]
    );
    assert!(mean <= 0.02, "{mean}");
    assert!(errors[1] <= errors[0], "{errors:?}");
}

#[test]
fn what_forward_evaluation_cannot_do_is_refused() {
    let device = device();
    let spheres = generate::spheres(generate::square_light(0.4).unwrap());
    let setup = Setup::ground(&spheres, 2.2, 16);
    for words in
        ["technique=ray-march layers=3", "technique=ray-march search=linear", "technique=pcss"]
    {
        let mut stage = setup.stage(&device, words);
        let plan = stage.plan(setup.light(), None).unwrap();
        let made = Forward::new(&device, stage, plan, &spheres, |_| true);
        let problem = made.err().unwrap().to_string();
        assert!(problem.contains("search=hierarchical"), "{words}: {problem}");
    }
    let words = "technique=ray-march";
    let plan = setup.stage(&device, words).plan(setup.light(), None).unwrap();
    let made = Forward::new(&device, setup.stage(&device, words), plan, &spheres, |_| true);
    assert!(made.is_err(), "another node's plan");
}
