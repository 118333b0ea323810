//! The nodes of the occluder map: blocks of 8×8 texels and superblocks of 32×32, with their moments.

use super::settings::{Accumulate, Settings, Sides};
use crate::graph::{Access, Graph, Pass, Push, ResourceId, STORAGE_BYTES, Use};
use crate::shaders::module;
use crate::stages::depth_layers::DepthLayers;
use crate::techniques::room::PassInputs;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// A block's and a superblock's side in texels (`node.glsl`).
const BLOCK: u32 = 8;

const SUPERBLOCK: u32 = 32;

/// The number of nodes of a superblock and its blocks, which lie together.
const FAMILY: u64 = 17;

/// The occluder map's nodes, as resources and sizes.
#[derive(Clone, Copy)]
pub(super) struct Nodes {
    pub texels: ResourceId,
    pub blocks: ResourceId,
    /// Superblocks with their blocks, their slopes, and behind them the prefix sums that give the moments of any rectangle
    /// of a block's texels: one buffer, since a stage has four for sure.
    pub families: ResourceId,
    /// Where the sums begin in it, in 16 bytes.
    pub sums: u32,
    /// The number of blocks in a row of the map, a multiple of a superblock's.
    pub block_row: u32,
    pub superblock_row: u32,
}

/// The sides that are summed apart: 0 front, 1 back.
pub(super) fn sides(settings: &Settings) -> &'static [u32] {
    if matches!(settings.sides, Sides::Two | Sides::Mean) { &[0, 1] } else { &[0] }
}

/// How both sides are combined: blending cannot choose a face by receiver, which the mean needs.
pub(super) fn combination(settings: &Settings) -> Sides {
    match (settings.sides, settings.accumulate) {
        (Sides::Mean, Accumulate::Blend | Accumulate::BlendFp16) => Sides::Two,
        (sides, _) => sides,
    }
}

pub(super) fn scale_of(inputs: &PassInputs) -> [f32; 2] {
    inputs.occluders.scale(inputs.light).map(|s| s as f32)
}

/// The push constants of `blocks.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Blocks {
    /// The map's side in texels.
    pub map: i32,
    /// The number of blocks in a row of the map.
    pub row: i32,
    /// 1 over the near plane's distance, 1/m.
    pub inv_near: f32,
    /// Where the prefix sums begin among the nodes, in 16 bytes.
    pub sums: i32,
    /// Where the slopes begin among the texels, in 4 bytes.
    pub slopes: i32,
    /// 0: both layers as they are; 1: front texels take the back layer's distance where it has one; 2:
    /// back texels behind a front that is flatter by far are left out.
    pub faces: i32,
}

/// The push constants of `superblocks.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Superblocks {
    /// The number of superblocks in a row of the map.
    pub row: i32,
}

pub(super) fn declare_nodes(
    graph: &mut Graph,
    layers: &DepthLayers,
    settings: &Settings,
    inputs: &PassInputs,
    superblocks_too: bool,
) -> Nodes {
    let sides = sides(settings).len() as u32;
    let superblock_row = inputs.occluders.side.div_ceil(SUPERBLOCK);
    let block_row = superblock_row * (SUPERBLOCK / BLOCK);
    let count = |row: u32| u64::from(row) * u64::from(row) * u64::from(sides);
    // The moments of w and of its slopes.
    let node_bytes = 3 * size_of::<[f32; 4]>() as u64;
    let texels_a_block = u64::from(BLOCK * BLOCK);
    let families = count(superblock_row) * FAMILY * node_bytes;
    let nodes = Nodes {
        texels: graph.buffer(
            "soft_shadow_map.texels",
            // From N = 2,881 on it would be larger with two sides; blocks beyond have no slopes.
            (count(block_row) * texels_a_block * 8).min(STORAGE_BYTES),
        ),
        blocks: graph.buffer("soft_shadow_map.blocks", count(block_row) * node_bytes),
        families: graph.buffer(
            "soft_shadow_map.families",
            // From N = 1,409 on it would be larger with two sides; blocks beyond have no sums.
            (families + count(block_row) * texels_a_block * 32).min(STORAGE_BYTES),
        ),
        sums: (families / 16) as u32,
        block_row,
        superblock_row,
    };
    let (shader, groups) = match inputs.processor {
        true => (module!("soft_shadow_map/blocks_serial.comp"), block_row.div_ceil(BLOCK)),
        false => (module!("soft_shadow_map/blocks.comp"), block_row),
    };
    graph.push(Pass::compute(
        "soft_shadow_map.blocks",
        shader,
        [groups, groups, sides],
        Push::new(&Blocks {
            map: inputs.occluders.side as i32,
            row: block_row as i32,
            inv_near: inputs.occluders.top() as f32,
            sums: nodes.sums as i32,
            slopes: (count(block_row) * texels_a_block) as i32,
            faces: match combination(settings) {
                Sides::Bottom => 1,
                Sides::Mean => 2,
                Sides::One | Sides::Two => 0,
            },
        }),
        smallvec![
            Use::bound(0, layers.front, Access::SampledCompute),
            Use::bound(1, layers.back.unwrap_or(layers.front), Access::SampledCompute),
            Use::bound(2, nodes.texels, Access::BufferWriteCompute),
            Use::bound(3, nodes.blocks, Access::BufferWriteCompute),
            Use::bound(4, nodes.families, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    if superblocks_too {
        graph.push(Pass::compute(
            "soft_shadow_map.superblocks",
            module!("soft_shadow_map/superblocks.comp"),
            [superblock_row.div_ceil(8), superblock_row.div_ceil(8), sides],
            Push::new(&Superblocks { row: superblock_row as i32 }),
            smallvec![
                Use::bound(0, nodes.blocks, Access::BufferReadCompute),
                Use::bound(1, nodes.families, Access::BufferWriteCompute),
            ],
            inputs.need,
        ));
    }
    nodes
}
