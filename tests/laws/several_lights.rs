//! Several lights in one node: each layer is what a node of its own gives, and what need not run does not.

use antumbra::scene::{Scene, generate};
use antumbra::{
    Error, Frame, FramePlan, FramePlans, LightIndex, RectangleLight, Scope, Slot, TechniqueIndex,
    Visibility,
};
use antumbra_harness::{HeadlessDevice, Stage};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, settings};
use glam::{DMat4, DVec3};

/// The light of the scenes, shifted along x; `away` shines up, where nothing is.
fn light(shift: f64, away: bool) -> RectangleLight {
    let light = generate::square_light(0.4).unwrap();
    let frame = light.world_from_light();
    let [half_u, half_v] = light.half_extents();
    let axis = |axis: DVec3, half: f64| frame.transform_vector3(axis) * half;
    let (u, v) = (axis(DVec3::X, half_u), axis(DVec3::Y, half_v));
    // It shines along v × u.
    let (u, v) = if away { (u, v) } else { (v, u) };
    RectangleLight::new(light.center() + DVec3::X * shift, u, v).unwrap()
}

fn shift(index: u32) -> f64 {
    0.3 * f64::from(index) - 0.4
}

fn cards() -> Scene {
    generate::stacked_cards(light(0.0, false))
}

/// A stage whose node has so many lights and further settings.
fn stage(device: &HeadlessDevice, scene: &Scene, lights: u32, words: &[&str]) -> Stage {
    let setup = Setup::ground(scene, 2.2, 64);
    let mut stage = setup.stage(device, words[0]);
    configure(&mut stage, lights, words).unwrap();
    stage
}

fn configure(stage: &mut Stage, lights: u32, words: &[&str]) -> Result<(), Error> {
    stage.configure_with(settings(words[0]), |description| {
        description.lights = lights;
        description.other_techniques = words[1..].iter().map(|w| settings(w)).collect();
        description.frames_in_flight = 2;
    })
}

/// The plan of one of the lights.
fn plan(stage: &mut Stage, index: u32, change: impl FnOnce(&mut Frame)) -> FramePlan {
    let planned = stage.plan_with(light(shift(index), false), |frame| {
        frame.light_index = LightIndex(index);
        change(frame);
    });
    planned.unwrap()
}

/// As if the camera had moved aside.
fn aside(frame: &mut Frame, by: f64) {
    frame.world_from_ndc = DMat4::from_translation(DVec3::X * by) * frame.world_from_ndc;
}

fn steps(plans: &[FramePlan]) -> Vec<usize> {
    plans.iter().map(|p| p.plan().steps.len()).collect()
}

/// Runs them in one submit and reads every layer.
fn run(stage: &mut Stage, plans: &[FramePlan]) -> Vec<Vec<f32>> {
    stage.run_all(plans).unwrap();
    (0..plans.len() as u32)
        .map(|light| stage.visibility_under(LightIndex(light)).unwrap())
        .collect()
}

/// What a node of one light gives for each of four lights.
fn of_one(one: &mut Stage, by: f64) -> Vec<Vec<f32>> {
    let of = |index| {
        let plan = plan(one, index, |frame| {
            frame.light_index = LightIndex(0);
            aside(frame, by);
        });
        run(one, &[plan]).remove(0)
    };
    (0..4).map(of).collect()
}

