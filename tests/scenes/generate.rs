//! The generated scenes are whole, and models are put into their set-up.

use antumbra::RectangleLight;
use antumbra::scene::generate::*;
use antumbra::scene::{Bounds, Mesh, Role, Scene};
use glam::{DMat4, DVec3};
use std::f64::consts::PI;

/// Where the generated scenes have their object and their light.
const OBJECT_CENTER: DVec3 = DVec3::new(0.0, 2.0, 0.0);
const LIGHT_CENTER: DVec3 = DVec3::new(0.0, 4.0, 0.0);

fn light() -> RectangleLight {
    square_light(1.0).unwrap()
}

fn all() -> Vec<(&'static str, Scene)> {
    vec![
        ("card", card(light())),
        ("tall_box", tall_box(light())),
        ("stacked_cards", stacked_cards(light())),
        ("slats", slats(light(), 16)),
        ("foliage", foliage(light(), 400, 1)),
        ("contact", contact(light())),
        ("spheres", spheres(light())),
    ]
}

fn object(scene: &Scene) -> Bounds {
    scene.bounds(|i| i.role.blocks()).unwrap()
}

fn at(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

/// Checks a mesh: its normals have unit length, its indices are in range, and its triangles have an area and face the
/// way their normals point.
fn check_mesh(name: &str, mesh: &Mesh) {
    assert_eq!(mesh.positions.len(), mesh.normals.len(), "{name}");
    assert!(mesh.indices.len().is_multiple_of(3) && !mesh.indices.is_empty(), "{name}");
    for t in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| at(mesh.positions[i as usize]));
        let flat = (b - a).cross(c - a);
        assert!(flat.length() > 1e-9, "{name}: a triangle without area");
        for i in t {
            let normal = at(mesh.normals[*i as usize]);
            assert!((normal.length() - 1.0).abs() < 1e-6, "{name}: a normal of another length");
            assert!(normal.dot(flat) > 0.0, "{name}: a triangle that faces the other way");
        }
    }
}

#[test]
fn every_scene_is_whole() {
    for (name, scene) in all() {
        for mesh in &scene.meshes {
            check_mesh(name, mesh);
        }
        assert_eq!(scene.instances[0].name, "ground");
        assert_eq!(scene.instances[0].role, Role::Receiver);
        assert!(scene.instances[1..].iter().all(|i| i.role == Role::Occluder), "{name}");
        let light = scene.light(None).unwrap();
        assert_eq!((light.light.center(), light.light.emission()), (LIGHT_CENTER, DVec3::NEG_Y));
        assert!(object(&scene).min.y >= -1e-7, "{name} stands in the ground");
        assert!(object(&scene).max.y < 3.0, "{name} reaches the light");
    }
}

#[test]
#[should_panic(expected = "faces the other way")]
fn a_mesh_turned_inside_out_is_noticed() {
    let mut mesh = cuboid(DVec3::ONE);
    mesh.indices.reverse();
    check_mesh("a box inside out", &mesh);
}

#[test]
fn objects_that_hang_are_one_metre_across_round_their_place() {
    for (name, scene) in all() {
        if ["card", "stacked_cards", "slats", "foliage"].contains(&name) {
            let bounds = object(&scene);
            assert!((bounds.size().max_element() - 1.0).abs() < 1e-6, "{name}: {bounds:?}");
            assert!((bounds.center() - OBJECT_CENTER).length() < 1e-6, "{name}: {bounds:?}");
        }
    }
    let tall = object(&tall_box(light()));
    assert!((tall.size() - DVec3::new(0.4, 1.0, 0.4)).length() < 1e-6);
    assert!(tall.min.y.abs() < 1e-7, "it stands on the ground");
}

/// The penumbra of a light of side 3 over the widest object still falls on the ground.
#[test]
fn the_ground_is_wide_enough_for_its_shadows() {
    let half_light = 1.5;
    for (name, scene) in all() {
        for p in scene.world_positions(|i| i.role.blocks()) {
            // From the light's far rim, past the point, down to y = 0.
            let stretch = LIGHT_CENTER.y / (LIGHT_CENTER.y - p.y);
            let reach = (p.x.abs().max(p.z.abs()) + half_light) * stretch - half_light;
            assert!(reach <= 0.5 * GROUND_SIDE, "{name}: the shadow of {p} reaches {reach}");
        }
    }
}

#[test]
fn foliage_grows_from_its_seed_alone() {
    let plant = |seed| foliage(light(), 300, seed);
    assert_eq!(plant(7).meshes[1].positions, plant(7).meshes[1].positions);
    assert_ne!(plant(7).meshes[1].positions, plant(8).meshes[1].positions);
    assert_eq!(plant(7).triangles(), 2 + 600);
    assert_eq!(foliage(light(), 0, 7).triangles(), 2, "no leaf, no plant");
    // Normals in every direction: their mean is that of 300 random ones, about 1/√300.
    let scene = plant(7);
    let normals = scene.meshes[1].normals.iter().map(|n| at(*n));
    let mean = normals.sum::<DVec3>() / scene.meshes[1].normals.len() as f64;
    assert!(mean.length() < 0.15, "{mean}");
}

