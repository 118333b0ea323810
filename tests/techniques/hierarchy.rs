//! The hierarchy of triangles, read back from the device: is every triangle in exactly one leaf, and in all boxes above it?

use antumbra::scene::{Mesh, Role, Scene, generate};
use antumbra::{FramePlan, Technique};
use antumbra_harness::{HeadlessDevice, Stage, View};
use antumbra_tests::device;
use antumbra_tests::measure::model;
use glam::{DMat4, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};

/// The triangles of a leaf, the texels before the first node, and the bit that marks a leaf.
const LEAF: usize = 2;
const HEAD: usize = 2;
const IS_LEAF: u32 = 1 << 31;

/// A hierarchy as it is walked.
struct Tree {
    nodes: Vec<[u32; 4]>,
    triangles: Vec<[f32; 4]>,
    low: Vec3,
    step: Vec3,
}

impl Tree {
    fn read(stage: &mut Stage, plan: &FramePlan, count: usize) -> Self {
        let (nodes, _): (Vec<[u32; 4]>, _) = stage.inspect(plan, "hierarchy.nodes").unwrap();
        let (triangles, _): (Vec<[f32; 4]>, _) =
            stage.inspect(plan, "hierarchy.triangles").unwrap();
        let of = |nth: usize| {
            let [x, y, z, _] = nodes[nth].map(f32::from_bits);
            Vec3::new(x, y, z)
        };
        let (low, step) = (of(0), of(1));
        Self { nodes: nodes[HEAD..HEAD + count].to_vec(), triangles, low, step }
    }

    /// The least and largest corner of a node's box.
    fn bounds(&self, node: usize) -> [Vec3; 2] {
        let [x, y, z, _] = self.nodes[node];
        let at = |pick: fn(u32) -> u32| {
            let steps = Vec3::new(pick(x) as f32, pick(y) as f32, pick(z) as f32);
            self.low + steps * self.step
        };
        [at(|word| word & 0xffff), at(|word| word >> 16)]
    }

    /// A triangle's corners; none for a place that only fills a leaf.
    fn triangle(&self, nth: usize) -> Option<[Vec3; 3]> {
        let corner = |i: usize| self.triangles[3 * nth + i];
        let there = corner(0)[3] > 0.0;
        there.then(|| [0, 1, 2].map(|i| Vec3::new(corner(i)[0], corner(i)[1], corner(i)[2])))
    }

    /// Walks the whole tree, checks that boxes hold what is below them, and returns the leaves in order.
    fn check(&self) -> Vec<usize> {
        let mut leaves = Vec::new();
        // The nodes whose subtrees hold the present one: the box and the end of each.
        let mut above: Vec<([Vec3; 2], usize)> = Vec::new();
        for (place, node) in self.nodes.iter().enumerate() {
            above.retain(|(_, end)| place < *end);
            if node[3] & IS_LEAF == 0 {
                let end = node[3] as usize;
                assert!(end > place && end <= self.nodes.len(), "node {place} ends at {end}");
                assert!(
                    above.iter().all(|(_, outer)| end <= *outer),
                    "node {place} leaves another"
                );
                above.push((self.bounds(place), end));
                continue;
            }
            let leaf = (node[3] & !IS_LEAF) as usize;
            leaves.push(leaf);
            let own = [(self.bounds(place), place + 1)];
            for i in leaf * LEAF..(leaf + 1) * LEAF {
                for corner in self.triangle(i).into_iter().flatten() {
                    for ([low, high], _) in above.iter().chain(&own) {
                        let inside = corner.cmpge(*low).all() && corner.cmple(*high).all();
                        assert!(inside, "{corner} of triangle {i} outside {low} to {high}");
                    }
                }
            }
        }
        assert!(
            above.iter().all(|(_, end)| *end == self.nodes.len()),
            "a node ends beyond the last"
        );
        leaves
    }
}

fn stage_of(device: &HeadlessDevice, scene: &Scene) -> Stage {
    let technique: Technique = "traced".parse().unwrap();
    Stage::new(device, scene, &View::map_of_ground(3.0, 8.0), [32; 2], technique, |_| true).unwrap()
}

/// Builds a scene's hierarchy and checks it; returns how many triangles are in it. None where nothing can be shadowed,
/// and no hierarchy is built.
fn check(stage: &mut Stage, scene: &Scene) -> Option<usize> {
    let plan = stage.plan(scene.light(None).unwrap().light, None).unwrap();
    stage.run(&plan).unwrap();
    plan.passes().find(|(name, _)| *name == "hierarchy.nodes")?;
    let blocking = scene.instances.iter().filter(|i| i.role.blocks());
    let places: usize =
        blocking.map(|i| (scene.meshes[i.mesh].indices.len() / 3).next_multiple_of(LEAF)).sum();
    let leaves = places / LEAF;
    let tree = Tree::read(stage, &plan, 2 * leaves - 1);
    let mut found = tree.check();
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
    let mut tree = Tree::read(&mut stage, &plan, 1);
    tree.step *= 0.5;
    tree.check();
}
