//! The scene's triangles in vertex and index buffers, and the uniforms of each object.

use crate::device::Gpu;
use antumbra::Role;
use antumbra::scene::{self, Scene};
use glam::{DMat4, DVec3};
use std::marker::PhantomData;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// One vertex: what the pipelines read. The node reads the positions alone, by stride.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
}

/// Bytes from one vertex to the next.
pub const STRIDE: u32 = size_of::<Vertex>() as u32;

/// Position and normal as vertex attributes.
const ATTRIBUTES: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];

/// The layout of the first `attributes` attributes of a vertex.
pub fn vertex_layout(attributes: usize) -> wgpu::VertexBufferLayout<'static> {
    wgpu::VertexBufferLayout {
        array_stride: u64::from(STRIDE),
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &ATTRIBUTES[..attributes],
    }
}

/// One object of the scene.
pub struct Object {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    /// The number of indices.
    pub count: u32,
    /// Least and largest corner of the mesh.
    pub bounds: [[f32; 3]; 2],
    pub double_sided: bool,
    pub role: Role,
    pub world_from_mesh: DMat4,
    /// Turns normals to the world's; their lengths change.
    pub world_from_normal: [[f32; 4]; 3],
}

impl Object {
    /// Uploads a scene. Objects that share a mesh share its buffers.
    pub fn all(gpu: &Gpu, scene: &Scene) -> Vec<Self> {
        let buffers: Vec<_> = scene.meshes.iter().map(|mesh| upload(gpu, mesh)).collect();
        scene
            .instances
            .iter()
            .filter(|instance| !scene.meshes[instance.mesh].indices.is_empty())
            .map(|instance| {
                let mesh = &scene.meshes[instance.mesh];
                let (vertices, indices) = buffers[instance.mesh].clone();
                let normals = instance.world_from_normal().as_mat3();
                Self {
                    vertices,
                    indices,
                    count: mesh.indices.len() as u32,
                    bounds: mesh.bounds(),
                    double_sided: mesh.double_sided,
                    role: instance.role,
                    world_from_mesh: instance.world_from_mesh,
                    world_from_normal: normals.to_cols_array_2d().map(|[x, y, z]| [x, y, z, 0.0]),
                }
            })
            .collect()
    }

    /// The corners of its box, in the world.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| f64::from(self.bounds[i >> axis & 1][axis]);
            self.world_from_mesh.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
        })
    }

    /// Draws its triangles with whatever pipeline is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.count, 0, 0..1);
    }
}

fn upload(gpu: &Gpu, mesh: &scene::Mesh) -> (wgpu::Buffer, wgpu::Buffer) {
    let buffer = |label, contents, usage| {
        let create = BufferInitDescriptor { label: Some(label), contents, usage };
        gpu.device.create_buffer_init(&create)
    };
    let vertices: Vec<Vertex> = mesh
        .positions
        .iter()
        .zip(&mesh.normals)
        .map(|(&position, &normal)| Vertex { position, normal })
        .collect();
    (
        buffer(
            "vertices",
            bytemuck::cast_slice(&vertices),
            wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE,
        ),
        buffer(
            "indices",
            bytemuck::cast_slice(&mesh.indices),
            wgpu::BufferUsages::INDEX | wgpu::BufferUsages::STORAGE,
        ),
    )
}

/// Bytes between two objects' uniforms: what dynamic offsets are multiples of by default.
const UNIFORM_STRIDE: usize = 256;

/// A `T` for each object, in one uniform buffer. (wgpu has push constants only as a feature.)
pub struct PerObject<T> {
    pub layout: wgpu::BindGroupLayout,
    buffer: wgpu::Buffer,
    group: wgpu::BindGroup,
    of: PhantomData<T>,
}

impl<T: bytemuck::NoUninit> PerObject<T> {
    /// Room for `count` objects.
    pub fn new(gpu: &Gpu, count: usize) -> Self {
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("per object"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: wgpu::BufferSize::new(size_of::<T>() as u64),
                },
                count: None,
            }],
        });
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("per object"),
            size: (UNIFORM_STRIDE * count.max(1)) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("per object"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &buffer,
                    offset: 0,
                    size: wgpu::BufferSize::new(size_of::<T>() as u64),
                }),
            }],
        });
        Self { layout, buffer, group, of: PhantomData }
    }

    /// Sets every object's value, for the commands that are submitted from now on.
    pub fn write(&self, gpu: &Gpu, values: impl Iterator<Item = T>) {
        let mut bytes = Vec::new();
        for (i, value) in values.enumerate() {
            bytes.resize(i * UNIFORM_STRIDE, 0);
            bytes.extend_from_slice(bytemuck::bytes_of(&value));
        }
        gpu.queue.write_buffer(&self.buffer, 0, &bytes);
    }

    /// Shows shaders the value of one object.
    pub fn bind(&self, pass: &mut wgpu::RenderPass, object: usize) {
        pass.set_bind_group(0, &self.group, &[(object * UNIFORM_STRIDE) as u32]);
    }
}
