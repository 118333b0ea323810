//! Where the samples of a line are put, what maps are kept, and lines where they are hardest.

use antumbra::scene::{Role, Scene, generate};
use antumbra::techniques::linear_light::twin::{between, bits, run_at};
use antumbra::{Frame, RectangleLight};
use antumbra_harness::{Stage, View};
use antumbra_tests::measure::{Setup, metre_line, model, percent};
use antumbra_tests::{Function, device};
use glam::{DMat4, DQuat, DVec3};

/// Where the samples of the light's first line are, behind the last frame.
fn places(stage: &mut Stage, light: &RectangleLight) -> Vec<f32> {
    let plan = stage.plan(light, None).unwrap();
    stage.run(&plan).unwrap();
    let (texels, _) = stage.inspect::<[f32; 4]>(&plan, "linear_light.places").unwrap();
    let count = texels[3][0] as usize;
    texels[4..4 + count].iter().map(|t| t[0]).collect()
}

/// Two cards a fifth of a metre apart, side by side along the line: their penumbrae overlap (Fig. 6). Under the gap
/// both ends of a line of a metre are hidden, and 0.4 m in its middle are not.
fn overlapping(light: RectangleLight) -> Scene {
    let mut scene = generate::stage(light);
    let mut card = generate::quad(0.6, 1.0);
    card.double_sided = true;
    for x in [-0.4, 0.4] {
        let at = DMat4::from_translation(DVec3::new(x, 2.0, 0.0));
        scene.add("card", card.clone(), at, Role::Occluder);
    }
    scene
}

#[test]
fn overlapping_penumbrae_are_lost_to_two_samples_and_found_by_those_added() {
    let device = device();
    let scene = overlapping(generate::line_light(1.0, 0.0).unwrap());
    let setup = Setup::ground(&scene, 2.2, 160);
    let mut stage = setup.stage(&device, "technique=linear-light samples=2");
    let two = setup.visibility(&mut stage);
    let (truth, _) = setup.traced(&stage, 16);
    // Pixels that see more than a tenth of the light, and are black.
    let lost = |image: &[f32]| {
        let both = truth.iter().zip(image);
        both.filter(|(t, v)| **t > 0.1 && **v == 0.0).count()
    };
    let in_shadow = truth.iter().filter(|t| **t < 1.0).count();
    println!("two: {} of {in_shadow} lost, {:.2} %", lost(&two), percent(&truth, &two));
    assert!(lost(&two) > in_shadow / 100, "the paper's failure is not there: {}", lost(&two));

    let mut stage = setup.stage(&device, "technique=linear-light error=0.002");
    let more = setup.visibility(&mut stage);
    let places = places(&mut stage, &setup.light());
    println!("{places:?}: {} lost, {:.2} %", lost(&more), percent(&truth, &more));
    assert!(places.len() > 2 && places.len() < 8, "{places:?}");
    assert!(lost(&more) == 0 && percent(&truth, &more) < 2.0);
    assert!(percent(&truth, &two) > 3.0 * percent(&truth, &more));
}

/// What is lost is no more than asked for: the rest of the error is the maps', the skins' and what the line's middle
/// does not tell, 1.3 points in all. Fewer samples serve a larger error.
#[test]
fn samples_are_added_until_the_error_asked_for() {
    let device = device();
    for (name, scene) in [
        ("card", generate::card(metre_line())),
        ("stacked cards", generate::stacked_cards(metre_line())),
        ("spheres", generate::spheres(metre_line())),
        ("bunny", generate::normalized(&model("bunny"), metre_line()).unwrap()),
        ("foliage", generate::foliage(metre_line(), 300, 7)),
    ] {
        let setup = Setup::ground(&scene, 2.2, 160);
        let mut truth = None;
        let mut last = 0;
        for asked in [0.05, 0.02, 0.01] {
            let words = format!("technique=linear-light samples=16 error={asked}");
            let mut stage = setup.stage(&device, &words);
            let image = setup.visibility(&mut stage);
            let (truth, _) = truth.get_or_insert_with(|| setup.traced(&stage, 16));
            let places = places(&mut stage, &setup.light());
            let error = percent(truth, &image);
            println!("{name}, {asked}: {} samples, {error:.2} %", places.len());
            assert!(places.first() == Some(&0.0) && places.last() == Some(&1.0));
            assert!(places.is_sorted() && places.len() >= last, "{places:?}");
            assert!(error < 100.0 * asked + 1.3 || places.len() == 16, "{name}, {asked}: {error}");
            last = places.len();
        }
        let most = if name == "card" { 2 } else { 16 };
        assert!(last <= most && (name != "foliage" || last > 8), "{name}: {last}");
    }
}

