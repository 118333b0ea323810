//! The soft shadow map: the occlusion of each texel of a receiver map by the patches, gathered or blended.

use super::nodes::{Nodes, scale_of};
use super::settings::{Accumulate, Settings, Sides, spread_of};
use crate::graph::{Access, Draw, Graph, Owner, Pass, Push, ResourceId, Target, Use, Work};
use crate::shaders::{self, module};
use crate::stages::depth_layers::MapView;
use crate::techniques::room::PassInputs;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The value of `BACK_OR_FRONT` in `gather.glsl`: each texel's back face where it lies before the receiver, else its
/// front face.
const BACK_OR_FRONT: i32 = 2;

/// Blended contributions are multiples of 2⁻²⁴ (`patch.frag`).
pub const BLEND_STEPS: f32 = 16_777_216.0;

/// The number of blocks in a group (`patch_count.comp`).
const GROUP: u32 = 64;

/// The receiver texels' places in occluder texels: the step, and the centre of texel (0, 0).
pub fn receiver_grid(view: &MapView, occluders: &MapView) -> ([f32; 2], [f32; 2]) {
    let (per, first) = (occluders.texels_per_uv(), occluders.first());
    let receiver_per = view.texels_per_uv();
    let step = [0, 1].map(|i| per[i] / receiver_per[i]);
    let zero = [0, 1].map(|i| (view.min[i] * per[i] + first[i] + 0.5 * step[i]) as f32);
    (step.map(|s| s as f32), zero)
}

/// The push constants of `gather_map.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GatherMap {
    /// (Δu/Lx, Δv/Ly), 1/m.
    pub scale: [f32; 2],
    /// Occluder texels a receiver texel.
    pub t_step: [f32; 2],
    /// The occluder-map position of the centre of receiver texel (0, 0), in texels.
    pub t_first: [f32; 2],
    /// No occluder is nearer than 1/w_max.
    pub w_max: f32,
    /// The largest |δ| of the series, see [`super::settings::spread_of`].
    pub spread: f32,
    /// 1 over the receiver map's near plane, 1/m.
    pub receiver_inv_near: f32,
    /// The receiver map's side in texels.
    pub receiver_map: i32,
    /// The number of superblocks in a row of the map.
    pub row: i32,
    /// Where the prefix sums begin among the nodes, in 16 bytes.
    pub sums: i32,
    /// 0 front, 1 back.
    pub side: i32,
}

pub(super) fn gather_map(
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
    // A workgroup of 8×8 invocations handles 2×2 texels each.
    let groups = settings.receiver_map.div_ceil(16);
    graph.push(Pass::compute(
        pass_name,
        module!("soft_shadow_map/gather_map.comp"),
        [groups, groups, 1],
        Push::new(&GatherMap {
            scale: scale_of(inputs),
            t_step,
            t_first,
            w_max: inputs.occluders.top() as f32,
            spread: spread_of(settings.tolerance),
            receiver_inv_near: view.top() as f32,
            receiver_map: settings.receiver_map as i32,
            row: nodes.superblock_row as i32,
            sums: nodes.sums as i32,
            side: match (side, settings.sides) {
                (1, Sides::Mean) => BACK_OR_FRONT,
                _ => side as i32,
            },
        }),
        smallvec![
            Use::bound(0, receiver_depth, Access::SampledCompute),
            Use::bound(1, nodes.texels, Access::BufferReadCompute),
            Use::bound(2, nodes.families, Access::BufferReadCompute),
            Use::bound(3, map, Access::ImageWrite),
        ],
        inputs.need,
    ));
    map
}

/// The push constants of `patch_count.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PatchCount {
    /// The number of blocks of one side.
    pub blocks: i32,
    /// 0 front, 1 back.
    pub side: i32,
}

/// The push constants of `patch_scan.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PatchScan {
    /// The number of groups of 64 blocks.
    pub groups: i32,
}

/// The push constants of `patch_emit.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PatchEmit {
    /// The number of blocks in a row of the map.
    pub row: i32,
    /// 0 front, 1 back.
    pub side: i32,
}

/// The push constants of `patch.vert` and `patch.frag`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PatchDraw {
    /// (Δu/Lx, Δv/Ly), 1/m.
    pub scale: [f32; 2],
    /// Occluder texels a receiver texel.
    pub t_step: [f32; 2],
    /// The occluder-map position of the centre of receiver texel (0, 0), in texels.
    pub t_first: [f32; 2],
    /// No receiver is further than 1/w_far.
    pub w_far: f32,
    /// 1 over the receiver map's near plane, 1/m.
    pub receiver_inv_near: f32,
    /// The receiver map's side in texels.
    pub receiver_map: i32,
    /// Contributions are rounded to multiples of 1/steps of the light; 0 rounds none.
    pub steps: f32,
}

pub(super) fn blend_map(
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
        module!("soft_shadow_map/patch_count.comp"),
        [groups.div_ceil(64), 1, 1],
        Push::new(&PatchCount { blocks: blocks as i32, side: side as i32 }),
        smallvec![
            Use::bound(0, nodes.blocks, Access::BufferReadCompute),
            Use::bound(1, counts, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    graph.push(Pass::compute(
        scan_name,
        module!("soft_shadow_map/patch_scan.comp"),
        [1, 1, 1],
        Push::new(&PatchScan { groups: groups as i32 }),
        smallvec![
            Use::bound(0, counts, Access::BufferReadCompute),
            Use::bound(1, offsets, Access::BufferWriteCompute),
            Use::bound(2, arguments, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    graph.push(Pass::compute(
        emit_name,
        module!("soft_shadow_map/patch_emit.comp"),
        [blocks.div_ceil(64), 1, 1],
        Push::new(&PatchEmit { row: nodes.block_row as i32, side: side as i32 }),
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
        push: Push::new(&PatchDraw {
            scale: scale_of(inputs),
            t_step,
            t_first,
            w_far: (1.0 / view.far) as f32,
            receiver_inv_near: view.top() as f32,
            receiver_map: settings.receiver_map as i32,
            steps: if settings.accumulate == Accumulate::Blend { BLEND_STEPS } else { 0.0 },
        }),
        work: Work::Raster {
            vertex: module!("soft_shadow_map/patch.vert"),
            fragment: Some(shaders::PATCH_FRAG),
            cut: None,
            cull: vk::CullModeFlags::NONE,
            target: Target::Add,
            draw: Draw::Indirect { arguments, offset: 0 },
        },
        need: *inputs.need,
    });
    map
}
