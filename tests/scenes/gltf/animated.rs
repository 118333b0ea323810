//! Files of several scenes, and those that are shown at a time of an animation.

use super::posed::{assert_close_by, points};
use super::*;
use antumbra::scene::{GltfOptions, from_gltf_as};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// The file of a test, written where no other writes.
fn written(name: &str, root: &Value, bin: &[u8]) -> PathBuf {
    let path = antumbra_tests::example::folder(&format!("animated-{name}")).join("scene.glb");
    std::fs::write(&path, glb(root, bin)).unwrap();
    path
}

/// The square at a time of an animation whose only channel has these times and values.
fn at(
    name: &str,
    (path, interpolation, kind): (&str, &str, &str),
    times: &[f32],
    values: &[f32],
    time: f64,
) -> Result<Scene, String> {
    let (mut file, primitives) = square();
    let bytes: Vec<u8> = times.iter().flat_map(|t| t.to_le_bytes()).collect();
    let view = file.view(&bytes);
    let input = file.accessor(
        json!({"bufferView": view, "componentType": 5126, "type": "SCALAR", "count": times.len()}),
    );
    let bytes: Vec<u8> = values.iter().flat_map(|t| t.to_le_bytes()).collect();
    let view = file.view(&bytes);
    let each = match kind {
        "SCALAR" => 1,
        "VEC3" => 3,
        _ => 4,
    };
    let output = file.accessor(json!(
        {"bufferView": view, "componentType": 5126, "type": kind, "count": values.len() / each}
    ));
    let sampler = json!({"input": input, "output": output, "interpolation": interpolation});
    let members = json!({"animations": [
        {"name": "other"},
        {"name": "moving", "samplers": [sampler], "channels": [
            {"sampler": 0, "target": {"node": 0, "path": path}},
            {"sampler": 0, "target": {"path": "pointer"}},
        ]},
    ]});
    let path = written(name, &file.root(&primitives, members), &file.bin);
    let of = GltfOptions { animation: Some(("moving", time)), ..GltfOptions::default() };
    let by_number = GltfOptions { animation: Some(("1", time)), ..GltfOptions::default() };
    let scene = from_gltf_as(&path, &of).map_err(|e| e.to_string());
    let same = from_gltf_as(&path, &by_number).map_err(|e| e.to_string());
    assert_eq!(scene.is_ok(), same.is_ok());
    scene
}

fn expected(place: impl Fn(DVec3) -> DVec3) -> Vec<DVec3> {
    TWO_TRIANGLES.map(|i| place(DVec3::from_array(SQUARE[i as usize].map(f64::from)))).to_vec()
}

#[test]
fn each_way_between_keys_is_its_own() {
    let moved = ("translation", "LINEAR", "VEC3");
    let values = [0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 8.0, 4.0, 0.0];
    for (way, time, to) in [
        ("LINEAR", 1.5, DVec3::new(4.0, 0.0, 0.0)),
        ("LINEAR", 2.5, DVec3::new(8.0, 2.0, 0.0)),
        // Before the first and after the last it stands.
        ("LINEAR", -9.0, DVec3::ZERO),
        ("LINEAR", 99.0, DVec3::new(8.0, 4.0, 0.0)),
        ("STEP", 1.99, DVec3::ZERO),
        ("STEP", 2.0, DVec3::new(8.0, 0.0, 0.0)),
    ] {
        let scene =
            at("between", (moved.0, way, moved.2), &[1.0, 2.0, 3.0], &values, time).unwrap();
        assert_close_by(&points(&scene), &expected(|p| p + to), 1e-6);
    }
    // In tangent, value, out tangent of each key, over two seconds: Hermite's polynomial of a half.
    let values = [
        [9.0, 9.0, 9.0],
        [1.0, 0.0, 0.0],
        [4.0, 0.0, 2.0],
        [0.0, 0.0, -2.0],
        [3.0, 0.0, 0.0],
        [9.0, 9.0, 9.0],
    ];
    let way = ("translation", "CUBICSPLINE", "VEC3");
    let scene = at("cubic", way, &[0.0, 2.0], values.as_flattened(), 1.0).unwrap();
    // (1 + 3)/2 + 2 s/8 (out − in)
    let to = DVec3::new(2.0 + 0.25 * 4.0, 0.0, 0.25 * 4.0);
    assert_close_by(&points(&scene), &expected(|p| p + to), 1e-6);
}

#[test]
fn rotations_go_along_the_shorter_arc() {
    let half = FRAC_1_SQRT_2 as f32;
    // A quarter turn about Z, once as it is and once by the quaternion's other sign.
    for sign in [1.0, -1.0] {
        let values = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, sign * half, sign * half];
        let way = ("rotation", "LINEAR", "VEC4");
        let scene = at("turn", way, &[0.0, 1.0], &values, 1.0 / 3.0).unwrap();
        let turn = glam::DQuat::from_rotation_z(PI / 6.0);
        assert_close_by(&points(&scene), &expected(|p| turn * p), 1e-6);
    }
}

