//! The hierarchy as a tree for rays: does `hierarchy/segment.glsl` find in it what the processor's tracer finds in its own,
//! and how good a tree is it?

use crate::hierarchy::{leaves_in, stage_of};
use antumbra::scene::{Mesh, Role, Scene, generate};
use antumbra_harness::bumps::bumpy_ball;
use antumbra_harness::rays::RayTracer;
use antumbra_harness::{DeviceTree, HeadlessDevice, HostBuffer, run_compute};
use antumbra_tests::compile::try_compile;
use antumbra_tests::device::unwatched;
use antumbra_tests::measure::model;
use antumbra_tests::rig::Random;
use antumbra_tests::room::room;
use ash::vk;
use glam::{DMat4, DVec3, Vec3};
use rayon::prelude::*;

/// Rays a scene: 1,000,000 over the four scenes where the processor's side is optimized, else a fourth of that.
const RAYS: usize = if cfg!(debug_assertions) { 62_500 } else { 250_000 };

/// The relative error of one rounding to f32.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// The roundings of a product of two corners and a direction: one of each difference from the ray's start, two of the
/// cross product and three of the dot product, with two to spare.
const ROUNDINGS: f64 = 8.0;

/// `blocked` of segment.glsl for a list of segments. The hierarchy's images are buffers here, texel by texel.
const SEGMENTS: &str = r#"#version 450
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, std430) readonly buffer Rays { vec4 rays[]; };
layout(set = 0, binding = 1, std430) buffer Hits { uint hits[]; };
layout(set = 0, binding = 2, std430) readonly buffer Nodes { uvec4 nodes[]; };
layout(set = 0, binding = 3, std430) readonly buffer Triangles { vec4 triangles[]; };
layout(push_constant) uniform Push { uint count; uint node_count; };
#define imageLoad(list, at) list[(at).x + ((at).y << 12)]
const float ROUNDING = 1.0 / 4194304.0;
#include "hierarchy/segment.glsl"
void main()
{
    uint nth = gl_GlobalInvocationID.x;
    if (nth >= count) {
        return;
    }
    int turns = 60000;
    bool hit = blocked(segment_of(rays[2u * nth].xyz, rays[2u * nth + 1u].xyz, true), node_count, turns);
    hits[nth] = turns > 0 ? uint(hit) : 2u;
}
"#;

/// A segment in the hierarchy's space, from where it starts and along.
#[derive(Clone, Copy, Debug)]
struct Ray {
    from: Vec3,
    along: Vec3,
}

/// A scene's hierarchy with the same triangles in 64 bits.
struct Case {
    tree: DeviceTree,
    tracer: RayTracer,
    /// Corners in the hierarchy's space.
    triangles: Vec<[DVec3; 3]>,
    /// World space to the hierarchy's is less this.
    origin: DVec3,
}

impl Case {
    fn new(device: &HeadlessDevice, scene: &Scene) -> Self {
        let mut stage = stage_of(device, scene);
        let plan = stage.plan(scene.lights[0].light, None).unwrap();
        stage.run(&plan).unwrap();
        let tree = DeviceTree::read(&mut stage, &plan, leaves_in(scene)).unwrap();
        let mut triangles = corners(scene);
        let least = |corners: &mut dyn Iterator<Item = DVec3>| corners.fold(DVec3::MAX, DVec3::min);
        let here = (0..tree.triangles.len() / 3).filter_map(|i| tree.triangle(i)).flatten();
        let there = least(&mut triangles.iter().flatten().copied());
        let origin = there - least(&mut here.map(Vec3::as_dvec3));
        triangles.iter_mut().flatten().for_each(|corner| *corner -= origin);
        let tracer = RayTracer::new(scene).unwrap();
        Self { tree, tracer, triangles, origin }
    }

