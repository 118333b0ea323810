//! The hierarchy of triangles, read back from the device: is every triangle in exactly one leaf, and in all boxes above it?

use antumbra::Technique;
use antumbra::scene::{Mesh, Role, Scene, generate};
use antumbra::stages::hierarchy::LEAF;
use antumbra_harness::{DeviceTree, HeadlessDevice, Link, Stage, View};
use antumbra_tests::device;
use antumbra_tests::measure::model;
use glam::{DMat4, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};

/// A box's sides are rounded outwards to steps, with a margin for the arithmetic.
const LOOSE_STEPS: f32 = 3.0;

/// Walks the whole tree, checks that boxes hold what is below them and hardly more, and returns the leaves in order.
fn leaves_of(tree: &DeviceTree) -> Vec<usize> {
    let mut leaves = Vec::new();
    let mut held = vec![[Vec3::MAX, Vec3::MIN]; tree.nodes];
    // The nodes whose subtrees hold the present one: the box and the end of each.
    let mut above: Vec<(usize, usize)> = Vec::new();
    for place in 0..tree.nodes {
        above.retain(|(_, end)| place < *end);
        let leaf = match tree.link(place) {
            Link::Leaf(leaf) => leaf,
            Link::End(end) => {
                assert!(end > place && end <= tree.nodes, "node {place} ends at {end}");
                assert!(
                    above.iter().all(|(_, outer)| end <= *outer),
                    "node {place} leaves another"
                );
                above.push((place, end));
                continue;
            }
        };
        leaves.push(leaf);
        for corner in DeviceTree::places(leaf).filter_map(|i| tree.triangle(i)).flatten() {
            for (node, _) in above.iter().chain(&[(place, place + 1)]) {
                let [low, high] = &mut held[*node];
                (*low, *high) = (low.min(corner), high.max(corner));
            }
        }
    }
    for (node, [low, high]) in held.into_iter().enumerate() {
        check_box(tree, node, low, high);
    }
    assert!(above.iter().all(|(_, end)| *end == tree.nodes), "a node ends beyond the last");
    leaves
}

/// Checks a node's box against the box of what it holds, which is none where its leaves are empty.
fn check_box(tree: &DeviceTree, node: usize, low: Vec3, high: Vec3) {
    let [least, most] = tree.bounds(node);
    let loose = tree.step * LOOSE_STEPS;
    let holds = low.cmpge(least).all() && high.cmple(most).all();
    assert!(holds || low.x > high.x, "{low} to {high} outside of {least} to {most} of node {node}");
    let tight = (low - loose).cmple(least).all() && (high + loose).cmpge(most).all();
    assert!(
        tight || low.x > high.x,
        "{low} to {high} in {least} to {most}, too large for node {node}"
    );
}

/// A stage of `traced` over a scene.
pub fn stage_of(device: &HeadlessDevice, scene: &Scene) -> Stage {
    let technique: Technique = "traced".parse().unwrap();
    Stage::new(device, scene, &View::map_of_ground(3.0, 8.0), [32; 2], technique, |_| true).unwrap()
}

/// The leaves of a scene's hierarchy.
pub fn leaves_in(scene: &Scene) -> usize {
    let blocking = scene.instances.iter().filter(|i| i.role.blocks());
    blocking.map(|i| (scene.meshes[i.mesh].indices.len() / 3).div_ceil(LEAF as usize)).sum()
}

/// Builds a scene's hierarchy and checks it; returns how many triangles are in it. None where nothing can be shadowed,
/// and no hierarchy is built.
fn check(stage: &mut Stage, scene: &Scene) -> Option<usize> {
    let plan = stage.plan(scene.light(None).unwrap().light, None).unwrap();
    stage.run(&plan).unwrap();
    plan.passes().find(|(name, _)| *name == "hierarchy.nodes")?;
    let leaves = leaves_in(scene);
    let places = leaves * LEAF as usize;
    let tree = DeviceTree::read(stage, &plan, leaves).unwrap();
    let mut found = leaves_of(&tree);
    found.sort_unstable();
    assert!(found.iter().copied().eq(0..leaves), "each leaf once");
    Some((0..places).filter_map(|nth| tree.triangle(nth)).count())
}

/// A mesh of triangles anywhere, some of them degenerate, some with corners that are no numbers or do not exist.
fn mesh(corners: &[[f32; 3]], indices: &[u32]) -> Mesh {
    let count = corners.len() as u32;
    Mesh {
        positions: corners.to_vec(),
        normals: vec![[0.0, 1.0, 0.0]; corners.len()],
        // What is at least 1000 stays beyond the last vertex.
        indices: indices.iter().map(|&i| if i < 1000 { i % count } else { i }).collect(),
        ..Mesh::default()
    }
}

