//! The meshes whose triangles are in the hierarchy, and the space that the hierarchy is in.

use super::boxes::has_triangles;
use super::camera::Camera;
use super::check::bad;
use super::{CutOutList, Description, Frame};
use crate::Error;
use crate::lent::{Geometry, LightIndex, MeshBuffers, MeshInstance, from_origin, origin_of};
use crate::light::{Light, Shape};
use crate::stages::hierarchy::{CUT_OUT, LEAF, MeshPush, Sizes, WHOLE};
use ash::vk;
use glam::{DMat3, DMat4, DVec3, DVec4};
use std::hash::{DefaultHasher, Hash, Hasher};

/// The most triangles and meshes that block light in any frame, for which a node has memory where a technique works
/// with the triangles themselves: some 120 bytes a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// The most triangles, 1 to 5,000,000; the number of triangles of each mesh counts as even.
    pub triangles: u32,
    /// The most meshes, 1 to 65,536. Meshes behind each other in the list that share their buffers count as one.
    pub meshes: u32,
}

impl Capacity {
    /// The largest capacity.
    pub const MOST: Self = Self { triangles: 5_000_000, meshes: 65_536 };

    /// The capacity for some meshes, and at least [`Self::default`].
    pub fn of<'a>(meshes: impl IntoIterator<Item = &'a MeshInstance>) -> Self {
        let blocking = meshes.into_iter().filter(|m| m.role.blocks() && has_triangles(m));
        let [triangles, count] = blocking.fold([0u64; 2], |[triangles, count], mesh| {
            let of_mesh = match mesh.geometry {
                Geometry::Buffers(buffers) => (buffers.count / 3).next_multiple_of(LEAF),
                Geometry::HostDrawn(_) => 0,
            };
            [triangles + u64::from(of_mesh), count + 1]
        });
        let least = Self::default();
        Self {
            triangles: least.triangles.max(triangles.min(u64::from(Self::MOST.triangles)) as u32),
            meshes: least.meshes.max(count.min(u64::from(Self::MOST.meshes)) as u32),
        }
    }

    /// Checks the capacity's ranges.
    pub(super) fn check(&self) -> Result<(), Error> {
        let Self { triangles, meshes } = *self;
        if (1..=Self::MOST.triangles).contains(&triangles)
            && (1..=Self::MOST.meshes).contains(&meshes)
        {
            return Ok(());
        }
        bad(format!(
            "a capacity of {triangles} triangles in {meshes} meshes is outside 1 to 5,000,000 in 1 to 65,536"
        ))
    }
}

impl Default for Capacity {
    /// 131,072 triangles in 1,024 meshes: some 16 MB.
    fn default() -> Self {
        Self { triangles: 1 << 17, meshes: 1 << 10 }
    }
}

/// A blocking mesh in buffers, as the passes that read its triangles take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TriangleMesh {
    pub positions: vk::Buffer,
    /// The indices; the positions once more where there are none.
    pub indices: vk::Buffer,
    pub push: MeshPush,
    /// The mesh's number among those that textures cut out.
    pub cut_out: Option<u32>,
}

/// The blocking meshes of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TriangleList {
    pub meshes: Vec<TriangleMesh>,
    /// The origin of the hierarchy's space in world space.
    pub origin: DVec3,
    pub sizes: Sizes,
    /// Differs where another list of triangles blocks.
    pub key: u64,
}

impl TriangleList {
    /// Lists the blocking meshes of a frame.
    ///
    /// # Errors
    /// [`Error::Frame`] for meshes beyond the description's capacity, for indices of 8 bits, and for a blocking mesh that
    /// the host draws itself where there is an audit.
    pub fn fill(
        &mut self,
        description: &Description,
        meshes: &[MeshInstance],
        cut_outs: &CutOutList,
    ) -> Result<(), Error> {
        let capacity = description.capacity.triangles;
        self.meshes.clear();
        let blocking = |m: &MeshInstance| m.role.blocks() && has_triangles(m);
        let drawn = |m: &MeshInstance| matches!(m.geometry, Geometry::HostDrawn(_));
        if let Some(index) = meshes.iter().position(|m| m.role.blocks() && drawn(m))
            && description.audit > 0
        {
            return bad(format!(
                "mesh {index} is drawn by the host, which has no triangles for the audit to trace; give its buffers, \
                 or set audit to 0"
            ));
        }
        let listed = || {
            let blocking = meshes.iter().enumerate().filter(|(_, m)| blocking(m));
            blocking.filter_map(|(place, m)| match m.geometry {
                Geometry::Buffers(buffers) => Some((place, *m, buffers)),
                Geometry::HostDrawn(_) => None,
            })
        };
        self.origin = middle(listed().map(|(_, m, _)| m));
        let [of_meshes, key_bits] = MeshPush::key_bits(listed().count() as u32);
        let mut hasher = DefaultHasher::new();
        let mut needed = Needed::default();
        for (rank, (place, mesh, buffers)) in listed().enumerate() {
            buffers.hash_into(&mut hasher);
            let one = self.mesh(&mesh, &buffers, needed.triangles as u32)?;
            let key = (rank as u32).checked_shl(u32::BITS - of_meshes).unwrap_or(0);
            needed.add(&buffers, one.indices);
            let cut_out = cut_outs.number_of(place);
            if let Some(texture) = cut_out.and_then(|number| cut_outs.texture(number)) {
                texture.hash_into(&mut hasher);
            }
            let [x, y, z, _] = one.push.low;
            let low = [x, y, z, if cut_out.is_some() { CUT_OUT } else { WHOLE }];
            let push = MeshPush { key, key_bits, low, ..one.push };
            self.meshes.push(TriangleMesh { push, cut_out, ..one });
        }
        cut_outs.halved.hash(&mut hasher);
        if let Some(problem) = needed.beyond(description.capacity) {
            return bad(problem);
        }
        let cut_outs = self.meshes.iter().filter(|m| m.cut_out.is_some()).count() as u32;
        let triangles = needed.triangles as u32;
        let texels = description.cut_outs.all_texels();
        self.sizes = Sizes { capacity, triangles, texels, cut_outs };
        self.key = hasher.finish();
        Ok(())
    }

