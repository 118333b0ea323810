//! Plans in memory that is kept are those that are made anew.

use super::kinds::WAYS;
use super::*;
use crate::RectangleLight;

/// A frame of each of three lights: one over the scene, one aside, one that shines away from it.
fn lights<'a>(meshes: &'a [MeshInstance], change: impl Fn(&mut Frame<'a>)) -> [Frame<'a>; 3] {
    [0, 1, 2].map(|light_index| {
        let mut frame = Frame { light_index: LightIndex(light_index), ..frame(meshes) };
        let light = *frame.light.rectangle();
        let [u, v] = light.half_extents();
        let at = light.center() + DVec3::X * f64::from(light_index);
        frame.light = match light_index {
            2 => RectangleLight::new(at, DVec3::X * u, DVec3::Z * v).unwrap().into(),
            _ => RectangleLight::new(at, DVec3::X * u, DVec3::NEG_Z * v).unwrap().into(),
        };
        change(&mut frame);
        frame
    })
}

#[test]
fn plans_that_are_kept_are_those_made_anew() {
    let standing = meshes();
    let mut moved = standing.clone();
    moved[1].world_from_mesh = DMat4::from_translation(DVec3::new(0.4, 1.2, 0.1));
    let mut more = moved.clone();
    more.extend((0..40).map(|i| {
        let at = DVec3::new(f64::from(i) - 20.0, 0.5, f64::from(i % 7) - 3.0);
        mesh(CUBE, at, if i % 3 == 0 { Role::Occluder } else { Role::Both })
    }));
    let empty = Vec::new();
    let far = DMat4::from_scale(DVec3::splat(3.0));
    for words in WAYS {
        let description = Description {
            technique: words.parse().unwrap(),
            lights: 3,
            ..Description::new([64, 48])
        };
        let mut plans = FramePlans::new();
        let mut check = |what: &str, frames: &[Frame]| {
            plan_all(&description, Limits::default(), frames, &mut plans).unwrap();
            assert_eq!(plans.all().len(), frames.len());
            for (plan, frame) in plans.all().iter().zip(frames) {
                assert!(*plan == make(&description, frame), "{words}: {what}");
            }
        };
        check("at first", &lights(&standing, |_| ()));
        check("again", &lights(&standing, |_| ()));
        check("moved", &lights(&moved, |_| ()));
        check("numbered", &lights(&moved, |f| f.revision = Some(1)));
        check("the same number", &lights(&moved, |f| f.revision = Some(1)));
        check(
            "another camera",
            &lights(&moved, |f| (f.revision, f.world_from_ndc) = (Some(1), far)),
        );
        check("another number", &lights(&more, |f| f.revision = Some(2)));
        check("fewer lights", &lights(&more, |f| f.revision = Some(2))[1..]);
        check("the host's barriers", &lights(&more, |f| f.border_barriers = BorderBarriers::Host));
        check("within reach", &lights(&more, |f| f.reach = Some(5.0)));
        check("out of reach", &lights(&more, |f| f.reach = Some(0.5)));
        check("nothing", &lights(&empty, |_| ()));
        check("and back", &lights(&standing, |f| f.revision = Some(1)));
    }
}

#[test]
fn a_frame_that_is_refused_leaves_the_plans_before_it() {
    let meshes = meshes();
    let description = Description { lights: 3, ..Description::new([64, 48]) };
    let mut plans = FramePlans::new();
    let mut frames = lights(&meshes, |f| f.revision = Some(1));
    plan_all(&description, Limits::default(), &frames, &mut plans).unwrap();
    frames[1].reach = Some(-1.0);
    let error = plan_all(&description, Limits::default(), &frames, &mut plans).unwrap_err();
    assert!(error.to_string().contains("reach is -1"), "{error}");
    assert_eq!(plans.all().len(), 1);
    frames[1].reach = Some(f64::NAN);
    assert!(plan_all(&description, Limits::default(), &frames, &mut plans).is_err());
    frames[1].reach = None;
    plan_all(&description, Limits::default(), &frames, &mut plans).unwrap();
    for (plan, frame) in plans.all().iter().zip(&frames) {
        assert!(*plan == make(&description, frame));
    }
}

/// Occluders that cannot lie between the light and a receiver are not drawn, and the plan's report counts them.
#[test]
fn only_what_lies_between_light_and_receivers_is_drawn() {
    let light = generate::square_light(0.5).unwrap();
    let up = -light.emission();
    let above = light.center() + up;
    let mut meshes = meshes();
    meshes[0].role = Role::Receiver;
    let block = |at| mesh(CUBE, at, Role::Occluder);
    // Behind the light, beneath the ground, beside all light that falls on it.
    meshes.extend([block(above), block(-up), block(DVec3::new(4.9, 1.5, 0.0))]);
    let plan = make(&description(&[]), &frame(&meshes));
    assert_eq!(plan.meshes(MeshList::Occluders).len(), 1);
    let why = plan.explain();
    assert!(why.contains("1 of 4 occluder meshes can shadow some of 2"), "{why}");
    assert!(why.contains("3 of 4 occluder meshes lie outside"), "{why}");
    // Where only the cube receives, what stands beside it shadows nothing of it.
    meshes[0].role = Role::Occluder;
    let plan = make(&description(&[]), &frame(&meshes));
    assert_eq!(plan.meshes(MeshList::Occluders).len(), 1, "{}", plan.explain());
}
