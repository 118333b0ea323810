//! Meshes as they are written, placed and posed: integers, instances, hidden nodes, morph targets and skins.

use super::*;
use std::f64::consts::FRAC_1_SQRT_2;

/// The corners of all triangles in the world.
pub fn points(scene: &Scene) -> Vec<DVec3> {
    corners(scene).concat()
}

#[track_caller]
fn assert_close(found: &[DVec3], expected: &[DVec3]) {
    assert_close_by(found, expected, 1e-6);
}

#[track_caller]
pub fn assert_close_by(found: &[DVec3], expected: &[DVec3], within: f64) {
    assert_eq!(found.len(), expected.len());
    for (nth, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((*a - *b).length() < within, "corner {nth}: {a} instead of {b}");
    }
}

/// The corners of the square's triangles, each moved.
fn moved(by: impl Fn(DVec3) -> DVec3) -> Vec<DVec3> {
    let corner = |i: &u32| DVec3::from_array(SQUARE[*i as usize].map(f64::from));
    TWO_TRIANGLES.iter().map(corner).map(by).collect()
}

/// A file with bytes as an accessor of `count` elements.
fn accessor(file: &mut File, bytes: &[u8], [kind, component]: [Value; 2], count: usize) -> usize {
    let view = file.view(bytes);
    file.accessor(
        json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
    )
}

#[test]
fn integers_are_what_they_stand_for() {
    // Each component's least and largest integer, and what they stand for where the largest is 1.
    for (component, bytes, normalized, expected) in [
        (5120, [-128i8, 127].map(|x| x.to_le_bytes().to_vec()), true, [-1.0, 1.0]),
        (5120, [-128i8, 127].map(|x| x.to_le_bytes().to_vec()), false, [-128.0, 127.0]),
        (5121, [0u8, 255].map(|x| x.to_le_bytes().to_vec()), true, [0.0, 1.0]),
        (5122, [-32768i16, 32767].map(|x| x.to_le_bytes().to_vec()), true, [-1.0, 1.0]),
        (5123, [0u16, 65535].map(|x| x.to_le_bytes().to_vec()), true, [0.0, 1.0]),
        (5123, [0u16, 65535].map(|x| x.to_le_bytes().to_vec()), false, [0.0, 65535.0]),
    ] {
        let mut file = File::default();
        // A triangle of three corners at the ends, behind each a byte that belongs to nothing.
        let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]];
        let bytes_of = |c: &[usize; 3]| {
            let mut all: Vec<u8> = c.iter().flat_map(|k| bytes[*k].clone()).collect();
            all.push(0xEE);
            all
        };
        let all: Vec<u8> = corners.iter().flat_map(bytes_of).collect();
        let view = file.view(&all);
        file.views[view]["byteStride"] = json!(all.len() / 3);
        let position = file.accessor(json!({
            "bufferView": view, "componentType": component, "type": "VEC3", "count": 3,
            "normalized": normalized
        }));
        let primitives = json!([{"attributes": {"POSITION": position}}]);
        let members = json!({"extensionsRequired": ["KHR_mesh_quantization"]});
        let scene = file.scene(&primitives, members).unwrap();
        let expected = corners.map(|c| DVec3::from_array(c.map(|k| expected[k])));
        assert_close(&points(&scene), &expected);
        // Without the extension they are refused.
        let found = file.scene(&primitives, json!({})).unwrap_err();
        assert!(found.contains("it must hold VEC3 of 5126"), "{found}");
    }
}

