//! The passes of the gather at the G-buffer's pixels.

use super::nodes::{Nodes, scale_of, sides};
use super::settings::{Settings, Sides, spread_of};
use crate::graph::{Access, Graph, Pass, Push, Use, Uses};
use crate::shaders::module;
use crate::stages::tiles::Tiles;
use crate::techniques::room::PassInputs;
use bytemuck::{Pod, Zeroable};

const NAME: &str = "soft_shadow_map.gather_pixels";

/// The push constants of `gather_pixels.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GatherPixels {
    /// (Δu/Lx, Δv/Ly), 1/m.
    pub scale: [f32; 2],
    /// Occluder texels a unit of u and v.
    pub texels_per_uv: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// No occluder is nearer than 1/w_max.
    pub w_max: f32,
    /// The largest |δ| of the series, see [`super::settings::spread_of`].
    pub spread: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// The number of superblocks in a row of the map.
    pub row: i32,
    /// Where the prefix sums begin among the nodes, in 16 bytes.
    pub sums: i32,
    /// Bit 0: two sides; bit 1: their mean.
    pub flags: i32,
    /// The error of an occluder's w beyond its rounding, 1/m.
    pub depth_error: f32,
}

/// Adds the passes that gather at the pixels: at all of them, or at those of tiles that an occluder may shadow.
pub(super) fn gather(graph: &mut Graph, nodes: &Nodes, settings: &Settings, inputs: &PassInputs) {
    let (gbuffer, visibility) = (inputs.gbuffer, inputs.visibility);
    let [width, height] = gbuffer.extent;
    let push = Push::new(&pixel_push(nodes, settings, inputs));
    let write = if settings.classify { Access::ImageUpdate } else { Access::ImageWrite };
    let mut uses = Uses::from_slice(&gbuffer.all_bound());
    uses.extend([
        Use::bound(2, nodes.texels, Access::BufferReadCompute),
        Use::bound(3, nodes.families, Access::BufferReadCompute),
        Use::bound(4, visibility, write),
    ]);
    if settings.classify {
        let tiles = Tiles::start(graph, gbuffer.extent, inputs.need);
        let families = Use::bound(2, nodes.families, Access::BufferReadCompute);
        tiles.sort(
            graph,
            module!("soft_shadow_map/tiles.comp"),
            push,
            (&[families], visibility),
            gbuffer,
            inputs.need,
        );
        tiles.run(
            graph,
            (NAME, module!("soft_shadow_map/gather_pixels_listed.comp")),
            push,
            uses,
            5,
            inputs.need,
        );
    } else {
        // A workgroup of 8×8 invocations handles 2×2 pixels each.
        let groups = [width.div_ceil(16), height.div_ceil(16), 1];
        graph.push(Pass::compute(
            NAME,
            module!("soft_shadow_map/gather_pixels.comp"),
            groups,
            push,
            uses,
            inputs.need,
        ));
    }
}

fn pixel_push(nodes: &Nodes, settings: &Settings, inputs: &PassInputs) -> GatherPixels {
    let PassInputs { occluders, .. } = inputs;
    let two = i32::from(sides(settings).len() == 2);
    let mean = i32::from(settings.sides == Sides::Mean);
    GatherPixels {
        scale: scale_of(inputs),
        texels_per_uv: occluders.texels_per_uv().map(|x| x as f32),
        first: occluders.first().map(|x| x as f32),
        w_max: occluders.top() as f32,
        spread: spread_of(settings.tolerance),
        snap: inputs.snap,
        depth_error: inputs.depth_error as f32,
        row: nodes.superblock_row as i32,
        sums: nodes.sums as i32,
        flags: two | mean << 1,
    }
}