/// Maps of a revision are made once, and looked at from anywhere; a plan that others have overtaken is refused.
#[test]
fn kept_maps_are_made_once() {
    let device = device();
    let scene = generate::stacked_cards(metre_line());
    let setup = Setup::ground(&scene, 2.2, 64);
    let mut stage = setup.stage(&device, "technique=linear-light samples=4");
    let light = setup.light();
    let frame = |stage: &mut Stage, light: &RectangleLight, revision| {
        stage.plan_with(light, |f: &mut Frame| f.revision = revision).unwrap()
    };
    let run = |stage: &mut Stage, plan: &antumbra::FramePlan| {
        stage.run(plan).unwrap();
        stage.visibility().unwrap()
    };
    let plan = frame(&mut stage, &light, Some(7));
    let made = run(&mut stage, &plan);
    let kept = frame(&mut stage, &light, Some(7));
    let runs: Vec<_> = kept.plan().runs().iter().map(|r| r.pass.name).collect();
    assert_eq!(runs, ["gbuffer.constants", "linear_light.visibility"]);
    assert!(kept.plan().table().contains("the maps of scene revision 7 are kept"));
    assert_eq!(run(&mut stage, &kept), made);
    assert_eq!(run(&mut stage, &kept), made);

    // Another light under the same number is the host's mistake, and shows that nothing was made.
    let moved =
        RectangleLight::line(light.center() + DVec3::X, DVec3::X * 0.5, DVec3::NEG_Y).unwrap();
    let other = frame(&mut stage, &moved, Some(8));
    let elsewhere = run(&mut stage, &other);
    assert_ne!(elsewhere, made);
    let sentence = stage.run(&kept).unwrap_err().to_string();
    assert!(
        sentence.contains("has replaced") && sentence.contains("plan the frame again"),
        "{sentence}"
    );
    // Without a number everything is made, and nothing is kept.
    for _ in 0..2 {
        let plan = frame(&mut stage, &light, None);
        assert!(plan.plan().steps.len() > 20);
        assert_eq!(run(&mut stage, &plan), made);
    }
    let plan = frame(&mut stage, &light, Some(8));
    assert!(plan.plan().steps.len() > 20, "maps without a number are of no revision");
}

/// On receivers that lean against the line the transition is the rational function of eq. 1.
#[test]
fn tilted_receivers() {
    let device = device();
    let mut errors = Vec::new();
    for degrees in [0.0f64, 20.0, 40.0] {
        let mut scene = generate::card(generate::line_light(1.0, 0.0).unwrap());
        let tilt = DMat4::from_translation(DVec3::Y * 0.9)
            * DMat4::from_quat(DQuat::from_rotation_z(degrees.to_radians()));
        for instance in scene.instances.iter_mut().filter(|i| i.role != Role::Occluder) {
            instance.world_from_mesh = tilt * instance.world_from_mesh;
        }
        let setup = Setup {
            scene: &scene,
            view: View::map_of_ground(1.0, 8.0),
            extent: [160; 2],
            window: None,
            occluders_seen: false,
        };
        let of = |which: &str| {
            let words = format!("technique=linear-light samples=2 map=512 transition={which}");
            let mut stage = setup.stage(&device, &words);
            let image = setup.visibility(&mut stage);
            percent(&setup.traced(&stage, 16).0, &image)
        };
        let pair = [of("linear"), of("rational")];
        println!("{degrees}°: linear {:.2} %, rational {:.2} %", pair[0], pair[1]);
        assert!(pair[1] < 1.0, "{degrees}: {pair:?}");
        errors.push(pair);
    }
    assert!(errors[2][0] > 2.0 * errors[2][1], "{errors:?}");
}

