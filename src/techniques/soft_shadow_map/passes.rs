//! The rows of soft shadow maps.

use super::settings::{Accumulate, Receivers, Settings, Sides, spread_of};
use super::{pixels, push};
use crate::graph::{
    Access, Draw, Graph, Owner, Pass, Push, ResourceId, STORAGE_BYTES, Target, Use, Work,
};
use crate::shaders;
use crate::stages::depth_layers::{DepthLayers, MapView};
use crate::stages::visibility::{self};
use crate::techniques::room::PassInputs;
use ash::vk;
use smallvec::{SmallVec, smallvec};

/// Texels a side of a block and of a superblock, as in `node.glsl`.
const BLOCK: u32 = 8;
const SUPERBLOCK: u32 = 32;
/// As in `gather.glsl`: each texel's back face where it lies before the receiver, else its front face.
const BACK_OR_FRONT: i32 = 2;
/// Blended contributions are multiples of 2⁻²⁴, see `patch.frag`.
pub const BLEND_STEPS: f32 = 16_777_216.0;
/// A superblock and its blocks, as they lie together.
const FAMILY: u64 = 17;
/// Blocks a group, as in `patch_count.comp`.
const GROUP: u32 = 64;

/// The occluder map's nodes, as resources and sizes.
#[derive(Clone, Copy)]
pub(super) struct Nodes {
    pub texels: ResourceId,
    blocks: ResourceId,
    /// Moments of any rectangle of a block's texels.
    pub sums: ResourceId,
    /// Superblocks with their blocks.
    pub families: ResourceId,
    /// Blocks a row, a multiple of a superblock's.
    block_row: u32,
    pub superblock_row: u32,
}

/// Adds the passes that turn depth layers into the visible fraction.
pub(super) fn declare(
    graph: &mut Graph,
    layers: &DepthLayers,
    settings: &Settings,
    inputs: &PassInputs,
) {
    let (visibility, view) = (inputs.visibility, inputs.receivers);
    // Without a back layer the front is all there is to both sides. A map of the receivers has rows for each side, which
    // stay as they are.
    let one = Settings { sides: Sides::One, ..*settings };
    let at_pixels = settings.receivers == Receivers::Pixels;
    let settings = if at_pixels && layers.back.is_none() { &one } else { settings };
    let gather = settings.accumulate == Accumulate::Gather;
    let nodes = declare_nodes(graph, layers, settings, inputs, gather);
    match (settings.receivers, layers.receivers) {
        (Receivers::Map, Some(receiver_depth)) => {
            let maps: SmallVec<[_; 2]> = sides(settings)
                .iter()
                .map(|&side| {
                    if gather {
                        gather_map(graph, &nodes, receiver_depth, side, settings, inputs, view)
                    } else {
                        blend_map(graph, &nodes, receiver_depth, side, settings, inputs, view)
                    }
                })
                .collect();
            let both = [maps[0], maps[maps.len() - 1]];
            let mean = combination(settings) == Sides::Mean;
            let resolve = visibility::Resolve { receiver_depth, view, maps: both, mean };
            visibility::resolve(graph, visibility, &resolve, inputs.gbuffer, inputs.need);
        }
        _ => pixels::gather(graph, &nodes, settings, inputs),
    }
}

/// The sides that are summed apart: 0 front, 1 back.
pub(super) fn sides(settings: &Settings) -> &'static [u32] {
    if matches!(settings.sides, Sides::Two | Sides::Mean) { &[0, 1] } else { &[0] }
}

/// How they are put together: blending cannot choose a face by receiver, as the mean does.
fn combination(settings: &Settings) -> Sides {
    match (settings.sides, settings.accumulate) {
        (Sides::Mean, Accumulate::Blend | Accumulate::BlendFp16) => Sides::Two,
        (sides, _) => sides,
    }
}