    fn mesh(
        &self,
        mesh: &MeshInstance,
        buffers: &MeshBuffers,
        first: u32,
    ) -> Result<TriangleMesh, Error> {
        let (indices, offset, index_bits) = indices_of(buffers).or_else(bad)?;
        let origin = origin_of(&mesh.bounds);
        let m = from_origin(&mesh.world_from_mesh, origin);
        let row = |i: usize| {
            let row = m.row(i);
            DVec4::new(row.x, row.y, row.z, row.w - self.origin[i]).as_vec4().to_array()
        };
        let [low, high] = mesh.bounds;
        let size = [0, 1, 2].map(|i| f64::from(high[i]) - f64::from(low[i]));
        let count = buffers.count / 3;
        let push = MeshPush {
            rows: [row(0), row(1), row(2)],
            low: [low[0], low[1], low[2], WHOLE],
            cells: MeshPush::cells_of(size),
            first,
            count,
            padded: count.next_multiple_of(LEAF),
            positions: (buffers.positions_offset / 4) as u32,
            stride: buffers.positions_stride / 4,
            indices: offset as u32,
            index_bits,
            key: 0,
            key_bits: 0,
            origin,
        };
        Ok(TriangleMesh { positions: buffers.positions, indices, push, cut_out: None })
    }

    /// How the passes over pixels see the hierarchy's space.
    pub fn space(&self, frame: &Frame, description: &Description) -> Space {
        let camera = Camera::of(&frame.world_from_ndc);
        let near = if frame.far_depth() == 0.0 { 1.0 } else { 0.0 };
        let eye = camera
            .eye
            .unwrap_or_else(|| frame.world_from_ndc.project_point3(DVec3::new(0.0, 0.0, near)));
        let towards = match camera.eye {
            Some(_) => DVec4::W,
            // Depth grows towards the viewer where it is reversed.
            None => (camera.direction * if near == 1.0 { 1.0 } else { -1.0 }).extend(0.0),
        };
        let light_from_world = frame.light.rectangle().light_from_world();
        // A sun has no place: its light space begins where the hierarchy's does.
        let light_from_here = match frame.light.shape() {
            Shape::Sun { .. } => DMat4::from_mat3(DMat3::from_mat4(light_from_world)),
            _ => light_from_world * DMat4::from_translation(self.origin),
        };
        Space {
            eye_from_ndc: DMat4::from_translation(-eye) * frame.world_from_ndc,
            eye: eye - self.origin,
            towards,
            light_from_here,
            light: frame.light,
            depth_step: depth_step(description.depth_format),
            nodes: self.sizes.nodes(),
        }
    }
}

/// What keeps the triangles of a frame's blocking meshes out of a hierarchy, as a sentence without its full stop; `None`
/// where [`TriangleList::fill`] takes all of them.
pub(crate) fn kept_out(capacity: Capacity, meshes: &[MeshInstance]) -> Option<String> {
    let mut needed = Needed::default();
    let blocking = |(_, m): &(usize, &MeshInstance)| m.role.blocks() && has_triangles(m);
    for (index, mesh) in meshes.iter().enumerate().filter(blocking) {
        let Geometry::Buffers(buffers) = mesh.geometry else {
            return Some(format!(
                "mesh {index} blocks light and is drawn by the host; give its buffers"
            ));
        };
        match indices_of(&buffers) {
            Ok((indices, ..)) => needed.add(&buffers, indices),
            Err(problem) => return Some(problem),
        }
    }
    needed.beyond(capacity)
}

