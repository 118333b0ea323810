//! Files that the loader must refuse, each with its sentence.

use super::*;

/// Changes one member of the square's file, given as a JSON pointer, and expects a sentence.
#[track_caller]
fn changed(pointer: &str, value: Value, sentence: &str) {
    let (file, primitives) = square();
    let mut root = file.root(&primitives, json!({}));
    let (owner, key) = pointer.rsplit_once('/').unwrap();
    let owner = root.pointer_mut(owner).unwrap();
    match key.parse::<usize>() {
        Ok(index) => owner[index] = value,
        Err(_) => owner[key] = value,
    }
    let found = open(&glb(&root, &file.bin)).unwrap_err();
    assert!(found.contains(sentence), "{pointer}: {found}");
    assert!(!found.contains('\n'), "{found}");
}

#[test]
fn indices_of_the_json_that_lead_nowhere() {
    changed("/scene", json!(7), "its member \"scene\" refers to scenes[7], and the file has 1");
    changed("/scenes/0/nodes/0", json!(9), "the scene refers to nodes[9], and the file has 1");
    changed("/nodes/0/children", json!([5]), "node \"thing\" refers to nodes[5]");
    changed("/nodes/0/mesh", json!(3), "node \"thing\" refers to meshes[3], and the file has 1");
    changed("/nodes/0/camera", json!(0), "node \"thing\" refers to cameras[0], and the file has 0");
    changed("/meshes/0/primitives/0/material", json!(1), "mesh \"shape\" refers to materials[1]");
    let primitive = "/meshes/0/primitives/0";
    let pointer = format!("{primitive}/attributes/POSITION");
    changed(&pointer, json!(8), "the POSITION of mesh \"shape\" refers to accessors[8]");
    let pointer = format!("{primitive}/attributes/NORMAL");
    changed(&pointer, json!(8), "the NORMAL of mesh \"shape\" refers to accessors[8]");
    let pointer = format!("{primitive}/indices");
    changed(&pointer, json!(8), "the indices of mesh \"shape\" refers to accessors[8]");
    changed("/accessors/0/bufferView", json!(4), "refers to bufferViews[4], and the file has 2");
    changed("/bufferViews/0/buffer", json!(2), "bufferViews[0] refers to buffers[2]");
}

#[test]
fn counts_and_offsets_that_no_buffer_holds() {
    let huge = json!(u64::MAX);
    let needs = "accessors[0], the POSITION of mesh \"shape\", needs";
    for count in [json!(5), json!(1u64 << 40), huge.clone()] {
        changed("/accessors/0/count", count, needs);
    }
    changed("/accessors/0/byteOffset", json!(4), needs);
    changed("/accessors/0/byteOffset", huge.clone(), needs);
    changed(
        "/bufferViews/0/byteStride",
        json!(4),
        "12 bytes in a bufferView with a byteStride of 4",
    );
    changed("/bufferViews/0/byteStride", json!(16), needs);
    changed("/bufferViews/0/byteStride", huge.clone(), needs);
    changed("/bufferViews/0/byteLength", json!(47), needs);
    changed(
        "/bufferViews/0/byteLength",
        json!(4800),
        "bufferViews[0] spans 4800 bytes from byte 1",
    );
    changed("/bufferViews/0/byteOffset", huge.clone(), "bufferViews[0] spans 48 bytes");
    changed("/buffers/0/byteLength", json!(1000), "buffers[0] states 1000 bytes and holds");
    changed("/buffers/0/byteLength", huge, "buffers[0] states 18446744073709551615 bytes");
    changed("/accessors/0/count", json!(-1), "it is not the JSON of a glTF 2.0 file");
}

