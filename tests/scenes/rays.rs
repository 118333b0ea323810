//! The ray tracer that techniques are judged against, held against the truth and against itself.

use crate::truth::random::Random;
use antumbra::scene::{Mesh, Role, Scene, from_gltf, generate};
use antumbra::truth::{ErrorSummary, Receiver, Sampling, Tracer};
use antumbra::{Error, RectangleLight};
use antumbra_harness::rays::{CostNode, RayTracer, surface_area_cost};
use antumbra_tests::example::root;
use glam::{DMat4, DVec3, Vec3};

const WIDTH: usize = 100;

fn bunny() -> Scene {
    from_gltf(&root().join("scenes/bunny.glb")).unwrap()
}

/// A grid on the ground; the last pixels of each line and the lowest line make tiles that are not whole.
fn ground(scene: &Scene) -> Vec<Receiver> {
    let bounds = scene.bounds(|_| true).unwrap();
    let at = |i: usize, n: usize| (i as f64 + 0.37) / n as f64 * 3.0 - 1.5;
    let grid = (0..60).flat_map(|z| (0..WIDTH).map(move |x| (at(x, WIDTH), at(z, 60))));
    let position = |(x, z)| DVec3::new(x, bounds.min.y, z);
    grid.map(|p| Receiver { position: position(p), normal: DVec3::Y }).collect()
}

