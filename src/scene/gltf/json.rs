//! The parts of a glTF file's JSON that this reader has types of its own for: nodes, meshes, cameras, accessors and what
//! they lie in. The rest of the document is the `gltf` crate's ([`super::document`]).
//!
//! The crate cannot hold these to what is promised of any file. By version 1.4:
//!
//! | part | what is measured |
//! |---|---|
//! | nodes | their transforms are f32, in which a node 20,000.0001 m from the origin stands at 20,000 m; and a list of empty ones takes 263 bytes for each of the file's, of which there are 256 |
//! | cameras | f32, in which a `yfov` of 0.7 is 0.69999999; one without a `type` is refused |
//! | meshes, primitives | those without `primitives` or `attributes`, which draw nothing, refuse the whole file |
//! | scenes | one without nodes, or whose name is a number, refuses the file |
//! | accessors, views, buffers | lists `min` and `max` are kept as trees of values; how deep unknown extensions are is limited, since each is kept |
//!
//! Every index is as the file gives it: whoever follows one checks it (see [`at`]).

use super::Problem;
use super::attributes::Attributes;
#[cfg(feature = "draco")]
use super::extensions::PrimitiveExtensions;
#[cfg(feature = "meshopt")]
use super::extensions::ViewExtensions;
use super::extensions::{self, NodeExtensions};
use crate::error::quoted;
use serde::Deserialize;
use serde_json::Value;
use std::cell::Cell;

/// The members that decide whether the rest can be read: members of another version have other types.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Head {
    asset: Asset,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Root {
    pub scene: Option<usize>,
    #[serde(default)]
    pub extensions_used: Vec<String>,
    #[serde(default)]
    pub scenes: Vec<SceneRoots>,
    #[serde(default)]
    pub nodes: Vec<Node>,
    #[serde(default)]
    pub meshes: Vec<Mesh>,
    #[serde(default)]
    pub cameras: Vec<Camera>,
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(default)]
    pub buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub buffers: Vec<Buffer>,
    /// Where the elements of accessors are that have no bytes of their own.
    #[cfg(feature = "draco")]
    #[serde(skip)]
    pub compressed: Vec<Compressed>,
}

/// Where in compressed bytes an accessor's elements are.
#[cfg(feature = "draco")]
#[derive(Debug)]
pub(super) struct Compressed {
    /// The buffer view of the compressed bytes.
    pub view: usize,
    /// The attribute among those of a mesh, or its triangles' corners.
    pub part: Option<u32>,
    /// Whether the largest integer stands for 1.
    pub normalized: bool,
}