#[test]
fn animated_weights_morph() {
    let (mut file, _) = square();
    let up = file.vectors(&[[0.0, 0.0, 1.0]; 4]);
    let aside = file.vectors(&[[1.0, 0.0, 0.0]; 4]);
    let bytes: Vec<u8> = [0.0f32, 1.0].iter().flat_map(|t| t.to_le_bytes()).collect();
    let view = file.view(&bytes);
    let input = file
        .accessor(json!({"bufferView": view, "componentType": 5126, "type": "SCALAR", "count": 2}));
    let bytes: Vec<u8> = [0.0f32, 0.5, 1.0, 0.25].iter().flat_map(|t| t.to_le_bytes()).collect();
    let view = file.view(&bytes);
    let output = file
        .accessor(json!({"bufferView": view, "componentType": 5126, "type": "SCALAR", "count": 4}));
    let primitives = json!([{
        "attributes": {"POSITION": 0}, "indices": 1,
        "targets": [{"POSITION": up}, {"POSITION": aside}],
    }]);
    let members = json!({"animations": [{
        "samplers": [{"input": input, "output": output}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
    }]});
    let path = written("weights", &file.root(&primitives, members), &file.bin);
    let of = GltfOptions { animation: Some(("0", 0.5)), ..GltfOptions::default() };
    let scene = from_gltf_as(&path, &of).unwrap();
    assert_close_by(&points(&scene), &expected(|p| p + DVec3::new(0.375, 0.0, 0.5)), 1e-6);
}

#[test]
fn what_is_wrong_with_an_animation_is_a_sentence() {
    let way = ("translation", "LINEAR", "VEC3");
    let two = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let refused = |way, times: &[f32], values: &[f32], time, sentence: &str| {
        let found = at("wrong", way, times, values, time).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    };
    refused(way, &[1.0, 1.0], &two, 1.0, "its time 1 is 1, after 1; times must rise");
    refused(way, &[0.0, f32::NAN], &two, 1.0, "its time 1 is NaN");
    refused(way, &[], &[], 1.0, "has no times");
    refused(way, &[0.0, 1.0], &two[..3], 0.5, "has no finite value 1 for key 1");
    refused(way, &[0.0, 1.0], &[0.0, f32::NAN, 0.0, 1.0, 0.0, 0.0], 0.5, "has no finite value 0");
    refused(way, &[0.0, 1.0], &two, f64::NAN, "an animation has no time NaN");
    refused(("translation", "SPLINE", "VEC3"), &[0.0, 1.0], &two, 0.5, "none of LINEAR, STEP");
    refused(("translation", "LINEAR", "VEC4"), &[0.0], &[0.0; 4], 0.5, "it must hold VEC3");
    refused(("rotation", "LINEAR", "VEC4"), &[0.0], &[0.0; 4], 0.5, "a rotation of length 0");
    let (file, primitives) = square();
    let path = written(
        "none",
        &file.root(&primitives, json!({"animations": [{"name": "walk"}]})),
        &file.bin,
    );
    let of = GltfOptions { animation: Some(("run", 0.0)), ..GltfOptions::default() };
    let found = from_gltf_as(&path, &of).unwrap_err().to_string();
    assert!(found.contains("it has no animation \"run\"; it has 1: \"walk\""), "{found}");
    // A node with a matrix cannot be moved.
    let (mut file, _) = square();
    let times = file.view(&0.0f32.to_le_bytes());
    let input = file.accessor(
        json!({"bufferView": times, "componentType": 5126, "type": "SCALAR", "count": 1}),
    );
    let output = file.vectors(&[[1.0, 0.0, 0.0]]);
    let members = json!({
        "nodes": [{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}],
        "animations": [{
            "samplers": [{"input": input, "output": output}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        }],
    });
    let path = written("matrix", &file.root(&primitives, members), &file.bin);
    let first = GltfOptions { animation: Some(("0", 0.0)), ..GltfOptions::default() };
    let found = from_gltf_as(&path, &first).unwrap_err().to_string();
    assert!(found.contains("nodes[0] has a matrix, and an animation moves it"), "{found}");
    // What is wrong with an animation that nobody named stops nothing.
    let members = json!({"animations": [3]});
    let path = written("broken", &file.root(&primitives, members), &file.bin);
    assert!(from_gltf(&path).is_ok());
    let found = from_gltf_as(&path, &first).unwrap_err().to_string();
    assert!(found.contains("animations[0] is wrong"), "{found}");
}

#[test]
fn a_scene_is_taken_by_its_name_or_number() {
    let (file, primitives) = square();
    let members = json!({
        "scenes": [{"nodes": [0]}, {"name": "second", "nodes": [0, 1]}],
        "nodes": [{"name": "a", "mesh": 0}, {"name": "b", "mesh": 0}],
    });
    let path = written("scenes", &file.root(&primitives, members), &file.bin);
    let instances = |scene| {
        let scene = from_gltf_as(&path, &GltfOptions { scene, ..GltfOptions::default() });
        scene.map(|scene| scene.instances.len()).map_err(|e| e.to_string())
    };
    assert_eq!(
        [instances(None), instances(Some("second")), instances(Some("1"))],
        [Ok(1), Ok(2), Ok(2)]
    );
    assert_eq!(instances(Some("0")), Ok(1));
    let found = instances(Some("third")).unwrap_err();
    assert!(found.contains("it has no scene \"third\"; it has 2: \"\", \"second\""), "{found}");
}
