//! A glTF file of one triangle, put together from text so that its parts may be anything, and long.

use super::seed::container;

/// How long a long list is, about, in bytes: work that grew as its square would not end.
pub const LONG: usize = 1 << 20;

/// The accessor of the triangle's three positions.
pub const POSITIONS: usize = 0;
/// The accessor of its three indices, a byte each.
pub const INDICES: usize = 1;

pub struct Parts {
    pub nodes: String,
    pub meshes: String,
    /// Members of the root beside the usual ones, each with a comma before it.
    pub other: String,
    /// Buffers behind the first one.
    pub buffers: String,
    /// Where the bytes are, if not in the .glb's chunk.
    pub uri: Option<String>,
    pub accessors: Vec<String>,
    pub views: Vec<String>,
    pub bin: Vec<u8>,
}

impl Default for Parts {
    fn default() -> Self {
        let mut parts = Self {
            nodes: r#"{"mesh":0}"#.into(),
            meshes: mesh(&primitive(POSITIONS, INDICES)),
            other: String::new(),
            buffers: String::new(),
            uri: None,
            accessors: Vec::new(),
            views: Vec::new(),
            bin: Vec::new(),
        };
        assert_eq!(parts.positions(3), POSITIONS);
        assert_eq!(parts.indices(3), INDICES);
        parts
    }
}

impl Parts {
    /// Adds bytes; answers with their bufferView.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        let (offset, length) = (self.bin.len(), bytes.len());
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length}}}"#));
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    /// Adds an accessor; answers with its index.
    pub fn accessor(&mut self, members: &str) -> usize {
        self.accessors.push(format!("{{{members}}}"));
        self.accessors.len() - 1
    }

    /// Adds points, of which no three in a row are in line.
    pub fn positions(&mut self, count: usize) -> usize {
        let point = |i: usize| [i as f32, (i * i % 7) as f32, 1.0].map(f32::to_le_bytes).concat();
        let view = self.view(&(0..count).flat_map(point).collect::<Vec<_>>());
        self.accessor(&vectors(view, count))
    }

    /// Adds indices of the first three vertices, a byte each.
    pub fn indices(&mut self, count: usize) -> usize {
        let view = self.view(&(0..count).map(|i| (i % 3) as u8).collect::<Vec<_>>());
        self.accessor(&format!(
            r#""bufferView":{view},"componentType":5121,"type":"SCALAR","count":{count}"#
        ))
    }

    /// The whole file.
    pub fn file(&self) -> Vec<u8> {
        let Self { nodes, meshes, other, .. } = self;
        let buffers = if self.buffers.is_empty() { "" } else { &format!(",{}", self.buffers) };
        let (accessors, views) = (self.accessors.join(","), self.views.join(","));
        let length = self.bin.len();
        let uri = self.uri.as_ref().map_or(String::new(), |uri| format!(r#","uri":"{uri}""#));
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],"meshes":[{meshes}],
            "accessors":[{accessors}],"bufferViews":[{views}],
            "buffers":[{{"byteLength":{length}{uri}}}{buffers}]{other}}}"#
        );
        match self.uri {
            Some(_) => text.into_bytes(),
            None => container(text.as_bytes(), &self.bin),
        }
    }
}

/// An accessor's members: positions or normals.
pub fn vectors(view: usize, count: usize) -> String {
    format!(r#""bufferView":{view},"componentType":5126,"type":"VEC3","count":{count}"#)
}

/// The part of an accessor's members that replaces elements.
pub fn sparse(count: usize, indices: usize, component: u32, values: usize) -> String {
    format!(
        r#""sparse":{{"count":{count},"indices":{{"bufferView":{indices},"componentType":{component}}},
           "values":{{"bufferView":{values}}}}}"#
    )
}

pub fn mesh(primitives: &str) -> String {
    format!(r#"{{"primitives":[{primitives}]}}"#)
}

pub fn primitive(positions: usize, indices: usize) -> String {
    format!(r#"{{"attributes":{{"POSITION":{positions}}},"indices":{indices}}}"#)
}

/// As many of these as make a long list, separated by commas: one more than a power of two, which what
/// doubles as it grows has most room to spare for.
pub fn list(item: &str) -> String {
    let most = LONG / (item.len() + 1);
    listed((most / 2).next_power_of_two() + 1, |_| item.into())
}

/// So many items, separated by commas.
pub fn listed(count: usize, item: impl Fn(usize) -> String) -> String {
    (0..count).map(item).collect::<Vec<_>>().join(",")
}
