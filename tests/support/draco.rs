//! Meshes compressed by Draco, as glTF files have them.

use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder,
    PointAttribute, PointIndex,
};

/// Bits of a coordinate: positions come back to within a 16,384th of the mesh's size.
pub const BITS: i32 = 14;

/// An attribute of points: what it is, its type, its numbers a point and their bytes.
pub type Attribute<'a> = (GeometryAttributeType, DataType, usize, &'a [u8]);

/// The stream of a mesh; its attributes have the numbers 0, 1, … in it. With speed 10 triangles are in sequence, with 5 and
/// 0 by either kind of Edgebreaker.
///
/// # Panics
/// If the encoder fails.
pub fn compressed(attributes: &[Attribute], triangles: &[[u32; 3]], speed: i32) -> Vec<u8> {
    let mut mesh = Mesh::new();
    let mut options = EncoderOptions::new();
    options.set_global_int("encoding_speed", speed);
    options.set_global_int("decoding_speed", speed);
    for (nth, &(kind, number, components, bytes)) in attributes.iter().enumerate() {
        let width = number.byte_length() * components;
        let mut attribute = PointAttribute::new();
        attribute.init(kind, components as u8, number, false, bytes.len() / width);
        attribute.buffer_mut().write(0, bytes);
        mesh.add_attribute(attribute);
        options.set_attribute_int(nth as i32, "quantization_bits", BITS);
    }
    mesh.set_num_faces(triangles.len());
    for (nth, corners) in triangles.iter().enumerate() {
        mesh.set_face(FaceIndex(nth as u32), corners.map(PointIndex));
    }
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut buffer = EncoderBuffer::new();
    encoder.encode(&options, &mut buffer).unwrap();
    buffer.data().to_vec()
}
