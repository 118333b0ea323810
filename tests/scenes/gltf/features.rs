//! Features that the loader must read.

use super::*;
use antumbra::scene::{Lens, Role};
use std::f64::consts::FRAC_1_SQRT_2;

#[test]
fn an_indexed_square_gets_flat_normals() {
    let (file, primitives) = square();
    let scene = file.scene(&primitives, json!({})).unwrap();
    assert_eq!(corners(&scene), square_corners());
    // Flat normals belong to triangles: each has three vertices of its own.
    assert_eq!(scene.meshes[0].positions.len(), 6);
    assert!(scene.meshes[0].normals.iter().all(|n| *n == [0.0, 0.0, 1.0]));
    assert!(!scene.meshes[0].double_sided);
    assert_eq!((scene.instances[0].name.as_str(), scene.instances[0].role), ("thing", Role::Both));
}

#[test]
fn given_normals_are_normalized_and_their_vertices_shared() {
    let mut file = File::default();
    // The third is no direction, the fourth no number: both become their triangle's.
    let normals = [[0.0, 0.0, 2.0], [3.0, 0.0, 4.0], [0.0, 0.0, 0.0], [f32::NAN, 0.0, 1.0]];
    let primitives = json!([{
        "attributes": {"POSITION": file.vectors(&SQUARE), "NORMAL": file.vectors(&normals)},
        "indices": file.indices(&TWO_TRIANGLES)
    }]);
    let scene = file.scene(&primitives, json!({})).unwrap();
    let up = [0.0, 0.0, 1.0];
    assert_eq!(scene.meshes[0].normals, [up, [0.6, 0.0, 0.8], up, up]);
    assert_eq!(scene.meshes[0].indices, TWO_TRIANGLES);
}

#[test]
fn vertices_that_no_triangle_uses_are_left_out() {
    let mut file = File::default();
    let mut positions = vec![[f32::NAN; 3]; 100];
    positions[40..44].copy_from_slice(&SQUARE);
    let normals = vec![[0.0, 0.0, 1.0]; 100];
    let primitives = json!([{
        "attributes": {"POSITION": file.vectors(&positions), "NORMAL": file.vectors(&normals)},
        "indices": file.indices(&TWO_TRIANGLES.map(|i| i + 40))
    }]);
    let scene = file.scene(&primitives, json!({})).unwrap();
    assert_eq!(corners(&scene), square_corners());
    assert_eq!(scene.meshes[0].positions.len(), 4);
}

#[test]
fn indices_of_every_width_and_none() {
    for (component, width) in [(5121, 1), (5123, 2), (5125, 4)] {
        let mut file = File::default();
        let position = file.vectors(&SQUARE);
        let bytes: Vec<u8> =
            TWO_TRIANGLES.iter().flat_map(|i| i.to_le_bytes()[..width].to_vec()).collect();
        let view = file.view(&bytes);
        let indices = file.accessor(
            json!({"bufferView": view, "componentType": component, "type": "SCALAR", "count": 6}),
        );
        let primitives = json!([{"attributes": {"POSITION": position}, "indices": indices}]);
        let scene = file.scene(&primitives, json!({})).unwrap();
        assert_eq!(corners(&scene), square_corners(), "componentType {component}");
    }
    let mut file = File::default();
    let unrolled = TWO_TRIANGLES.map(|i| SQUARE[i as usize]);
    let primitives = json!([{"attributes": {"POSITION": file.vectors(&unrolled)}}]);
    assert_eq!(corners(&file.scene(&primitives, json!({})).unwrap()), square_corners());
}

#[test]
fn strips_and_fans_keep_the_winding() {
    let strip = [SQUARE[0], SQUARE[1], SQUARE[3], SQUARE[2]];
    for (mode, order) in [(5, strip), (6, SQUARE)] {
        let mut file = File::default();
        let position = file.vectors(&order);
        let primitives = json!([{"attributes": {"POSITION": position}, "mode": mode}]);
        let scene = file.scene(&primitives, json!({})).unwrap();
        let triangles = corners(&scene);
        assert_eq!(triangles.len(), 2, "mode {mode}");
        let area: f64 = triangles.iter().map(|[a, b, c]| (b - a).cross(c - a).z / 2.0).sum();
        assert!((area - 1.0).abs() < 1e-12, "mode {mode} covers {area}, all of it facing +z");
    }
}

