//! The scene's triangles in vertex and index buffers.

use crate::Outcome;
use crate::device::Gpu;
use antumbra::scene::{Instance, Mesh, Scene};
use ash::vk::BufferUsageFlags as Usage;
use std::sync::Arc;
use vk_graph::driver::buffer::Buffer;

/// One vertex: what the G-buffer's pipeline reads. The node reads the positions alone, by stride.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
}

/// Bytes from one vertex to the next.
pub const STRIDE: u32 = size_of::<Vertex>() as u32;

/// One object of the scene: its mesh in buffers, and where it stands.
pub struct Model {
    pub vertices: Arc<Buffer>,
    pub indices: Arc<Buffer>,
    pub count: u32,
    /// Least and largest corner of the mesh.
    pub bounds: [[f32; 3]; 2],
    pub double_sided: bool,
    pub instance: Instance,
}

/// Uploads the scene. A mesh that stands in several places has its buffers once.
pub fn upload(gpu: &Gpu, scene: &Scene) -> Outcome<Vec<Model>> {
    let meshes = scene.meshes.iter().map(|mesh| Uploaded::new(gpu, mesh));
    let meshes = meshes.collect::<Outcome<Vec<_>>>()?;
    let model = |instance: &Instance| {
        let mesh = meshes[instance.mesh].as_ref()?;
        Some(Model {
            vertices: mesh.vertices.clone(),
            indices: mesh.indices.clone(),
            count: mesh.count,
            bounds: mesh.bounds,
            double_sided: scene.meshes[instance.mesh].double_sided,
            instance: instance.clone(),
        })
    };
    Ok(scene.instances.iter().filter_map(model).collect())
}

struct Uploaded {
    vertices: Arc<Buffer>,
    indices: Arc<Buffer>,
    count: u32,
    bounds: [[f32; 3]; 2],
}

impl Uploaded {
    /// Uploads a mesh; `None` for one without triangles. (An engine would stage its geometry into device memory;
    /// the node does not mind either way.)
    fn new(gpu: &Gpu, mesh: &Mesh) -> Outcome<Option<Self>> {
        if mesh.indices.len() < 3 {
            return Ok(None);
        }
        let vertices: Vec<Vertex> = mesh
            .positions
            .iter()
            .zip(&mesh.normals)
            .map(|(&position, &normal)| Vertex { position, normal })
            .collect();
        let buffer = |usage, bytes: &[u8]| -> Outcome<Arc<Buffer>> {
            let made = Buffer::create_from_slice(&gpu.device, usage, bytes)
                .map_err(|e| format!("making a buffer of {} bytes: {e}", bytes.len()))?;
            Ok(Arc::new(made))
        };
        Ok(Some(Self {
            vertices: buffer(
                Usage::VERTEX_BUFFER | Usage::STORAGE_BUFFER,
                bytemuck::cast_slice(&vertices),
            )?,
            indices: buffer(
                Usage::INDEX_BUFFER | Usage::STORAGE_BUFFER,
                bytemuck::cast_slice(&mesh.indices),
            )?,
            count: mesh.indices.len() as u32,
            bounds: mesh.bounds(),
        }))
    }
}
