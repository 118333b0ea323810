use super::*;
use crate::graph::{MeshList, Need};
use crate::scene::generate;
use glam::DVec3;

const UNUSED: Scope = Scope {
    stage: vk::PipelineStageFlags::FRAGMENT_SHADER,
    access: vk::AccessFlags::SHADER_READ,
    layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
};
const IMAGE: HostImage = HostImage {
    image: vk::Image::null(),
    view: vk::ImageView::null(),
    before: UNUSED,
    after: UNUSED,
};

fn mesh(bounds: Bounds, at: DVec3, role: Role) -> MeshInstance {
    MeshInstance {
        positions: vk::Buffer::null(),
        positions_offset: 0,
        positions_stride: 12,
        indices: None,
        count: 36,
        world_from_mesh: DMat4::from_translation(at),
        bounds,
        role,
        double_sided: false,
    }
}

const GROUND: Bounds = [[-4.0, 0.0, -4.0], [4.0, 0.0, 4.0]];
const CUBE: Bounds = [[-0.5; 3], [0.5; 3]];

fn meshes() -> Vec<MeshInstance> {
    vec![mesh(GROUND, DVec3::ZERO, Role::Both), mesh(CUBE, DVec3::new(0.0, 1.5, 0.0), Role::Both)]
}

fn frame(meshes: &[MeshInstance]) -> Frame<'_> {
    Frame {
        light: generate::square_light(0.5).unwrap(),
        world_from_ndc: DMat4::IDENTITY,
        background: 0.0,
        meshes,
        depth: IMAGE,
        mask: None,
        visibility_before: UNUSED,
        visibility_after: UNUSED,
        window: None,
        slot: 0,
        border_barriers: BorderBarriers::Node,
    }
}

fn description(words: &[(&str, &str)]) -> Description {
    let mut description = Description::new([64, 48]);
    for (key, value) in words {
        description.settings.set(key, value).unwrap();
    }
    description
}

fn ran(plan: &FramePlan) -> Vec<&'static str> {
    plan.plan.steps.iter().map(|s| plan.plan.graph.passes()[s.pass].name).collect()
}

fn make(description: &Description, frame: &Frame) -> FramePlan {
    plan(description, Limits::default(), frame).unwrap()
}

#[test]
fn the_rows_that_settings_call_for_run_in_order() {
    let meshes = meshes();
    let pixels = make(&description(&[]), &frame(&meshes));
    assert_eq!(
        ran(&pixels),
        [
            "depth_layers.front",
            "depth_layers.back",
            "soft_shadow_map.blocks",
            "soft_shadow_map.superblocks",
            "soft_shadow_map.gather_pixels"
        ]
    );
    let one = make(&description(&[("sides", "one")]), &frame(&meshes));
    assert!(!ran(&one).contains(&"depth_layers.back"));
    let map = [("receivers", "map"), ("accumulate", "blend"), ("sides", "one")];
    let blend = make(&description(&map), &frame(&meshes));
    assert_eq!(ran(&blend).last(), Some(&"visibility.resolve"));
    assert!(ran(&blend).contains(&"soft_shadow_map.blend_front"));
    assert_eq!(blend.meshes(MeshList::Receivers).len(), 2);
}

#[test]
fn a_ground_that_shadows_nothing_takes_no_texels() {
    let meshes = meshes();
    let plan = make(&description(&[]), &frame(&meshes));
    assert_eq!(plan.meshes(MeshList::Occluders).len(), 1, "the cube alone");
    let pass = &plan.plan.graph.passes()[plan.plan.steps[0].pass];
    assert_eq!(
        pass.need,
        Need::Yes("1 of 2 occluder meshes can shadow some of 2 receiver meshes".into())
    );
}

