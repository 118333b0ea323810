//! Roles, names, normals and the camera that frames a scene.

use antumbra::scene::{Camera, Instance, Lens, Mesh, Role, Scene, generate};
use glam::{DMat4, DVec3};

fn two_nodes() -> Scene {
    let mut scene = generate::card(generate::square_light(1.0).unwrap());
    scene.instances[1].name = "card".into();
    scene
}

#[test]
fn roles_are_read_and_written_by_the_same_words() {
    for role in [Role::Occluder, Role::Receiver, Role::Both] {
        assert_eq!(role.to_string().parse::<Role>().unwrap(), role);
    }
    let sentence = "caster".parse::<Role>().unwrap_err().to_string();
    assert_eq!(sentence, "the role \"caster\" is not known; write occluder, receiver or both");
}

#[test]
fn a_role_is_set_by_the_nodes_name() {
    let mut scene = two_nodes();
    scene.set_role("card", Role::Both).unwrap();
    assert_eq!(scene.instances[1].role, Role::Both);
    assert_eq!(scene.instances[0].role, Role::Receiver, "other nodes keep theirs");
    let sentence = scene.set_role("cart", Role::Both).unwrap_err().to_string();
    assert_eq!(
        sentence,
        "no node with a mesh is named \"cart\"; the nodes are \"ground\", \"card\""
    );
}

#[test]
fn a_light_is_found_by_name_and_the_first_without_one() {
    let mut scene = two_nodes();
    let mut second = scene.lights[0].clone();
    second.name = "lamp".into();
    scene.lights.push(second);
    assert_eq!(scene.light(None).unwrap().name, "light");
    assert_eq!(scene.light(Some("lamp")).unwrap().name, "lamp");
    let sentence = scene.light(Some("sun")).unwrap_err().to_string();
    assert_eq!(sentence, "no light is named \"sun\"; the lights are \"light\", \"lamp\"");
    scene.lights.clear();
    assert!(scene.light(None).unwrap_err().to_string().contains("\"area_light\": \"rectangle\""));
}

/// Normals follow any transform, mirrored and flattening ones, as cross products of edges do.
#[test]
fn normals_stay_perpendicular_and_outward() {
    let transforms = [
        DMat4::from_scale(DVec3::new(2.0, 0.5, 3.0)) * DMat4::from_rotation_x(0.3),
        DMat4::from_scale(DVec3::new(-1.0, 1.0, 2.0)),
        DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)),
    ];
    let mesh = generate::cuboid(DVec3::ONE);
    for world_from_mesh in transforms {
        let instance = Instance { name: String::new(), mesh: 0, world_from_mesh, role: Role::Both };
        let place = |i: u32| {
            let p = DVec3::from_array(mesh.positions[i as usize].map(f64::from));
            world_from_mesh.transform_vector3(p)
        };
        let mut faces_seen = 0;
        for t in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [place(t[0]), place(t[1]), place(t[2])];
            let flat = (b - a).cross(c - a) * if instance.mirrored() { -1.0 } else { 1.0 };
            let normal = instance.world_from_normal()
                * DVec3::from_array(mesh.normals[t[0] as usize].map(f64::from));
            if flat.length() > 0.0 {
                faces_seen += 1;
                assert!(normal.normalize().dot(flat.normalize()) > 1.0 - 1e-12);
                assert!(normal.dot(a + b + c) >= 0.0, "a box's normals point out of it");
            }
        }
        assert!(faces_seen >= 4);
    }
}

/// A framed point lands inside the image, in front of the near plane, and the frame is not loose.
#[test]
fn framing_holds_the_occluders_at_every_aspect_scale_and_place() {
    let light = || generate::square_light(1.0).unwrap();
    for scene in [generate::card(light()), generate::tall_box(light()), generate::spheres(light())]
    {
        for (aspect, scale, place) in [(1.0, 1.0, 0.0), (2.5, 1e-3, 1e3), (0.4, 1e4, 2e4)] {
            let mut moved = scene.clone();
            let world = DMat4::from_translation(DVec3::splat(place))
                * DMat4::from_scale(DVec3::splat(scale));
            for instance in &mut moved.instances {
                instance.world_from_mesh = world * instance.world_from_mesh;
            }
            let camera = Camera::framing(&moved, aspect);
            let view_from_world = camera.world_from_view.inverse();
            let Lens::Perspective { yfov } = camera.lens else { panic!("{camera:?}") };
            let tan = (0.5 * yfov).tan();
            let mut widest: f64 = 0.0;
            for p in moved.world_positions(|i| i.role.blocks()) {
                let v = view_from_world.transform_point3(p);
                assert!(-v.z > camera.near && camera.near > 0.0);
                let reach = (v.x / (v.z * tan * aspect)).abs().max((v.y / (v.z * tan)).abs());
                assert!(reach < 1.0, "{p} is outside the image ({reach})");
                widest = widest.max(reach);
            }
            assert!(widest > 0.15, "the occluders fill {widest} of the image");
            assert!(camera.world_from_view.w_axis.y > place, "the camera looks from above");
        }
    }
}

#[test]
fn framing_gives_a_camera_whatever_the_scene() {
    let mut point = Scene::default();
    let dot = Mesh {
        positions: vec![[1e6, 0.0, 0.0]],
        normals: vec![[0.0, 1.0, 0.0]],
        ..Mesh::default()
    };
    point.add("dot", dot, DMat4::IDENTITY, Role::Both);
    for scene in [Scene::default(), point] {
        for aspect in [1.0, 0.0, -1.0, f64::NAN, f64::INFINITY] {
            let camera = Camera::framing(&scene, aspect);
            assert!(camera.world_from_view.is_finite());
            assert!(camera.near > 0.0 && matches!(camera.lens, Lens::Perspective { .. }));
        }
    }
}
