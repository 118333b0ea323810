//! What hosts stumble over at the border without a mistake of theirs.

use super::*;
use antumbra::LightIndex;
use antumbra::Slot;
use antumbra::frame::plan_all;
use antumbra::{BorderBarriers, Visibility};

/// A host whose maths crate is another, or another version, gives arrays.
#[test]
fn arrays_serve_as_well_as_glam() {
    let host = Host::new();
    let wanted = host.plan();
    let f64s = host.clip_from_world.inverse().to_cols_array();
    let columns = host.clip_from_world.inverse().to_cols_array_2d();
    let bounds = [host.meshes[0].bounds, host.meshes[1].bounds];
    let meshes: Vec<_> = (host.meshes.iter().zip(bounds))
        .map(|(mesh, bounds)| {
            let transform = mesh.world_from_mesh.to_cols_array().map(|x| x as f32);
            MeshInstance::new(mesh.geometry, transform, bounds, mesh.role)
        })
        .collect();
    let light =
        RectangleLight::facing([0.0, 3.0, 0.0f32], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.5; 2]);
    let light = light.unwrap();
    for frame in [
        Frame::new(Slot(0), light, f64s, &meshes, depth()),
        Frame::new(Slot(0), light, columns, &meshes, depth()),
    ] {
        let plan = frame::plan(&host.description, Limits::default(), &frame).unwrap();
        assert_eq!(plan, wanted);
    }
    let single = Frame::new(Slot(0), light, f64s.map(|x| x as f32), &meshes, depth());
    let plan = frame::plan(&host.description, Limits::default(), &single).unwrap();
    assert_eq!(plan.doubts(), [], "single precision is no mistake");
}

#[test]
fn a_host_that_clears_depth_next_does_not_care_how_it_comes_back() {
    let host = Host::new();
    let change = |f: &mut Frame| {
        f.depth.after = Scope::ANY;
        f.border_barriers = BorderBarriers::Host;
    };
    let plan = host.plan_with(change).unwrap();
    let access = plan.accesses().iter().find(|a| a.name == "gbuffer.depth").unwrap();
    let barrier = access.exit_barrier().unwrap();
    assert_eq!(barrier.before.layout, barrier.after.layout, "the layout stays");
    assert_eq!(barrier.after.stage, vk::PipelineStageFlags::ALL_COMMANDS);
    // A second light would not know where it is.
    let any = HostImage { after: Scope::ANY, ..depth() };
    let sentence = host.refused(|f| f.depth = any.handed_back());
    says(&sentence, &["gbuffer.depth", "handed_back()", "`after`", "UNDEFINED"]);
}

#[test]
fn lights_hand_depth_on_and_the_last_one_need_not_care() {
    let mut host = Host::new();
    host.description.lights = 2;
    let first = depth();
    let second = HostImage { after: Scope::ANY, ..first.handed_back() };
    let frame = |light_index, depth| {
        let matrix = host.clip_from_world.inverse();
        Frame { light_index, ..Frame::new(Slot(0), host.light, matrix, &host.meshes, depth) }
    };
    let mut plans = antumbra::FramePlans::new();
    let frames = [frame(LightIndex(0), first), frame(LightIndex(1), second)];
    plan_all(&host.description, Limits::default(), &frames, &mut plans).unwrap();
    assert!(plans.all().iter().all(|plan| plan.doubts().is_empty()));
}

#[test]
fn depth_without_stencil_has_a_scope_of_its_own() {
    let plan = Host::new().plan_with(|f| f.depth.before = Scope::DEPTH_DRAWN_ONLY).unwrap();
    let barrier = plan.entry_barriers().find(|b| b.image == depth().image).unwrap();
    let (one, two) = (barrier.vk(), barrier.vk2());
    assert_eq!(one.old_layout, vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL);
    assert_eq!((two.old_layout, two.new_layout), (one.old_layout, one.new_layout));
    assert_eq!(two.src_stage_mask, vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS);
    assert_eq!(two.dst_stage_mask, vk::PipelineStageFlags2::COMPUTE_SHADER);
    assert_eq!(two.src_access_mask, vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE);
    assert_eq!(two.image, depth().image);
}

#[test]
fn the_first_frame_has_no_use_before() {
    let host = Host::new();
    let after = Scope::FRAGMENT_SAMPLED;
    for before in [Scope::UNUSED, after] {
        let plan = host.plan_with(|f| f.visibility = Visibility::Own { before, after }).unwrap();
        let result = plan.accesses().iter().find(|a| a.name == "visibility").unwrap();
        let barrier = result.entry_barrier().unwrap();
        assert_eq!(
            barrier.before.layout,
            vk::ImageLayout::UNDEFINED,
            "whatever it held is forgotten"
        );
    }
    documented(&["In the first frame, and the first after a resize, there was no use before"]);
}

#[test]
fn conventions_are_documented() {
    documented(&[
        "column vectors",
        "right-handed",
        "inverse(projection * view) * scale(1, -1, 1)",
        "counter-clockwise",
        "metres",
        "including its jitter",
        "`[least, largest]`",
        "`half_v × half_u`",
    ]);
}