#[test]
fn accessors_of_the_wrong_kind() {
    changed("/accessors/0/type", json!("VEC2"), "it must hold VEC3 of 5126 (32-bit floats)");
    changed("/accessors/0/componentType", json!(5122), "it must hold VEC3 of 5126");
    changed("/accessors/1/type", json!("VEC3"), "it must hold SCALAR of 5121, 5123 or 5125");
    changed("/accessors/1/componentType", json!(5126), "it must hold SCALAR of 5121");
    changed("/meshes/0/primitives/0/mode", json!(7), "mesh \"shape\": its mode is 7");
    changed(
        "/accessors/1/count",
        json!(5),
        "mesh \"shape\": it has 5 corners; a list of triangles",
    );
    changed("/accessors/0/count", json!(3), "its corner 5 is vertex 3, and it has 3 positions");
    changed(
        "/accessors/0/bufferView",
        Value::Null,
        "has no bufferView, and no compression that is read",
    );
    let (mut file, primitives) = square();
    let normal = file.vectors(&SQUARE[..3]);
    let mut primitives = primitives;
    primitives[0]["attributes"]["NORMAL"] = json!(normal);
    let found = file.scene(&primitives, json!({})).unwrap_err();
    assert_eq!(found, "mesh \"shape\" has 3 normals for 4 positions; it must have as many");
    let strip = json!([{"attributes": {"POSITION": file.vectors(&SQUARE[..2])}, "mode": 5}]);
    assert!(file.scene(&strip, json!({})).unwrap_err().contains("3 or more"));
}

#[test]
fn positions_that_are_no_numbers() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut file = File::default();
        let mut positions = SQUARE;
        positions[2][1] = bad;
        let position = file.vectors(&positions);
        let primitives = json!([{"attributes": {"POSITION": position}, "mode": 6}]);
        let found = file.scene(&primitives, json!({})).unwrap_err();
        assert!(found.starts_with("mesh \"shape\": its position 2 is [1.0, "), "{found}");
    }
}

#[test]
fn sparse_parts_that_contradict_themselves() {
    let attempt = |change: &dyn Fn(&mut Value), indices: &[u8]| {
        let mut file = File::default();
        let indices = file.view(indices);
        let values = file.view(&floats(&SQUARE[..2]));
        let mut accessor = json!({
            "componentType": 5126, "type": "VEC3", "count": 3,
            "sparse": {
                "count": 2,
                "indices": {"bufferView": indices, "componentType": 5121},
                "values": {"bufferView": values}
            }
        });
        change(&mut accessor);
        let position = file.accessor(accessor);
        file.scene(&json!([{"attributes": {"POSITION": position}}]), json!({}))
    };
    let as_it_is = |_: &mut Value| {};
    assert_eq!(attempt(&as_it_is, &[0, 2]).unwrap().triangles(), 1);
    let order = "must list its indices in rising order and below 3";
    for bad in [[2, 0], [1, 1], [1, 3]] {
        assert!(attempt(&as_it_is, &bad).unwrap_err().contains(order));
    }
    for (change, sentence) in [
        ((|a| a["sparse"]["count"] = json!(4)) as fn(&mut Value), "replaces 4 elements of 3"),
        (|a| a["sparse"]["count"] = json!(3), "needs 3 elements of 1 bytes"),
        (|a| a["sparse"]["values"]["byteOffset"] = json!(1), "needs 2 elements of 12 bytes"),
        (
            |a| a["sparse"]["indices"]["componentType"] = json!(5126),
            "indices of componentType 5126",
        ),
        (|a| a["sparse"]["indices"]["bufferView"] = json!(9), "refers to bufferViews[9]"),
        (|a| a["sparse"]["values"]["bufferView"] = json!(9), "refers to bufferViews[9]"),
        (|a| a["count"] = json!(u64::MAX), "without a bufferView; at most 65536"),
    ] {
        let found = attempt(&change, &[0, 2]).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    }
}

#[test]
fn hierarchies_that_are_no_trees() {
    for (nodes, roots, twice) in [
        (json!([{"children": [0]}]), json!([0]), "node 0"),
        (json!([{"children": [1]}, {"name": "b", "children": [0]}]), json!([0]), "node 0"),
        (json!([{"children": [2]}, {"children": [2]}, {"name": "c"}]), json!([0, 1]), "node \"c\""),
        (json!([{"mesh": 0}]), json!([0, 0]), "node 0"),
    ] {
        let (file, primitives) = square();
        let members = json!({"nodes": nodes, "scenes": [{"nodes": roots}]});
        let found = file.scene(&primitives, members).unwrap_err();
        assert!(found.starts_with(&format!("{twice} is reached twice")), "{found}");
    }
}

