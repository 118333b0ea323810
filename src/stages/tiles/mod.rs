//! Skips the 8×8-pixel tiles that no occluder can shadow, and lists the others.
//!
//! ```text
//!   pixels ──► tiles ──┬─► lit: no occluder before any of its receivers; 1 is written at once
//!   occluders ──┘      └─► listed ──► the technique's own pass, by an indirect dispatch
//! ```
//! A tile's receivers are bounded in light space, and one query of the occluders' hierarchy finds whether any occluder
//! lies within the light's window before the nearest receiver that it could shadow. Where none does, every pixel of
//! the tile would find none by itself and see all of the light that its own surface leaves. So the image is the same
//! to the bit, and 63 of 64 queries are saved.
//!
//! Where pixels' own surfaces block light, their part needs normals, which the technique's own pass makes. Such tiles
//! are listed too, with a mark that no occluder need be tested for them.
//!
//! Umbra tiles are not detected. No shortcut of a technique finds for certain that a sum reaches the whole light: soft
//! shadow maps sum to 0.89 and up in full umbra, and other techniques test each pixel's own plane.
//!
//! **What it costs** a tile of 8×8 pixels: 64 depths and as many texels of the mask to bound it, one query of the
//! hierarchy's nodes that the light's window touches, and 64 values written where it is lit. A pixel that finds by
//! itself that it is lit fetches 13 depths for its normal, and four pixels share a query of the nodes.
//!
//! Measured in 640×480 (`benches/techniques`): sorting takes 5 to 15 ms, where the passes without it take 55 to 5000;
//! with tiles of 4×4 and of 16×16 pixels the sums are within a tenth of each other.
//!
//! The order of the list is up to the device, but the image is not: each tile writes only its own pixels.

pub mod twin;

use super::visibility::GBuffer;
use crate::graph::{Access, Graph, Need, Pass, Push, ResourceId, Use, Uses, Work};
use crate::shaders::{Module, module};
use smallvec::smallvec;

/// A tile's side in pixels (`lists.glsl`).
pub(crate) const TILE: u32 = 8;
/// The list holds the number of tiles, and then one word a tile.
const HEAD: u64 = 4;

/// The list of tiles that a technique's pass over the pixels runs for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tiles {
    /// The numbers of workgroups for an indirect dispatch.
    arguments: ResourceId,
    /// The number of listed tiles, and their words.
    list: ResourceId,
}

impl Tiles {
    /// The number of tiles in an image.
    pub fn in_image(extent: [u32; 2]) -> u64 {
        extent.map(|e| u64::from(e.div_ceil(TILE))).iter().product()
    }

    /// Adds the pass that empties the list.
    pub fn start(graph: &mut Graph, extent: [u32; 2], need: &Need) -> Self {
        let tiles = Self::in_image(extent);
        let arguments = graph.buffer("visibility.tile_arguments", 16);
        let list = graph.buffer("visibility.tile_list", HEAD + 4 * tiles);
        graph.push(Pass::compute(
            "visibility.tiles_start",
            module!("visibility/tiles_start.comp"),
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

    /// Adds the pass that sorts the tiles by a technique's shader; `occluders` are its inputs, bound at 2 and from 6
    /// on.
    pub fn sort(
        &self,
        graph: &mut Graph,
        shader: Module,
        push: Push,
        (occluders, visibility): (&[Use], ResourceId),
        gbuffer: &GBuffer,
        need: &Need,
    ) {
        // One workgroup of 8×8 invocations sorts 8×8 tiles.
        let [x, y] = gbuffer.extent.map(|e| e.div_ceil(8 * TILE));
        let mut uses = Uses::from_slice(&gbuffer.all_bound());
        uses.extend([
            Use::bound(3, self.arguments, Access::BufferUpdate),
            Use::bound(4, self.list, Access::BufferUpdate),
            Use::bound(5, visibility, Access::ImageWrite),
        ]);
        uses.extend_from_slice(occluders);
        graph.push(Pass::compute("visibility.tiles", shader, [x, y, 1], push, uses, need));
    }

    /// Adds a technique's pass for the listed tiles; the list is bound at `binding`.
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