#[derive(Debug, Deserialize)]
pub(super) struct SceneRoots {
    /// A name, where it is one.
    #[serde(default)]
    pub name: Value,
    #[serde(default)]
    pub nodes: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Node {
    pub name: Option<String>,
    #[serde(default)]
    pub children: Vec<usize>,
    // Boxed, because three bytes of a file, `{},`, are a node.
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<Box<[f64; 3]>>,
    pub rotation: Option<Box<[f64; 4]>>,
    pub scale: Option<Box<[f64; 3]>>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    /// How far each morph target of its mesh goes, instead of what the mesh says.
    pub weights: Option<Box<[f64]>>,
    pub camera: Option<usize>,
    pub extensions: Option<Box<NodeExtensions>>,
    #[serde(default)]
    pub extras: Value,
}

#[derive(Debug, Deserialize)]
pub(super) struct Mesh {
    pub name: Option<String>,
    #[serde(default)]
    pub primitives: Vec<Primitive>,
    /// How far each morph target goes.
    #[serde(default)]
    pub weights: Vec<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    pub mode: Option<u64>,
    #[serde(default)]
    pub targets: Vec<Target>,
    #[cfg(feature = "draco")]
    pub extensions: Option<Box<PrimitiveExtensions>>,
}

/// What a morph target adds.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord)]
#[serde(rename_all = "UPPERCASE")]
pub(super) struct Target {
    pub position: Option<usize>,
    pub normal: Option<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Camera {
    pub perspective: Option<Perspective>,
    pub orthographic: Option<Orthographic>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Orthographic {
    pub xmag: f64,
    pub ymag: f64,
    pub znear: f64,
    pub zfar: f64,
}

#[derive(Debug, Deserialize)]
pub(super) struct Perspective {
    pub yfov: f64,
    pub znear: f64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
    #[serde(default)]
    pub normalized: bool,
    pub count: u64,
    #[serde(rename = "type")]
    pub kind: String,
    pub sparse: Option<Sparse>,
    /// The place among [`Root::compressed`] that says where its elements are.
    #[serde(skip)]
    pub compressed: Option<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub count: u64,
    pub indices: SparseIndices,
    pub values: SparseValues,
    /// Whether its indices were looked at, and rise.
    #[serde(skip)]
    pub in_order: Cell<bool>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<u64>,
    #[cfg(feature = "meshopt")]
    pub extensions: Option<Box<ViewExtensions>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    pub byte_length: u64,
}

impl Root {
    /// Whether positions and normals may be integers.
    pub fn is_quantized(&self) -> bool {
        self.extensions_used.iter().any(|name| name == extensions::QUANTIZATION)
    }
}

/// Reads the JSON and refuses files that need more than this loader knows.
pub(super) fn parse(text: &[u8]) -> Result<Root, Problem> {
    let head: Head = from_json(text)?;
    let version = &head.asset.version;
    if version != "2" && !version.starts_with("2.") {
        let version = quoted(version);
        return Err(format!("its asset.version is {version}; only glTF 2.0 is read"));
    }
    if let Some(refusal) = extensions::refusal(&head.extensions_required) {
        return Err(refusal);
    }
    let mut root: Root = from_json(text)?;
    // What is required is used, whether or not the file says so.
    root.extensions_used.extend(head.extensions_required);
    Ok(root)
}

pub(super) fn from_json<'a, T: Deserialize<'a>>(text: &'a [u8]) -> Result<T, Problem> {
    // A byte order mark is not allowed, and common enough that every reader ignores it.
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    serde_json::from_slice(text).map_err(|e| {
        format!("it is not the JSON of a glTF 2.0 file: {}", shortened(&e.to_string()))
    })
}

/// The numbers of characters that a sentence shows of the beginning and of the end of a JSON parser's error.
const SHOWN: [usize; 2] = [100, 60];

/// A parser's error without the middle of a long string that it quotes; the position in the file is at its end.
pub(super) fn shortened(message: &str) -> String {
    let length = message.chars().count();
    let [first, last] = SHOWN;
    if length <= first + last {
        return message.into();
    }
    let start: String = message.chars().take(first).collect();
    let end: String = message.chars().skip(length - last).collect();
    format!("{start}…{end}")
}

/// A decoder's message as a part of a sentence.
pub(super) fn in_a_line(message: &str) -> String {
    let words: Vec<&str> = message.split(|c: char| c.is_whitespace() || c.is_control()).collect();
    let words = words.into_iter().filter(|word| !word.is_empty());
    shortened(&words.collect::<Vec<_>>().join(" "))
}

/// The place of the item of a name, or of a number, among those that the file calls `what`.
pub(super) fn by_name<'a>(
    what: &str,
    names: impl ExactSizeIterator<Item = Option<&'a str>> + Clone,
    name: &str,
) -> Result<usize, Problem> {
    let named = names.clone().position(|of| of == Some(name));
    let number = name.parse().ok().filter(|number| *number < names.len());
    named.or(number).ok_or_else(|| {
        let count = names.len();
        let shown: Vec<_> = names.take(8).map(|of| quoted(of.unwrap_or_default())).collect();
        let list = if shown.is_empty() { String::new() } else { format!(": {}", shown.join(", ")) };
        format!("it has no {what} {}; it has {count}{list}", quoted(name))
    })
}

/// Follows an index: `owner` (node "lamp", say) refers to item `index` of the array called `what`.
pub(super) fn at<'a, T>(
    items: &'a [T],
    index: usize,
    what: &str,
    owner: impl FnOnce() -> String,
) -> Result<&'a T, Problem> {
    items.get(index).ok_or_else(|| {
        format!("{} refers to {what}[{index}], and the file has {}", owner(), items.len())
    })
}