/// The room that blocking meshes need in a hierarchy.
#[derive(Default)]
struct Needed {
    triangles: u64,
    /// Meshes one behind the other with the same buffers count once.
    sets: u32,
    last: Option<[vk::Buffer; 2]>,
}

impl Needed {
    fn add(&mut self, buffers: &MeshBuffers, indices: vk::Buffer) {
        self.triangles += u64::from((buffers.count / 3).next_multiple_of(LEAF));
        let pair = [buffers.positions, indices];
        self.sets += u32::from(self.last.replace(pair) != Some(pair));
    }

    /// A sentence where that is more than a capacity has.
    fn beyond(&self, capacity: Capacity) -> Option<String> {
        let Self { triangles, sets, .. } = self;
        let Capacity { triangles: room, meshes: most } = capacity;
        (*triangles > u64::from(room) || *sets > most).then(|| {
            format!(
                "{triangles} triangles in {sets} meshes block light, and the description's capacity is {room} in {most}; \
                 raise it"
            )
        })
    }
}

/// The buffer of a mesh's indices, the offset in it in indices, and their bits; that of the positions, 0 and 0 without
/// any. A sentence for a type that no shader reads.
fn indices_of(buffers: &MeshBuffers) -> Result<(vk::Buffer, u64, u32), String> {
    match buffers.indices {
        None => Ok((buffers.positions, 0, 0)),
        Some((buffer, offset, vk::IndexType::UINT16)) => Ok((buffer, offset / 2, 16)),
        Some((buffer, offset, vk::IndexType::UINT32)) => Ok((buffer, offset / 4, 32)),
        Some((_, _, other)) => Err(format!(
            "a mesh has indices of the type {other:?}, which no shader reads; give UINT16 or UINT32"
        )),
    }
}

/// A camera and a light in the hierarchy's space.
#[derive(Clone, Copy, Debug)]
pub struct Space {
    /// Normalized device coordinates to positions relative to [`Self::eye`].
    pub eye_from_ndc: DMat4,
    /// The eye; for an orthographic camera a point of its near plane.
    pub eye: DVec3,
    /// The direction towards an orthographic camera, w 0; (0, 0, 0, 1) for a perspective.
    pub towards: DVec4,
    /// The hierarchy's space to light space.
    pub light_from_here: DMat4,
    /// The light.
    pub light: Light,
    /// How far a pixel's depth may be from the surface's: a share of it where above 0, else this much below 0.
    pub depth_step: f32,
    /// The number of nodes.
    pub nodes: u32,
}

impl Default for Space {
    /// A space for passes that do not run.
    fn default() -> Self {
        Self {
            eye_from_ndc: DMat4::IDENTITY,
            eye: DVec3::ZERO,
            towards: DVec4::W,
            light_from_here: DMat4::IDENTITY,
            light: crate::RectangleLight::unit().into(),
            depth_step: 0.0,
            nodes: 0,
        }
    }
}

/// A step of a depth format: a share of the depth above 0, or the negative of a step of its own.
fn depth_step(format: vk::Format) -> f32 {
    match format {
        vk::Format::D16_UNORM | vk::Format::D16_UNORM_S8_UINT => -1.0 / 65535.0,
        vk::Format::X8_D24_UNORM_PACK32 | vk::Format::D24_UNORM_S8_UINT => -1.0 / 16_777_215.0,
        _ => 1.0 / 8_388_608.0,
    }
}

/// The middle of the box around some meshes, in world space.
fn middle(meshes: impl Iterator<Item = MeshInstance>) -> DVec3 {
    let [low, high] = meshes.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], mesh| {
        let [center, half] = super::boxes::around(&mesh);
        [low.min(center - half), high.max(center + half)]
    });
    let middle = low.midpoint(high);
    if middle.is_finite() { middle } else { DVec3::ZERO }
}

impl MeshBuffers {
    /// Hashes which triangles the buffers hold, wherever those are.
    fn hash_into(&self, hasher: &mut DefaultHasher) {
        (self.positions, self.positions_offset, self.positions_stride, self.count).hash(hasher);
        self.indices.map(|(buffer, offset, kind)| (buffer, offset, kind.as_raw())).hash(hasher);
    }
}

/// The hierarchy of a frame: which triangles it is over, and where they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TreeKey {
    /// Differs where another list of triangles blocks.
    pub list: u64,
    /// The revision of their places; `None` where anything may have moved.
    pub moved: Option<Moved>,
}

/// A revision of the meshes' places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moved {
    /// The frame's revision of its meshes.
    Meshes(u64),
    /// The frame's revision of light and meshes.
    Light(LightIndex, u64),
}

impl TreeKey {
    /// The key of a frame's hierarchy.
    pub fn of(list: &TriangleList, frame: &Frame) -> Self {
        let meshes = frame.mesh_revision.map(Moved::Meshes);
        let light = frame.revision.map(|revision| Moved::Light(frame.light_index, revision));
        Self { list: list.key, moved: meshes.or(light) }
    }
}