#[test]
fn hidden_nodes_have_neither_triangles_nor_lights_and_keep_their_cameras() {
    let (file, primitives) = square();
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    let light = json!({"area_light": "rectangle", "width": 1, "height": 1});
    let members = json!({
        "extensionsRequired": ["KHR_node_visibility"],
        "scenes": [{"nodes": [0, 1, 3]}],
        "nodes": [
            {"name": "seen", "mesh": 0, "extensions": {"KHR_node_visibility": {}}},
            {"name": "hidden", "mesh": 0, "extensions": hidden, "children": [2], "extras": light},
            // A child that says otherwise is hidden too.
            {"name": "below", "mesh": 0, "camera": 0, "extras": light,
             "extensions": {"KHR_node_visibility": {"visible": true}}},
            {"name": "lamp", "extras": light},
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
    });
    let scene = file.scene(&primitives, members).unwrap();
    let names: Vec<_> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    let lights: Vec<_> = scene.lights.iter().map(|l| l.name.as_str()).collect();
    assert_eq!((names, lights), (vec!["seen"], vec!["lamp"]));
    assert_eq!(scene.cameras.len(), 1);
}

#[test]
fn a_node_places_its_mesh_as_often_as_it_has_instances() {
    let (mut file, primitives) = square();
    let translation = file.vectors(&[[5.0, 0.0, 0.0], [0.0, 7.0, 0.0]]);
    let scale = file.vectors(&[[1.0, 1.0, 1.0], [2.0, 3.0, 1.0]]);
    // Around z by 90 degrees, in bytes: not quite of length 1.
    let turned: Vec<u8> = [[0i8, 0, 0, 127], [0, 0, 90, 90]]
        .as_flattened()
        .iter()
        .map(|x| x.cast_unsigned())
        .collect();
    let rotation = accessor(&mut file, &turned, [json!("VEC4"), json!(5120)], 2);
    file.accessors[rotation]["normalized"] = json!(true);
    let instanced = |attributes: Value| {
        json!({
            "nodes": [{
                "name": "thing", "mesh": 0, "translation": [0, 0, 1],
                "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
            }],
            "extensionsRequired": ["EXT_mesh_gpu_instancing"],
        })
    };
    let attributes = json!({"TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale});
    let scene = file.scene(&primitives, instanced(attributes)).unwrap();
    let first = moved(|p| p + DVec3::new(5.0, 0.0, 1.0));
    let second = moved(|p| DVec3::new(-3.0 * p.y, 7.0 + 2.0 * p.x, 1.0));
    assert_close(&points(&scene), &[first, second].concat());
    assert_eq!(scene.meshes.len(), 1);
    assert!(scene.instances.iter().all(|i| i.name == "thing"));

    let three = file.vectors(&[[0.0; 3]; 3]);
    for (attributes, sentence) in [
        (json!({}), "has instances without a TRANSLATION"),
        (json!({"TRANSLATION": translation, "SCALE": three}), "has 2 and 3 instances"),
        (
            json!({"TRANSLATION": 99}),
            "the TRANSLATION of the instances of node \"thing\" refers to accessors[99]",
        ),
        (json!({"ROTATION": translation}), "it must hold VEC4"),
    ] {
        let found = file.scene(&primitives, instanced(attributes)).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    }
    // Zeros that take no bytes.
    let many = file.accessor(json!({
        "componentType": 5126, "type": "VEC3", "count": 60_000,
        "sparse": {
            "count": 1,
            "indices": {"bufferView": 1, "componentType": 5121},
            "values": {"bufferView": 0}
        }
    }));
    let found = file.scene(&primitives, instanced(json!({"TRANSLATION": many}))).unwrap_err();
    assert!(found.contains("the nodes have 60000 instances"), "{found}");
}

#[test]
fn names_that_instances_share_are_short() {
    let (mut file, primitives) = square();
    let translation = file.vectors(&[[0.0; 3]; 2]);
    let name = "ä".repeat(1000);
    let members = json!({"nodes": [{
        "name": name, "mesh": 0,
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation}}}
    }]});
    let scene = file.scene(&primitives, members).unwrap();
    assert_eq!(scene.instances[1].name, format!("{}…", "ä".repeat(64)));
}

#[test]
fn morph_targets_go_as_far_as_their_weights() {
    let (mut file, mut primitives) = square();
    let up = file.vectors(&[[0.0, 0.0, 2.0]; 4]);
    let aside = file.vectors(&[[4.0, 0.0, 0.0]; 4]);
    primitives[0]["targets"] = json!([{"POSITION": up}, {"POSITION": aside}, {}]);
    let scene = |nodes: Value, weights: Value| {
        let mut root = file.root(&primitives, json!({"nodes": nodes}));
        root["meshes"][0]["weights"] = weights;
        root["scenes"] =
            json!([{"nodes": (0..root["nodes"].as_array().unwrap().len()).collect::<Vec<_>>()}]);
        open(&glb(&root, &file.bin))
    };
    let plain = json!([{"mesh": 0}]);
    assert_close(&points(&scene(plain.clone(), json!([])).unwrap()), &moved(|p| p));
    let half = scene(plain.clone(), json!([0.5, -1.0, 3.0])).unwrap();
    assert_close(&points(&half), &moved(|p| p + DVec3::new(-4.0, 0.0, 1.0)));
    // The node's weights take the place of the mesh's; nodes that agree share a mesh.
    let nodes =
        json!([{"mesh": 0, "weights": [0, 1, 0]}, {"mesh": 0}, {"mesh": 0, "weights": [0, 1]}]);
    let three = scene(nodes, json!([1, 0, 0])).unwrap();
    let right = moved(|p| p + DVec3::new(4.0, 0.0, 0.0));
    let above = moved(|p| p + DVec3::new(0.0, 0.0, 2.0));
    assert_close(&points(&three), &[right.clone(), above, right].concat());
    assert_eq!(three.meshes.len(), 2);
    let found = scene(plain, json!([1e300])).unwrap_err();
    assert!(found.contains("the weights of its morph targets must be finite"), "{found}");
    let short = file.vectors(&[[0.0; 3]; 3]);
    primitives[0]["targets"] = json!([{"POSITION": short}]);
    let members = json!({"nodes": [{"name": "thing", "mesh": 0, "weights": [1]}]});
    let found = file.scene(&primitives, members).unwrap_err();
    assert!(found.contains("a morph target for another number of vertices"), "{found}");
}

