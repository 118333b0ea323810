//! A .glb file of meshes with opacity maps, each map a PNG in it.

use antumbra::scene::{Mesh, OpacityMap, Wrap};
use image::ExtendedColorType::La8;
use image::ImageEncoder;
use image::codecs::png::PngEncoder;
use serde_json::{Value, json};

/// A file under construction: its bytes, and the views and accessors into them.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// The view of some bytes, by its index.
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (at, length) = (self.bytes.len(), bytes.len());
        self.views.push(json!({"buffer": 0, "byteOffset": at, "byteLength": length}));
        self.bytes.extend(bytes);
        self.views.len() - 1
    }

    /// The accessor of elements of four-byte components, by its index.
    fn accessor<T: bytemuck::NoUninit>(&mut self, kind: &str, component: u32, of: &[T]) -> usize {
        let view = self.view(bytemuck::cast_slice(of));
        self.accessors.push(json!({
            "bufferView": view, "componentType": component, "type": kind, "count": of.len(),
        }));
        self.accessors.len() - 1
    }

    fn primitive(&mut self, mesh: &Mesh, material: usize) -> Value {
        const FLOAT: u32 = 5126;
        const UNSIGNED_INT: u32 = 5125;
        json!({
            "attributes": {
                "POSITION": self.accessor("VEC3", FLOAT, &mesh.positions),
                "NORMAL": self.accessor("VEC3", FLOAT, &mesh.normals),
                "TEXCOORD_0": self.accessor("VEC2", FLOAT, &mesh.texture_coordinates),
            },
            "indices": self.accessor("SCALAR", UNSIGNED_INT, &mesh.indices),
            "material": material,
        })
    }
}

fn sampler(map: &OpacityMap) -> Value {
    let wrap = map.wrap.map(|wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    });
    json!({"wrapS": wrap[0], "wrapT": wrap[1], "magFilter": if map.linear { 9729 } else { 9728 }})
}

/// The file of a mesh with its opacity map as the alpha of a gray PNG.
///
/// # Panics
/// If the map is no image.
pub fn glb(mesh: &Mesh, map: &OpacityMap) -> Vec<u8> {
    let mut file = File::default();
    let primitive = file.primitive(mesh, 0);
    let pixels: Vec<u8> = map.texels.iter().flat_map(|alpha| [200, *alpha]).collect();
    let mut png = Vec::new();
    let [width, height] = map.size;
    PngEncoder::new(&mut png).write_image(&pixels, width, height, La8).unwrap();
    let image = file.view(&png);
    let mut material = json!({
        "doubleSided": mesh.double_sided,
        "alphaMode": "BLEND",
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
    });
    if let Some(cutoff) = map.cutoff {
        (material["alphaMode"], material["alphaCutoff"]) = (json!("MASK"), json!(cutoff));
    }
    let File { bytes, views, accessors } = file;
    let text = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": bytes.len()}],
        "bufferViews": views,
        "accessors": accessors,
        "images": [{"bufferView": image, "mimeType": "image/png"}],
        "samplers": [sampler(map)],
        "textures": [{"source": 0, "sampler": 0}],
        "materials": [material],
        "meshes": [{"primitives": [primitive]}],
        "nodes": [{"name": "cut out", "mesh": 0}],
        "scenes": [{"nodes": [0]}],
    });
    let mut text = text.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = bytes;
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let mut all = b"glTF".to_vec();
    let length = |bytes: usize| (bytes as u32).to_le_bytes();
    all.extend(2u32.to_le_bytes());
    all.extend(length(12 + 8 + text.len() + 8 + bytes.len()));
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bytes)] {
        all.extend(length(chunk.len()));
        all.extend(kind);
        all.extend(chunk);
    }
    all
}