fn scenes() -> [(&'static str, Scene); 4] {
    let light = |side| generate::square_light(side).unwrap();
    [
        ("card", generate::card(light(0.8))),
        ("foliage", generate::foliage(light(0.8), 150, 3)),
        ("spheres", generate::spheres(light(0.3))),
        ("bunny", bunny()),
    ]
}

#[test]
fn fractions_are_as_near_the_truth_as_those_of_stratified_random_rays() {
    for (name, scene) in scenes() {
        let light = *scene.light(None).unwrap().light.rectangle();
        let receivers = ground(&scene);
        let (truth, rays) = (Tracer::new(&scene).unwrap(), RayTracer::new(&scene).unwrap());
        let of_truth = |sampling: Sampling| {
            truth.visible_fractions(light, &receivers, &sampling).unwrap().visible
        };
        let exact = of_truth(Sampling::new(2048, 1).unwrap());
        let summary = |image: &[f32]| ErrorSummary::between(&exact, image, None).unwrap();
        for n in [1, 4, 16, 64_u32] {
            let trace = |light: &RectangleLight| {
                rays.visible_fractions(light, &receivers, WIDTH, n, 0.0).unwrap()
            };
            let found = summary(&trace(&light));
            let random = summary(&of_truth(Sampling::one_grid(n.isqrt(), 2).unwrap()));
            assert!(random.pixels > 500, "{name}: {} pixels are in shadow", random.pixels);
            let [found, random] = [found, random].map(|s| s.mean_abs_error);
            // Evenly spread points err less than a random one in each stratum; the truth's own noise is 0.2 %.
            assert!(
                found <= random + 0.002,
                "{name}, {n} rays: {found} and {random} by random rays"
            );
            // A light twice as large has another penumbra, which the bound must notice.
            if n == 64 {
                let wrong = summary(&trace(&larger(&light))).mean_abs_error;
                assert!(wrong > random + 0.002, "{name}: {wrong} under the wrong light");
            }
        }
    }
}

fn larger(light: &RectangleLight) -> RectangleLight {
    let ([w, h], axes) = (light.half_extents(), light.world_from_light());
    let half = |half: DVec3| axes.transform_vector3(half * 2.0);
    RectangleLight::new(light.center(), half(DVec3::X * w), half(DVec3::NEG_Y * h)).unwrap()
}

/// Whether the truth's tracer, which is f64, finds a triangle on a segment: as the only ray of a light of a nanometre
/// at its end. The tracer moves and shortens segments; what it traces is `from` to `to`.
fn hit_in_f64(truth: &Tracer, from: DVec3, to: DVec3) -> bool {
    let normal = (from - to).normalize();
    let (x, y) = normal.any_orthonormal_pair();
    let sampling = Sampling::one_grid(1, 1).unwrap();
    let light = |at: DVec3| RectangleLight::new(at, x * 1e-9, y * -1e-9).unwrap();
    let offset = truth.offset(light(to), from, &sampling);
    // Rays end an offset before the light's plane, and begin an offset along the normal.
    let light = light(to - normal * offset);
    let receiver = Receiver { position: from - normal * offset, normal };
    truth.visible_fraction(light, &receiver, &sampling, 0).unwrap().visible < 0.5
}

#[test]
fn a_hundred_thousand_segments_meet_what_they_meet_in_f64_but_within_rounding_of_an_edge() {
    for (name, scene) in [("bunny", bunny()), ("triangles", scattered())] {
        let bounds = scene.bounds(|i| i.role.blocks()).unwrap();
        let (truth, rays) = (Tracer::new(&scene).unwrap(), RayTracer::new(&scene).unwrap());
        // Where positions, corners and ends are rounded to f32, and the sums of products of them.
        let extent = scene.bounds(|_| true).unwrap().size().max_element();
        let rounding = 16.0 / f64::from(1 << 24) * extent;
        let mut random = Random(9);
        let mut within = || {
            let share = DVec3::from_array([(); 3].map(|()| random.within(0.0, 1.0)));
            bounds.min + bounds.size() * share
        };
        let (mut hits, mut unlike) = (0, 0);
        for _ in 0..50_000 {
            let (from, to) = (within(), within());
            let hit = rays.hit(from, to);
            hits += usize::from(hit);
            if hit == hit_in_f64(&truth, from, to) {
                continue;
            }
            unlike += 1;
            let steps = [-1.0, 0.0, 1.0].map(|step| step * rounding);
            let near = steps.iter().flat_map(|&x| steps.iter().map(move |&y| (x, y)));
            let near = near.flat_map(|(x, y)| steps.iter().map(move |&z| DVec3::new(x, y, z)));
            let like = near.filter(|&by| hit_in_f64(&truth, from + by, to + by) == hit).count();
            assert!(like > 0, "{name}: {from} to {to} is {hit}, and far from any edge");
        }
        assert!((5_000..45_000).contains(&hits), "{name}: {hits} hits do not test both answers");
        // Of these none is.
        assert!(unlike <= 5, "{name}: {unlike} of 50,000 segments are unlike in f32");
    }
}

/// 400 triangles in a metre, needles among them.
fn scattered() -> Scene {
    let (mut scene, mut random) = (Scene::default(), Random(4));
    for i in 0..400 {
        let at = random.vector(1.0);
        let corners = [(); 3].map(|()| random.vector([0.05, 0.4][i % 2]));
        let thin = [1.0, 1e-3][i % 3 / 2];
        let corners = [corners[0], corners[1], corners[0].lerp(corners[2], thin)];
        let positions = corners.map(|c| c.as_vec3().to_array()).into();
        let mesh = Mesh { positions, indices: vec![0, 1, 2], ..Mesh::default() };
        scene.add(&format!("triangle {i}"), mesh, DMat4::from_translation(at), Role::Both);
    }
    scene
}

#[test]
fn a_floor_of_needles_does_not_shadow_itself_wherever_the_scene_and_its_light_are() {
    // 4 m long and 2 mm wide; from above, nothing is in the light's way.
    let mut floor = Mesh::default();
    for i in 0..2001_u32 {
        let x = (f64::from(i) * 2e-3 - 2.0) as f32;
        floor.positions.extend([[x, 0.0, -2.0], [x, 0.0, 2.0]]);
        if i > 0 {
            let first = 2 * i - 2;
            floor.indices.extend([first, first + 1, first + 2, first + 2, first + 1, first + 3]);
        }
    }
    for (away, height) in [(0.0, 3.0), (20_000.0, 3.0), (0.0, 2e5)] {
        let mut scene = Scene::default();
        let moved = DVec3::new(away, 0.0, -away);
        let turned = DMat4::from_rotation_z(0.3);
        scene.add("floor", floor.clone(), DMat4::from_translation(moved) * turned, Role::Both);
        let up = turned.transform_vector3(DVec3::Y);
        let half = height * 0.2;
        let half_v = turned.transform_vector3(DVec3::NEG_Z) * half;
        let half_u = turned.transform_vector3(DVec3::X) * half;
        let light = RectangleLight::new(moved + up * height, half_u, half_v).unwrap();
        let position = |r: Receiver| moved + turned.transform_vector3(r.position);
        let receivers: Vec<Receiver> = ground(&generate::card(light))
            .into_iter()
            .map(|r| Receiver { position: position(r), normal: up })
            .collect();
        let rays = RayTracer::new(&scene).unwrap();
        for n in [1, 16] {
            let seen = rays.visible_fractions(&light, &receivers, WIDTH, n, 0.0).unwrap();
            let dark = seen.iter().filter(|v| **v < 1.0).count();
            assert_eq!(dark, 0, "{away} m away, light at {height} m, {n} rays");
        }
        // From below, the floor hides all of it.
        let below = |r: &Receiver| Receiver { normal: -r.normal, ..*r };
        let below: Vec<Receiver> = receivers.iter().map(below).collect();
        let seen = rays.visible_fractions(&light, &below, WIDTH, 16, 0.0).unwrap();
        assert!(seen.iter().all(|v| *v == 0.0), "{away} m away, light at {height} m, from below");
    }
}

#[test]
fn images_have_the_same_bits_on_any_number_of_threads() {
    let scene = bunny();
    let (light, receivers) = (*scene.light(None).unwrap().light.rectangle(), ground(&scene));
    for n in [1, 4, 64] {
        let image = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            // The tree is built anew: its shape must not matter either.
            pool.install(|| {
                let rays = RayTracer::new(&scene).unwrap();
                rays.visible_fractions(&light, &receivers, WIDTH, n, 0.0).unwrap()
            })
        };
        let one = image(1);
        assert!(one.contains(&0.0) && one.contains(&1.0));
        assert!([2, 3, 7].into_iter().all(|threads| image(threads) == one), "{n} rays");
    }
}