/// Occluders that the segment goes through or ends at, and receivers in its plane and on its line: numbers, and how
/// wrong they are.
#[test]
fn what_touches_the_line() {
    let device = device();
    let mut card = generate::quad(1.0, 1.0);
    card.double_sided = true;
    let sideways = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let upright = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    // The mean error in percent with 2 samples and with 8, which are what an error asked for gives where something is
    // this near: the nearest ends of occluders are further aside than a map looks.
    for (name, at, most) in [
        ("through", DMat4::from_rotation_translation(upright, DVec3::Y * 4.0), [16.5, 2.2]),
        (
            "at an end",
            DMat4::from_rotation_translation(upright, DVec3::new(0.5, 3.5, 0.0)),
            [29.0, 14.0],
        ),
        ("right under", DMat4::from_translation(DVec3::Y * (4.0 - 1e-3)), [79.0, 12.0]),
    ] {
        for role in [Role::Occluder, Role::Both] {
            let mut scene = generate::stage(generate::line_light(1.0, 0.0).unwrap());
            scene.add("card", card.clone(), at, role);
            let setup = Setup { occluders_seen: true, ..Setup::ground(&scene, 2.2, 64) };
            for (words, most) in ["samples=2", "samples=8"].into_iter().zip(most) {
                let mut stage = setup.stage(&device, &format!("technique=linear-light {words}"));
                let image = setup.visibility(&mut stage);
                let good = image.iter().all(|v| v.is_finite() && (0.0..=1.0).contains(v));
                assert!(good, "{name}, {role:?}, {words}");
                let error = percent(&setup.traced(&stage, 16).0, &image);
                println!("{name}, {role:?}, {words}: {error:.2} %");
                assert!(error < most, "{name}, {role:?}, {words}: {error}");
            }
        }
    }
    // A receiver in the light's plane, and one that the line lies in.
    for at in [
        DMat4::from_translation(DVec3::Y * 4.0),
        DMat4::from_rotation_translation(sideways, DVec3::Y * 4.0),
    ] {
        let mut scene = generate::card(generate::line_light(1.0, 0.0).unwrap());
        scene.add("shelf", card.clone(), at, Role::Receiver);
        let setup = Setup::ground(&scene, 2.2, 64);
        for words in ["samples=2", "samples=8 transition=linear"] {
            let image = setup
                .visibility(&mut setup.stage(&device, &format!("technique=linear-light {words}")));
            assert!(image.iter().all(|v| v.is_finite() && (0.0..=1.0).contains(v)), "{words}");
        }
    }
}

#[test]
fn runs_of_bits() {
    let file = "linear_light/mask.glsl";
    let at = || 0..32i32;
    Function::new(file, "uint bits(int low, int high)")
        .random(2_000, (at(), -1..32i32))
        .bits(|x| vec![bits(x[0] as i32, x[1] as i32)])
        .check(&device());
    Function::new(file, "uint run_at(uint mask, int at)")
        .case((u32::MAX, 0))
        .case((u32::MAX, 31))
        .case((0, 7))
        .random(4_000, (0..=u32::MAX, at()))
        .bits(|x| vec![run_at(x[0], x[1] as i32)])
        .check(&device());
    Function::new(file, "uint between(float a, float b)")
        .case((0.0, 1.0))
        .case((1.0, 0.0))
        .case((-1e30, 1e30))
        .case((f32::INFINITY, f32::INFINITY))
        .case((0.5, 0.5))
        .random(4_000, (-0.5..1.5f32, -0.5..1.5f32))
        .bits(|x| vec![between(f32::from_bits(x[0]), f32::from_bits(x[1]))])
        .check(&device());
}