#[test]
fn every_triangle_is_in_one_leaf_and_boxes_hold_it() {
    let device = device();
    let light = || generate::square_light(0.5).unwrap();
    let mut scene = generate::normalized(&model("bunny"), light()).unwrap();
    scene = scene.with_occluders_as(Role::Both);
    let triangles = scene.triangles();
    let found = check(&mut stage_of(&device, &scene), &scene);
    let ground = scene.instances.iter().filter(|i| !i.role.blocks());
    let apart: usize = ground.map(|i| scene.meshes[i.mesh].indices.len() / 3).sum();
    assert_eq!(found, Some(triangles - apart));
}

/// Triangles that are no triangles take no place, and hang nothing.
#[test]
fn any_triangles_make_a_sound_hierarchy() {
    let device = device();
    let light = generate::square_light(0.5).unwrap();
    let coordinate = prop_oneof![
        8 => -1.0f32..1.0,
        1 => Just(0.25f32),
        1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(-900f32)],
    ];
    let corners = prop::collection::vec(prop::array::uniform3(coordinate), 1..60);
    let indices = prop::collection::vec(prop_oneof![20 => 0u32..60, 1 => 1000u32..2000], 3..200);
    let meshes = prop::collection::vec((corners, indices), 1..6);
    let config = Config { cases: 24, rng_seed: RngSeed::Fixed(7), ..Config::default() };
    TestRunner::new(config)
        .run(&meshes, |meshes| {
            let mut scene = generate::stage(light);
            let mut sound = 0;
            for (nth, (corners, indices)) in meshes.iter().enumerate() {
                let indices = &indices[..indices.len() / 3 * 3];
                let mesh = mesh(corners, indices);
                let is_sound = |t: &[u32]| {
                    t.iter().all(|&i| {
                        let corner = mesh.positions.get(i as usize);
                        corner.is_some_and(|p| p.iter().all(|x| x.is_finite()))
                    })
                };
                sound += mesh.indices.chunks_exact(3).filter(|t| is_sound(t)).count();
                let at = DMat4::from_translation(DVec3::new(nth as f64, 2.0, 0.0));
                scene.add("any", mesh, at, Role::Both);
            }
            let others: usize = scene.instances[..scene.instances.len() - meshes.len()]
                .iter()
                .filter(|i| i.role.blocks())
                .map(|i| scene.meshes[i.mesh].indices.len() / 3)
                .sum();
            let bounded = scene
                .meshes
                .iter()
                .all(|m| m.bounds().as_flattened().iter().all(|x| x.is_finite()));
            prop_assume!(bounded);
            let found = check(&mut stage_of(&device, &scene), &scene);
            prop_assert!(found.is_none_or(|found| found == sound + others), "{:?}", found);
            Ok(())
        })
        .unwrap();
}

/// Ten thousand triangles at one place have equal keys, which only their numbers tell apart.
#[test]
fn many_triangles_at_one_place_make_a_tree_of_bounded_depth() {
    let device = device();
    let mut scene = generate::stage(generate::square_light(0.5).unwrap());
    let corners = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 0.1]];
    let indices: Vec<u32> = (0..30_000).map(|i| i % 3).collect();
    scene.add("pile", mesh(&corners, &indices), DMat4::from_translation(DVec3::Y), Role::Both);
    let others = scene.triangles() - 10_000;
    let blocking = scene.instances.iter().filter(|i| !i.role.blocks());
    let apart: usize = blocking.map(|i| scene.meshes[i.mesh].indices.len() / 3).sum();
    let found = check(&mut stage_of(&device, &scene), &scene);
    assert_eq!(found, Some(10_000 + others - apart));
}

/// The check notices a box that does not hold its triangles.
#[test]
#[should_panic(expected = "outside")]
fn a_box_that_is_too_small_is_noticed() {
    let device = device();
    let scene = generate::card(generate::square_light(0.5).unwrap());
    let mut stage = stage_of(&device, &scene);
    let plan = stage.plan(scene.light(None).unwrap().light, None).unwrap();
    stage.run(&plan).unwrap();
    let mut tree = DeviceTree::read(&mut stage, &plan, 1).unwrap();
    tree.step *= 0.5;
    leaves_of(&tree);
}
