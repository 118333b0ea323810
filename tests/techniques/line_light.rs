//! Lights without height: what takes them, and how far from the truth it is.

use antumbra::scene::generate;
use antumbra::truth::ExactLine;
use antumbra::{RectangleLight, Technique};
use antumbra_harness::View;
use antumbra_tests::device;
use antumbra_tests::measure::{
    Setup, as_measured, bunny_under_a_line, metre_line, percent, summary,
};

/// The mean error in percent on the card, the spheres and the bunny, as measured on lavapipe. On a line many
/// lights have one point in each of n parts of its length, which leaves an end of a shadow off by no more
/// than 1/n; from 256 points on it is the maps that err, and finer ones err less. A hard shadow has no
/// penumbra at all.
const TABLE: &[(&str, [f64; 3])] = &[
    ("technique=many-lights samples=64", [0.50, 0.99, 1.96]),
    ("technique=many-lights samples=256", [0.31, 0.73, 1.87]),
    ("technique=many-lights samples=256 map=1024", [0.12, 0.24, 1.16]),
    ("technique=ray-march map=1024 rays=64", [0.39, 0.53, 1.18]),
    ("technique=hard", [17.89, 23.67, 14.17]),
];

#[test]
fn errors_are_what_they_were_measured_to_be() {
    let device = device();
    let scenes =
        [generate::card(metre_line()), generate::spheres(metre_line()), bunny_under_a_line()];
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
            assert_eq!(*noise, 0.0, "the truth of a line is exact");
            let s = summary(truth, &image);
            let line = format!(
                "{name}, {words}: mean {:.3} %, bias {:.3}, p99 {:.3}, on lit pixels {:.3} %",
                100.0 * s.mean_abs_error,
                100.0 * s.bias,
                s.p99,
                100.0 * s.lit_error,
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

/// A line a twentieth too long, or turned 3° too far, is further from what many points see than the true one.
#[test]
fn a_wrong_line_is_noticed() {
    let device = device();
    let scene = generate::card(metre_line());
    let setup = Setup::ground(&scene, 2.2, 160);
    let mut stage = setup.stage(&device, "technique=many-lights samples=256 map=1024");
    let image = setup.visibility(&mut stage);
    let exact = ExactLine::new(&scene).unwrap();
    let receivers = Setup::receivers(&stage);
    let error = |light: &RectangleLight| {
        let truth = exact.visible_fractions(light, &receivers).unwrap();
        percent(&truth.iter().map(|&v| v as f32).collect::<Vec<_>>(), &image)
    };
    let right = error(&metre_line());
    let longer = error(&generate::line_light(1.05, 0.4).unwrap());
    let turned = error(&generate::line_light(1.0, 0.45).unwrap());
    println!("{right:.3} %; too long {longer:.3} %, turned {turned:.3} %");
    assert!(longer > 2.0 * right && turned > 2.0 * right, "{right} {longer} {turned}");
}

/// A hard shadow is that of the light's centre, of which a height changes nothing.
#[test]
fn a_hard_shadow_is_that_of_a_rectangle() {
    let device = device();
    let [line, square] = [
        generate::line_light(0.6, 0.0).unwrap(),
        generate::rectangle_light(0.6, 0.6, 0.0).unwrap(),
    ]
    .map(|light| {
        let scene = generate::spheres(light);
        let setup = Setup::ground(&scene, 2.2, 160);
        setup.visibility(&mut setup.stage(&device, "technique=hard"))
    });
    assert!(line.contains(&0.0) && line == square);
}

/// A device's node refuses a line where the plan on the host does.
#[test]
fn what_takes_no_lines_says_so() {
    let device = device();
    let scene = generate::card(metre_line());
    let setup = Setup::ground(&scene, 2.2, 32);
    let line = metre_line().into();
    for technique in Technique::all().iter().filter(|t| !t.room().takes().shapes.hold(&line)) {
        let mut stage = setup.stage(&device, &format!("technique={technique}"));
        let sentence = stage.plan(setup.light(), None).map(|_| ()).unwrap_err().to_string();
        assert!(sentence.contains("the light is a line"), "{sentence}");
    }
}
