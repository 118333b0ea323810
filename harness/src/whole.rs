//! Opens files of any content: each must give a whole scene or an error of one sentence.

use antumbra::Shape;
use antumbra::glam::DVec3;
use antumbra::scene::{AreaLight, Camera, Lens, Scene, from_gltf_bytes};
use std::path::Path;

/// A folder that does not exist, where no buffer is found.
const NOWHERE: &str = "/no/such/folder/file";

/// The longest sentence, in bytes: names and what the JSON parser quotes are cut short.
const LONGEST_SENTENCE: usize = 1000;

/// Opens a file that needs no other.
///
/// # Panics
/// Panics where the loader breaks a promise.
pub fn open(file: &[u8]) -> Result<Scene, String> {
    match from_gltf_bytes(file, Path::new(NOWHERE)) {
        Ok(scene) => {
            check(&scene);
            let held: usize = scene.meshes.iter().map(|mesh| mesh.indices.len() / 3).sum();
            assert!(held <= most_triangles(file), "{held} triangles from {} bytes", file.len());
            Ok(scene)
        }
        Err(error) => {
            let sentence = error.to_string();
            check_sentence(&sentence);
            Err(sentence)
        }
    }
}

/// One for each byte of the file, and of what its compressed parts may decode to.
fn most_triangles(file: &[u8]) -> usize {
    let mut words = file.windows(b"_compression".len());
    let is_compressed = words.any(|word| word == b"_compression");
    file.len() + if is_compressed { 64 * file.len() + (16 << 20) } else { 0 }
}

/// Checks the text of an error.
///
/// # Panics
/// Panics where it is not one sentence on one line.
pub fn check_sentence(sentence: &str) {
    assert!((1..=LONGEST_SENTENCE).contains(&sentence.len()), "{sentence:?}");
    assert!(!sentence.chars().any(char::is_control), "{sentence:?}");
}

/// Checks what every scene that loads promises to its users.
///
/// # Panics
/// Panics where the scene breaks a promise.
pub fn check(scene: &Scene) {
    assert!(scene.triangles() > 0);
    for mesh in &scene.meshes {
        assert_eq!(mesh.positions.len(), mesh.normals.len());
        assert_eq!(mesh.indices.len() % 3, 0);
        assert!(mesh.indices.iter().all(|i| (*i as usize) < mesh.positions.len()));
        assert!(mesh.positions.as_flattened().iter().all(|c| c.is_finite()));
        for n in &mesh.normals {
            let length = DVec3::from_array(n.map(f64::from)).length();
            assert!((length - 1.0).abs() < 1e-6, "a normal of length {length}");
        }
    }
    for instance in &scene.instances {
        assert!(instance.mesh < scene.meshes.len());
        assert!(instance.world_from_mesh.is_finite());
    }
    check_opacity_maps(scene);
    scene.lights.iter().for_each(check_light);
    let cameras = scene.cameras.iter().map(|(_, camera)| *camera).chain(scene.camera);
    for camera in cameras.chain([Camera::framing(scene, 1.5)]) {
        let x = camera.world_from_view;
        assert!(x.is_finite() && (x.determinant() - 1.0).abs() < 1e-9);
        match camera.lens {
            Lens::Perspective { yfov } => assert!(camera.near > 0.0 && yfov > 0.0),
            Lens::Orthographic { half, far } => {
                assert!(half[0] > 0.0 && half[1] > 0.0 && far > camera.near && camera.near >= 0.0);
            }
        }
        assert!(camera.clip_from_view(1.0).inverse().is_finite());
    }
}

/// Checks what a scene promises of opacity maps, texture coordinates and notes.
fn check_opacity_maps(scene: &Scene) {
    for map in &scene.opacity_maps {
        let [width, height] = map.size.map(|side| side as usize);
        assert!(width > 0 && height > 0 && map.texels.len() == width * height, "{:?}", map.size);
        assert!(map.cutoff.is_none_or(|cutoff| cutoff > 0.0), "{:?}", map.cutoff);
    }
    for mesh in &scene.meshes {
        let places = mesh.texture_coordinates.as_flattened();
        let count = mesh.opacity_map.map_or(0, |_| 2 * mesh.positions.len());
        assert!(places.len() == count && places.iter().all(|place| place.is_finite()));
        assert!(mesh.opacity_map.is_none_or(|map| mesh.cut_out && map < scene.opacity_maps.len()));
    }
    assert!(scene.notes.len() <= 33);
    scene.notes.iter().for_each(|note| check_sentence(note));
}

fn check_light(light: &AreaLight) {
    let rectangle = light.light.rectangle();
    assert!(rectangle.world_from_light().is_finite());
    let half = rectangle.half_extents();
    assert!(half[0] > 0.0 && half[1] >= 0.0 || light.light.shape() == Shape::Point, "{half:?}");
    assert!(light.color.iter().chain([&light.intensity]).all(|c| c.is_finite() && *c >= 0.0));
    let Some(corners) = light.light.outline() else { return };
    assert!((3..=16).contains(&corners.len()));
    // As far outside as f32 puts what is on the edge.
    let inside = |p: &[f64; 2]| (0..2).all(|i| p[i].abs() <= half[i] * (1.0 + 1e-6));
    assert!(corners.iter().all(inside), "{corners:?} in {half:?}");
    let after = |i: usize| corners[(i + 1) % corners.len()];
    let cross = |(i, p): (usize, &[f64; 2])| p[0] * after(i)[1] - p[1] * after(i)[0];
    let doubled: f64 = corners.iter().enumerate().map(cross).sum();
    assert!(doubled > 0.0, "{corners:?} run clockwise");
}
