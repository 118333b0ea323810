//! The models that come with the repository.

use super::*;
use antumbra::scene::{Lens, Role, generate};

fn model(name: &str) -> Scene {
    from_gltf(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name)).unwrap()
}

#[test]
fn the_bunny() {
    let scene = model("bunny.glb");
    assert_eq!(scene.triangles(), 16_944 / 3 + 2);
    let found: Vec<_> = scene.instances.iter().map(|i| (i.name.as_str(), i.role)).collect();
    assert_eq!(found, [("occluder0", Role::Both), ("ground", Role::Receiver)]);
    let light = scene.light(Some("light")).unwrap().light.rectangle();
    let [half_width, half_height] = light.half_extents();
    assert!((half_width - 0.4).abs() + (half_height - 0.2).abs() < 1e-15);
    assert_eq!(light.center(), DVec3::new(1.1, 2.4, -1.3));
    // Tilted towards the bunny at the origin.
    let to_origin = (DVec3::new(0.0, 0.4, 0.0) - light.center()).normalize();
    assert!(light.emission().dot(to_origin) > 0.95, "{}", light.emission());
    let camera = scene.camera.unwrap();
    assert_eq!((camera.lens, camera.near), (Lens::Perspective { yfov: 0.75 }, 0.05));
    assert_eq!(camera.world_from_view.w_axis.truncate(), DVec3::new(1.3, 2.1, 2.4));
}

#[test]
fn suzanne() {
    let scene = model("suzanne.glb");
    assert_eq!(scene.triangles(), 44_526 / 3 + 2);
    assert_eq!(scene.instances[0].role, Role::Occluder);
    let light = scene.light(None).unwrap().light.rectangle();
    assert!((light.emission() - DVec3::NEG_Y).length() < 1e-7, "{}", light.emission());
    assert!(light.half_extents().iter().all(|h| (h - 0.3).abs() < 1e-15));
}

/// The file's normals and the winding of its triangles agree on what is outside.
#[test]
fn the_models_are_not_inside_out() {
    for name in ["bunny.glb", "suzanne.glb"] {
        let scene = model(name);
        for mesh in &scene.meshes {
            let at = |p: [f32; 3]| DVec3::from_array(p.map(f64::from));
            let agree = mesh.indices.chunks_exact(3).filter(|t| {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| at(mesh.positions[i as usize]));
                at(mesh.normals[t[0] as usize]).dot((b - a).cross(c - a)) >= 0.0
            });
            let share = agree.count() as f64 / (mesh.indices.len() / 3) as f64;
            assert!(share > 0.98, "{name}: {share}");
        }
    }
}

#[test]
fn the_bunny_fits_the_set_up_of_the_generated_scenes() {
    let light = generate::square_light(0.4).unwrap();
    let scene = generate::normalized(&model("bunny.glb"), light).unwrap();
    let bounds = scene.bounds(|i| i.role.blocks()).unwrap();
    assert!((bounds.size().max_element() - 1.0).abs() < 1e-6);
    assert!((bounds.center() - DVec3::new(0.0, 2.0, 0.0)).length() < 1e-6);
    assert_eq!(scene.triangles(), 16_944 / 3 + 2);
}
