//! The rows of the gather at the G-buffer's pixels.

use super::passes::{Nodes, scale_of, sides};
use super::push;
use super::settings::{Settings, Sides, spread_of};
use crate::graph::{Access, Graph, Pass, Push, Use};
use crate::shaders;
use crate::stages::tiles::Tiles;
use crate::techniques::room::PassInputs;
use smallvec::smallvec;

const NAME: &str = "soft_shadow_map.gather_pixels";

/// Adds the rows that gather at the pixels: at all of them, or at those of tiles that may feel an occluder.
pub(super) fn gather(graph: &mut Graph, nodes: &Nodes, settings: &Settings, inputs: &PassInputs) {
    let (gbuffer, visibility) = (inputs.gbuffer, inputs.visibility);
    let [width, height] = gbuffer.extent;
    let push = Push::new(&pixel_push(nodes, settings, inputs));
    let write = if settings.classify { Access::ImageUpdate } else { Access::ImageWrite };
    let uses = smallvec![
        Use::bound(0, gbuffer.depth, Access::SampledCompute),
        Use::bound(1, gbuffer.mask.unwrap_or(gbuffer.depth), Access::SampledCompute),
        Use::bound(2, nodes.texels, Access::BufferReadCompute),
        Use::bound(3, nodes.sums, Access::BufferReadCompute),
        Use::bound(4, nodes.families, Access::BufferReadCompute),
        Use::bound(5, visibility, write),
    ];
    if settings.classify {
        let tiles = Tiles::start(graph, gbuffer.extent, inputs.need);
        let families = Use::bound(2, nodes.families, Access::BufferReadCompute);
        tiles.sort(graph, shaders::TILES, push, (&[families], visibility), gbuffer, inputs.need);
        tiles.run(graph, (NAME, shaders::GATHER_TILES), push, uses, 6, inputs.need);
    } else {
        // 8×8 invocations of 2×2 pixels.
        let groups = [width.div_ceil(16), height.div_ceil(16), 1];
        graph.push(Pass::compute(NAME, shaders::GATHER_PIXELS, groups, push, uses, inputs.need));
    }
}

fn pixel_push(nodes: &Nodes, settings: &Settings, inputs: &PassInputs) -> push::GatherPixels {
    let PassInputs { gbuffer, occluders, .. } = inputs;
    let two = i32::from(sides(settings).len() == 2);
    let mean = i32::from(settings.sides == Sides::Mean);
    push::GatherPixels {
        light_from_ndc: gbuffer.light_from_ndc,
        scale: scale_of(inputs),
        texels_per_uv: occluders.texels_per_uv().map(|x| x as f32),
        first: occluders.first().map(|x| x as f32),
        extent: gbuffer.extent.map(|e| e as i32),
        background: gbuffer.background,
        w_max: (1.0 / occluders.near) as f32,
        spread: spread_of(settings.tolerance),
        snap: inputs.snap,
        depth_error: inputs.depth_error as f32,
        row: nodes.superblock_row as i32,
        flags: i32::from(gbuffer.mask.is_some()) | two << 1 | mean << 2,
    }
}
