//! The world's triangles in vertex and index buffers.

use crate::Outcome;
use crate::device::Gpu;
use crate::resources::Buffer;
use crate::world::Object;
use antumbra::MeshInstance;
use ash::vk;
use glam::DMat4;

/// One vertex: what the G-buffer's pipeline reads. The node reads the positions alone, by stride.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
}

/// Bytes from one vertex to the next.
pub const STRIDE: u32 = size_of::<Vertex>() as u32;

/// One object in buffers.
pub struct Model {
    pub vertices: Buffer,
    pub indices: Buffer,
    pub count: u32,
    /// Red, green, blue and the role, as the mask stores it.
    pub albedo_role: [u8; 4],
    /// Least and largest corner of the mesh.
    bounds: [[f32; 3]; 2],
    double_sided: bool,
    object: Object,
}

impl Model {
    /// Uploads an object.
    pub fn new(gpu: &mut Gpu, object: Object) -> Outcome<Self> {
        let mesh = &object.mesh;
        let vertices: Vec<Vertex> = mesh
            .positions
            .iter()
            .zip(&mesh.normals)
            .map(|(&position, &normal)| Vertex { position, normal })
            .collect();
        let extreme = |pick: fn(f32, f32) -> f32, start: f32| {
            mesh.positions.iter().fold([start; 3], |m, p| [0, 1, 2].map(|i| pick(m[i], p[i])))
        };
        let role = object.role.mask();
        let [r, g, b] = object.albedo;
        use vk::BufferUsageFlags as Usage;
        Ok(Self {
            vertices: Buffer::with(gpu, "vertices", &vertices, Usage::VERTEX_BUFFER)?,
            indices: Buffer::with(gpu, "indices", &mesh.indices, Usage::INDEX_BUFFER)?,
            count: mesh.indices.len() as u32,
            albedo_role: [r, g, b, role],
            bounds: [extreme(f32::min, f32::INFINITY), extreme(f32::max, f32::NEG_INFINITY)],
            double_sided: mesh.double_sided,
            object,
        })
    }

    /// Where it stands at a time.
    pub fn world_from_mesh(&self, seconds: f64) -> DMat4 {
        self.object.world_from_mesh(seconds)
    }

    /// The same buffers as the node takes them.
    pub fn for_node(&self, seconds: f64) -> MeshInstance {
        MeshInstance {
            positions: self.vertices.raw,
            positions_offset: 0,
            positions_stride: STRIDE,
            indices: Some((self.indices.raw, 0, vk::IndexType::UINT32)),
            count: self.count,
            world_from_mesh: self.world_from_mesh(seconds),
            bounds: self.bounds,
            role: self.object.role,
            double_sided: self.double_sided,
        }
    }

    /// Destroys the buffers; no frame may use them any more.
    pub fn destroy(self, gpu: &mut Gpu) {
        self.vertices.destroy(gpu);
        self.indices.destroy(gpu);
    }
}