#[test]
fn four_lights_in_one_submit_are_four_nodes_to_the_bit() {
    let device = device();
    let scene = cards();
    let words = [
        "map=64",
        "technique=ray-march map=32 rays=4",
        "technique=pcss map=128",
        "receivers=map map=32 receiver_map=64",
    ];
    let mut node = stage(&device, &scene, 4, &words);
    let apart = words.map(|words| of_one(&mut stage(&device, &scene, 1, &[words]), 0.0));
    let shadows = |image: &Vec<f32>| image.iter().any(|&v| v < 0.5);
    assert!(apart.iter().flatten().all(shadows), "every light casts a shadow");
    let plans: Vec<_> =
        (0..4).map(|i| plan(&mut node, i, |f| f.technique_index = TechniqueIndex(i))).collect();
    for (index, image) in run(&mut node, &plans).into_iter().enumerate() {
        assert!(image == apart[index][index], "light {index}, with settings of its own");
    }
    // Every light has the same settings, and so the same maps and buffers one behind the other.
    for (index, apart) in (0..).zip(&apart) {
        // Recorded in another order than that of the layers, and with the other frame slot.
        let of = |i| {
            plan(&mut node, i, |f| (f.technique_index, f.slot) = (TechniqueIndex(index), Slot(1)))
        };
        let plans: Vec<_> = [2, 0, 3, 1].map(of).into();
        assert!(run(&mut node, &plans) == *apart, "settings {index}");
        let timed = (0..5).map(|light| node.node().unwrap().timings(Slot(1), LightIndex(light)));
        let timed: Vec<_> = timed.collect();
        let rows = plans[0].plan().runs().len();
        assert!(timed[..4].iter().flatten().all(|passes| passes.len() == rows), "{timed:?}");
        assert_eq!(timed[4], None);
    }
    assert_eq!(node.node().unwrap().timings(Slot(2), LightIndex(0)), None);
}

/// In memory that is kept, while camera and scene move or stay.
#[test]
fn lights_planned_together_are_lights_planned_alone() {
    let device = device();
    let scene = cards();
    let words = ["map=64", "technique=pcss map=128"];
    let [mut together, mut apart] = [(); 2].map(|()| stage(&device, &scene, 4, &words));
    let mut plans = FramePlans::new();
    // How far the camera and the lights have moved, and how often.
    let moments =
        [(0.0, 0.0, 1, 1), (0.2, 0.0, 1, 2), (0.2, 0.0, 1, 2), (0.2, 0.3, 2, 3), (0.0, 0.0, 3, 4)];
    for (nth, (camera, moved, scene_revision, view_revision)) in moments.into_iter().enumerate() {
        let lamp = |index: u32| light(shift(index) + moved, false);
        let change = |index: usize, frame: &mut Frame| {
            frame.light_index = LightIndex(index as u32);
            frame.technique_index = TechniqueIndex(u32::from(index == 3));
            frame.revision = Some(scene_revision);
            frame.view_revision = Some(view_revision);
            aside(frame, camera);
        };
        together.plan_all_with(&[0, 1, 2, 3].map(lamp), change, &mut plans).unwrap();
        let alone = |i: u32| apart.plan_with(lamp(i), |f| change(i as usize, f)).unwrap();
        let alone: Vec<_> = (0..4).map(alone).collect();
        assert_eq!(steps(plans.all()), steps(&alone), "moment {nth}");
        assert_eq!(nth == 2, steps(&alone) == [0; 4], "moment {nth} alone is idle");
        let images = run(&mut together, plans.all());
        assert!(images == run(&mut apart, &alone), "moment {nth}");
    }
    // Plans of a node that has been made anew since are refused, and made again.
    configure(&mut together, 4, &words).unwrap();
    assert!(together.run_all(plans.all()).is_err());
}