#[test]
fn what_cannot_be_traced_is_refused_and_what_the_light_does_not_reach_is_lit() {
    let scene = generate::card(generate::square_light(0.5).unwrap());
    let (light, receivers) = (*scene.light(None).unwrap().light.rectangle(), ground(&scene));
    let rays = RayTracer::new(&scene).unwrap();
    let trace = |receivers: &[Receiver], width, n, error| {
        rays.visible_fractions(&light, receivers, width, n, error).map_err(|e| e.to_string())
    };
    let refused = |result: Result<Vec<f32>, String>, why: &str| {
        let error = result.unwrap_err();
        assert!(error.contains(why), "{error}");
    };
    refused(trace(&receivers, WIDTH, 5, 0.0), "1, 4, 16 or 64 (it is 5)");
    refused(trace(&receivers, WIDTH, 4, -1.0), "at least 0 m (it is -1)");
    refused(trace(&receivers, 7, 4, 0.0), "6000 receivers are no image of a width of 7 pixels");
    refused(trace(&receivers, 0, 4, 0.0), "a width of 0 pixels");
    let torn = Receiver { position: DVec3::NAN, normal: DVec3::Y };
    refused(trace(&[torn], 1, 4, 0.0), "receiver 0 must have a finite position");
    let above = Receiver { position: light.center() + DVec3::Y, normal: DVec3::Y };
    let nothing = Receiver { position: DVec3::ZERO, normal: DVec3::ZERO };
    assert_eq!(trace(&[above, nothing], 2, 16, 0.0).unwrap(), [1.0; 2]);
    assert_eq!(trace(&[], 1, 16, 0.0).unwrap(), [0.0; 0]);
    let empty = RayTracer::new(&Scene::default()).unwrap();
    assert_eq!(empty.visible_fractions(&light, &receivers, WIDTH, 4, 0.0).unwrap(), [1.0; 6000]);
    assert!(!empty.hit(DVec3::ZERO, DVec3::X) && empty.tree_cost() == 0.0);
    let mut torn = scene.clone();
    torn.meshes[0].positions[0] = [f32::NAN; 3];
    assert!(matches!(RayTracer::new(&torn).err(), Some(Error::Scene(_))));
}

#[test]
fn the_surface_area_cost_is_that_of_a_tree_by_hand_and_obvhs_builds_a_good_one() {
    let leaf = |low, triangles| CostNode { low, high: low + Vec3::new(0.5, 1.0, 1.0), triangles };
    let root = CostNode { low: Vec3::ZERO, high: Vec3::ONE, triangles: 0 };
    let nodes = [root, leaf(Vec3::ZERO, 1), leaf(Vec3::X * 0.5, 3)];
    // A half cube has two thirds of the cube's surface.
    let cost = |scale: f32| {
        let scaled = |n: &CostNode| CostNode { low: n.low * scale, high: n.high * scale, ..*n };
        surface_area_cost(nodes.iter().map(scaled))
    };
    for scale in [1.0, 1e-3, 1e6] {
        let expected = 1.0 + 2.0 / 3.0 * (1.0 + 3.0);
        assert!((cost(scale) - expected).abs() < 1e-5, "{} at {scale}", cost(scale));
    }
    assert_eq!(surface_area_cost([]), 0.0);

    // A tree that halves the triangles in the order of the file, which is no bad one, costs more.
    let scene = bunny();
    let mut triangles = Vec::new();
    for instance in scene.instances.iter().filter(|i| i.role.blocks()) {
        let mesh = &scene.meshes[instance.mesh];
        triangles.extend(mesh.indices.chunks_exact(3).map(|t| {
            [0, 1, 2].map(|i| {
                let at = Vec3::from_array(mesh.positions[t[i] as usize]).as_dvec3();
                instance.world_from_mesh.transform_point3(at).as_vec3()
            })
        }));
    }
    let mut nodes = Vec::new();
    let mut open = vec![triangles.as_slice()];
    while let Some(part) = open.pop() {
        let corners = || part.iter().flatten().copied();
        let low = corners().reduce(Vec3::min).unwrap();
        let high = corners().reduce(Vec3::max).unwrap();
        let is_leaf = part.len() <= 8;
        nodes.push(CostNode { low, high, triangles: if is_leaf { part.len() as u32 } else { 0 } });
        if !is_leaf {
            open.extend(<[_; 2]>::from(part.split_at(part.len() / 2)));
        }
    }
    let (by_order, built) = (surface_area_cost(nodes), RayTracer::new(&scene).unwrap().tree_cost());
    assert!(built > 10.0 && built < 0.8 * by_order, "{built} and {by_order} in the file's order");
}
