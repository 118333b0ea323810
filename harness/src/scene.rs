//! A scene's meshes in buffers.

use crate::{HeadlessDevice, HostBuffer};
use antumbra::lent::MeshBounds;
use antumbra::scene::{Instance, Scene};
use antumbra::{Error, Geometry, MeshBuffers, MeshInstance};
use ash::vk;
use glam::{DMat4, DVec3};

/// The buffers of one mesh.
struct OwnedMesh {
    positions: HostBuffer,
    normals: HostBuffer,
    indices: HostBuffer,
    count: u32,
    bounds: MeshBounds,
    /// The origin from which the positions in the buffer count, in the scene's mesh.
    origin: DVec3,
}

/// A scene as the device sees it.
pub struct SceneBuffers {
    meshes: Vec<Option<OwnedMesh>>,
}

impl SceneBuffers {
    /// Uploads every mesh; those without triangles take no buffers.
    ///
    /// # Errors
    /// [`Error::Memory`] or [`Error::Vulkan`] where the device refuses.
    pub fn new(device: &HeadlessDevice, scene: &Scene) -> Result<Self, Error> {
        use vk::BufferUsageFlags as Usage;
        let upload = |mesh: &antumbra::scene::Mesh| {
            if mesh.indices.len() < 3 {
                return Ok(None);
            }
            let mut near = mesh.clone();
            let origin = near.move_to_origin();
            let vertices = |name, data| {
                HostBuffer::with_data::<[f32; 3]>(
                    device,
                    name,
                    data,
                    Usage::VERTEX_BUFFER | Usage::STORAGE_BUFFER,
                )
            };
            Ok(Some(OwnedMesh {
                positions: vertices("positions", &near.positions)?,
                normals: vertices("normals", &mesh.normals)?,
                indices: HostBuffer::with_data(
                    device,
                    "indices",
                    &mesh.indices,
                    Usage::INDEX_BUFFER | Usage::STORAGE_BUFFER,
                )?,
                count: mesh.indices.len() as u32,
                bounds: near.bounds(),
                origin,
            }))
        };
        let meshes = scene.meshes.iter().map(upload).collect::<Result<_, Error>>()?;
        Ok(Self { meshes })
    }

    /// The scene's instances as the node takes them.
    pub fn instances(&self, scene: &Scene) -> Vec<MeshInstance> {
        let instance = |i: &Instance| {
            let mesh = self.meshes.get(i.mesh)?.as_ref()?;
            Some(MeshInstance {
                geometry: Geometry::Buffers(MeshBuffers::indexed(
                    mesh.positions.raw(),
                    12,
                    mesh.indices.raw(),
                    mesh.count,
                )),
                world_from_mesh: self.world_from_buffer(i),
                bounds: mesh.bounds,
                role: i.role,
                double_sided: scene.meshes[i.mesh].double_sided,
                cut_out: scene.meshes[i.mesh].cut_out,
            })
        };
        scene.instances.iter().filter_map(instance).collect()
    }

    /// Positions, normals, indices and their count.
    pub(crate) fn draw(&self, mesh: usize) -> Option<(vk::Buffer, vk::Buffer, vk::Buffer, u32)> {
        let mesh = self.meshes.get(mesh)?.as_ref()?;
        Some((mesh.positions.raw(), mesh.normals.raw(), mesh.indices.raw(), mesh.count))
    }

    /// Where the positions of an instance in its buffer go in the world.
    pub(crate) fn world_from_buffer(&self, instance: &Instance) -> DMat4 {
        let mesh = self.meshes.get(instance.mesh).and_then(Option::as_ref);
        let origin = mesh.map_or(DVec3::ZERO, |mesh| mesh.origin);
        instance.world_from_mesh * DMat4::from_translation(origin)
    }
}