#[test]
fn points_and_lines_are_passed_over() {
    let mut file = File::default();
    let position = file.vectors(&SQUARE);
    let attributes = json!({"POSITION": position});
    let primitives = json!([
        {"attributes": attributes, "mode": 0},
        {"attributes": attributes, "mode": 6},
        {"attributes": attributes, "mode": 3},
        {"attributes": {}, "mode": 4},
    ]);
    assert_eq!(file.scene(&primitives, json!({})).unwrap().triangles(), 2);
}

#[test]
fn interleaved_accessors_are_read_with_their_stride() {
    let mut file = File::default();
    // Position, a number between, normal: 28 bytes a vertex, the last one cut off after its normal.
    let mut bytes = Vec::new();
    for p in SQUARE {
        bytes.extend(floats(&[p]));
        bytes.extend([0xAB; 4]);
        bytes.extend(floats(&[[1.0, 0.0, 0.0]]));
    }
    let view = file.view(&bytes);
    file.views[view]["byteStride"] = json!(28);
    let part = |offset: u32| {
        json!({"bufferView": view, "byteOffset": offset, "componentType": 5126, "type": "VEC3",
               "count": 4})
    };
    let (position, normal) = (file.accessor(part(0)), file.accessor(part(16)));
    let indices = file.indices(&TWO_TRIANGLES);
    let primitives = json!([
        {"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices}
    ]);
    let scene = file.scene(&primitives, json!({})).unwrap();
    assert_eq!(corners(&scene), square_corners());
    assert!(scene.meshes[0].normals.iter().all(|n| *n == [1.0, 0.0, 0.0]));
}

/// `accessor` with elements 1 and 3 replaced by the square's.
fn sparse(file: &mut File, mut accessor: Value) -> usize {
    let indices = file.view(&[1, 3]);
    let values = file.view(&floats(&[SQUARE[1], SQUARE[3]]));
    accessor["sparse"] = json!({
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values}
    });
    file.accessor(accessor)
}

#[test]
fn sparse_accessors_replace_elements_of_a_view_or_of_zeros() {
    for over_zeros in [false, true] {
        let mut file = File::default();
        let mut accessor = json!({"componentType": 5126, "type": "VEC3", "count": 4});
        if !over_zeros {
            let nine = [9.0; 3];
            let view = file.view(&floats(&[SQUARE[0], nine, SQUARE[2], nine]));
            accessor["bufferView"] = json!(view);
        }
        let position = sparse(&mut file, accessor);
        let indices = file.indices(&TWO_TRIANGLES);
        let primitives = json!([{"attributes": {"POSITION": position}, "indices": indices}]);
        let mut expected = square_corners();
        if over_zeros {
            for corner in expected.as_flattened_mut().iter_mut().filter(|c| c.x == c.y) {
                *corner = DVec3::ZERO;
            }
        }
        assert_eq!(corners(&file.scene(&primitives, json!({})).unwrap()), expected);
    }
}

#[test]
fn buffers_come_from_data_uris_padded_or_not() {
    let (file, primitives) = square();
    let uri = data_uri(&file.bin);
    for uri in [uri.clone(), uri.trim_end_matches('=').into(), uri.replace('=', "%3D")] {
        let root = file
            .root(&primitives, json!({"buffers": [{"byteLength": file.bin.len(), "uri": uri}]}));
        assert_eq!(corners(&open(root.to_string().as_bytes()).unwrap()), square_corners());
        let marked = format!("\u{feff}{root}");
        assert_eq!(open(marked.as_bytes()).unwrap().triangles(), 2, "a byte order mark is ignored");
    }
}

#[test]
fn buffers_come_from_files_beside_the_scene() {
    let folder = Folder::new("external");
    let (file, primitives) = square();
    for (name, uri) in [
        ("plain.bin", "plain.bin"),
        ("with space é.bin", "with%20space%20%C3%A9.bin"),
        ("with space é.bin", "with space é.bin"),
        ("below/it:s.bin", "./below/it:s.bin"),
    ] {
        // Longer than stated: what follows is padding.
        folder.write(name, &[file.bin.as_slice(), &[1, 2, 3]].concat());
        let buffers = json!([{"byteLength": file.bin.len(), "uri": uri}]);
        let root = file.root(&primitives, json!({"buffers": buffers}));
        let path = folder.write("scene.gltf", root.to_string().as_bytes());
        assert_eq!(corners(&from_gltf(&path).unwrap()), square_corners(), "{uri}");
    }
}

