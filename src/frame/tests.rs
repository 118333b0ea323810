use super::*;
use crate::RectangleLight;
use crate::graph::MeshList;
use crate::lent::Slot;
use crate::lent::*;
use crate::scene::{Role, generate};
use crate::stages::depth_layers::{Eye, MapView};
use ash::vk::Handle;
use glam::DVec3;

mod kinds;
mod lights;
mod plans;
mod several;

fn image(format: vk::Format, extent: [u32; 2], usage: vk::ImageUsageFlags) -> HostImage {
    HostImage {
        image: vk::Image::from_raw(1),
        view: vk::ImageView::from_raw(2),
        format,
        extent,
        usage,
        before: Scope::FRAGMENT_SAMPLED,
        after: Scope::FRAGMENT_SAMPLED,
    }
}

fn depth() -> HostImage {
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    image(vk::Format::D32_SFLOAT, [64, 48], usage)
}

fn target() -> HostImage {
    let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
    let image = image(vk::Format::R32_SFLOAT, [64, 48], usage);
    HostImage { image: vk::Image::from_raw(5), ..image }
}

fn mesh(bounds: MeshBounds, at: DVec3, role: Role) -> MeshInstance {
    let geometry = Geometry::Buffers(MeshBuffers {
        positions: vk::Buffer::from_raw(3),
        positions_offset: 0,
        positions_stride: 12,
        indices: None,
        count: 36,
    });
    MeshInstance::new(geometry, DMat4::from_translation(at), bounds, role)
}

const GROUND: MeshBounds = [[-4.0, 0.0, -4.0], [4.0, 0.0, 4.0]];
const CUBE: MeshBounds = [[-0.5; 3], [0.5; 3]];

fn meshes() -> Vec<MeshInstance> {
    vec![mesh(GROUND, DVec3::ZERO, Role::Both), mesh(CUBE, DVec3::new(0.0, 1.5, 0.0), Role::Both)]
}

fn frame(meshes: &[MeshInstance]) -> Frame<'_> {
    let light = generate::square_light(0.5).unwrap();
    Frame { background: Some(0.0), ..Frame::new(Slot(0), light, DMat4::IDENTITY, meshes, depth()) }
}