#[test]
fn what_reaches_nothing_costs_nothing_behind_the_first_frame() {
    let device = device();
    let scene = cards();
    let mut node = stage(&device, &scene, 16, &["map=32"]);
    let frame = |node: &mut Stage, lights: u32| -> Vec<FramePlan> {
        let of = |index: u32| {
            let reaches = index.is_multiple_of(4);
            let planned = node.plan_with(light(shift(index / 4), !reaches), |frame| {
                frame.light_index = LightIndex(index);
            });
            planned.unwrap()
        };
        (0..lights).map(of).collect()
    };
    let first = frame(&mut node, 16);
    let images = run(&mut node, &first);
    let mut four = stage(&device, &scene, 4, &["map=32"]);
    let of_four: Vec<_> = (0..4).map(|i| plan(&mut four, i, |_| {})).collect();
    let four_images = run(&mut four, &of_four);
    let all = |plans: &[FramePlan]| steps(plans).iter().sum::<usize>();
    assert_eq!(all(&first), all(&of_four) + 12);
    for _ in 0..2 {
        let next = frame(&mut node, 16);
        assert_eq!(all(&next), all(&of_four), "12 of them reach nothing");
        let table = next[1].plan().table();
        assert!(table.contains("every pixel is lit already"), "{table}");
        assert!(run(&mut node, &next) == images);
        assert!(
            node.node().unwrap().timings(Slot(0), LightIndex(1)).is_none(),
            "no pass, no times"
        );
    }
    for (index, image) in images.iter().enumerate() {
        match index % 4 {
            0 => assert!(*image == four_images[index / 4]),
            _ => assert!(image.iter().all(|&v| v == 1.0)),
        }
    }
}

#[test]
fn idle_lights_cost_nothing_and_a_moving_camera_sees_what_each_light_shadows() {
    let device = device();
    let scene = cards();
    // Lights 0 and 1 share maps; 2 and 3 have some to themselves.
    let words = ["map=64", "technique=hard map=128", "technique=back-projection map=64"];
    let of = [0, 0, 1, 2];
    let mut node = stage(&device, &scene, 4, &words);
    let mut fresh = words.map(|words| stage(&device, &scene, 1, &[words]));
    let plans = |node: &mut Stage, view: u64| -> Vec<FramePlan> {
        let of_light = |index: u32| {
            plan(node, index, |frame| {
                frame.technique_index = TechniqueIndex(of[index as usize]);
                (frame.revision, frame.view_revision) = (Some(1), Some(view));
                aside(frame, 0.1 * view as f64);
            })
        };
        (0..4).map(of_light).collect()
    };
    let mut passes = Vec::new();
    for view in 0..4 {
        // Everything is planned before the first is recorded.
        let moved = plans(&mut node, view);
        passes.push(steps(&moved));
        let images = run(&mut node, &moved);
        let apart: Vec<_> = fresh.iter_mut().map(|one| of_one(one, 0.1 * view as f64)).collect();
        for (index, image) in images.iter().enumerate() {
            assert!(*image == apart[of[index] as usize][index], "light {index} of view {view}");
        }
        let idle = plans(&mut node, view);
        assert_eq!(steps(&idle), [0; 4]);
        assert!(run(&mut node, &idle) == images, "an idle frame changed an image");
    }
    assert_eq!(passes[1][..2], passes[0][..2], "shared maps are drawn by each light");
    assert_eq!(passes[1][2..], [2, 2], "kept maps are not: the camera's constants and the pixels");
    assert!(passes[1..].iter().all(|p| *p == passes[1]), "{passes:?}");
    // A plan that counts on maps which another light has drawn over is refused.
    let stale = plan(&mut node, 2, |frame| {
        frame.technique_index = TechniqueIndex(1);
        frame.revision = Some(1);
    });
    let over = plan(&mut node, 0, |frame| frame.technique_index = TechniqueIndex(1));
    node.run(&over).unwrap();
    let sentence = node.run(&stale).unwrap_err().to_string();
    assert!(sentence.contains("plan the frame again"), "{sentence}");
}