#[test]
fn a_buffer_that_no_triangle_needs_is_not_opened() {
    let (file, primitives) = square();
    let buffers = json!([
        {"byteLength": file.bin.len(), "uri": data_uri(&file.bin)},
        {"byteLength": 9, "uri": "animation.bin"}
    ]);
    let root = file.root(&primitives, json!({"buffers": buffers}));
    assert_eq!(open(root.to_string().as_bytes()).unwrap().triangles(), 2);
}

#[test]
fn transforms_multiply_down_the_hierarchy_in_f64() {
    let turn = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
    let (file, primitives) = square();
    let nodes = json!([
        {"name": "leaf", "mesh": 0, "translation": [0.0, 0.25, 0.0]},
        {"name": "top", "children": [2], "translation": [20000.0001, 0.0, 0.0]},
        {"name": "mid", "children": [0], "rotation": turn, "scale": [2, 4, 8]},
    ]);
    let scene =
        file.scene(&primitives, json!({"nodes": nodes, "scenes": [{"nodes": [1]}]})).unwrap();
    // (x, y) ↦ 2x, 4(y + ¼), turned by 90°, moved; f32 would round 20000.0001 to 20000.
    let expected = DMat4::from_cols_array(&[
        0.0, 2.0, 0.0, 0.0, -4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0, 0.0, 19999.0001, 0.0, 0.0, 1.0,
    ]);
    let found = scene.instances[0].world_from_mesh;
    assert!(found.abs_diff_eq(expected, 1e-11), "{found}");

    let scene = with_nodes(&json!([{"mesh": 0, "rotation": [0, 0, 0, 3]}])).unwrap();
    assert_eq!(scene.instances[0].world_from_mesh, DMat4::IDENTITY, "a rotation never scales");

    let mut matrix = expected.to_cols_array();
    matrix[3] = 1e-8; // An exporter's rounding error.
    let scene = with_nodes(&json!([{"mesh": 0, "matrix": matrix}])).unwrap();
    assert_eq!(scene.instances[0].world_from_mesh, expected);
    assert_eq!(scene.instances[0].name, "node 0", "a node without a name is called by its number");
}

#[test]
fn mirrored_nodes_stay_mirrored() {
    let scene = with_nodes(&json!([{"mesh": 0, "scale": [-1, 1, 1]}, {"mesh": 0}])).unwrap();
    assert!(scene.instances[0].mirrored() && !scene.instances[1].mirrored());
    assert_eq!(scene.meshes.len(), 1, "two nodes share one mesh");
    assert_eq!(scene.triangles(), 4);
}

#[test]
fn double_sided_materials_part_a_mesh_in_two() {
    let mut file = File::default();
    let attributes = json!({"POSITION": file.vectors(&SQUARE)});
    let primitives = json!([
        {"attributes": attributes, "mode": 6, "material": 0},
        {"attributes": attributes, "mode": 6, "material": 1},
        {"attributes": attributes, "mode": 6, "material": 0},
    ]);
    let faded = json!({"baseColorFactor": [1, 1, 1, 0.5]});
    let materials =
        json!([{"doubleSided": true}, {"alphaMode": "BLEND", "pbrMetallicRoughness": faded}]);
    let scene = file.scene(&primitives, json!({"materials": materials})).unwrap();
    let found: Vec<_> =
        scene.meshes.iter().map(|m| (m.double_sided, m.indices.len() / 3)).collect();
    assert_eq!(found, [(false, 2), (true, 4)]);
    let cut: Vec<_> = scene.meshes.iter().map(|m| m.cut_out).collect();
    assert_eq!(cut, [true, false], "of these one is not opaque");
    let mut scene = scene;
    scene.set_role("thing", Role::Receiver).unwrap();
    assert!(scene.instances.iter().all(|i| i.role == Role::Receiver), "both are the node's");
}

#[test]
fn the_default_scene_the_first_or_every_root() {
    let (file, primitives) = square();
    let nodes =
        json!([{"name": "a", "mesh": 0}, {"name": "b", "children": [2]}, {"name": "c", "mesh": 0}]);
    let scenes = json!([{"nodes": [0]}, {"nodes": [1]}, {}]);
    let names = |members: Value| -> Vec<String> {
        let scene = file.scene(&primitives, members).unwrap();
        scene.instances.iter().map(|i| i.name.clone()).collect()
    };
    assert_eq!(names(json!({"nodes": nodes, "scenes": scenes, "scene": 1})), ["c"]);
    let mut root = file.root(&primitives, json!({"nodes": nodes, "scenes": scenes}));
    root.as_object_mut().unwrap().remove("scene");
    assert_eq!(open(&glb(&root, &file.bin)).unwrap().instances[0].name, "a");
    root.as_object_mut().unwrap().remove("scenes");
    assert_eq!(open(&glb(&root, &file.bin)).unwrap().instances.len(), 2);
}

