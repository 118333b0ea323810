//! The meshes of a frame that textures cut out, and the room that a node has for them.

use super::boxes::has_triangles;
use super::check::bad;
use crate::Error;
use crate::graph::{Graph, Need};
use crate::lent::{Geometry, MeshInstance, OpacityTexture, Wrap};
use ash::vk;
use bytemuck::{Pod, Zeroable};

/// The most meshes with an opacity texture ([`MeshInstance::opacity`]) in any frame, and the memory for their textures where
/// a technique works with the triangles themselves, or an audit does. None by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CutOuts {
    /// The most meshes, 0 to 16,384. With 0 no pipeline for them is made.
    pub meshes: u32,
    /// The texels of all their textures together, 0 to 67,108,864, a byte each. Textures that do not fit are made smaller,
    /// all by the same power of 2. Techniques that draw maps read the host's images and need none.
    pub texels: u32,
}

impl CutOuts {
    /// The largest room.
    pub const MOST: Self = Self { meshes: 1 << 14, texels: 1 << 26 };

    /// The room for some meshes, with all texels of their textures where there is room for them.
    pub fn of<'a>(meshes: impl IntoIterator<Item = &'a MeshInstance>) -> Self {
        let mut seen: Vec<OpacityTexture> = Vec::new();
        let (mut count, mut texels) = (0u64, 0u64);
        for texture in meshes.into_iter().filter_map(texture_of) {
            count += 1;
            if !seen.iter().any(|known| shares_texels(known, texture)) {
                texels += texels_of(texture, 0);
                seen.push(*texture);
            }
        }
        Self {
            meshes: count.min(u64::from(Self::MOST.meshes)) as u32,
            texels: texels.min(u64::from(Self::MOST.texels)) as u32,
        }
    }

    /// The texels that the textures of so many meshes have at least, and of this room.
    pub(super) fn all_texels(&self) -> u32 {
        self.texels.max(4 * self.meshes)
    }

    /// Declares the buffer of the meshes that are cut out, of which a frame has `count`, where there is room for any.
    pub(super) fn declare(&self, graph: &mut Graph, count: u32, need: &Need) {
        if self.meshes > 0 {
            let none = Need::No(graph.because("no texture cuts out a mesh"));
            let bytes = size_of::<CutOutRecord>() as u64 * u64::from(self.meshes);
            graph.cut_outs(bytes, if count > 0 { need } else { &none });
        }
    }

    /// Checks the room's ranges.
    pub(super) fn check(&self) -> Result<(), Error> {
        let Self { meshes, texels } = *self;
        if meshes <= Self::MOST.meshes && texels <= Self::MOST.texels {
            return Ok(());
        }
        bad(format!(
            "cut_outs of {meshes} meshes and {texels} texels are beyond 16,384 and 67,108,864"
        ))
    }
}

/// A mesh's texture where the node has to look it up.
fn texture_of(mesh: &MeshInstance) -> Option<&OpacityTexture> {
    let drawn = matches!(mesh.geometry, Geometry::Buffers(_)) && has_triangles(mesh);
    mesh.opacity.as_ref().filter(|_| drawn)
}

/// Whether two textures have the same opacities.
fn shares_texels(a: &OpacityTexture, b: &OpacityTexture) -> bool {
    (a.view, a.extent, a.factor.to_bits()) == (b.view, b.extent, b.factor.to_bits())
}

/// The sides of a texture that was halved a number of times.
fn halved(texture: &OpacityTexture, times: u32) -> [u32; 2] {
    texture.extent.map(|side| (side >> times).max(1))
}

/// The texels of a texture that was halved a number of times; rows of words of four.
fn texels_of(texture: &OpacityTexture, times: u32) -> u64 {
    let [width, height] = halved(texture, times).map(u64::from);
    (width * height).next_multiple_of(4)
}

/// A mesh's cut-out as shaders read it (`cut_outs/cut_out.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct CutOutRecord {
    /// The numbers of [`OpacityTexture::transform`] that make u, and the cutoff.
    pub u: [f32; 4],
    /// Those that make v, and the factor.
    pub v: [f32; 4],
    /// Where the coordinates begin, in floats.
    pub first: u32,
    /// Floats from one to the next, and the bits of `cut_outs/cut_out.glsl` above them.
    pub bits: u32,
    /// Where the texture's opacities begin among those of all textures, in texels.
    pub texels: u32,
    /// The width and height of the texture there: 16 bits each.
    pub extent: u32,
}

impl CutOutRecord {
    /// The record of a texture whose opacities are read from its own image.
    pub fn of(texture: &OpacityTexture) -> Self {
        Self::new(texture, 0, 0)
    }