/// A square whose left side hangs on a joint at the origin, and whose right side on one that is turned and moved.
fn skinned() -> (File, Value, Value) {
    let (mut file, mut primitives) = square();
    let joints =
        accessor(&mut file, &[[0u8, 1, 0, 0]; 4].concat(), [json!("VEC4"), json!(5121)], 4);
    // Half of the weights that the right side has are of the second set; none of them adds up to 1.
    let weights: Vec<u8> = SQUARE
        .iter()
        .flat_map(|p| if p[0] < 0.5 { [128u8, 0, 0, 0] } else { [0, 64, 0, 0] })
        .collect();
    let weights = accessor(&mut file, &weights, [json!("VEC4"), json!(5121)], 4);
    file.accessors[weights]["normalized"] = json!(true);
    let more: Vec<u8> =
        SQUARE.iter().flat_map(|p| if p[0] < 0.5 { [0u8; 4] } else { [0, 64, 0, 0] }).collect();
    let more = accessor(&mut file, &more, [json!("VEC4"), json!(5121)], 4);
    file.accessors[more]["normalized"] = json!(true);
    primitives[0]["attributes"]["JOINTS_0"] = json!(joints);
    primitives[0]["attributes"]["WEIGHTS_0"] = json!(weights);
    primitives[0]["attributes"]["JOINTS_1"] = json!(joints);
    primitives[0]["attributes"]["WEIGHTS_1"] = json!(more);
    // The second joint was at x = 1 when it was bound.
    let bind = |x: f32| {
        let mut m = [0.0f32; 16];
        for i in [0, 5, 10, 15] {
            m[i] = 1.0;
        }
        m[12] = -x;
        m
    };
    let bytes: Vec<u8> =
        [bind(0.0), bind(1.0)].as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let bind = accessor(&mut file, &bytes, [json!("MAT4"), json!(5126)], 2);
    let members = json!({
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            // Where the node itself stands does not matter.
            {"name": "thing", "mesh": 0, "skin": 0, "translation": [100, 200, 300]},
            {"name": "root", "children": [2], "translation": [10, 0, 0]},
            {"name": "tip", "translation": [1, 0, 5], "rotation": [0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2]},
        ],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": bind}],
    });
    (file, primitives, members)
}

#[test]
fn a_skin_stands_where_its_joints_do() {
    let (file, primitives, members) = skinned();
    let scene = file.scene(&primitives, members.clone()).unwrap();
    let posed = |p: DVec3| {
        if p.x < 0.5 {
            return p + DVec3::new(10.0, 0.0, 0.0);
        }
        // Around y by 90 degrees: x goes to −z; both right corners are at the joint.
        DVec3::new(11.0, p.y, 5.0)
    };
    assert_close(&points(&scene), &moved(posed));
    // Flat normals are those of the posed triangles.
    let n = DVec3::from_array(scene.meshes[0].normals[0].map(f64::from));
    assert!((n - DVec3::new(-5.0, 0.0, 1.0).normalize()).length() < 1e-6, "{n}");
}

#[test]
fn skins_that_contradict_themselves_are_refused() {
    let (file, primitives, members) = skinned();
    let refused = |pointer: &str, value: Value, sentence: &str| {
        let mut root = file.root(&primitives, members.clone());
        *root.pointer_mut(pointer).unwrap() = value;
        let found = open(&glb(&root, &file.bin)).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    };
    refused("/nodes/0/skin", json!(3), "node \"thing\" refers to skins[3], and the file has 1");
    refused("/skins/0/joints", json!([1, 9]), "skins[0] refers to nodes[9]");
    refused("/skins/0/joints", json!([]), "skins[0] has no joints");
    refused("/skins/0/joints", json!([1]), "hangs on joint 1, and the skin has 1");
    refused("/skins/0/joints", json!([1, 2, 2]), "has 3 joints and fewer inverseBindMatrices");
    let attributes = json!({"POSITION": primitives[0]["attributes"]["POSITION"]});
    refused("/meshes/0/primitives/0/attributes", attributes, "neither JOINTS_0 nor WEIGHTS_0");
}