    /// Segments between points anywhere in the scene's box and a tenth around it.
    fn rays(&self, count: usize) -> Vec<Ray> {
        let (low, high) = self
            .triangles
            .iter()
            .flatten()
            .fold((DVec3::MAX, DVec3::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
        let (low, size) = (low - 0.1 * (high - low), 1.2 * (high - low));
        let mut random = Random(11);
        let mut point = || low + size * DVec3::from_array([0; 3].map(|_| random.unit()));
        (0..count)
            .map(|_| {
                let from = point().as_vec3();
                Ray { from, along: (point() - from.as_dvec3()).as_vec3() }
            })
            .collect()
    }

    /// What the device says of each ray.
    fn on_device(&self, device: &HeadlessDevice, rays: &[Ray]) -> Vec<bool> {
        let spirv = try_compile("segments.comp", SEGMENTS).unwrap_or_else(|log| panic!("{log}"));
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let words: Vec<[f32; 8]> = rays
            .iter()
            .map(|Ray { from: f, along: a }| [f.x, f.y, f.z, 0.0, a.x, a.y, a.z, 0.0])
            .collect();
        let input = HostBuffer::with_data(device, "rays", &words, usage).unwrap();
        // What no shader writes: a ray that was not traced shows.
        let hits = HostBuffer::with_data(device, "hits", &vec![7u32; rays.len()], usage).unwrap();
        let nodes = HostBuffer::with_data(device, "nodes", &self.tree.texels, usage).unwrap();
        let corners =
            HostBuffer::with_data(device, "triangles", &self.tree.triangles, usage).unwrap();
        let push = [rays.len() as u32, self.tree.nodes as u32].map(u32::to_le_bytes);
        let groups = [(rays.len() as u32).div_ceil(64), 1, 1];
        let buffers = [&input, &hits, &nodes, &corners];
        run_compute(device, &spirv, push.as_flattened(), &buffers, groups).unwrap();
        let hits: Vec<u32> = hits.read();
        assert!(hits.iter().all(|hit| *hit < 2), "a ray was cut off or not traced");
        hits.iter().map(|hit| *hit == 1).collect()
    }

    fn on_processor(&self, rays: &[Ray]) -> Vec<bool> {
        let hit = |ray: &Ray| {
            let from = self.origin + ray.from.as_dvec3();
            self.tracer.hit(from, from + ray.along.as_dvec3())
        };
        rays.par_iter().map(hit).collect()
    }

    /// Whether rounding may decide about a ray: it hits triangles that are larger by what `roundings` may move their edges
    /// and planes, and misses all of those that are smaller by as much.
    fn is_at_an_edge(&self, ray: &Ray, roundings: f64) -> bool {
        let any = |by: f64| self.triangles.iter().any(|t| crosses(t, ray, by * ROUNDING));
        any(roundings) && !any(-roundings)
    }
}

/// The blocking triangles of a scene in world space.
fn corners(scene: &Scene) -> Vec<[DVec3; 3]> {
    let blocking = scene.instances.iter().filter(|i| i.role.blocks());
    let of = |i: &antumbra::scene::Instance| {
        let mesh = &scene.meshes[i.mesh];
        let corner = |index: u32| {
            let position = mesh.positions[index as usize].map(f64::from);
            i.world_from_mesh.transform_point3(DVec3::from_array(position))
        };
        let triangle = |t: &[u32]| [corner(t[0]), corner(t[1]), corner(t[2])];
        mesh.indices.chunks_exact(3).map(triangle).collect::<Vec<_>>()
    };
    blocking.flat_map(of).collect()
}

/// Whether a segment crosses a triangle whose edges and plane are moved outwards by a relative error of `share`, and
/// inwards where that is below 0.
fn crosses(triangle: &[DVec3; 3], ray: &Ray, share: f64) -> bool {
    let (from, d) = (ray.from.as_dvec3(), ray.along.as_dvec3());
    let [a, b, c] = triangle.map(|corner| corner - from);
    let (u, v) = (b - a, c - a);
    let normal = u.cross(v);
    // The corners themselves are off by a rounding of their places, and differences of them as well.
    let place = from.length() + a.length().max(b.length()).max(c.length());
    let of_edge = |p: DVec3, q: DVec3| {
        share * d.length() * (p.length() * q.length() + place * (p.length() + q.length()))
    };
    let spread = u.length() * v.length() + place * (u.length() + v.length());
    let of_plane = |along: f64| share * along * spread;
    let volume = normal.dot(a);
    let thick = of_plane(a.length());
    let side_is = |side: f64| {
        let inside = |p: DVec3, q: DVec3| side * p.cross(q).dot(d) >= -of_edge(p, q);
        let reach = side * (normal.dot(d) - volume);
        inside(a, b) && inside(b, c) && inside(c, a) && reach >= -of_plane(d.length()) - thick
    };
    let is_flat_on = volume.abs() <= thick.abs();
    match (share > 0.0, is_flat_on) {
        (true, true) => side_is(1.0) || side_is(-1.0),
        (false, true) => false,
        _ => side_is(volume.signum()),
    }
}

fn scenes() -> [(&'static str, Scene); 4] {
    let light = || generate::square_light(0.5).unwrap();
    let mut ball = generate::stage(light());
    let cells = if cfg!(debug_assertions) { 37 } else { 73 };
    let turned = DMat4::from_translation(DVec3::Y) * DMat4::from_rotation_x(0.4);
    ball.add("ball", bumpy_ball(cells), turned, Role::Both);
    let both = |scene: Scene| scene.with_occluders_as(Role::Both);
    let of = |name| both(generate::normalized(&model(name), light()).unwrap());
    [("bunny", of("bunny")), ("suzanne", of("suzanne")), ("room", room()), ("ball", ball)]
}

/// The same answers as the processor's tracer, but for rays whose answer is a matter of rounding.
#[test]
fn rays_hit_what_the_processors_hit() {
    let device = unwatched();
    for (name, scene) in scenes() {
        let case = Case::new(&device, &scene);
        let rays = case.rays(RAYS);
        let (here, there) = (case.on_device(&device, &rays), case.on_processor(&rays));
        let hits = there.iter().filter(|hit| **hit).count();
        let differ: Vec<_> = (0..RAYS).filter(|&i| here[i] != there[i]).map(|i| rays[i]).collect();
        let explained = |by: f64| differ.iter().filter(|r| case.is_at_an_edge(r, by)).count();
        println!(
            "{name}: {hits} of {RAYS} rays hit, {} differ, {} of them within one rounding of an edge",
            differ.len(),
            explained(1.0)
        );
        assert!(hits > RAYS / 50 && hits < RAYS - RAYS / 50, "{name}: {hits}");
        assert_eq!(explained(ROUNDINGS), differ.len(), "{name}: rays that no rounding explains");
        assert!(differ.len() <= RAYS / 1000, "{name}: {}", differ.len());
    }
}

/// A corner of a large triangle that is a hundredth of its size off is noticed.
#[test]
fn a_triangle_that_is_off_is_noticed() {
    let device = unwatched();
    let mut case = Case::new(&device, &room());
    let size = |[a, b, _]: [Vec3; 3]| (b - a).length();
    let there =
        (0..case.tree.triangles.len() / 3).filter_map(|i| Some((i, case.tree.triangle(i)?)));
    let (nth, triangle) = there.max_by(|a, b| size(a.1).total_cmp(&size(b.1))).unwrap();
    let inwards = (triangle[1] - triangle[0]) * 0.02;
    (0..3).for_each(|axis| case.tree.triangles[3 * nth][axis] += inwards[axis]);
    let rays = case.rays(62_500);
    let (here, there) = (case.on_device(&device, &rays), case.on_processor(&rays));
    let mut differ = (0..rays.len()).filter(|&i| here[i] != there[i]);
    assert!(differ.any(|i| !case.is_at_an_edge(&rays[i], ROUNDINGS)));
}

/// The surface-area cost beside that of obvhs's tree, which is improved by reinsertion and has larger leaves.
#[test]
fn the_tree_is_not_much_worse_than_a_processors() {
    let device = unwatched();
    for (name, scene) in scenes() {
        let case = Case::new(&device, &scene);
        let (here, there) = (case.tree.cost(), case.tracer.tree_cost());
        let ratio = here / there;
        println!("{name}: cost {here:.1}, obvhs's {there:.1}, ratio {ratio:.2}");
        assert!((0.5..=2.5).contains(&ratio), "{name}: {here} beside {there}");
    }
}

/// A card of a million triangles, each a thousandth of its distance wide, lets no ray through; with edges as products of
/// corners alone, one of some hundred thousand slips between them.
#[test]
fn nothing_slips_between_small_triangles() {
    let device = unwatched();
    let mut scene = generate::stage(generate::square_light(0.5).unwrap());
    let place = DMat4::from_translation(DVec3::Y * 2.0);
    scene.add("card", tiled_square(708), place, Role::Both);
    let case = Case::new(&device, &scene);
    let mut random = Random(5);
    // Points of a grid, whose rays pass corners more often than others do.
    let mut across = || 0.9 * ((random.unit() * 64.0).floor() + 0.5) / 64.0 - 0.45;
    let mut at = |height: f64| DVec3::new(across(), height, across()) - case.origin;
    let ray = |_| {
        let from = at(0.0).as_vec3();
        Ray { from, along: (at(4.0) - from.as_dvec3()).as_vec3() }
    };
    let rays: Vec<_> = (0..400_000).map(ray).collect();
    let through = case.on_device(&device, &rays).iter().filter(|hit| !**hit).count();
    assert_eq!(through, 0, "of {}", rays.len());
}

/// A square of side 1 in the plane y = 0, of `cells` × `cells` quads.
fn tiled_square(cells: u32) -> Mesh {
    let at = |i: u32| i as f32 / cells as f32 - 0.5;
    let grid = |n: u32| (0..n).flat_map(move |row| (0..n).map(move |column| (row, column)));
    let positions: Vec<_> =
        grid(cells + 1).map(|(row, column)| [at(column), 0.0, at(row)]).collect();
    let quad = |(row, column)| {
        let a = row * (cells + 1) + column;
        let b = a + cells + 1;
        [a, b, b + 1, a, b + 1, a + 1]
    };
    let normals = vec![[0.0, 1.0, 0.0]; positions.len()];
    Mesh { positions, normals, indices: grid(cells).flat_map(quad).collect(), ..Mesh::default() }
}
