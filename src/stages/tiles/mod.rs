//! Tiles of pixels that are done at once, and a list of the others.
//!
//! ```text
//!   pixels ──► tiles ──┬─► lit: nothing before any of its receivers, written there and then
//!   occluders ──┘      └─► listed ──► the technique's own pass, as many workgroups as there are (indirect)
//! ```
//! A tile's receivers are bounded in light space, and the occluders' hierarchy is asked once for all of them
//! whether anything lies within the light's window before the nearest to be felt. Where nothing does, each
//! pixel would have found nothing either: it sees all of the light that its own surface leaves. So the image is
//! the same to the bit, and what is saved is asking 64 times.
//!
//! Where pixels block light themselves, that part takes their normals, which are the technique's to make: such
//! tiles are listed too, with a mark that no occluder need be asked for.
//!
//! Umbra is not told. A technique's sums reach all of the light or more for sure at none of its shortcuts: soft
//! shadow maps sum to 0.89 and up in full umbra, and other techniques ask each pixel's own plane.
//!
//! **What it costs** a tile of 8×8 pixels: 64 depths and as many of the mask to bound it, the nodes of the
//! hierarchy that the light's window touches, once, and 64 values written where it is lit. A pixel that finds
//! for itself that it is lit fetches 13 depths for its normal, and four pixels the same nodes.
//!
//! Measured in 640×480 (`benches/techniques`): 5 to 15 ms to sort, of 55 to 5000 that the passes take without; with tiles
//! of 4×4 and of 16×16 pixels the sums are within a tenth of each other.
//!
//! The order of the list is up to the device; each tile writes its own pixels alone, so the image is not.

pub mod twin;

use super::visibility::GBuffer;
use crate::graph::{Access, Graph, Need, Pass, Push, ResourceId, Use, Uses, Work};
use crate::shaders::{self, Module};
use smallvec::smallvec;

/// Pixels a side of a tile, as in `lists.glsl`.
pub(crate) const TILE: u32 = 8;
/// A word a tile behind their number.
const HEAD: u64 = 4;

/// The tiles that a technique's pass over the pixels runs for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tiles {
    /// Workgroups, as an indirect dispatch takes them.
    arguments: ResourceId,
    /// How many, and where they are.
    list: ResourceId,
}

impl Tiles {
    /// How many there are of an image.
    pub fn in_image(extent: [u32; 2]) -> u64 {
        extent.map(|e| u64::from(e.div_ceil(TILE))).iter().product()
    }

    /// Adds the row that begins an empty list.
    pub fn start(graph: &mut Graph, extent: [u32; 2], need: &Need) -> Self {
        let tiles = Self::in_image(extent);
        let arguments = graph.buffer("visibility.tile_arguments", 16);
        let list = graph.buffer("visibility.tile_list", HEAD + 4 * tiles);
        graph.push(Pass::compute(
            "visibility.tiles_start",
            shaders::TILES_START,
            [1, 1, 1],
            Push::NONE,
            smallvec![
                Use::bound(0, arguments, Access::BufferWriteCompute),
                Use::bound(1, list, Access::BufferWriteCompute),
            ],
            need,
        ));
        Self { arguments, list }
    }

    /// Adds the row that sorts tiles by a technique's shader: `occluders` is what it asks, at binding 2 and from 6 on.
    pub fn sort(
        &self,
        graph: &mut Graph,
        shader: Module,
        push: Push,
        (occluders, visibility): (&[Use], ResourceId),
        gbuffer: &GBuffer,
        need: &Need,
    ) {
        // 8×8 invocations of a tile.
        let [x, y] = gbuffer.extent.map(|e| e.div_ceil(8 * TILE));
        let mut uses = smallvec![
            Use::bound(0, gbuffer.depth, Access::SampledCompute),
            Use::bound(1, gbuffer.mask.unwrap_or(gbuffer.depth), Access::SampledCompute),
            Use::bound(3, self.arguments, Access::BufferUpdate),
            Use::bound(4, self.list, Access::BufferUpdate),
            Use::bound(5, visibility, Access::ImageWrite),
        ];
        uses.extend_from_slice(occluders);
        graph.push(Pass::compute("visibility.tiles", shader, [x, y, 1], push, uses, need));
    }

    /// Adds a technique's row for what is listed; the list is bound at `binding`.
    pub fn run(
        &self,
        graph: &mut Graph,
        (name, shader): (&'static str, Module),
        push: Push,
        mut uses: Uses,
        binding: u8,
        need: &Need,
    ) {
        uses.push(Use::bound(binding, self.list, Access::BufferReadCompute));
        uses.push(Use::fixed(self.arguments, Access::Indirect));
        let work = Work::Indirect { shader, arguments: self.arguments, offset: 0 };
        graph.push(Pass { name, uses, push, work, need: *need });
    }
}
