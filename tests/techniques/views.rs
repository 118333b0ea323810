//! Scenes that several views show: a room whose walls reach up to its lamp, and a yard under a sun.

use antumbra::scene::{AreaLight, Camera, Lens, Role, Scene, generate};
use antumbra::{Light, RectangleLight};
use antumbra_harness::{GBuffer, Stage, View};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent, settings};
use antumbra_tests::room;
use glam::{DMat3, DMat4, DVec3};

const EXTENT: [u32; 2] = [320, 240];

/// The size where an image is compared with another of the same pixels.
const SMALL: [u32; 2] = [160, 120];

/// A stage whose node is lent the triangles' normals, so that errors are those of maps.
fn stage(device: &antumbra_harness::HeadlessDevice, setup: &Setup, words: &str) -> Stage {
    let mut stage = setup.stage(device, words);
    stage.configure_with(settings(words), |d| d.normals = Some(GBuffer::NORMALS)).unwrap();
    stage
}

fn setup<'a>(scene: &'a Scene, camera: &Camera) -> Setup<'a> {
    of_extent(scene, camera, EXTENT)
}

fn of_extent<'a>(scene: &'a Scene, camera: &Camera, extent: [u32; 2]) -> Setup<'a> {
    let view = View::of(camera, extent);
    Setup { scene, view, extent, window: None, occluders_seen: true }
}

/// The room with a ceiling and all four walls, but for what the camera looks through.
fn closed_room() -> Scene {
    let mut scene = room::room();
    let mut block = |name: &str, size: [f64; 3], at: [f64; 3]| {
        let place = DMat4::from_translation(DVec3::from_array(at));
        scene.add(name, generate::cuboid(DVec3::from_array(size)), place, Role::Both);
    };
    block("ceiling", [4.0, 0.1, 4.0], [0.0, 2.65, 0.0]);
    block("right", [0.1, 2.6, 1.6], [2.05, 1.3, -1.2]);
    scene
}

/// A fence, a barrel and two sheds on 300 m of ground under a sun, as somebody who stands there sees them.
fn yard() -> (Scene, Camera) {
    let mut scene = Scene::default();
    scene.add("ground", generate::ground(300.0), DMat4::IDENTITY, Role::Both);
    let mut block = |name: &str, size: [f64; 3], at: [f64; 3]| {
        let place = DMat4::from_translation(DVec3::from_array(at));
        scene.add(name, generate::cuboid(DVec3::from_array(size)), place, Role::Both);
    };
    for i in 0..24 {
        block(&format!("picket {i}"), [0.06, 1.0, 0.02], [-1.8 + 0.16 * f64::from(i), 0.5, -2.0]);
    }
    block("rail", [4.0, 0.06, 0.03], [0.0, 0.8, -2.03]);
    block("barrel", [0.5, 0.8, 0.5], [-0.9, 0.4, -0.4]);
    block("near shed", [5.0, 3.0, 4.0], [-7.0, 1.5, -14.0]);
    block("far shed", [9.0, 5.0, 6.0], [30.0, 2.5, -70.0]);
    let sun = Light::sun(DVec3::new(0.5, -0.8, -0.35), 0.0093, DVec3::ZERO, 215.0).unwrap();
    scene.lights.push(AreaLight {
        name: "sun".into(),
        light: sun,
        color: [1.0; 3],
        intensity: 1.0,
    });
    let (eye, target) = (DVec3::new(1.2, 1.7, 3.0), DVec3::new(-0.3, 0.8, -2.0));
    (scene, looking(eye, target))
}

fn looking(eye: DVec3, target: DVec3) -> Camera {
    let z = (eye - target).normalize();
    let x = DVec3::Y.cross(z).normalize();
    let world_from_view =
        DMat4::from_translation(eye) * DMat4::from_mat3(DMat3::from_cols(x, z.cross(x), z));
    Camera { world_from_view, lens: Lens::Perspective { yfov: 0.9 }, near: 0.05 }
}

/// Settings; the mean error in percent that was measured in the room with four views, and in the yard.
const ERRORS: &[(&str, [f64; 2])] = &[
    ("technique=ray-march", [2.0, 6.0]),
    ("technique=soft-shadow-map map=256", [3.2, 10.0]),
    ("technique=occlusion-textures", [2.6, 5.6]),
    ("technique=pcss", [4.8, 6.0]),
    ("technique=hard", [12.0, 18.0]),
];

/// Each technique is nearer to the truth with four views than with one, and no further than was measured.
#[test]
fn rooms_and_yards_are_seen_finely_where_somebody_looks() {
    let device = device();
    let (yard, eye) = yard();
    let room = closed_room();
    let scenes = [(&room, room::camera(), "room"), (&yard, eye, "yard")];
    for (nth, (scene, camera, name)) in scenes.into_iter().enumerate() {
        let setup = setup(scene, &camera);
        let mut truth = None;
        for (words, most) in ERRORS {
            let errors = [1, 4].map(|views| {
                let mut stage = stage(&device, &setup, &format!("{words} views={views}"));
                let image = setup.visibility(&mut stage);
                let (truth, _) = truth.get_or_insert_with(|| setup.traced(&stage, 128));
                percent(truth, &image)
            });
            println!(
                "{name}, {words}: {:.2} % with one view, {:.2} % with four",
                errors[0], errors[1]
            );
            assert!(errors[1] <= most[nth], "{name}, {words}: {errors:?}");
            assert!(errors[1] < 0.8 * errors[0], "{name}, {words}: {errors:?}");
        }
    }
}

