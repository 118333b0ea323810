//! Meshes that were compressed by Draco.

use super::posed::{assert_close_by, points};
use super::textures::{alphas, base};
use super::*;
use antumbra_tests::draco::{Attribute, BITS, compressed};
use draco_core::{DataType, GeometryAttributeType};

/// A grid of so many points a side over the square, with bumps.
pub fn grid(side: usize) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let at = |i: usize| (i % side, i / side);
    let step = 1.0 / (side - 1) as f32;
    let point = |(x, y): (usize, usize)| {
        let [x, y] = [x, y].map(|i| i as f32 * step);
        [x, y, 0.2 * (6.0 * x).sin() * (5.0 * y).cos()]
    };
    let squares = (0..side * side).map(at).filter(|(x, y)| x + 1 < side && y + 1 < side);
    let triangles = squares.flat_map(|(x, y)| {
        let i = (y * side + x) as u32;
        let s = side as u32;
        [[i, i + 1, i + s], [i + 1, i + s + 1, i + s]]
    });
    ((0..side * side).map(at).map(point).collect(), triangles.collect())
}

/// A file of one compressed primitive with accessors of so many points and corners, which have no bytes.
fn file_of(
    stream: &[u8],
    attributes: &[(&str, &str, u32)],
    [points, corners]: [usize; 2],
) -> (File, Value) {
    let mut file = File::default();
    let view = file.view(stream);
    let mut accessors = json!({});
    let mut ids = json!({});
    for (nth, (name, kind, component)) in attributes.iter().enumerate() {
        accessors[*name] = json!(
            file.accessor(json!({"componentType": component, "type": kind, "count": points}))
        );
        ids[*name] = json!(nth);
    }
    let indices = file.accessor(json!({"componentType": 5123, "type": "SCALAR", "count": corners}));
    let primitives = json!([{
        "attributes": accessors,
        "indices": indices,
        "extensions": {"KHR_draco_mesh_compression": {"bufferView": view, "attributes": ids}},
    }]);
    (file, primitives)
}

fn required() -> Value {
    json!({"extensionsRequired": ["KHR_draco_mesh_compression"]})
}

const POSITION: (&str, &str, u32) = ("POSITION", "VEC3", 5126);
const NORMAL: (&str, &str, u32) = ("NORMAL", "VEC3", 5126);

fn of_floats(kind: GeometryAttributeType, bytes: &[u8]) -> Attribute<'_> {
    (kind, DataType::Float32, 3, bytes)
}

/// The order of triangles and of their corners is the encoder's own: triangles are compared from their least corner on, in
/// the order of their middles.
fn in_order(mut triangles: Vec<[DVec3; 3]>) -> Vec<DVec3> {
    let key = |p: &DVec3| [p.x, p.y, p.z].map(|c| (c * 1000.0).round() as i64);
    for t in &mut triangles {
        let least = (0..3).min_by_key(|&i| key(&t[i])).unwrap();
        t.rotate_left(least);
    }
    triangles.sort_by_key(|t| key(&((t[0] + t[1] + t[2]) / 3.0)));
    triangles.concat()
}