#[test]
fn transforms_that_place_nothing() {
    let finite = "its translation, rotation and scale must be finite";
    let mut matrix = DMat4::IDENTITY.to_cols_array();
    matrix[3] = 0.5;
    for (node, sentence) in [
        (json!({"rotation": [0, 0, 0, 0]}), finite),
        (json!({"rotation": [1e200, 0, 0, 0]}), finite),
        (json!({"matrix": matrix}), "its last row must be 0 0 0 1"),
        (json!({"translation": [0, 1e10, 0]}), "its mesh reaches further than 1e9 m"),
        (json!({"scale": [1e10, 1, 1]}), "its mesh reaches further than 1e9 m"),
        (
            json!({"shadow": 0, "extras": {"shadow_role": "caster"}}),
            "its shadow_role is \"caster\"",
        ),
        (
            json!({"extras": {"shadow_role": 3}}),
            "its shadow_role is 3; write occluder, receiver or both",
        ),
    ] {
        let mut node = node;
        node["mesh"] = json!(0);
        node["name"] = json!("odd\nnode");
        let found = with_nodes(&json!([node])).unwrap_err();
        assert!(found.starts_with(r#"node "odd\nnode": "#) && found.contains(sentence), "{found}");
    }
    let (file, primitives) = square();
    let nodes =
        json!([{"scale": [1e300, 1, 1], "children": [1]}, {"mesh": 0, "scale": [1e300, 1, 1]}]);
    let found = file.scene(&primitives, json!({"nodes": nodes})).unwrap_err();
    assert_eq!(found, "node 1: its transform is not finite");
}

#[test]
fn cameras_that_see_nothing() {
    let (file, primitives) = square();
    for (yfov, znear, scale, sentence) in [
        (0.0, 0.1, 1, "a yfov of 0"),
        (3.2, 0.1, 1, "a yfov of 3.2; it must be between 0 and π"),
        (0.7, 0.0, 1, "a znear of 0; it must be above 0"),
        (0.7, 0.1, 0, "node \"eye\": no view can be had"),
    ] {
        let nodes = json!([{"mesh": 0}, {"name": "eye", "camera": 0, "scale": [1, scale, 1]}]);
        let cameras = json!([{"perspective": {"yfov": yfov, "znear": znear}}]);
        let members = json!({"nodes": nodes, "cameras": cameras, "scenes": [{"nodes": [0, 1]}]});
        let found = file.scene(&primitives, members).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    }
    let nodes = json!([{"mesh": 0}, {"camera": 0}]);
    for (camera, sentence) in [
        (json!({}), "neither a perspective nor an orthographic projection"),
        (
            json!({"orthographic": {"xmag": 0, "ymag": 1, "znear": 0, "zfar": 1}}),
            "an xmag of 0 and",
        ),
        (
            json!({"orthographic": {"xmag": 1, "ymag": 1, "znear": 2, "zfar": 2}}),
            "zfar must be beyond",
        ),
        (json!({"orthographic": {"xmag": 1, "ymag": 1, "znear": -1, "zfar": 2}}), "a znear of -1"),
    ] {
        let members = json!({"nodes": nodes, "cameras": [camera], "scenes": [{"nodes": [0, 1]}]});
        let found = file.scene(&primitives, members).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    }
}

#[test]
fn extensions_versions_and_files_that_are_something_else() {
    for name in ["KHR_mesh_quantization_2", "WEB3D_quantized_attributes", "CESIUM_RTC"] {
        changed(
            "/extensionsRequired",
            json!([name]),
            &format!("requires the extension \"{name}\""),
        );
    }
    changed("/asset/version", json!("1.0"), "its asset.version is \"1.0\"; only glTF 2.0 is read");
    changed("/meshes/0/primitives", json!([]), "it has no triangles");
    for (bytes, sentence) in [
        (&b""[..], "it is not the JSON of a glTF 2.0 file"),
        (b"\x89PNG\r\n", "it is not the JSON of a glTF 2.0 file"),
        (b"{}", "missing field `asset`"),
        // Version 1 had maps where version 2 has lists.
        (br#"{"accessors": {}, "asset": {"version": "1.0"}}"#, "its asset.version is \"1.0\""),
        (b"glTF", "its .glb header is cut off"),
        (b"glTF\x01\0\0\0\x0c\0\0\0", "a .glb of version 1; only version 2"),
        (b"glTF\x02\0\0\0\x0b\0\0\0", "less than a header's 12 bytes"),
        (b"glTF\x02\0\0\0\x00\0\0\0", "less than a header's 12 bytes"),
        (b"glTF\x02\0\0\0\x0c\0\0\0", "its .glb container is empty"),
        (b"glTF\x02\0\0\0\xff\0\0\0", "claims 255 bytes, and the file has 12"),
        (
            b"glTF\x02\0\0\0\x14\0\0\0\xff\xff\xff\xffJSON",
            "claims 4294967295 bytes, and 0 are left",
        ),
        (b"glTF\x02\0\0\0\x14\0\0\0\0\0\0\0BIN\0", "its first .glb chunk is not JSON"),
        (b"glTF\x02\0\0\0\x0e\0\0\0\0\0", "chunk's header is cut off"),
    ] {
        let found = open(bytes).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    }
    let found = from_gltf(Path::new("/no/such/file.glb")).unwrap_err().to_string();
    assert!(found.starts_with("/no/such/file.glb: it cannot be read: "), "{found}");
    let found = from_gltf(&std::env::temp_dir()).unwrap_err().to_string();
    assert!(found.contains("not a regular file"), "{found}");
}

#[test]
fn buffers_that_lie_elsewhere() {
    let folder = Folder::new("elsewhere");
    let (file, primitives) = square();
    folder.write("secret.bin", &file.bin);
    let secret = folder.0.join("secret.bin").display().to_string();
    let sentence = |uri: &str| {
        let buffers = json!([{"byteLength": file.bin.len(), "uri": uri}]);
        let root = file.root(&primitives, json!({"buffers": buffers}));
        let path = folder.write("inner/scene.gltf", root.to_string().as_bytes());
        from_gltf(&path).unwrap_err().to_string()
    };
    let outside = "must be a relative path to a file in the scene's folder or below";
    for uri in [
        "../secret.bin",
        "%2e%2e/secret.bin",
        "..%2Fsecret.bin",
        "below/../../secret.bin",
        &secret,
        &secret.replacen('/', "%2F", 1),
        &format!("file://{secret}"),
        "http://example.org/a.bin",
        "c:a.bin",
        "",
    ] {
        assert!(sentence(uri).contains(outside), "{uri}: {}", sentence(uri));
    }
    assert!(sentence("%FF.bin").contains("is not UTF-8"));
    assert!(sentence("gone.bin").contains("its file \"gone.bin\" cannot be read"));
    assert!(sentence("a%00b.bin").contains("cannot be read"));
    assert!(sentence(".").contains("is not a regular file"));
    assert!(sentence("data:text/plain,abc").contains("its data URI must read"));
    assert!(sentence("data:;base64,a*b").contains("is not base64"));
    assert!(sentence("data:;base64,AAAA").contains("and holds 3"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../secret.bin", folder.0.join("inner/link.bin")).unwrap();
        assert!(sentence("link.bin").contains(outside), "a link out of the folder");
    }
    let found = file.scene(&primitives, json!({"buffers": [{"byteLength": 9, "uri": "/x"}]}));
    assert!(found.unwrap_err().starts_with("buffers[0]: its uri"));
    let text = file.root(&primitives, json!({})).to_string();
    assert!(
        open(text.as_bytes()).unwrap_err().contains("has no uri, and the file no binary chunk")
    );
    // Takes no room: what was never written to is a hole.
    let huge = std::fs::File::create(folder.0.join("inner/huge.bin")).unwrap();
    huge.set_len(5_000_000_000).unwrap();
    assert!(sentence("huge.bin").contains("hold more than 4 GiB together"));
}
