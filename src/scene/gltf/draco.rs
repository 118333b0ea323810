//! Meshes that were compressed by Draco (KHR_draco_mesh_compression): the accessors of a primitive have no bytes of their
//! own, and one buffer view holds them all.

use super::Problem;
use super::json::{Compressed, Root, in_a_line};
use super::room::Room;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, FaceIndex, Mesh, MeshDecoder};
use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;

/// What was decompressed of a file.
pub(super) struct Streams {
    /// The elements of accessors, by their place among those of the root.
    elements: Vec<OnceCell<Vec<u8>>>,
    /// The streams, by their buffer views.
    meshes: RefCell<BTreeMap<usize, Rc<Mesh>>>,
}

impl Streams {
    pub fn new(root: &Root) -> Self {
        let elements = root.compressed.iter().map(|_| OnceCell::new()).collect();
        Self { elements, meshes: RefCell::default() }
    }

    /// The elements in a part of a `stream`, of a file whose bytes and whose buffers' are so many.
    pub fn elements<'a>(
        &self,
        place: usize,
        of: &Compressed,
        (room, bytes): (&Room, u64),
        stream: impl FnOnce() -> Result<&'a [u8], Problem>,
    ) -> Result<&[u8], Problem> {
        let Some(cell) = self.elements.get(place) else { return Ok(&[]) };
        if let Some(known) = cell.get() {
            return Ok(known);
        }
        let known = self.meshes.borrow().get(&of.view).cloned();
        let mesh = match known {
            Some(mesh) => mesh,
            None => {
                let mesh = Rc::new(decoded(stream()?, room.left(bytes))?);
                room.take(whole(&mesh), bytes)?;
                self.meshes.borrow_mut().insert(of.view, Rc::clone(&mesh));
                mesh
            }
        };
        room.take(size(&mesh, of.part), bytes)?;
        let part = part(&mesh, of)?;
        Ok(cell.get_or_init(|| part))
    }
}

/// Tells the accessors of compressed primitives where their elements are. Those that have bytes of their own keep to these.
pub(super) fn mark(root: &mut Root) {
    let Root { meshes, accessors, compressed, .. } = root;
    let mut mark = |accessor: Option<usize>, view, part| {
        let of = accessor.and_then(|index| accessors.get_mut(index));
        if let Some(of) = of.filter(|of| of.buffer_view.is_none() && of.sparse.is_none()) {
            of.compressed.get_or_insert(compressed.len());
            compressed.push(Compressed { view, part, normalized: of.normalized });
        }
    };
    for primitive in meshes.iter().flat_map(|mesh| &mesh.primitives) {
        let Some(draco) = primitive.extensions.as_ref().and_then(|e| e.draco.as_ref()) else {
            continue;
        };
        mark(primitive.indices, draco.buffer_view, None);
        for (name, accessor) in primitive.attributes.all() {
            if let Some(id) = draco.attributes.get(&name) {
                mark(Some(accessor), draco.buffer_view, Some(*id));
            }
        }
    }
}

/// Decodes a Draco stream that may have no more than `room` bytes of attributes, and of triangles.
fn decoded(stream: &[u8], room: u64) -> Result<Mesh, Problem> {
    let limits = DecodeLimits::default()
        .with_max_decoded_bytes(room)
        .with_max_faces(room / 12)
        .with_max_points(room / 12);
    let mut mesh = Mesh::new();
    let mut buffer = DecoderBuffer::new(stream).with_limits(limits);
    MeshDecoder::new()
        .decode(&mut buffer, &mut mesh)
        .map_err(|e| format!("its Draco stream is wrong: {}", in_a_line(&e.to_string())))?;
    Ok(mesh)
}

/// The bytes of all of a mesh.
fn whole(mesh: &Mesh) -> u64 {
    let attributes = (0..mesh.num_attributes()).filter_map(|id| mesh.try_attribute(id).ok());
    let bytes: usize = attributes.map(|of| of.buffer().data().len()).sum();
    bytes as u64 + size(mesh, None)
}

/// The bytes that a part of a mesh will take.
fn size(mesh: &Mesh, part: Option<u32>) -> u64 {
    let elements = match part {
        None => 3 * mesh.num_faces(),
        Some(id) => {
            let of = mesh.attribute_by_unique_id(id);
            of.map_or(0, |of| mesh.num_points() * usize::from(of.num_components()))
        }
    };
    4 * elements as u64
}

/// A part of a mesh as packed elements: its triangles' corners as 32-bit integers, or an attribute as 32-bit floats.
fn part(mesh: &Mesh, of: &Compressed) -> Result<Vec<u8>, Problem> {
    let Some(id) = of.part else {
        let faces = (0..mesh.num_faces()).map(|face| mesh.face(FaceIndex(face as u32)));
        return Ok(faces.flatten().flat_map(|point| point.0.to_le_bytes()).collect());
    };
    let attribute = mesh
        .attribute_by_unique_id(id)
        .ok_or_else(|| format!("its Draco stream has no attribute {id}"))?;
    let most = if of.normalized { largest(attribute.data_type()) } else { 1.0 };
    let numbers = attribute.read_f32s(mesh.num_points(), usize::from(attribute.num_components()));
    Ok(numbers.into_iter().flat_map(|number| (number / most).to_le_bytes()).collect())
}

/// What stands for 1 where integers are normalized.
fn largest(kind: DataType) -> f32 {
    match kind {
        DataType::Int8 => f32::from(i8::MAX),
        DataType::Uint8 => f32::from(u8::MAX),
        DataType::Int16 => f32::from(i16::MAX),
        DataType::Uint16 => f32::from(u16::MAX),
        _ => 1.0,
    }
}
