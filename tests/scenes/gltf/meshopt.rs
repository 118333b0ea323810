//! Buffer views that meshoptimizer compressed.

use super::draco::grid;
use super::posed::{assert_close_by, points};
use super::textures::{alphas, base};
use super::*;
use ::meshopt::encoding::{
    EncodeExpMode, encode_filter_exp, encode_filter_oct, encode_filter_quat,
};
use ::meshopt::{encode_index_buffer, encode_index_sequence, encode_vertex_buffer};

const EXTENSIONS: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Adds a view of a stream whose elements are in a buffer that the file does not have.
fn view(
    file: &mut File,
    stream: &[u8],
    mode: &str,
    [count, stride]: [usize; 2],
    extension: &str,
) -> usize {
    let view = file.view(stream);
    let compressed = &mut file.views[view];
    let (offset, length) = (compressed["byteOffset"].clone(), stream.len());
    *compressed = json!({
        "buffer": 1, "byteLength": count * stride,
        "extensions": {extension: {
            "buffer": 0, "byteOffset": offset, "byteLength": length,
            "byteStride": stride, "count": count, "mode": mode,
        }},
    });
    view
}

fn accessor(file: &mut File, view: usize, [kind, component]: [Value; 2], count: usize) -> usize {
    file.accessor(
        json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
    )
}

fn members(file: &File, extensions: &[&str]) -> Value {
    // The second buffer stands for what is not in the file.
    json!({
        "extensionsRequired": extensions,
        "buffers": [
            {"byteLength": file.bin.len()},
            {"byteLength": 1_000_000, "extensions": {"EXT_meshopt_compression": {"fallback": true}}},
        ],
    })
}

/// A file of a mesh whose positions and corners are compressed, the latter as a mode says.
fn file_of(
    points: &[[f32; 3]],
    triangles: &[[u32; 3]],
    mode: &str,
    short: bool,
    extension: &str,
) -> (File, Value) {
    let mut file = File::default();
    let indices = triangles.as_flattened();
    let (count, corners) = (points.len(), indices.len());
    let stream = encode_vertex_buffer(points).unwrap();
    let positions = view(&mut file, &stream, "ATTRIBUTES", [count, 12], extension);
    let stream = match mode {
        "TRIANGLES" => encode_index_buffer(indices, count).unwrap(),
        _ => encode_index_sequence(indices, count).unwrap(),
    };
    let stride = if short { 2 } else { 4 };
    let of = view(&mut file, &stream, mode, [corners, stride], extension);
    let primitives = json!([{
        "attributes": {"POSITION": accessor(&mut file, positions, [json!("VEC3"), json!(5126)], count)},
        "indices": accessor(&mut file, of, [json!("SCALAR"), json!(if short { 5123 } else { 5125 })], corners),
    }]);
    (file, primitives)
}

/// Corners of each triangle from its least on: a stream may turn them.
fn turned(triangles: impl Iterator<Item = [DVec3; 3]>) -> Vec<DVec3> {
    let turn = |mut t: [DVec3; 3]| {
        let least = (0..3).min_by(|&a, &b| t[a].to_array().partial_cmp(&t[b].to_array()).unwrap());
        t.rotate_left(least.unwrap());
        t
    };
    triangles.flat_map(turn).collect()
}

#[test]
fn every_mode_is_what_it_was_made_of() {
    let (grid_points, triangles) = grid(40);
    let wide = |i: u32| DVec3::from_array(grid_points[i as usize].map(f64::from));
    let expected = turned(triangles.iter().map(|t| t.map(wide)));
    for extension in EXTENSIONS {
        for mode in ["TRIANGLES", "INDICES"] {
            for short in [true, false] {
                let (file, primitives) = file_of(&grid_points, &triangles, mode, short, extension);
                let uncompressed = 12 * grid_points.len() + 12 * triangles.len();
                assert!(
                    file.bin.len() < uncompressed * 2 / 3,
                    "{mode}: {} of {uncompressed}",
                    file.bin.len()
                );
                let scene = file.scene(&primitives, members(&file, &[extension])).unwrap();
                assert_eq!(
                    turned(corners(&scene).into_iter()),
                    expected,
                    "{extension}, {mode}, {short}"
                );
            }
        }
    }
}

