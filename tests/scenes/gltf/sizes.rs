//! The loader reads, makes and says no more than a file's length allows.
//! tests/untrusted measures what that takes of the memory.

use super::*;

/// Five primitives of as many triangles, which share their accessors: a byte an index.
fn five_times(triangles: usize) -> (File, Value) {
    let mut file = File::default();
    let position = file.vectors(&SQUARE[..3]);
    let view = file.view(&vec![0; 3 * triangles]);
    let indices = file.accessor(json!(
        {"bufferView": view, "componentType": 5121, "type": "SCALAR", "count": 3 * triangles}
    ));
    let primitive = json!({"attributes": {"POSITION": position}, "indices": indices});
    (file, json!(vec![primitive; 5]))
}

/// Primitives that share one accessor over and over must not multiply without end.
#[test]
fn more_triangles_than_bytes_are_refused() {
    let (file, primitives) = five_times(2000);
    let found = file.scene(&primitives, json!({})).unwrap_err();
    let bytes = glb(&file.root(&primitives, json!({})), &file.bin).len();
    assert_eq!(
        found,
        format!(
            "mesh \"shape\", primitive 3: with it the meshes have 8000 triangles from {bytes} bytes of \
             file and buffers, which is more than one a byte; fewer primitives must share their accessors"
        )
    );
    let three = json!(primitives.as_array().unwrap()[..3]);
    assert_eq!(file.scene(&three, json!({})).unwrap().triangles(), 6000);
}

/// The many materials of a sphere, say: the scene holds its triangles once.
#[test]
fn meshes_of_the_same_triangles_are_one() {
    let (file, primitives) = square();
    let mesh = |material: usize| {
        let mut primitives = primitives.clone();
        primitives[0]["material"] = json!(material);
        json!({"name": format!("shape {material}"), "primitives": primitives})
    };
    let glass =
        json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0]}});
    let materials = json!([{}, {"doubleSided": true}, glass, {"name": "red"}]);
    let members = json!({
        "materials": materials,
        "meshes": [mesh(0), mesh(1), mesh(2), mesh(3), mesh(1)],
        "nodes": [{"mesh": 0}, {"mesh": 1}, {"mesh": 2}, {"mesh": 3}, {"mesh": 4}],
        "scenes": [{"nodes": [0, 1, 2, 3, 4]}],
    });
    let scene = file.scene(&json!([]), members).unwrap();
    let found: Vec<usize> = scene.instances.iter().map(|i| i.mesh).collect();
    assert_eq!(found, [0, 1, 2, 0, 1]);
    let looks: Vec<_> = scene.meshes.iter().map(|m| (m.double_sided, m.cut_out)).collect();
    assert_eq!(looks, [(false, false), (true, false), (false, true)]);
}

#[test]
fn sentences_are_short_whatever_a_file_says() {
    let long = "x".repeat(100_000);
    for pointer in ["/accessors/0/count", "/accessors/0/type", "/asset/version", "/nodes/0/mesh"] {
        let (file, primitives) = square();
        let mut root = file.root(&primitives, json!({}));
        *root.pointer_mut(pointer).unwrap() = json!(long);
        let found = open(&glb(&root, &file.bin)).unwrap_err();
        assert!(found.len() < 300, "{pointer}: {} bytes", found.len());
    }
    let (file, primitives) = square();
    let text = file.root(&primitives, json!({"nodes": [{"mesh": long}]})).to_string();
    let found = open(text.as_bytes()).unwrap_err();
    let at = format!("at line 1 column {}", text.find(&long).unwrap() + long.len() + 1);
    assert!(found.ends_with(&at), "{found}");
}
