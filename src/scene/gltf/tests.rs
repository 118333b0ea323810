//! What the loader holds in the memory, which its results do not show; what they show is tested in `tests/scenes/gltf`.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use super::buffers::Buffers;
use super::document::Document;
use super::json::Root;
use super::pose::Pose;
use super::triangles::Reader;
use serde_json::{Value, json};
use std::path::Path;

/// The root of a file with these buffers, whose views are each the whole of a buffer of this length.
fn root(buffers: &Value, length: usize, members: &[(&str, Value)]) -> Root {
    let count = buffers.as_array().unwrap().len();
    let views: Vec<Value> =
        (0..count).map(|i| json!({"buffer": i, "byteLength": length})).collect();
    let mut root = json!({"asset": {"version": "2.0"}, "buffers": buffers, "bufferViews": views});
    for (key, value) in members {
        root[*key] = value.clone();
    }
    serde_json::from_value(root).unwrap()
}

#[test]
fn triangles_beyond_the_limit_are_refused_before_they_are_made() {
    let most = 1 << 16;
    let bytes = vec![0; 36 + 3 * most];
    // Positions, and behind them the indices, a byte each.
    let accessors = json!([
        {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
        {"bufferView": 0, "byteOffset": 36, "componentType": 5121, "type": "SCALAR", "count": 3 * most},
    ]);
    let primitive = json!({"attributes": {"POSITION": 0}, "indices": 1});
    let meshes = json!([{"name": "shape", "primitives": vec![primitive; 5]}]);
    let members = [("accessors", accessors), ("meshes", meshes)];
    let root = root(&json!([{"byteLength": bytes.len()}]), bytes.len(), &members);
    // As of a file so long that its length is no limit.
    let buffers = Buffers::new(&root, 5 * most, Some(&bytes), Path::new("."));
    let document = Document::default();
    let read = |limit| {
        let mut reader = Reader::with_limit(&root, &buffers, (&document, false), limit);
        let shape = reader.shape(0, &Pose::default()).unwrap();
        reader
            .read(0, &shape, None)
            .map(|parts| parts.into_iter().map(|(mesh, _)| mesh).collect::<Vec<_>>())
    };
    let found = read(4 * most).unwrap_err();
    assert!(found.starts_with("mesh \"shape\", primitive 4: its triangles exceed"), "{found}");
    assert_eq!(read(5 * most).unwrap()[0].indices.len(), 15 * most);
}

/// However a file's buffers write its name, it is in the memory once.
#[test]
fn one_file_for_many_buffers() {
    let folder = std::env::temp_dir().join(format!("antumbra one file {}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let bytes = [1, 2, 3, 4];
    std::fs::write(folder.join("a.bin"), bytes).unwrap();
    let names = ["a.bin", "./a.bin", "%61.bin", "././%61.bin"];
    let listed = json!(names.map(|uri| json!({"byteLength": bytes.len(), "uri": uri})));
    let root = root(&listed, bytes.len(), &[]);
    let buffers = Buffers::new(&root, 0, None, &folder);
    let of = |index: usize| buffers.view(index, || "a test".into()).unwrap().0;
    for (index, name) in names.iter().enumerate() {
        assert_eq!(of(index), bytes);
        assert!(std::ptr::eq(of(index), of(0)), "{name}");
    }
    assert_eq!(buffers.held(), bytes.len() as u64);
    // What is left in a temporary folder harms nobody.
    let _ = std::fs::remove_dir_all(&folder);
}