#[test]
fn every_kind_of_stream_is_the_mesh_that_it_was_made_of() {
    let (grid_points, triangles) = grid(12);
    let wide = |p: &[f32; 3]| DVec3::from_array(p.map(f64::from));
    let expected = triangles.iter().map(|t| t.map(|i| wide(&grid_points[i as usize]))).collect();
    let bytes = floats(&grid_points);
    let up = floats(&vec![[0.0, 0.6, 0.8]; grid_points.len()]);
    // A step of a coordinate, of a mesh that is 1 m wide.
    let within = 2.0 / f64::from(1 << BITS);
    let mut lengths = Vec::new();
    for speed in [0, 5, 10] {
        let stream = compressed(
            &[
                of_floats(GeometryAttributeType::Position, &bytes),
                of_floats(GeometryAttributeType::Normal, &up),
            ],
            &triangles,
            speed,
        );
        lengths.push(stream.len());
        let counts = [grid_points.len(), 3 * triangles.len()];
        let (file, primitives) = file_of(&stream, &[POSITION, NORMAL], counts);
        let scene = file.scene(&primitives, required()).unwrap();
        let found = corners(&scene);
        assert_close_by(&in_order(found), &in_order(Clone::clone(&expected)), within);
        let normals = &scene.meshes[0].normals;
        assert!(normals.iter().all(|n| (wide(n) - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-3));
        // A file may use the extension without requiring it.
        assert_eq!(points(&file.scene(&primitives, json!({})).unwrap()).len(), counts[1]);
    }
    // The kinds are kinds.
    assert!(lengths[0] != lengths[1] && lengths[1] < lengths[2], "{lengths:?}");
}

/// Where a texture lies is in the stream too.
#[test]
fn a_compressed_texture_coordinate_is_as_it_was() {
    let (points, triangles) = grid(6);
    let bytes = floats(&points);
    let places: Vec<u8> =
        points.iter().flat_map(|p| [p[0], 1.0 - p[1]]).flat_map(f32::to_le_bytes).collect();
    for speed in [0, 10] {
        let stream = compressed(
            &[
                of_floats(GeometryAttributeType::Position, &bytes),
                (GeometryAttributeType::TexCoord, DataType::Float32, 2, places.as_slice()),
            ],
            &triangles,
            speed,
        );
        let counts = [points.len(), 3 * triangles.len()];
        let (mut file, mut primitives) =
            file_of(&stream, &[POSITION, ("TEXCOORD_0", "VEC2", 5126)], counts);
        primitives[0]["material"] = json!(0);
        let mut members = required();
        members["images"] = json!([{"bufferView": file.view(&alphas(&[0, 255]))}]);
        members["textures"] = json!([{"source": 0}]);
        members["materials"] = json!([base("MASK", json!({}))]);
        let scene = file.scene(&primitives, members).unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!((mesh.opacity_map, mesh.texture_coordinates.len()), (Some(0), counts[1]));
        for (place, point) in mesh.texture_coordinates.iter().zip(&mesh.positions) {
            let off = [place[0] - point[0], 1.0 - place[1] - point[1]];
            assert!(off.iter().all(|off| off.abs() < 1e-3), "{place:?} at {point:?}");
        }
    }
}

/// Joints and weights are integers in the stream; the largest stands for 1 where the accessor is normalized.
#[test]
fn a_compressed_skin_is_as_it_was() {
    let bytes = floats(&SQUARE);
    let joints: Vec<u8> = SQUARE.iter().flat_map(|_| [0u8, 1, 0, 0]).collect();
    // The corners at y = 1 follow the second joint.
    let weights: Vec<u8> = SQUARE
        .iter()
        .flat_map(|p| if p[1] > 0.5 { [0u8, 255, 0, 0] } else { [255, 0, 0, 0] })
        .collect();
    let generic = GeometryAttributeType::Generic;
    let stream = compressed(
        &[
            of_floats(GeometryAttributeType::Position, &bytes),
            (generic, DataType::Uint8, 4, &joints),
            (generic, DataType::Uint8, 4, &weights),
        ],
        &[[0, 1, 2], [0, 2, 3]],
        10,
    );
    let of = [POSITION, ("JOINTS_0", "VEC4", 5121), ("WEIGHTS_0", "VEC4", 5121)];
    let (mut file, primitives) = file_of(&stream, &of, [4, 6]);
    file.accessors[2]["normalized"] = json!(true);
    let members = json!({
        "extensionsRequired": ["KHR_draco_mesh_compression"],
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [
            {"mesh": 0, "skin": 0},
            {"name": "still"},
            {"name": "lifted", "translation": [0, 0, 2]},
        ],
        "skins": [{"joints": [1, 2]}],
    });
    let scene = file.scene(&primitives, members).unwrap();
    let lifted =
        |p: [f32; 3]| DVec3::new(p[0].into(), p[1].into(), if p[1] > 0.5 { 2.0 } else { 0.0 });
    let expected = [[0, 1, 2], [0, 2, 3]].map(|t: [usize; 3]| t.map(|i| lifted(SQUARE[i])));
    assert_close_by(&in_order(corners(&scene)), &in_order(expected.to_vec()), 1e-3);
}

#[test]
fn what_is_wrong_with_a_stream_is_a_sentence() {
    let (grid_points, triangles) = grid(4);
    let bytes = floats(&grid_points);
    let position = of_floats(GeometryAttributeType::Position, &bytes);
    let stream = compressed(&[position], &triangles, 5);
    let counts = [grid_points.len(), 3 * triangles.len()];
    let refused = |stream: &[u8], attributes: &[_], counts, sentence: &str| {
        let (file, primitives) = file_of(stream, attributes, counts);
        let found = file.scene(&primitives, required()).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    };
    let cut = &stream[..stream.len() / 2];
    refused(cut, &[POSITION], counts, "its Draco stream is wrong");
    refused(b"DRACO", &[POSITION], counts, "its Draco stream is wrong");
    refused(&stream, &[POSITION, NORMAL], counts, "its Draco stream has no attribute 1");
    let more = [counts[0], counts[1] + 3];
    refused(&stream, &[POSITION], more, "needs 57 elements of 4 bytes");
    let more = [counts[0] + 1, counts[1]];
    refused(&stream, &[POSITION], more, "needs 17 elements of 12 bytes");
    // As a vector of another length.
    refused(&stream, &[("POSITION", "VEC4", 5126)], counts, "it must hold VEC3");
}

/// A flat grid takes next to nothing for each of its points: it is refused before it takes the memory.
#[test]
fn a_stream_that_unfolds_to_more_than_it_may_is_refused() {
    let (mut grid_points, triangles) = grid(1200);
    grid_points.iter_mut().for_each(|p| *p = [0.0; 3]);
    let bytes = floats(&grid_points);
    let position = of_floats(GeometryAttributeType::Position, &bytes);
    let stream = compressed(&[position], &triangles, 5);
    let counts = [grid_points.len(), 3 * triangles.len()];
    let (file, primitives) = file_of(&stream, &[POSITION], counts);
    let found = file.scene(&primitives, required()).unwrap_err();
    println!("{} bytes: {found}", stream.len());
    assert!(
        found.contains("over the caller's ceiling") || found.contains("hold more than"),
        "{found}"
    );
}

/// The file that `tests/files/untrusted.rs` and the fuzzer break; `ANTUMBRA_WRITE_SEED=1` writes it anew.
#[test]
fn the_fuzzers_seed_loads() {
    let path = antumbra_tests::example::root().join("fuzz/seeds/draco.glb");
    if std::env::var("ANTUMBRA_WRITE_SEED").is_ok() {
        let mut file = File::default();
        let mut primitives = Vec::new();
        // Each kind of stream: each has its own bytes, accessors and triangles.
        for speed in [0, 5, 10] {
            let (points, triangles) = grid(4);
            let (points, up) = (floats(&points), floats(&vec![[0.0, 0.6, 0.8]; points.len()]));
            let attributes = [
                of_floats(GeometryAttributeType::Position, &points),
                of_floats(GeometryAttributeType::Normal, &up),
            ];
            let stream = compressed(&attributes, &triangles, speed);
            let (one, made) = file_of(&stream, &[POSITION, NORMAL], [16, 54]);
            let view = file.view(&stream);
            let accessors = file.accessors.len();
            file.accessors.extend(one.accessors);
            let mut primitive = made[0].clone();
            primitive["indices"] = json!(accessors + 2);
            primitive["attributes"] = json!({"POSITION": accessors, "NORMAL": accessors + 1});
            primitive["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = json!(view);
            primitives.push(primitive);
        }
        let root = file.root(&Value::Array(primitives), required());
        std::fs::write(&path, glb(&root, &file.bin)).unwrap();
    }
    let scene = from_gltf(&path).unwrap();
    assert_eq!(points(&scene).len(), 3 * 54);
}

/// A model that the official encoder made: as many triangles as its accessors say, in the boxes that they say.
#[test]
fn a_model_of_the_official_encoder_is_whole() {
    let path = Path::new("/usr/share/assimp/models/glTF2/draco/2CylinderEngine.gltf");
    let Ok(text) = std::fs::read_to_string(path) else {
        return antumbra_tests::skip("it needs the model of Debian's package assimp-testmodels");
    };
    let root: Value = serde_json::from_str(&text).unwrap();
    let scene = from_gltf(path).unwrap();
    let primitives: Vec<&Value> = root["meshes"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|mesh| mesh["primitives"].as_array().unwrap())
        .collect();
    let accessor = |of: &Value| &root["accessors"][of.as_u64().unwrap() as usize];
    let triangles: u64 =
        primitives.iter().map(|p| accessor(&p["indices"])["count"].as_u64().unwrap() / 3).sum();
    let found: usize = scene.meshes.iter().map(|mesh| mesh.indices.len() / 3).sum();
    assert!(triangles > 10_000);
    // Equal shapes are read once.
    assert!(found as u64 <= triangles && found as u64 > triangles / 2, "{found} of {triangles}");
    // Each mesh of the scene has the size of the box around the primitives of one of the file's.
    let size = |min: &[f64; 3], max: &[f64; 3]| DVec3::from_array(*max) - DVec3::from_array(*min);
    let boxes = root["meshes"].as_array().unwrap().iter().map(|mesh| {
        let of = |member: &str, better: fn(f64, f64) -> f64, none: f64| {
            let all = mesh["primitives"].as_array().unwrap().iter();
            let all = all.map(|p| &accessor(&p["attributes"]["POSITION"])[member]);
            all.fold([none; 3], |best, of| {
                let of: [f64; 3] = serde_json::from_value(of.clone()).unwrap();
                [0, 1, 2].map(|i| better(best[i], of[i]))
            })
        };
        size(&of("min", f64::min, f64::INFINITY), &of("max", f64::max, f64::NEG_INFINITY))
    });
    let boxes: Vec<DVec3> = boxes.collect();
    for mesh in &scene.meshes {
        let [min, max] = mesh.bounds().map(|c| c.map(f64::from));
        let of = size(&min, &max);
        let nearest = boxes.iter().map(|b| (*b - of).length()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 2e-3 * of.length(), "{of} is the size of no primitive, {nearest} away");
    }
    println!("{found} triangles of {} meshes", scene.meshes.len());
}