fn description(words: &[(&str, &str)]) -> Description {
    let mut description = Description::new([64, 48]);
    for (key, value) in words {
        description.technique.set(key, value).unwrap();
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
fn the_passes_that_settings_call_for_run_in_order() {
    let meshes = meshes();
    let pixels = make(&description(&[]), &frame(&meshes));
    assert_eq!(
        ran(&pixels),
        [
            "gbuffer.constants",
            "depth_layers.front",
            "depth_layers.back",
            "soft_shadow_map.blocks",
            "soft_shadow_map.superblocks",
            "visibility.tiles_start",
            "visibility.tiles",
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
    let why = plan.plan.graph.why(pass);
    let expected = "1 of 2 occluder meshes can shadow some of 2 receiver meshes";
    assert_eq!(why.to_string(), expected);
}

#[test]
fn without_anything_to_shadow_only_the_lit_pass_runs_and_says_why() {
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
        assert_eq!(plan.plan.skipped.len(), 13);
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
    assert!(refuse(&Frame { slot: Slot(2), ..f }).contains("2 frames in flight"));
    assert!(refuse(&Frame { mask: Some(depth()), ..f }).contains("mask"));
    let nan = DMat4::from_scale(DVec3::NAN);
    assert!(refuse(&Frame { world_from_ndc: nan, ..f }).contains("finite"));
    assert!(refuse(&Frame { world_from_ndc: DMat4::ZERO, ..f }).contains("invertible"));
    let window = Some([[0.5; 2], [0.5; 2]]);
    assert!(refuse(&Frame { window, ..f }).contains("least first"));
    let mut stride = good.clone();
    let Geometry::Buffers(buffers) = &mut stride[1].geometry else { unreachable!() };
    buffers.positions_stride = 20;
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
    let tiny = |d: &mut Description| {
        d.technique = crate::techniques::pcss::Settings { map: 4097, ..Default::default() }.into();
    };
    assert!(refuse(tiny).contains("0 to 4096"));
}

/// Each fault of an image gets an error that names the image, what it is and what it should be.
#[test]
fn every_bad_image_is_one_sentence() {
    let meshes = meshes();
    let d = description(&[]);
    let f = frame(&meshes);
    let refuse = |depth: HostImage| {
        plan(&d, Limits::default(), &Frame { depth, ..f }).map(|p| ran(&p)).unwrap_err().to_string()
    };
    let undefined = Scope::DEPTH_DRAWN.forgotten();
    for (wrong, words) in [
        (HostImage { extent: [64, 40], ..depth() }, ["64×40", "64×48"]),
        (HostImage { format: vk::Format::D16_UNORM, ..depth() }, ["D16_UNORM", "D32_SFLOAT"]),
        (
            HostImage { usage: vk::ImageUsageFlags::STORAGE, ..depth() },
            ["without SAMPLED", "STORAGE"],
        ),
        (HostImage { before: undefined, ..depth() }, ["UNDEFINED", "which layout"]),
        (
            HostImage { before: Scope::COLOR_DRAWN, ..depth() },
            ["COLOR_ATTACHMENT", "layout of color"],
        ),
        (HostImage { view: vk::ImageView::null(), ..depth() }, ["view", "null"]),
    ] {
        let sentence = refuse(wrong);
        let named = sentence.starts_with("gbuffer.depth");
        assert!(named && words.iter().all(|w| sentence.contains(w)), "{words:?}: {sentence}");
    }
}

#[test]
fn what_is_lent_must_be_what_was_described() {
    let meshes = meshes();
    let f = frame(&meshes);
    let refuse = |d: &Description, frame: Frame| {
        plan(d, Limits::default(), &frame).map(|p| ran(&p)).unwrap_err().to_string()
    };
    let visibility = Visibility::Lent(target());
    let lent = Description { lent_visibility: true, ..description(&[]) };
    make(&lent, &Frame { visibility, ..f });
    assert!(refuse(&lent, f).contains("lent_visibility"));
    assert!(refuse(&description(&[]), Frame { visibility, ..f }).contains("lent_visibility"));
    let dry = HostImage { usage: vk::ImageUsageFlags::SAMPLED, ..target() };
    let visibility = Visibility::Lent(dry);
    assert!(
        refuse(&lent, Frame { visibility, ..f }).contains("visibility was created without STORAGE")
    );

    let d16 = Some(vk::Format::D16_UNORM);
    let maps = Description { occluder_maps: d16, ..description(&[("map", "32")]) };
    let map = image(vk::Format::D16_UNORM, [32; 2], vk::ImageUsageFlags::SAMPLED);
    let view = MapView {
        eye: Eye::Behind(0.0),
        min: [-1.0; 2],
        max: [1.0; 2],
        near: 0.5,
        far: 9.0,
        side: 32,
    };
    let clip_from_world = view.clip_from_light() * f.light.rectangle().light_from_world();
    let both = OccluderMaps { front: map, back: Some(map), clip_from_world };
    let with = |maps| Frame { occluder_maps: Some(maps), ..f };
    assert_eq!(
        ran(&make(&maps, &with(both)))[1..3],
        ["depth_layers.copy_front", "depth_layers.copy_back"]
    );
    assert!(refuse(&maps, f).contains("occluder maps"));
    assert!(refuse(&description(&[]), with(both)).contains("occluder maps"));
    assert!(refuse(&maps, with(OccluderMaps { back: None, ..both })).contains("set sides=one"));
    let small = HostImage { extent: [16; 2], ..map };
    assert!(refuse(&maps, with(OccluderMaps { front: small, ..both })).contains("16×16"));
    let window = Some([[-1.0; 2], [1.0; 2]]);
    assert!(refuse(&maps, Frame { window, ..with(both) }).contains("window of their own"));
    let aside = OccluderMaps { clip_from_world: DMat4::IDENTITY, ..both };
    assert!(refuse(&maps, with(aside)).contains("clip_from_world"));
    // One side asks for no back, and an own window counts no occluder meshes.
    let one = Description { occluder_maps: d16, ..description(&[("map", "32"), ("sides", "one")]) };
    let plan = make(&one, &with(OccluderMaps { back: None, ..both }));
    assert!(plan.meshes(MeshList::Occluders).is_empty());
    assert!(plan.plan.table().contains("the host's maps may shadow"), "{}", plan.plan.table());
}

#[test]
fn the_border_is_listed_with_stage_access_and_layout() {
    let meshes = meshes();
    let mut asked = frame(&meshes);
    asked.border_barriers = BorderBarriers::Host;
    let plan = make(&description(&[]), &asked);
    let names: Vec<_> = plan.accesses().iter().map(|a| a.name).collect();
    assert_eq!(names, ["gbuffer.depth", "visibility"]);
    let depth = plan.accesses()[0].node.unwrap();
    assert!(!depth.writes && depth.entry.stage == vk::PipelineStageFlags::COMPUTE_SHADER);
    assert_eq!(depth.entry.layout, asked.depth.before.layout, "fetched where the host keeps it");
    let result = plan.accesses()[1].node.unwrap();
    assert!(result.writes);
    assert_eq!(result.exit, Scope::COMPUTE_WRITTEN);
    assert!(plan.plan.handover.is_empty());
    // Depth was not written here, but its readers behind the node were not waited for before it.
    let exits: Vec<_> = plan.exit_barriers().collect();
    assert_eq!(exits.len(), 2);
    assert_eq!(exits[1].before, Scope::COMPUTE_WRITTEN);
    let entries: Vec<_> = plan.entry_barriers().collect();
    assert_eq!(entries[1].before.layout, vk::ImageLayout::UNDEFINED, "written whole");

    // Where the node places them, what follows it is what the host named.
    let plan = make(&description(&[]), &frame(&meshes));
    let result = plan.accesses()[1];
    assert_eq!(result.node.unwrap().exit, result.after);
}

#[test]
fn what_a_frame_leaves_alone_goes_straight_to_its_next_use() {
    let border_barriers = BorderBarriers::Host;
    let lent = HostImage { before: Scope::DEPTH_DRAWN, ..depth() };
    let alone = Frame { depth: lent, border_barriers, ..frame(&[]) };
    let plan = make(&description(&[]), &alone);
    let depth = plan.accesses()[0];
    assert_eq!(depth.node, None);
    assert_eq!(depth.entry_barrier(), None);
    let exit = depth.exit_barrier().unwrap();
    assert_eq!((exit.before, exit.after), (Scope::DEPTH_DRAWN, Scope::FRAGMENT_SAMPLED));
    // Read where the node reads it, in the same layout: nothing to wait for.
    let meshes = meshes();
    let same = HostImage { after: Scope::COMPUTE_SAMPLED, ..lent };
    let plan = make(&description(&[]), &Frame { depth: same, border_barriers, ..frame(&meshes) });
    assert_eq!(plan.accesses()[0].exit_barrier(), None);
}

#[test]
fn every_buffer_that_is_read_is_listed_once() {
    let mut meshes = meshes();
    let Geometry::Buffers(buffers) = &mut meshes[1].geometry else { unreachable!() };
    buffers.indices = Some((buffers.positions, 64, vk::IndexType::UINT16));
    let mut other = meshes[1];
    let Geometry::Buffers(buffers) = &mut other.geometry else { unreachable!() };
    buffers.positions = vk::Buffer::from_raw(9);
    meshes.push(other);
    meshes.push(MeshInstance { geometry: Geometry::HostDrawn(7), ..other });
    let plan = make(&description(&[]), &frame(&meshes));
    assert!(plan.has_host_draws());
    let found: Vec<_> = plan.buffer_accesses().iter().map(|a| (a.buffer, a.scope.access)).collect();
    use vk::AccessFlags as A;
    assert_eq!(
        found,
        [
            (vk::Buffer::from_raw(3), A::VERTEX_ATTRIBUTE_READ | A::INDEX_READ),
            (vk::Buffer::from_raw(9), A::VERTEX_ATTRIBUTE_READ)
        ]
    );
}

#[test]
fn a_plan_is_shown_as_a_table_and_as_a_picture() {
    let meshes = meshes();
    let plan = make(&description(&[]), &frame(&meshes)).plan;
    let table = plan.table();
    assert!(table.starts_with("run   gbuffer.constants"), "{table}");
    assert!(table.contains("skip  visibility.lit"), "{table}");
    let dot = plan.graphviz();
    assert!(dot.starts_with("digraph") && dot.trim_end().ends_with('}'), "{dot}");
    assert!(dot.contains("depth_layers.front_depth\\n128×128 D32_SFLOAT"), "{dot}");
    assert_eq!(dot.matches("shape=box").count(), plan.steps.len());
}

fn of_technique(words: &str) -> Description {
    Description { technique: words.parse().unwrap(), ..Description::new([64, 48]) }
}

#[test]
fn every_point_of_many_lights_has_a_view_of_its_own() {
    let meshes = meshes();
    let description = of_technique("many-lights samples=9");
    let plan = make(&description, &frame(&meshes));
    let passes = ran(&plan);
    assert_eq!(passes.len(), 3 + 2 * 9);
    assert_eq!(
        passes[1..5],
        ["many_lights.receivers", "many_lights.point_depth", "many_lights.add_point", passes[2]]
    );
    assert_eq!(passes.last(), Some(&"many_lights.average"));
    let matrices: Vec<_> =
        (0..9).flat_map(|view| plan.draws(MeshList::Occluders, view)).map(|d| d.1).collect();
    assert_eq!(matrices.len(), 9, "one occluder, nine views");
    assert!((1..9).all(|i| matrices[i] != matrices[0]));
    assert_eq!(plan.draws(MeshList::Occluders, 9).count(), 0);
    assert!(plan.plan.table().contains("×9"));
    let lines = plan.plan.table().lines().filter(|l| l.starts_with("run")).count();
    assert_eq!(lines, 5, "{}", plan.plan.table());
}

#[test]
fn many_lights_take_no_ready_made_maps() {
    let mut description = of_technique("many-lights");
    description.occluder_maps = Some(vk::Format::D32_SFLOAT);
    let error = description.check().unwrap_err().to_string();
    assert!(error.contains("lend meshes"), "{error}");
}

/// Only the node's own fragments know the slices.
#[test]
fn slices_take_no_host_draws_and_no_ready_made_maps() {
    let mut meshes = meshes();
    let mut description = of_technique("occlusion-textures");
    let passes = ran(&make(&description, &frame(&meshes)));
    assert!(passes.contains(&"occlusion_textures.front_slices"), "{passes:?}");
    for mesh in &mut meshes {
        mesh.geometry = Geometry::HostDrawn(7);
    }
    let error = plan(&description, Limits::default(), &frame(&meshes)).unwrap_err().to_string();
    assert!(error.contains("drawn by the host") && error.contains("give its buffers"), "{error}");
    // A mesh that only receives is not sorted into slices.
    for mesh in &mut meshes {
        mesh.role = Role::Receiver;
    }
    assert!(plan(&description, Limits::default(), &frame(&meshes)).is_ok());
    description.occluder_maps = Some(vk::Format::D32_SFLOAT);
    let error = description.check().unwrap_err().to_string();
    assert!(error.contains("lend meshes"), "{error}");
}
