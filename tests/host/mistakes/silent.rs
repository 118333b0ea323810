//! What would give a wrong image and no error.

use super::*;
use antumbra::Slot;

#[test]
fn mistake_18_the_depth_of_the_background() {
    let host = Host::new();
    assert_eq!(host.plan_with(|f| f.background = Some(0.0)).unwrap().doubts(), []);
    let plan = host.plan_with(|f| f.background = Some(1.0)).unwrap();
    // The matrix is as it was, and is not doubted for it.
    assert_eq!(plan.doubts(), [Doubt::Background { given: 1.0 }]);
    says(&plan.explain(), &["doubt: background is 1", "depth 0 is the far end"]);
    // From an orthographic matrix it does not follow.
    let above = DMat4::from_scale(DVec3::splat(4.0));
    says(&host.refused(|f| f.world_from_ndc = above), &["orthographic", "give background"]);
}

#[test]
fn mistake_19_a_flip_of_y_that_is_missing_or_doubled() {
    let host = Host::new();
    let flip = DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0));
    let y_up = flip * host.clip_from_world;
    for world_from_ndc in [y_up.inverse(), host.clip_from_world.inverse() * flip] {
        let plan = host.plan_with(|f| f.world_from_ndc = world_from_ndc).unwrap();
        assert_eq!(plan.doubts(), [Doubt::Mirrored]);
        says(
            &plan.explain(),
            &["doubt: the camera shows the world mirrored", "scale(1, -1, 1)", ", mirrored,"],
        );
    }
    // As documented, by whichever convention of depth.
    let plan = host.plan_with(|f| f.world_from_ndc = y_up.inverse() * flip).unwrap();
    assert_eq!(plan.doubts(), []);
    // Depth 1 − z where it was z.
    let mut other_way = DMat4::IDENTITY;
    (other_way.z_axis.z, other_way.w_axis.z) = (-1.0, 1.0);
    let standard = other_way * host.clip_from_world;
    assert_eq!(host.plan_with(|f| f.world_from_ndc = standard.inverse()).unwrap().doubts(), []);
    let plan = host.plan_with(|f| f.world_from_ndc = standard.inverse() * flip).unwrap();
    assert_eq!(plan.doubts(), [Doubt::Mirrored]);
}

#[test]
fn mistake_20_a_camera_that_is_not_inverted() {
    let host = Host::new();
    let plan = host.plan_with(|f| f.world_from_ndc = host.clip_from_world).unwrap();
    let [Doubt::Aslant { row }] = plan.doubts() else { panic!("{:?}", plan.doubts()) };
    assert_eq!(*row, host.clip_from_world.row(3).to_array());
    says(
        &plan.explain(),
        &["doubt: world_from_ndc's last row is", "give the inverse of projection * view"],
    );
}

#[test]
fn mistake_21_a_transposed_camera() {
    let host = Host::new();
    let transposed = host.clip_from_world.inverse().transpose();
    let plan = host.plan_with(|f| f.world_from_ndc = transposed).unwrap();
    println!("{}", plan.explain());
    assert!(matches!(plan.doubts()[0], Doubt::Aslant { .. }), "{:?}", plan.doubts());
    says(&plan.explain(), &["not transposed"]);
}

#[test]
fn a_camera_that_looks_elsewhere_is_doubted_gently() {
    let mut host = Host::new();
    host.meshes.iter_mut().for_each(|mesh| mesh.world_from_mesh.w_axis.x += 100.0);
    let light = [100.0, 3.0, 0.0];
    host.light = RectangleLight::facing(light, DVec3::NEG_Y, DVec3::X, [0.5; 2]).unwrap();
    let plan = host.plan();
    let eye = Some(EYE.to_array().map(|x| (x * 1e6).round() / 1e6));
    let Doubt::SeesNoReceiver { receivers: 2, eye: Some(at) } = plan.doubts()[0] else {
        panic!("{:?}", plan.doubts())
    };
    assert_eq!(Some(at.map(|x| (x * 1e6).round() / 1e6)), eye);
    says(
        &plan.explain(),
        &["sees none of 2 receivers", "unless it looks elsewhere", "sees 0 of 2"],
    );
}

#[test]
fn a_camera_that_is_turned_round_has_everything_behind_it() {
    let host = Host::new();
    let turn = DMat4::from_translation(EYE)
        * DMat4::from_rotation_y(std::f64::consts::PI)
        * DMat4::from_translation(-EYE);
    let turned = turn * host.clip_from_world.inverse();
    let plan = host.plan_with(|f| f.world_from_ndc = turned).unwrap();
    assert!(matches!(
        plan.doubts(),
        [Doubt::SeesNoReceiver { receivers: 2, .. }, Doubt::EndlessPenumbra]
    ));
    says(&plan.explain(), &["doubt: all that may be shadowed lies behind the camera"]);
    // Among what may be shadowed penumbrae have no end either, and nothing is wrong.
    let into = DMat4::from_translation(DVec3::new(0.0, 0.2, 1.0) - EYE);
    let inside = into * host.clip_from_world.inverse();
    let plan = host.plan_with(|f| f.world_from_ndc = inside).unwrap();
    assert_eq!(plan.doubts(), []);
    says(&plan.explain(), &["reaches up to the eye, where penumbrae span inf pixels"]);
}

