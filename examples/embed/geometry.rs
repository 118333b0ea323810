//! The world's triangles in vertex and index buffers.

use crate::Outcome;
use crate::device::Gpu;
use crate::gbuffer::Push;
use crate::posing::{PosingPass, Skinned};
use crate::resources::Buffer;
use crate::world::Object;
use antumbra::lent::MeshBounds;
use ash::vk;
use glam::{DMat3, DMat4};
use gpu_allocator::MemoryLocation;

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
    pub double_sided: bool,
    /// Least and largest corner of the mesh: the jelly's swing included, or around this frame's pose.
    pub bounds: MeshBounds,
    /// What writes the vertices each frame; `None` where they stay.
    pub skinned: Option<Skinned>,
    pub object: Object,
}

impl Model {
    /// Uploads an object.
    pub fn new(gpu: &mut Gpu, posing: &PosingPass, mut object: Object) -> Outcome<Self> {
        let mesh = &object.mesh;
        let vertices: Vec<Vertex> = mesh
            .positions
            .iter()
            .zip(&mesh.normals)
            .map(|(&position, &normal)| Vertex { position, normal })
            .collect();
        let swell = object.jelly.unwrap_or(0.0);
        let [least, largest] = mesh.bounds();
        let role = object.role.mask();
        let [r, g, b] = object.albedo;
        use vk::BufferUsageFlags as Usage;
        let drawn = Usage::VERTEX_BUFFER | Usage::STORAGE_BUFFER;
        let (vertices, skinned) = match object.skin.take() {
            None => (Buffer::with(gpu, "vertices", &vertices, drawn)?, None),
            Some(skin) => {
                let bytes = size_of_val(vertices.as_slice()) as u64;
                let usage = drawn | Usage::TRANSFER_SRC;
                let posed = Buffer::new(gpu, "posed", bytes, usage, MemoryLocation::GpuOnly)?;
                let rest: &[[f32; 6]] = bytemuck::cast_slice(&vertices);
                let skinned = Skinned::new(gpu, posing, (skin, rest), &posed)?;
                (posed, Some(skinned))
            }
        };
        let mesh = &object.mesh;
        Ok(Self {
            vertices,
            skinned,
            indices: Buffer::with(
                gpu,
                "indices",
                &mesh.indices,
                Usage::INDEX_BUFFER | Usage::STORAGE_BUFFER,
            )?,
            count: mesh.indices.len() as u32,
            albedo_role: [r, g, b, role],
            bounds: [least.map(|x| x - swell), largest.map(|x| x + swell)],
            double_sided: mesh.double_sided,
            object,
        })
    }

    /// Poses the model for the frame of a slot at a time, where it has joints; the slot's last frame must be done.
    pub fn pose(&mut self, slot: usize, seconds: f64) -> Outcome<()> {
        let Some(skinned) = &mut self.skinned else { return Ok(()) };
        if let Some(bounds) = skinned.pose(slot, seconds)? {
            self.bounds = bounds;
        }
        Ok(())
    }

    /// The model's transform at a time.
    pub fn world_from_mesh(&self, seconds: f64) -> DMat4 {
        self.object.world_from_mesh(seconds)
    }

    /// The model's push constants, without the camera's matrix.
    pub fn push(&self, seconds: f64) -> Push {
        let normals = DMat3::from_mat4(self.world_from_mesh(seconds)).inverse().transpose();
        let columns = [normals.x_axis, normals.y_axis, normals.z_axis];
        Push {
            clip_from_mesh: [0.0; 16],
            world_from_normal: columns.map(|c| c.as_vec3().extend(0.0).to_array()),
            albedo_role: self.albedo_role,
            swell: self.object.jelly.unwrap_or(0.0),
            phase: (seconds * 8.0) as f32,
            unused: 0.0,
        }
    }

    /// Destroys the buffers; no frame may use them any more.
    pub fn destroy(self, gpu: &mut Gpu) {
        self.vertices.destroy(gpu);
        self.indices.destroy(gpu);
        if let Some(skinned) = self.skinned {
            skinned.destroy(gpu);
        }
    }
}