    fn new(texture: &OpacityTexture, texels: u64, halved_times: u32) -> Self {
        let row = |row: usize, last: f32| {
            let [a, b, c] = texture.transform[row];
            [a, b, c, last]
        };
        let wrap = |axis: usize| match texture.wrap[axis] {
            Wrap::Repeat => 0,
            Wrap::Mirror => 1,
            Wrap::Clamp => 2,
        };
        let flags = [texture.linear, texture.cutoff.is_some()].map(u32::from);
        let [width, height] = halved(texture, halved_times);
        Self {
            u: row(0, texture.cutoff.unwrap_or(0.0)),
            v: row(1, texture.factor),
            first: (texture.coordinates_offset / 4) as u32,
            bits: (texture.coordinates_stride / 4)
                | (wrap(0) << 16)
                | (wrap(1) << 18)
                | (flags[0] << 20)
                | (flags[1] << 21),
            texels: texels as u32,
            extent: width | (height << 16),
        }
    }
}

/// What the set of a mesh that is cut out binds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CutOutSet {
    pub coordinates: vk::Buffer,
    pub view: vk::ImageView,
    pub layout: vk::ImageLayout,
    /// The mesh's indices; the coordinates once more where there are none.
    pub indices: vk::Buffer,
}

/// The meshes of a frame that textures cut out, in the order of the frame's meshes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CutOutList {
    pub records: Vec<CutOutRecord>,
    pub sets: Vec<CutOutSet>,
    /// The numbers of those whose textures are not those of earlier ones.
    pub textures: Vec<u32>,
    /// How many times textures are halved where rays look them up.
    pub halved: u32,
    /// The meshes' places in the frame's list.
    places: Vec<u32>,
    /// Their textures.
    from: Vec<OpacityTexture>,
}

impl CutOutList {
    /// Empties the list and keeps the memory.
    pub fn clear(&mut self) {
        self.records.clear();
        self.sets.clear();
        self.textures.clear();
        self.places.clear();
        self.from.clear();
        self.halved = 0;
    }

    /// The number of the mesh at a place of the frame's list among those that are cut out; `None` for one that is not.
    pub fn number_of(&self, place: usize) -> Option<u32> {
        let found = self.places.binary_search_by_key(&place, |&place| place as usize);
        found.ok().map(|number| number as u32)
    }

    /// The texture of the mesh of a number.
    pub fn texture(&self, number: u32) -> Option<&OpacityTexture> {
        self.from.get(number as usize)
    }

    /// The first mesh with the same opacities as a texture.
    fn first_with(&self, texture: &OpacityTexture) -> Option<usize> {
        let mut first = self.textures.iter().map(|&number| number as usize);
        first.find(|&number| shares_texels(&self.from[number], texture))
    }

    /// Lists the meshes of a frame that textures cut out.
    ///
    /// # Errors
    /// [`Error::Frame`] for more of them than there is room for, and for a texture that no shader can read.
    pub fn fill(&mut self, room: &CutOuts, meshes: &[MeshInstance]) -> Result<(), Error> {
        self.clear();
        for (number, mesh) in meshes.iter().enumerate() {
            let Some(texture) = texture_of(mesh) else { continue };
            texture.check(number)?;
            if self.first_with(texture).is_none() {
                self.textures.push(self.from.len() as u32);
            }
            self.from.push(*texture);
            self.places.push(number as u32);
            let indices = match mesh.geometry {
                Geometry::Buffers(buffers) => buffers.indices.map(|(buffer, ..)| buffer),
                Geometry::HostDrawn(_) => None,
            };
            self.sets.push(CutOutSet {
                coordinates: texture.coordinates,
                view: texture.view,
                layout: texture.layout,
                indices: indices.unwrap_or(texture.coordinates),
            });
        }
        if self.from.len() > room.meshes as usize {
            return bad(format!(
                "{} meshes have an opacity texture, and the description's cut_outs has room for {}; raise it",
                self.from.len(),
                room.meshes
            ));
        }
        let texels = |times: u32| -> u64 {
            self.textures.iter().map(|&nth| texels_of(&self.from[nth as usize], times)).sum()
        };
        // After 14 halvings the largest texture is one texel.
        self.halved = (0..=14).find(|&t| texels(t) <= u64::from(room.all_texels())).unwrap_or(14);
        let mut end = 0;
        for nth in 0..self.from.len() {
            let texture = self.from[nth];
            let start = match self.first_with(&texture).filter(|&first| first < nth) {
                Some(first) => u64::from(self.records[first].texels),
                None => {
                    let start = end;
                    end += texels_of(&texture, self.halved);
                    start
                }
            };
            self.records.push(CutOutRecord::new(&texture, start, self.halved));
        }
        Ok(())
    }
}
