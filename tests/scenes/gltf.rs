//! glTF files built in code, one for each thing the loader must read or refuse.

mod animated;
mod draco;
mod far;
mod features;
mod lights;
mod meshopt;
mod models;
mod posed;
mod punctual;
mod refusals;
mod round_lights;
mod shining;
mod sizes;
mod texture_parts;
mod textures;

use antumbra::Error;
use antumbra::scene::{Scene, from_gltf, from_gltf_bytes};
use base64::Engine as _;
use glam::{DMat4, DVec3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A square in the plane z = 0, facing +z.
const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
const TWO_TRIANGLES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// Collects accessors and their bytes; the JSON around them is each test's own.
#[derive(Default)]
struct File {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Adds bytes as a bufferView, at an offset that is not aligned.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.push(0xEE);
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}));
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let view = self.view(&floats(vectors));
        self.accessor(json!(
            {"bufferView": view, "componentType": 5126, "type": "VEC3", "count": vectors.len()}
        ))
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessor(json!(
            {"bufferView": view, "componentType": 5125, "type": "SCALAR", "count": indices.len()}
        ))
    }

    /// The whole JSON: `members` over a scene of one node `thing` with the mesh `shape`.
    fn root(&self, primitives: &Value, members: Value) -> Value {
        let mut root = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "thing", "mesh": 0}],
            "meshes": [{"name": "shape", "primitives": primitives}],
            "bufferViews": self.views,
            "accessors": self.accessors,
            "buffers": [{"byteLength": self.bin.len()}],
        });
        let Value::Object(members) = members else { panic!("members are an object") };
        for (key, value) in members {
            root[key] = value;
        }
        root
    }

    fn scene(&self, primitives: &Value, members: Value) -> Result<Scene, String> {
        open(&glb(&self.root(primitives, members), &self.bin))
    }
}

/// The square as an indexed mesh without normals: the file and its primitives.
fn square() -> (File, Value) {
    let mut file = File::default();
    let primitives = json!([{
        "attributes": {"POSITION": file.vectors(&SQUARE)},
        "indices": file.indices(&TWO_TRIANGLES)
    }]);
    (file, primitives)
}

/// A scene of the square under these nodes, all of them roots.
fn with_nodes(nodes: &Value) -> Result<Scene, String> {
    let (file, primitives) = square();
    let roots: Vec<usize> = (0..nodes.as_array().unwrap().len()).collect();
    file.scene(&primitives, json!({"nodes": nodes, "scenes": [{"nodes": roots}]}))
}

fn floats(vectors: &[[f32; 3]]) -> Vec<u8> {
    vectors.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect()
}

fn glb(root: &Value, bin: &[u8]) -> Vec<u8> {
    container(root.to_string().as_bytes(), bin)
}

fn container(text: &[u8], bin: &[u8]) -> Vec<u8> {
    let mut text = text.to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((12 + 8 + text.len() + 8 + bin.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", text.as_slice()), (b"BIN\0", bin)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

fn data_uri(bytes: &[u8]) -> String {
    let text = base64::engine::general_purpose::STANDARD.encode(bytes);
    format!("data:application/octet-stream;base64,{text}")
}

/// Reads bytes whose buffers are all inside; an error is the problem without the file's name.
fn open(bytes: &[u8]) -> Result<Scene, String> {
    from_gltf_bytes(bytes, Path::new("/no/such/folder/file.gltf")).map_err(|error| match error {
        Error::File { problem, .. } => problem,
        other => panic!("{other}"),
    })
}

/// The corners of all triangles in the world, in order, whatever vertices they share.
fn corners(scene: &Scene) -> Vec<[DVec3; 3]> {
    let mut all = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        for t in mesh.indices.chunks_exact(3) {
            all.push([t[0], t[1], t[2]].map(|i| {
                let p = DVec3::from_array(mesh.positions[i as usize].map(f64::from));
                instance.world_from_mesh.transform_point3(p)
            }));
        }
    }
    all
}

/// The corners of the square's two triangles.
fn square_corners() -> Vec<[DVec3; 3]> {
    let corner = |i: usize| DVec3::from_array(SQUARE[i].map(f64::from));
    vec![[0, 1, 2].map(corner), [0, 2, 3].map(corner)]
}

/// A folder for one test's files, removed when the test is done with it.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("antumbra {test} {}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What is left in a temporary folder harms nobody.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Half of f32's last place at about 1: the precision required of transforms that a file wrote in f32.
fn close(a: DMat4, b: DMat4) -> bool {
    a.abs_diff_eq(b, 1e-7)
}