#[test]
fn without_anything_to_shadow_only_the_lit_row_runs_and_says_why() {
    let ground = [mesh(GROUND, DVec3::ZERO, Role::Receiver)];
    let above = [ground[0], mesh(CUBE, DVec3::new(0.0, 9.0, 0.0), Role::Occluder)];
    let aside = [mesh(GROUND, DVec3::ZERO, Role::Both)];
    let nobody = [mesh(CUBE, DVec3::new(0.0, 1.5, 0.0), Role::Occluder)];
    for (meshes, why) in [
        (&ground[..], "there are no occluders"),
        (&above, "behind the light"),
        (&aside, "flat"),
        (&nobody, "no receiver"),
        (&[], "there are no occluders"),
    ] {
        let plan = make(&description(&[]), &frame(meshes));
        assert_eq!(ran(&plan), ["visibility.lit"]);
        assert!(plan.plan.table().contains(why), "{why}: {}", plan.plan.table());
        assert_eq!(plan.plan.skipped.len(), 5);
    }
}

#[test]
fn every_bad_frame_is_one_sentence() {
    let good = meshes();
    let d = description(&[]);
    let refuse = |frame: &Frame| {
        plan(&d, Limits::default(), frame).map(|p| ran(&p)).unwrap_err().to_string()
    };
    let f = frame(&good);
    assert!(refuse(&Frame { slot: 2, ..f }).contains("2 frames in flight"));
    assert!(refuse(&Frame { mask: Some(IMAGE), ..f }).contains("mask"));
    let nan = DMat4::from_scale(DVec3::NAN);
    assert!(refuse(&Frame { world_from_ndc: nan, ..f }).contains("finite"));
    assert!(refuse(&Frame { world_from_ndc: DMat4::ZERO, ..f }).contains("invertible"));
    let window = Some([[0.5; 2], [0.5; 2]]);
    assert!(refuse(&Frame { window, ..f }).contains("least first"));
    let mut stride = good.clone();
    stride[1].positions_stride = 20;
    assert!(refuse(&frame(&stride)).contains("stride of 20"));
    let mut bounds = good.clone();
    bounds[1].bounds[0][1] = f32::NAN;
    assert!(refuse(&frame(&bounds)).contains("mesh 1"));
}

#[test]
fn every_bad_description_is_one_sentence() {
    let refuse = |change: fn(&mut Description)| {
        let mut d = Description::new([64, 48]);
        d.check().unwrap();
        change(&mut d);
        d.check().unwrap_err().to_string()
    };
    assert!(refuse(|d| d.extent = [0, 48]).contains("0×48"));
    assert!(refuse(|d| d.extent = [20_000, 48]).contains("16384"));
    assert!(refuse(|d| d.frames_in_flight = 0).contains("1 to 8"));
    assert!(refuse(|d| d.depth_format = vk::Format::R8_UNORM).contains("no depth"));
    assert!(refuse(|d| d.position_strides = vec![12, 8]).contains("8 bytes"));
    assert!(refuse(|d| d.settings.soft_shadow_map.map = 7).contains("16 to 4096"));
}

#[test]
fn the_hosts_images_are_listed_with_stage_access_and_layout() {
    let meshes = meshes();
    let mut asked = frame(&meshes);
    asked.border_barriers = BorderBarriers::Host;
    let plan = make(&description(&[]), &asked);
    let names: Vec<_> = plan.accesses().iter().map(|a| a.name).collect();
    assert_eq!(names, ["gbuffer.depth", "visibility"]);
    let depth = plan.accesses()[0];
    assert!(!depth.writes && depth.entry.stage == vk::PipelineStageFlags::COMPUTE_SHADER);
    assert_eq!(depth.entry.layout, UNUSED.layout, "fetched where the host keeps it");
    let result = plan.accesses()[1];
    assert!(result.writes);
    assert_eq!(result.exit.layout, vk::ImageLayout::GENERAL);
    assert!(plan.plan.handover.is_empty());
}

#[test]
fn a_plan_is_shown_as_a_table_and_as_a_picture() {
    let meshes = meshes();
    let plan = make(&description(&[]), &frame(&meshes)).plan;
    let table = plan.table();
    assert!(table.starts_with("run   depth_layers.front"), "{table}");
    assert!(table.contains("skip  visibility.lit"), "{table}");
    let dot = plan.graphviz();
    assert!(dot.starts_with("digraph") && dot.trim_end().ends_with('}'), "{dot}");
    assert!(dot.contains("depth_layers.front_depth\\n256×256 D32_SFLOAT"), "{dot}");
    assert_eq!(dot.matches("shape=box").count(), plan.steps.len());
}