/// Many lights have a map for each direction of a sun's disc in each view; the error that is left is of the pickets.
#[test]
fn many_lights_see_a_yard_through_views() {
    let device = device();
    let (yard, eye) = yard();
    let setup = setup(&yard, &eye);
    let errors = [1, 4].map(|views| {
        let words = format!("technique=many-lights samples=16 views={views}");
        let mut stage = stage(&device, &setup, &words);
        let image = setup.visibility(&mut stage);
        let (truth, _) = setup.traced(&stage, 128);
        percent(&truth, &image)
    });
    println!("{:.2} % with one view, {:.2} % with four", errors[0], errors[1]);
    assert!(errors[1] < 9.0 && errors[1] < 0.4 * errors[0], "{errors:?}");
}

/// Tiles that no occluder can shadow are skipped, which changes nothing, whichever view serves them.
#[test]
fn tiles_change_nothing() {
    let device = device();
    let (yard, eye) = yard();
    let room = closed_room();
    for (scene, camera) in [(&room, room::camera()), (&yard, eye)] {
        let setup = of_extent(scene, &camera, SMALL);
        for words in [
            "technique=soft-shadow-map map=64",
            "technique=pcss",
            "technique=occlusion-textures",
            "technique=occlusion-textures map=128 combine=product prefilter=mip",
        ] {
            let [with, without] = ["on", "off"].map(|classify| {
                let words = format!("{words} views=4 classify={classify}");
                setup.visibility(&mut stage(&device, &setup, &words))
            });
            let apart = with.iter().zip(&without).filter(|(a, b)| a.to_bits() != b.to_bits());
            assert_eq!(apart.count(), 0, "{words}");
        }
    }
}

/// What the image held before does not show: each pixel is written through one view.
#[test]
fn every_pixel_is_served() {
    let device = device();
    let (yard, eye) = yard();
    let room = closed_room();
    for (scene, camera) in [(&room, room::camera()), (&yard, eye)] {
        let setup = of_extent(scene, &camera, SMALL);
        for (words, _) in ERRORS {
            let words = format!("{} views=4", words.replace("map=256", "map=64"));
            let fresh = setup.visibility(&mut stage(&device, &setup, &words));
            let mut used = stage(&device, &setup, &words);
            // Another light's image is drawn into it first.
            let mut other = scene.light(None).unwrap().clone();
            let down = RectangleLight::facing(
                DVec3::new(0.0, 2.2, -1.0),
                DVec3::NEG_Y,
                DVec3::NEG_Z,
                [0.3; 2],
            );
            other.light = down.unwrap().into();
            let plan = used.plan_under(&other, None).unwrap();
            used.run(&plan).unwrap();
            let before = used.visibility().unwrap();
            let after = setup.visibility(&mut used);
            let changed = before.iter().zip(&after).filter(|(a, b)| a != b).count();
            assert!(changed > 250, "{words}: the other light changes {changed} pixels alone");
            let differ = fresh.iter().zip(&after).filter(|(a, b)| a.to_bits() != b.to_bits());
            assert_eq!(differ.count(), 0, "{words}: what was there before shows");
        }
    }
}

/// A board through the floor, a dome around everything and a block far away change the room's image by little more than
/// their texels do: the mean of the pixels that differ, in percent of those in shadow.
#[test]
fn what_lies_elsewhere_changes_little() {
    let device = device();
    let camera = room::camera();
    let base = room::room();
    let with = |name: &str, size: [f64; 3], at: [f64; 3]| {
        let mut scene = base.clone();
        let place = DMat4::from_translation(DVec3::from_array(at));
        scene.add(name, generate::cuboid(DVec3::from_array(size)), place, Role::Both);
        scene
    };
    let scenes = [
        ("a post that goes on below the floor", with("post", [0.05, 1.0, 0.05], [1.6, -0.51, 1.2])),
        ("a block 300 m away", with("block", [40.0, 20.0, 40.0], [-300.0, -30.0, -40.0])),
    ];
    for (words, _) in ERRORS {
        let words = format!("{words} views=4");
        let setup_of = |scene| setup(scene, &camera);
        let plain = setup_of(&base).visibility(&mut stage(&device, &setup_of(&base), &words));
        for (name, scene) in &scenes {
            let setup = setup_of(scene);
            let image = setup.visibility(&mut stage(&device, &setup, &words));
            let apart = percent(&plain, &image);
            println!("{words}, {name}: {apart:.2} % apart");
            let most = if words.contains("occlusion-textures") { OF_SLICES } else { OF_TEXELS };
            assert!(apart < most, "{words}, {name}: {apart} % apart");
        }
    }
}

/// What windows and texels that lie otherwise change, percent: none does.
const OF_TEXELS: f64 = 0.1;

/// The same where slices reach down to the end of the post, which is a receiver, too.
const OF_SLICES: f64 = 6.0;

/// The yard's ground has no dots: no pixel that sees the whole sun is dark, but for one in a thousand at edges.
#[test]
fn a_sun_over_a_wide_ground_makes_no_dots() {
    let device = device();
    let (scene, camera) = yard();
    let setup = setup(&scene, &camera);
    let mut truth = None;
    for (words, _) in ERRORS {
        let mut stage = stage(&device, &setup, &format!("{words} map=512"));
        let image = setup.visibility(&mut stage);
        let (truth, _) = truth.get_or_insert_with(|| setup.traced(&stage, 64));
        let lit = truth.iter().filter(|v| **v == 1.0).count();
        let dark = truth.iter().zip(&image).filter(|(t, v)| **t == 1.0 && **v < 0.5).count();
        println!("{words}: {dark} of {lit} lit pixels are dark");
        assert!(lit > 10_000 && dark * 500 < lit, "{words}: {dark} of {lit} lit pixels are dark");
    }
}