#[test]
fn filters_come_back_as_what_was_filtered() {
    let (grid_points, triangles) = grid(12);
    let count = grid_points.len();
    let mut file = File::default();
    let [ext, khr] = EXTENSIONS;
    // Positions by exponents, normals in the octahedron by bytes and by words.
    let positions = encode_filter_exp(&grid_points, 20, EncodeExpMode::Separate);
    let positions =
        view(&mut file, &encode_vertex_buffer(&positions).unwrap(), "ATTRIBUTES", [count, 12], ext);
    file.views[positions]["extensions"][ext]["filter"] = json!("EXPONENTIAL");
    let normal = |p: &[f32; 3]| {
        let n = DVec3::new(f64::from(p[0]) - 0.5, f64::from(p[1]) - 0.5, 0.7).normalize();
        n.as_vec3().extend(0.0).to_array()
    };
    let normals: Vec<[f32; 4]> = grid_points.iter().map(normal).collect();
    let bytes = encode_vertex_buffer(&encode_filter_oct::<i8>(&normals, 8)).unwrap();
    let words = encode_vertex_buffer(&encode_filter_oct::<i16>(&normals, 14)).unwrap();
    let of: Vec<usize> = triangles.as_flattened().iter().map(|i| *i as usize).collect();
    for (stream, stride, component, within) in [(bytes, 4, 5120, 0.02), (words, 8, 5122, 3e-4)] {
        let mut file =
            File { bin: file.bin.clone(), views: file.views.clone(), accessors: Vec::new() };
        let view = view(&mut file, &stream, "ATTRIBUTES", [count, stride], khr);
        file.views[view]["extensions"][khr]["filter"] = json!("OCTAHEDRAL");
        file.views[view]["byteStride"] = json!(stride);
        let position = accessor(&mut file, positions, [json!("VEC3"), json!(5126)], count);
        let normal = accessor(&mut file, view, [json!("VEC3"), json!(component)], count);
        file.accessors[normal]["normalized"] = json!(true);
        let indices = file.indices(triangles.as_flattened());
        let primitives =
            json!([{"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices}]);
        let scene =
            file.scene(&primitives, members(&file, &["KHR_mesh_quantization", ext, khr])).unwrap();
        let found = points(&scene);
        let expected: Vec<DVec3> =
            of.iter().map(|i| DVec3::from_array(grid_points[*i].map(f64::from))).collect();
        assert_close_by(&found, &expected, 2e-6);
        let mesh = &scene.meshes[0];
        for (corner, i) in mesh.indices.iter().zip(&of) {
            let n = DVec3::from_array(mesh.normals[*corner as usize].map(f64::from));
            let [x, y, z, _] = normals[*i].map(f64::from);
            assert!((n - DVec3::new(x, y, z)).length() < within, "{n} at {i}");
        }
    }
}

/// Instances turn by quaternions of 16 bits.
#[test]
fn a_filtered_rotation_is_as_it_was() {
    let (mut file, primitives) = square();
    let [x, y, z, w] = [0.5f32, -0.1, 0.3, 0.806_225_8];
    let turns = [[x, y, z, w], [-w, z, -y, x]];
    let stream = encode_vertex_buffer(&encode_filter_quat(&turns, 16)).unwrap();
    let ext = EXTENSIONS[0];
    let of = view(&mut file, &stream, "ATTRIBUTES", [2, 8], ext);
    file.views[of]["extensions"][ext]["filter"] = json!("QUATERNION");
    let rotation = accessor(&mut file, of, [json!("VEC4"), json!(5122)], 2);
    file.accessors[rotation]["normalized"] = json!(true);
    let mut members = members(&file, &[ext, "EXT_mesh_gpu_instancing"]);
    let instancing = json!({"EXT_mesh_gpu_instancing": {"attributes": {"ROTATION": rotation}}});
    members["nodes"] = json!([{"mesh": 0, "extensions": instancing}]);
    let scene = file.scene(&primitives, members).unwrap();
    let expected = turns.iter().flat_map(|q| {
        let q = glam::DQuat::from_array(q.map(f64::from)).normalize();
        TWO_TRIANGLES.map(|i| q * DVec3::from_array(SQUARE[i as usize].map(f64::from)))
    });
    assert_close_by(&points(&scene), &expected.collect::<Vec<_>>(), 1e-3);
}

#[test]
fn what_is_wrong_with_a_view_is_a_sentence() {
    let (grid_points, triangles) = grid(6);
    let ext = EXTENSIONS[0];
    let refused = |view: usize, member: &str, value: Value, sentence: &str| {
        let (mut file, primitives) = file_of(&grid_points, &triangles, "TRIANGLES", false, ext);
        file.views[view]["extensions"][ext][member] = value;
        let found = file.scene(&primitives, members(&file, &[ext])).unwrap_err();
        assert!(found.contains(sentence), "{member}: {found}");
    };
    refused(0, "mode", json!("VERTICES"), "36 elements of 12 bytes cannot be \"VERTICES\"");
    refused(0, "count", json!(35), "it decodes to 420 bytes, and the view has 432");
    refused(0, "byteStride", json!(u64::MAX), "and the view has 432");
    refused(0, "byteLength", json!(20), "its 20 bytes are no stream of 36 elements of 12 bytes");
    refused(
        0,
        "byteLength",
        json!(1u64 << 40),
        "the compression of bufferViews[0] spans 1099511627776 bytes",
    );
    refused(0, "buffer", json!(7), "refers to buffers[7]");
    refused(0, "filter", json!("OCTAHEDRAL"), "OCTAHEDRAL is not for elements of 12 bytes");
    refused(0, "filter", json!("SINUSOIDAL"), "\"SINUSOIDAL\" is not known");
    refused(1, "filter", json!("EXPONENTIAL"), "which is for attributes");
    // Every shape that the decoder would assert: all of the view's bytes, otherwise divided.
    let all = 4 * 3 * triangles.len();
    for (mode, stride) in
        [("TRIANGLES", 1), ("TRIANGLES", 8), ("INDICES", 3), ("ATTRIBUTES", 2), ("ATTRIBUTES", 300)]
    {
        let (mut file, primitives) = file_of(&grid_points, &triangles, "TRIANGLES", false, ext);
        let of = &mut file.views[1]["extensions"][ext];
        (of["mode"], of["byteStride"], of["count"]) =
            (json!(mode), json!(stride), json!(all / stride));
        let found = file.scene(&primitives, members(&file, &[ext])).unwrap_err();
        assert!(found.contains(&format!("cannot be \"{mode}\"")), "{found}");
    }
}

/// Places in a texture, and the texture's own bytes, which nobody compresses so, may be in such views.
#[test]
fn texture_coordinates_and_images_may_be_compressed() {
    let mut file = File::default();
    let places = [[0u16, 0], [65_535, 0], [65_535, 65_535], [0, 65_535]];
    let stream = encode_vertex_buffer(&SQUARE).unwrap();
    let positions = view(&mut file, &stream, "ATTRIBUTES", [4, 12], EXTENSIONS[0]);
    let stream = encode_vertex_buffer(&places).unwrap();
    let coordinates = view(&mut file, &stream, "ATTRIBUTES", [4, 4], EXTENSIONS[1]);
    let coordinates = file.accessor(json!({
        "bufferView": coordinates, "componentType": 5123, "normalized": true, "type": "VEC2", "count": 4
    }));
    let mut image = alphas(&[0, 255]);
    image.resize(image.len().next_multiple_of(4), 0);
    let words: Vec<[u8; 4]> = image.chunks(4).map(|word| word.try_into().unwrap()).collect();
    let stream = encode_vertex_buffer(&words).unwrap();
    let image = view(&mut file, &stream, "ATTRIBUTES", [words.len(), 4], EXTENSIONS[0]);
    let positions = accessor(&mut file, positions, [json!("VEC3"), json!(5126)], 4);
    let primitives = json!([{
        "attributes": {"POSITION": positions, "TEXCOORD_0": coordinates},
        "indices": file.indices(&TWO_TRIANGLES), "material": 0,
    }]);
    let mut members = members(&file, &EXTENSIONS);
    members["images"] = json!([{"bufferView": image}]);
    members["textures"] = json!([{"source": 0}]);
    members["materials"] = json!([base("MASK", json!({}))]);
    let scene = file.scene(&primitives, members).unwrap();
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    assert_eq!(scene.opacity_maps[0].texels, [0, 255]);
    let expected = TWO_TRIANGLES.map(|i| places[i as usize].map(|c| f32::from(c / 65_535)));
    assert_eq!(scene.meshes[0].texture_coordinates, expected);
}

/// The file that `tests/files/untrusted` and the fuzzer break; `ANTUMBRA_WRITE_SEED=1` writes it anew.
#[test]
fn the_fuzzers_seed_loads() {
    let path = antumbra_tests::example::root().join("fuzz/seeds/meshopt.glb");
    if std::env::var("ANTUMBRA_WRITE_SEED").is_ok() {
        let [ext, khr] = EXTENSIONS;
        let (grid_points, triangles) = grid(4);
        let (mut file, first) = file_of(&grid_points, &triangles, "TRIANGLES", true, ext);
        let (count, corners) = (grid_points.len(), 3 * triangles.len());
        let stream = encode_index_sequence(triangles.as_flattened(), count).unwrap();
        let of = view(&mut file, &stream, "INDICES", [corners, 4], khr);
        let indices = accessor(&mut file, of, [json!("SCALAR"), json!(5125)], corners);
        let positions = encode_filter_exp(&grid_points, 12, EncodeExpMode::Separate);
        let stream = encode_vertex_buffer(&positions).unwrap();
        let of = view(&mut file, &stream, "ATTRIBUTES", [count, 12], khr);
        file.views[of]["extensions"][khr]["filter"] = json!("EXPONENTIAL");
        let position = accessor(&mut file, of, [json!("VEC3"), json!(5126)], count);
        let normals = encode_filter_oct::<i8>(&vec![[0.0, 0.6, 0.8, 0.0]; count], 8);
        let stream = encode_vertex_buffer(&normals).unwrap();
        let of = view(&mut file, &stream, "ATTRIBUTES", [count, 4], ext);
        file.views[of]["extensions"][ext]["filter"] = json!("OCTAHEDRAL");
        file.views[of]["byteStride"] = json!(4);
        let normal = accessor(&mut file, of, [json!("VEC3"), json!(5120)], count);
        file.accessors[normal]["normalized"] = json!(true);
        let primitives = json!([
            first[0],
            {"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices},
        ]);
        let members = members(&file, &["KHR_mesh_quantization", ext, khr]);
        std::fs::write(&path, glb(&file.root(&primitives, members), &file.bin)).unwrap();
    }
    let scene = from_gltf(&path).unwrap();
    assert_eq!(points(&scene).len(), 2 * 54);
}
