//! How far are shadows from the triangles themselves from the truth, whatever the light's shape and whatever moves?

use antumbra::scene::{Role, Scene, generate};
use antumbra::truth::{Receiver, Sampling, Tracer};
use antumbra::{Light, RectangleLight, Technique};
use antumbra_harness::{Stage, View};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, as_measured, model, percent, summary};
use glam::{DMat4, DVec3};

/// Settings, and the mean error in percent on the card, the tall box and the spheres, the latter blocking and receiving,
/// as measured on lavapipe; the truth's own noise, some 0.15, is in it.
const TABLE: &[(&str, [f64; 3])] = &[
    ("technique=traced", [0.45, 0.66, 0.97]),
    ("technique=traced samples=256", [0.18, 0.27, 0.41]),
    ("technique=traced samples=1024", [0.12, 0.18, 0.20]),
    ("technique=traced leaves=1", [0.45, 0.66, 0.97]),
];

fn scenes() -> [Scene; 3] {
    let light = || generate::square_light(0.6).unwrap();
    let both = |scene: Scene| scene.with_occluders_as(Role::Both);
    [generate::card(light()), both(generate::tall_box(light())), both(generate::spheres(light()))]
}

#[test]
fn errors_are_as_measured() {
    let device = device();
    let mut problems = Vec::new();
    for (nth, scene) in scenes().iter().enumerate() {
        let mut setup = Setup::ground(scene, 2.5, 128);
        setup.occluders_seen = scene.instances.iter().any(|i| i.role == Role::Both);
        let mut truth = None;
        for (words, measured) in TABLE {
            let mut stage = setup.stage(&device, words);
            let image = setup.visibility(&mut stage);
            let (truth, _) = truth.get_or_insert_with(|| setup.traced(&stage, 2048));
            let found = summary(truth, &image);
            let error = 100.0 * found.mean_abs_error;
            println!("{words}: {error:.2} %, worst {:.2}", found.worst);
            if !as_measured(error, measured[nth]) {
                problems.push(format!("{words}: {error:.2} %, not {}", measured[nth]));
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Rays go to the samples that shafts test: only what lies at the very edge of a triangle may differ.
#[test]
fn rays_and_shafts_see_the_same_samples() {
    let device = device();
    let scene = model("bunny").with_occluders_as(Role::Both);
    let camera = scene.camera.unwrap();
    let setup = Setup {
        scene: &scene,
        view: View::of(&camera, [160, 120]),
        extent: [160, 120],
        window: None,
        occluders_seen: true,
    };
    let image = |words: &str| setup.visibility(&mut setup.stage(&device, words));
    let (shafts, rays) = (image("technique=traced"), image("technique=traced leaves=1"));
    let differ = shafts.iter().zip(&rays).filter(|(a, b)| a != b).count();
    let most = shafts.iter().zip(&rays).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    println!("{differ} of {} pixels differ, by {most} at most", shafts.len());
    assert!(differ <= shafts.len() / 200 && most <= 3.0 / 64.0);
    assert!(shafts.iter().any(|v| *v < 0.5));
}

fn traced(scene: &Scene, light: &Light, receivers: &[Receiver]) -> Vec<f32> {
    let sampling = Sampling::new(2048, 1).unwrap();
    Tracer::new(scene).unwrap().visible_fractions(light, receivers, &sampling).unwrap().visible
}

/// Every shape of a light against its truth, with 256 samples: mean error in percent, and the shape that is seen must be
/// the light's own.
#[test]
fn every_shape_of_a_light_is_its_own() {
    let device = device();
    let at = DVec3::Y * 4.0;
    let half = 0.5;
    let rectangle = RectangleLight::facing(at, DVec3::NEG_Y, DVec3::X, [2.0 * half; 2]).unwrap();
    let l = [[-0.5, -0.5], [0.5, -0.5], [0.5, -0.2], [-0.2, -0.2], [-0.2, 0.5], [-0.5, 0.5]];
    let lights: [(Light, f64); 9] = [
        (rectangle.into(), 0.5),
        (Light::with_outline(rectangle, &l).unwrap(), 1.1),
        (Light::disc(at, DVec3::NEG_Y, half).unwrap(), 0.5),
        (Light::sphere(at, half).unwrap(), 0.75),
        (Light::capsule(at, DVec3::X * 0.5, 0.1).unwrap(), 0.5),
        (Light::point(at).unwrap(), 0.5),
        (RectangleLight::point(at, DVec3::NEG_Y).unwrap().into(), 0.5),
        (RectangleLight::line(at, DVec3::X * half, DVec3::NEG_Y).unwrap().into(), 0.5),
        (Light::sun(DVec3::NEG_Y, 0.05, DVec3::ZERO, 5.0).unwrap(), 0.5),
    ];
    // Under another light the same image is wrong.
    let other = Light::disc(at + DVec3::X * 0.2, DVec3::NEG_Y, 0.4).unwrap();
    let mut of_other = None;
    for (light, bound) in lights {
        let mut scene = generate::tall_box(light).with_occluders_as(Role::Both);
        scene.lights[0].light = light;
        let setup = Setup { occluders_seen: true, ..Setup::ground(&scene, 2.0, 96) };
        let mut stage = setup.stage(&device, "technique=traced samples=256");
        let image = setup.visibility(&mut stage);
        let receivers = Setup::receivers(&stage);
        let error = percent(&traced(&scene, &light, &receivers), &image);
        let name = light.shape().name();
        println!("{name}: {error:.2} %");
        assert!(error <= bound, "{name}: {error:.2} %");
        let of_other = of_other.get_or_insert_with(|| traced(&scene, &other, &receivers));
        let wrong = percent(of_other, &image);
        assert!(wrong > 2.0 * bound, "{name}: {wrong:.2} % under another light");
    }
}

/// A mesh that moves, and a hierarchy that is kept while nothing does, give the image of a node that begins anew.
#[test]
fn moved_meshes_are_where_they_are() {
    let device = device();
    let scene = generate::spheres(generate::square_light(0.6).unwrap());
    let setup = Setup::ground(&scene, 2.5, 96);
    let light = setup.light();
    let anew = |scene: &Scene| {
        let setup = Setup { scene, ..setup };
        setup.visibility(&mut setup.stage(&device, "technique=traced"))
    };
    let mut moved = scene.clone();
    let sphere = moved.instances.iter_mut().find(|i| i.role.blocks()).unwrap();
    sphere.world_from_mesh = DMat4::from_translation(DVec3::X * 0.7) * sphere.world_from_mesh;
    let mut stage: Stage = setup.stage(&device, "technique=traced");
    let mut frame = |meshes_of: &Scene, revision: u64| {
        let mut meshes = stage.instances().to_vec();
        for (mesh, instance) in meshes.iter_mut().zip(&meshes_of.instances) {
            mesh.world_from_mesh = instance.world_from_mesh;
        }
        let plan = stage
            .plan_with(light, |f| (f.meshes, f.mesh_revision) = (&meshes, Some(revision)))
            .unwrap();
        let ran: Vec<_> = plan.passes().map(|(name, _)| name).collect();
        stage.run(&plan).unwrap();
        (stage.visibility().unwrap(), ran)
    };
    let built = |ran: &[&str]| ran.contains(&"hierarchy.split");
    let fitted = |ran: &[&str]| ran.contains(&"hierarchy.nodes");
    let (first, ran) = frame(&scene, 1);
    assert!(built(&ran) && fitted(&ran));
    let (kept, ran) = frame(&scene, 1);
    assert!(!built(&ran) && !fitted(&ran) && kept == first, "{ran:?}");
    let (after, ran) = frame(&moved, 2);
    assert!(!built(&ran) && fitted(&ran), "{ran:?}");
    assert!(first == anew(&scene) && after == anew(&moved) && first != after);
}

/// Meshes that the host draws are no triangles, and more of them than there is memory for are refused.
#[test]
fn what_the_hierarchy_cannot_hold_is_refused() {
    let device = device();
    let scene = generate::spheres(generate::square_light(0.6).unwrap());
    let setup = Setup::ground(&scene, 2.5, 32);
    let mut stage = setup.stage(&device, "technique=traced");
    let technique: Technique = "traced".parse().unwrap();
    stage.configure_with(technique, |d| d.capacity.triangles = 10).unwrap();
    let sentence = stage.plan(setup.light(), None).unwrap_err().to_string();
    assert!(sentence.contains("the description's capacity is 10 in"), "{sentence}");
    let none = stage.configure_with(technique, |d| d.capacity.triangles = 0).unwrap_err();
    assert!(none.to_string().contains("outside 1 to 5,000,000"), "{none}");
}