#[test]
fn a_sphere_is_closed_and_round() {
    let mesh = uv_sphere(0.5, 24, 12);
    check_mesh("sphere", &mesh);
    assert_eq!(mesh.indices.len() / 3, 2 * 24 * 11);
    // Signed volumes of the tetrahedra over its triangles: a hole or an overlap would show.
    let volume: f64 = mesh
        .indices
        .chunks_exact(3)
        .map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| at(mesh.positions[i as usize]));
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    let round = PI / 6.0;
    // A polyhedron inside the sphere, 1 − sin(x)/x or so short at 24 segments and 12 rings.
    assert!(volume < round && volume > 0.96 * round, "{volume} of {round}");
}

#[test]
fn lights_are_turned_towards_minus_z_and_bad_ones_refused() {
    let tilted = rectangle_light(0.8, 0.4, 0.5).unwrap();
    let [half_width, half_height] = tilted.half_extents();
    assert!((half_width - 0.4).abs() + (half_height - 0.2).abs() < 1e-15);
    let down = DVec3::new(0.0, -0.5_f64.cos(), -0.5_f64.sin());
    assert!((tilted.emission() - down).length() < 1e-12, "{}", tilted.emission());
    for (width, height, tilt) in [
        (-1.0, 1.0, 0.0),
        (1.0, -1.0, 0.0),
        (0.0, 1.0, 0.0),
        (f64::NAN, 1.0, 0.0),
        (1.0, 1.0, f64::NAN),
    ] {
        assert!(rectangle_light(width, height, tilt).is_err(), "{width} {height} {tilt}");
    }
}

#[test]
fn line_lights_are_turned_about_the_vertical_and_bad_ones_refused() {
    let line = line_light(1.2, 0.5).unwrap();
    assert!(line.is_line() && (line.half_extents()[0] - 0.6).abs() < 1e-15);
    assert!((line.emission() - DVec3::NEG_Y).length() < 1e-12);
    let along = line.world_from_light().transform_vector3(DVec3::X);
    let turned = DVec3::new(0.5_f64.cos(), 0.0, -0.5_f64.sin());
    assert!((along - turned).length() < 1e-12, "{along}");
    for (length, turn) in [(-1.0, 0.0), (0.0, 0.0), (f64::NAN, 0.0), (1.0, f64::NAN)] {
        assert!(line_light(length, turn).is_err(), "{length} {turn}");
    }
}

#[test]
fn polygon_lights_shine_down_whichever_way_their_corners_run() {
    let mut corners = [[0.0, 0.0], [1.0, 0.0], [0.2, 0.7]];
    for _ in 0..2 {
        let light = polygon_light(&corners).unwrap();
        assert!((light.emission() - DVec3::NEG_Y).length() < 1e-12);
        for &[x, y] in light.outline().unwrap() {
            let there =
                light.rectangle().world_from_light().transform_point3(DVec3::new(x, y, 0.0));
            let near = |&[x, z]: &[f64; 2]| there.distance(DVec3::new(x, 4.0, z)) < 1e-12;
            assert!(corners.iter().any(near), "{there}");
        }
        assert_eq!(card(light).lights[0].light, light);
        corners.reverse();
    }
    assert!(polygon_light(&corners[..2]).is_err());
}

#[test]
fn a_scene_is_put_into_the_set_up_whatever_its_size() {
    let mut odd = Scene::default();
    let away = DMat4::from_translation(DVec3::new(2e4, -7.0, 3.0))
        * DMat4::from_scale(DVec3::new(30.0, -20.0, 10.0));
    odd.add("thing", cuboid(DVec3::ONE), away, Role::Both);
    odd.add("floor", ground(1e3), DMat4::IDENTITY, Role::Receiver);
    let scene = normalized(&odd, light()).unwrap();
    let names: Vec<_> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["ground", "thing"]);
    assert_eq!(scene.instances[1].role, Role::Occluder);
    let bounds = object(&scene);
    assert!((bounds.center() - OBJECT_CENTER).length() < 1e-9);
    assert!((bounds.size() - DVec3::new(1.0, 2.0 / 3.0, 1.0 / 3.0)).length() < 1e-9);
    assert!(scene.instances[1].mirrored(), "mirrored it stays");

    let nothing = normalized(&stage(light()), light()).unwrap_err();
    assert!(nothing.to_string().contains("blocks light"));
    let mut flat = Scene::default();
    flat.add("dot", cuboid(DVec3::ZERO), DMat4::IDENTITY, Role::Both);
    assert!(normalized(&flat, light()).unwrap_err().to_string().contains("0 m across"));
}

#[test]
fn occluders_become_both_and_the_ground_stays() {
    let scene = spheres(light()).with_occluders_as(Role::Both);
    assert_eq!(scene.instances[0].role, Role::Receiver);
    assert!(scene.instances[1..].iter().all(|i| i.role == Role::Both));
}