fn declare_nodes(
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
    let node_bytes = 2 * size_of::<[f32; 4]>() as u64;
    let texels_a_block = u64::from(BLOCK * BLOCK);
    let nodes = Nodes {
        texels: graph.buffer("soft_shadow_map.texels", count(block_row) * texels_a_block * 4),
        blocks: graph.buffer("soft_shadow_map.blocks", count(block_row) * node_bytes),
        sums: graph.buffer(
            "soft_shadow_map.sums",
            // Above N = 2048 they would be larger; blocks beyond do without.
            (count(block_row) * texels_a_block * 16).min(STORAGE_BYTES),
        ),
        families: graph
            .buffer("soft_shadow_map.families", count(superblock_row) * FAMILY * node_bytes),
        block_row,
        superblock_row,
    };
    graph.push(Pass::compute(
        "soft_shadow_map.blocks",
        shaders::BLOCKS,
        [block_row.div_ceil(8), block_row.div_ceil(8), sides],
        Push::new(&push::Blocks {
            map: inputs.occluders.side as i32,
            row: block_row as i32,
            inv_near: (1.0 / inputs.occluders.near) as f32,
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
            Use::bound(4, nodes.sums, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    if superblocks_too {
        graph.push(Pass::compute(
            "soft_shadow_map.superblocks",
            shaders::SUPERBLOCKS,
            [superblock_row.div_ceil(8), superblock_row.div_ceil(8), sides],
            Push::new(&push::Superblocks { row: superblock_row as i32 }),
            smallvec![
                Use::bound(0, nodes.blocks, Access::BufferReadCompute),
                Use::bound(1, nodes.families, Access::BufferWriteCompute),
            ],
            inputs.need,
        ));
    }
    nodes
}

/// Receiver texels in occluder texels: the step, and the centre of texel (0, 0).
pub fn receiver_grid(view: &MapView, occluders: &MapView) -> ([f32; 2], [f32; 2]) {
    let (per, first) = (occluders.texels_per_uv(), occluders.first());
    let receiver_per = view.texels_per_uv();
    let step = [0, 1].map(|i| per[i] / receiver_per[i]);
    let zero = [0, 1].map(|i| (view.min[i] * per[i] + first[i] + 0.5 * step[i]) as f32);
    (step.map(|s| s as f32), zero)
}

pub(super) fn scale_of(inputs: &PassInputs) -> [f32; 2] {
    inputs.occluders.scale(inputs.light).map(|s| s as f32)
}

fn gather_map(
    graph: &mut Graph,
    nodes: &Nodes,
    receiver_depth: ResourceId,
    side: u32,
    settings: &Settings,
    inputs: &PassInputs,
    view: &MapView,
) -> ResourceId {
    const NAMES: [[&str; 2]; 2] = [
        ["soft_shadow_map.front_map", "soft_shadow_map.gather_front"],
        ["soft_shadow_map.back_map", "soft_shadow_map.gather_back"],
    ];
    let [map_name, pass_name] = NAMES[side as usize];
    let size = [settings.receiver_map; 2];
    let map = graph.image(map_name, vk::Format::R32_SFLOAT, size, Owner::Transient);
    let (t_step, t_first) = receiver_grid(view, inputs.occluders);
    // 8×8 invocations of 2×2 texels.
    let groups = settings.receiver_map.div_ceil(16);
    graph.push(Pass::compute(
        pass_name,
        shaders::GATHER_MAP,
        [groups, groups, 1],
        Push::new(&push::GatherMap {
            scale: scale_of(inputs),
            t_step,
            t_first,
            w_max: (1.0 / inputs.occluders.near) as f32,
            spread: spread_of(settings.tolerance),
            receiver_inv_near: (1.0 / view.near) as f32,
            receiver_map: settings.receiver_map as i32,
            row: nodes.superblock_row as i32,
            side: match (side, settings.sides) {
                (1, Sides::Mean) => BACK_OR_FRONT,
                _ => side as i32,
            },
        }),
        smallvec![
            Use::bound(0, receiver_depth, Access::SampledCompute),
            Use::bound(1, nodes.texels, Access::BufferReadCompute),
            Use::bound(2, nodes.sums, Access::BufferReadCompute),
            Use::bound(3, nodes.families, Access::BufferReadCompute),
            Use::bound(4, map, Access::ImageWrite),
        ],
        inputs.need,
    ));
    map
}

fn blend_map(
    graph: &mut Graph,
    nodes: &Nodes,
    receiver_depth: ResourceId,
    side: u32,
    settings: &Settings,
    inputs: &PassInputs,
    view: &MapView,
) -> ResourceId {
    const NAMES: [[&str; 5]; 2] = [
        [
            "soft_shadow_map.front_map",
            "soft_shadow_map.patch_count_front",
            "soft_shadow_map.patch_scan_front",
            "soft_shadow_map.patch_emit_front",
            "soft_shadow_map.blend_front",
        ],
        [
            "soft_shadow_map.back_map",
            "soft_shadow_map.patch_count_back",
            "soft_shadow_map.patch_scan_back",
            "soft_shadow_map.patch_emit_back",
            "soft_shadow_map.blend_back",
        ],
    ];
    const BUFFERS: [[&str; 4]; 2] = [
        [
            "soft_shadow_map.front_groups",
            "soft_shadow_map.front_offsets",
            "soft_shadow_map.front_arguments",
            "soft_shadow_map.front_patches",
        ],
        [
            "soft_shadow_map.back_groups",
            "soft_shadow_map.back_offsets",
            "soft_shadow_map.back_arguments",
            "soft_shadow_map.back_patches",
        ],
    ];
    let [map_name, count_name, scan_name, emit_name, blend_name] = NAMES[side as usize];
    let format = if settings.accumulate == Accumulate::BlendFp16 {
        vk::Format::R16_SFLOAT
    } else {
        vk::Format::R32_SFLOAT
    };
    let map = graph.image(map_name, format, [settings.receiver_map; 2], Owner::Transient);
    let blocks = nodes.block_row * nodes.block_row;
    let groups = blocks.div_ceil(GROUP);
    let texels = u64::from(inputs.occluders.side).pow(2);
    let [counts, offsets, arguments, patches] = BUFFERS[side as usize];
    let counts = graph.buffer(counts, u64::from(groups) * 4);
    let offsets = graph.buffer(offsets, u64::from(groups) * 4);
    let arguments = graph.buffer(arguments, 16);
    let patches = graph.buffer(patches, texels * 8);
    graph.push(Pass::compute(
        count_name,
        shaders::PATCH_COUNT,
        [groups.div_ceil(64), 1, 1],
        Push::new(&push::PatchCount { blocks: blocks as i32, side: side as i32 }),
        smallvec![
            Use::bound(0, nodes.blocks, Access::BufferReadCompute),
            Use::bound(1, counts, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    graph.push(Pass::compute(
        scan_name,
        shaders::PATCH_SCAN,
        [1, 1, 1],
        Push::new(&push::PatchScan { groups: groups as i32 }),
        smallvec![
            Use::bound(0, counts, Access::BufferReadCompute),
            Use::bound(1, offsets, Access::BufferWriteCompute),
            Use::bound(2, arguments, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    graph.push(Pass::compute(
        emit_name,
        shaders::PATCH_EMIT,
        [blocks.div_ceil(64), 1, 1],
        Push::new(&push::PatchEmit { row: nodes.block_row as i32, side: side as i32 }),
        smallvec![
            Use::bound(0, nodes.texels, Access::BufferReadCompute),
            Use::bound(1, nodes.blocks, Access::BufferReadCompute),
            Use::bound(2, offsets, Access::BufferReadCompute),
            Use::bound(3, patches, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    let (t_step, t_first) = receiver_grid(view, inputs.occluders);
    graph.push(Pass {
        name: blend_name,
        uses: smallvec![
            Use::fixed(map, Access::ColorTarget),
            Use::fixed(arguments, Access::Indirect),
            Use::bound(0, patches, Access::BufferReadVertex),
            Use::bound(1, receiver_depth, Access::SampledFragment),
        ],
        push: Push::new(&push::PatchDraw {
            scale: scale_of(inputs),
            t_step,
            t_first,
            w_far: (1.0 / view.far) as f32,
            receiver_inv_near: (1.0 / view.near) as f32,
            receiver_map: settings.receiver_map as i32,
            steps: if settings.accumulate == Accumulate::Blend { BLEND_STEPS } else { 0.0 },
        }),
        work: Work::Raster {
            vertex: shaders::PATCH_VERT,
            fragment: Some(shaders::PATCH_FRAG),
            cull: vk::CullModeFlags::NONE,
            target: Target::Add,
            draw: Draw::Indirect { arguments, offset: 0 },
        },
        need: *inputs.need,
    });
    map
}