#[test]
fn depths_on_two_sides_of_the_eye_are_no_cameras() {
    let host = Host::new();
    // Half way between 0 and 1 lies what is infinitely far.
    let mut add_half_w = DMat4::IDENTITY;
    add_half_w.w_axis.z = 0.5;
    let matrix = (add_half_w * host.clip_from_world).inverse();
    let plan = host.plan_with(|f| f.world_from_ndc = matrix).unwrap();
    assert_eq!(plan.doubts()[0], Doubt::EyeAmongDepths, "{}", plan.explain());
    says(&plan.explain(), &["doubt: the camera's eye lies between its near and its far plane"]);
}

#[test]
fn mistake_22_bounds_that_are_too_small() {
    // Positions lie on the device, where planning does not look.
    let mut host = Host::new();
    host.meshes[1].bounds = [[-0.1; 3], [0.1; 3]];
    assert_eq!(host.plan().doubts(), []);
    documented(&[
        "**Bounds that are too small.**",
        "What reaches beyond a box may cast no shadow, and show none",
    ]);
}

#[test]
fn mistake_23_bounds_with_their_corners_swapped() {
    for (axis, name) in [(0, "min above max in x"), (1, "in y"), (2, "in z")] {
        let mut host = Host::new();
        let [least, largest] = &mut host.meshes[1].bounds;
        std::mem::swap(&mut least[axis], &mut largest[axis]);
        says(&host.refused(|_| {}), &["mesh 1: its bounds have", name, "[least, largest]"]);
    }
    // Without triangles there is nothing to bound.
    let mut host = Host::new();
    host.meshes[1].bounds = [[f32::MAX; 3], [f32::MIN; 3]];
    let Geometry::Buffers(buffers) = &mut host.meshes[1].geometry else { unreachable!() };
    buffers.count = 0;
    host.plan();
}

#[test]
fn mistake_24_a_light_that_is_turned_round() {
    let mut host = Host::new();
    host.light = RectangleLight::facing([0.0, 3.0, 0.0], DVec3::Y, DVec3::X, [0.5; 2]).unwrap();
    let plan = host.plan();
    let emission = host.light.emission().to_array();
    let turned =
        [Doubt::OccludersBehindLight { emission }, Doubt::ReceiversBehindLight { emission }];
    assert_eq!(plan.doubts(), turned);
    says(
        &plan.explain(),
        &["doubt: every occluder within reach lies behind the light", "turn it round", "facing"],
    );
    // What lies out of reach says nothing: a lamp far from everything is no mistake.
    let idle = host.plan_with(|f| f.reach = Some(0.5)).unwrap();
    assert_eq!(idle.doubts(), []);
    // Nor does a mesh that is partly before the light.
    host.meshes[1].world_from_mesh.w_axis.y = 3.2;
    let receivers = host.plan();
    assert_eq!(receivers.doubts(), []);
}

#[test]
fn mistake_25_roles_without_a_mask() {
    let mut host = Host::new();
    host.meshes[1].role = Role::Occluder;
    let plan = host.plan();
    assert_eq!(plan.doubts(), [Doubt::OccluderWithoutMask { mesh: 1 }]);
    says(
        &plan.explain(),
        &["doubt: mesh 1 is Role::Occluder", "Frame::mask", "no mask, every pixel"],
    );
    host.description.mask_format = Some(vk::Format::R8_UNORM);
    let mask = HostImage { format: vk::Format::R8_UNORM, before: Scope::COLOR_DRAWN, ..depth() };
    let mask = HostImage { usage: Usage::COLOR_ATTACHMENT | Usage::SAMPLED, ..mask };
    let plan = host.plan_with(|f| f.mask = Some(mask)).unwrap();
    assert_eq!(plan.doubts(), []);
    says(&plan.explain(), &["roles of pixels: by the mask"]);
    // Roles by which no pixel can receive.
    host.meshes[0].role = Role::Occluder;
    let plan = host.plan_with(|f| f.mask = Some(mask)).unwrap();
    assert_eq!(plan.doubts(), [Doubt::NothingReceives]);
}

#[test]
fn mistake_26_a_revision_that_stays_when_something_moved() {
    documented(&[
        "**A `revision` that stays the same though something moved.**",
        "last frame's maps",
    ]);
}

/// Doubts cost no memory, and stay while what they are of is not looked at again.
#[test]
fn doubts_stay_with_a_revision() {
    let mut host = Host::new();
    host.meshes[1].role = Role::Occluder;
    let mut plans = antumbra::FramePlans::new();
    let matrix = host.clip_from_world.inverse();
    let own = Frame::new(Slot(0), host.light, matrix, &host.meshes, depth());
    let frame = Frame { revision: Some(1), ..own };
    for _ in 0..3 {
        frame::plan_all(&host.description, Limits::default(), &[frame], &mut plans).unwrap();
        assert_eq!(plans.all()[0].doubts(), [Doubt::OccluderWithoutMask { mesh: 1 }]);
    }
}
