//! A scene's meshes in buffers.

use crate::set::{Bound, BoundSet};
use crate::{HeadlessDevice, HostBuffer, OwnedImage};
use antumbra::frame::CutOutRecord;
use antumbra::lent::{MeshBounds, OpacityTexture};
use antumbra::scene::{Instance, Mesh, OpacityMap, Scene};
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
    cut: Option<OwnedCut>,
}

/// What cuts a mesh out.
struct OwnedCut {
    _coordinates: HostBuffer,
    texture: OpacityTexture,
    /// The set that the G-buffer's shaders read.
    set: BoundSet,
    _record: HostBuffer,
}

/// A scene as the device sees it.
pub struct SceneBuffers {
    meshes: Vec<Option<OwnedMesh>>,
    /// The scene's opacity maps, as alpha.
    _opacity_maps: Vec<OwnedImage>,
}

/// The layout that opacity maps are in.
const OPACITY_LAYOUT: vk::ImageLayout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;

/// Uploads an opacity map.
fn upload_opacity(device: &HeadlessDevice, map: &OpacityMap) -> Result<OwnedImage, Error> {
    let usage = vk::ImageUsageFlags::SAMPLED;
    let format = vk::Format::R8G8B8A8_UNORM;
    let image = OwnedImage::new(device, "opacity map", format, map.size, usage)?;
    let texels: Vec<[u8; 4]> = map.texels.iter().map(|&opacity| [0, 0, 0, opacity]).collect();
    image.write(&texels, OPACITY_LAYOUT)?;
    Ok(image)
}

impl OwnedCut {
    fn new(
        device: &HeadlessDevice,
        mesh: &Mesh,
        map: &OpacityMap,
        image: &OwnedImage,
    ) -> Result<Self, Error> {
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let name = "texture coordinates";
        let coordinates = HostBuffer::with_data(device, name, &mesh.texture_coordinates, storage)?;
        let texture = OpacityTexture {
            layout: OPACITY_LAYOUT,
            wrap: map.wrap,
            linear: map.linear,
            cutoff: map.cutoff,
            ..OpacityTexture::new(image.view(), map.size, coordinates.raw())
        };
        let record =
            HostBuffer::with_data(device, "cut-out", &[CutOutRecord::of(&texture)], storage)?;
        let stages = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
        let bound = [
            (0, Bound::Storage(&coordinates)),
            (1, Bound::Fetched(image.view(), OPACITY_LAYOUT)),
            (2, Bound::Storage(&record)),
        ];
        let set = BoundSet::new(device, stages, &bound)?;
        Ok(Self { _coordinates: coordinates, texture, set, _record: record })
    }
}

impl SceneBuffers {
    /// Uploads every mesh; those without triangles take no buffers.
    ///
    /// # Errors
    /// [`Error::Memory`] or [`Error::Vulkan`] where the device refuses.
    pub fn new(device: &HeadlessDevice, scene: &Scene) -> Result<Self, Error> {
        use vk::BufferUsageFlags as Usage;
        let maps = scene.opacity_maps.iter().map(|map| upload_opacity(device, map));
        let maps = maps.collect::<Result<Vec<_>, Error>>()?;
        let upload = |mesh: &Mesh| {
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
            let map =
                mesh.opacity_map.and_then(|map| scene.opacity_maps.get(map).zip(maps.get(map)));
            let cut =
                map.map(|(map, image)| OwnedCut::new(device, mesh, map, image)).transpose()?;
            Ok(Some(OwnedMesh {
                cut,
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
        Ok(Self { meshes, _opacity_maps: maps })
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
                opacity: mesh.cut.as_ref().map(|cut| cut.texture),
            })
        };
        scene.instances.iter().filter_map(instance).collect()
    }

    /// The set of a mesh that is cut out, for the G-buffer's shaders.
    pub(crate) fn cut_set(&self, mesh: usize) -> Option<&BoundSet> {
        let cut = self.meshes.get(mesh)?.as_ref()?.cut.as_ref()?;
        Some(&cut.set)
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