#[test]
fn roles_come_from_extras_of_any_kind() {
    let scene = with_nodes(&json!([
        {"mesh": 0, "extras": {"shadow_role": "occluder"}},
        {"mesh": 0, "extras": {"shadow_role": "receiver", "more": [1]}},
        {"mesh": 0, "extras": {"shadow_role": "both"}},
        {"mesh": 0, "extras": [1, 2]},
        {"mesh": 0, "extras": null},
        {"extras": {"shadow_role": 7}},
    ]))
    .unwrap();
    let roles: Vec<_> = scene.instances.iter().map(|i| i.role).collect();
    assert_eq!(roles, [Role::Occluder, Role::Receiver, Role::Both, Role::Both, Role::Both]);
}

#[test]
fn the_camera_is_the_first_perspective_one_without_its_scale() {
    let (file, primitives) = square();
    let nodes = json!([
        {"mesh": 0},
        {"camera": 0, "name": "plan"},
        {"camera": 2, "scale": [3, -3, 2], "translation": [1, 2, 3]},
        {"camera": 1},
    ]);
    let cameras = json!([
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": -1, "znear": 0, "zfar": 9}},
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.2}},
        {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}},
    ]);
    let scenes = json!([{"nodes": [3, 2, 1, 0]}]);
    let members = json!({"nodes": nodes, "cameras": cameras, "scenes": scenes});
    let mut scene = file.scene(&primitives, members).unwrap();
    let plan = Lens::Orthographic { half: [3.0, 1.0], far: 9.0 };
    let names: Vec<&str> = scene.cameras.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["plan", "node 2", "node 3"]);
    assert_eq!((scene.camera.unwrap().lens, scene.camera.unwrap().near), (plan, 0.0));
    // The far plane has depth 0, the near one 1, and the image holds what is 3 m aside and 1 m above.
    for (aspect, corner) in [(3.0, [1.0, 1.0]), (2.0, [1.0, 2.0 / 3.0]), (6.0, [0.5, 1.0])] {
        let clip_from_view = scene.camera.unwrap().clip_from_view(aspect);
        let seen = |x, y, z| clip_from_view.transform_point3(DVec3::new(x, y, z));
        assert!(
            (seen(3.0, -1.0, -9.0) - DVec3::new(corner[0], corner[1], 0.0)).length() < 1e-12,
            "{aspect}"
        );
        assert!((seen(0.0, 0.0, 0.0) - DVec3::Z).length() < 1e-12);
    }
    let missing = scene.set_camera("nobody").unwrap_err().to_string();
    assert!(missing.contains("no camera is named \"nobody\"; the cameras are"), "{missing}");
    scene.set_camera("node 2").unwrap();
    let camera = scene.camera.unwrap();
    assert_eq!((camera.lens, camera.near), (Lens::Perspective { yfov: 0.7 }, 0.1));
    // Looking along −z from (1, 2, 3), upside down, and rigid.
    let expected = DMat4::from_cols_array(&[
        -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 2.0, 3.0, 1.0,
    ]);
    assert!(close(camera.world_from_view, expected), "{}", camera.world_from_view);
    let mut none = with_nodes(&json!([{"mesh": 0}])).unwrap();
    assert!(none.camera.is_none() && none.cameras.is_empty());
    let missing = none.set_camera("eye").unwrap_err().to_string();
    assert!(missing.contains("no camera is named \"eye\"; the scene has none"), "{missing}");
}

#[test]
fn required_extensions_that_change_no_triangle_are_fine() {
    let (file, primitives) = square();
    let names = ["KHR_lights_punctual", "KHR_materials_unlit", "KHR_texture_transform"];
    assert!(file.scene(&primitives, json!({"extensionsRequired": names})).is_ok());
}

/// A deep hierarchy is walked, not recursed into.
#[test]
fn ten_thousand_nodes_deep() {
    let (file, primitives) = square();
    let depth = 10_000;
    let mut nodes: Vec<Value> =
        (1..depth).map(|i| json!({"children": [i], "translation": [0, 0.5, 0]})).collect();
    nodes.push(json!({"mesh": 0}));
    let scene = file.scene(&primitives, json!({"nodes": nodes})).unwrap();
    assert_eq!(scene.instances[0].world_from_mesh.w_axis.y, 0.5 * f64::from(depth - 1));
}