#[test]
fn a_resize_keeps_lights_apart() {
    let device = device();
    let scene = cards();
    let mut node = stage(&device, &scene, 3, &["map=32", "technique=hard map=32"]);
    let plans = |node: &mut Stage| -> Vec<FramePlan> {
        (0..3).map(|i| plan(node, i, |f| f.technique_index = TechniqueIndex(i % 2))).collect()
    };
    let before = plans(&mut node);
    let images = run(&mut node, &before);
    let memory = node.node().unwrap().memory();
    let objects = node.node().unwrap().object_count();
    assert_eq!(memory.iter().filter(|m| m.name == "visibility").count(), 1);
    assert_eq!(memory.iter().filter(|m| m.name == "depth_layers.front_depth").count(), 2);
    for extent in [[32, 48], [64, 64]] {
        let allocator = device.allocator();
        let mut allocator = allocator.lock().unwrap();
        let old = node.node().unwrap().visibility().unwrap();
        let retired = node.node().unwrap().resize(&mut *allocator, extent).unwrap();
        let new = node.node().unwrap().visibility().unwrap();
        assert!(new.image != old.image && new.extent == extent && new.layers == 3);
        let views: Vec<_> =
            (0..4).map(|i| node.node().unwrap().visibility_layer(LightIndex(i))).collect();
        assert!(views[..3].iter().all(|v| v.is_some_and(|v| v != new.view)), "{views:?}");
        assert_eq!(views[3], None);
        retired.destroy(&mut *allocator);
    }
    let sentence = node.run(&before[0]).unwrap_err().to_string();
    assert!(sentence.contains("before a resize"), "{sentence}");
    let after = plans(&mut node);
    assert_eq!(steps(&after), steps(&before), "nothing is kept");
    assert!(run(&mut node, &after) == images);
    assert_eq!(node.node().unwrap().object_count(), objects);
    assert_eq!(node.node().unwrap().memory(), memory);
}

/// A frame of one light picks up what the one before it hands back, in whatever layout.
#[test]
fn images_are_handed_from_light_to_light() {
    let device = device();
    let scene = cards();
    let mut node = stage(&device, &scene, 3, &["map=32"]);
    let images = {
        let plans: Vec<_> = (0..3).map(|i| plan(&mut node, i, |_| {})).collect();
        run(&mut node, &plans)
    };
    // The middle one has nothing to shadow: it hands on what it has not touched.
    let mut depth = None;
    let lights = [(0, false), (1, true), (2, false)];
    let plans: Vec<_> = lights
        .into_iter()
        .map(|(index, away)| {
            let planned = node.plan_with(light(shift(index), away), |frame| {
                frame.light_index = LightIndex(index);
                let found = depth.unwrap_or(frame.depth);
                // Last it goes back into the layout that it came in.
                let after = if index == 2 { frame.depth.after } else { Scope::FRAGMENT_SAMPLED };
                frame.depth = antumbra::HostImage { after, ..found };
                depth = Some(frame.depth.handed_back());
                let Visibility::Own { before, .. } = frame.visibility else { panic!() };
                frame.visibility = Visibility::Own { before: before.forgotten(), after: before };
            });
            planned.unwrap()
        })
        .collect();
    let handed = run(&mut node, &plans);
    assert!(handed[0] == images[0] && handed[2] == images[2]);
    assert!(handed[1].iter().all(|&v| v == 1.0));
}

#[test]
fn what_does_not_exist_is_refused() {
    let device = device();
    let scene = cards();
    let mut node = stage(&device, &scene, 2, &["map=32"]);
    let sentence = |node: &mut Stage, light_index, technique_index| {
        let planned = node.plan_with(light(0.0, false), |frame| {
            (frame.light_index, frame.technique_index) = (light_index, technique_index);
        });
        planned.unwrap_err().to_string()
    };
    assert!(
        sentence(&mut node, LightIndex(2), TechniqueIndex(0)).contains("light 2 does not exist")
    );
    assert!(
        sentence(&mut node, LightIndex(0), TechniqueIndex(1))
            .contains("technique 1 does not exist")
    );
    for lights in [0, 65] {
        let refused = configure(&mut node, lights, &["map=32"]).unwrap_err().to_string();
        assert!(refused.contains("1 to 64 lights"), "{refused}");
    }
    configure(&mut node, 64, &["map=16"]).unwrap();
}
