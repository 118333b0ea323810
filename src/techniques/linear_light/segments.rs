//! The passes that make the channels of a line's samples, segment by segment.

use super::line::{LineContext, SkinSide};
use super::settings::Transition;
use crate::graph::{Access, Draw, Graph, Pass, Push, Target, Use, Work};
use crate::shaders::module;
use crate::stages::visibility::grid;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The byte offsets in [`super::line::LineResources::groups`] of the workgroups of a segment's passes, and of the pass
/// that keeps the sample before.
const SEGMENT: u64 = 16;

const SAMPLE_BEFORE: u64 = 32;

/// Adds the passes of the segment before a sample, and the one that keeps the sample before it.
pub(super) fn declare(graph: &mut Graph, ctx: &LineContext, nth: u32) {
    // Edges towards the first sample are drawn into its channel first. Only after that is its other channel, from the
    // segment before, complete and can be read.
    skins(graph, ctx, &ctx.resources.left);
    keep(graph, ctx, nth);
    skins(graph, ctx, &ctx.resources.right);
}

/// The push constants of `start.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Start {
    /// The line's x along the light's x and y; its middle, m.
    pub turn: [f32; 4],
    /// The least and largest u at the line's first end, then at its last.
    pub u_window: [f32; 4],
    /// The least and largest v.
    pub v_window: [f32; 2],
    /// The line's length, m.
    pub line: f32,
    /// The line's share of the light.
    pub weight: f32,
    /// The sample's number; the segment before it has the same number.
    pub nth: i32,
    /// The line's row of the image of places.
    pub row: i32,
    /// Workgroups along a map's side.
    pub groups: i32,
}

/// Adds the pass that begins a sample and the segment before it, and sets the workgroups of their passes.
pub(super) fn start(graph: &mut Graph, ctx: &LineContext, nth: u32) {
    let LineContext { resources, settings, inputs, line, row } = *ctx;
    let [c, s] = line.along;
    let [x, y] = line.middle;
    graph.push(Pass::compute(
        "linear_light.start",
        module!("linear_light/start.comp"),
        [1, 1, 1],
        Push::new(&Start {
            turn: [c, s, x, y].map(|x| x as f32),
            u_window: line.u_window(),
            v_window: line.v.map(|v| v as f32),
            line: line.length(),
            weight: line.weight as f32,
            nth: nth as i32,
            row: row as i32,
            groups: grid([settings.map; 2])[0] as i32,
        }),
        smallvec![
            Use::bound(0, resources.layers.samples, Access::BufferReadCompute),
            Use::bound(1, resources.segment, Access::BufferWriteCompute),
            Use::bound(2, resources.draws, Access::BufferWriteCompute),
            Use::bound(3, resources.groups, Access::BufferWriteCompute),
            Use::bound(4, resources.places, Access::ImageWrite),
        ],
        inputs.need,
    ));
}

/// The push constants of `edges.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Edges {
    /// The least and largest u at the line's first end, then at its last.
    pub u_window: [f32; 4],
    /// The maps' side in texels.
    pub map: i32,
    /// −1: occluders that end towards −x; 1: towards +x.
    pub side: i32,
}

/// The push constants of `skins.vert` and `skins.frag`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Skins {
    /// The least and largest u at the line's first end, then at its last.
    pub u_window: [f32; 4],
    /// The line's length, m.
    pub line: f32,
    /// No receiver is further than 1/w_far.
    pub w_far: f32,
    /// The maps' side in texels.
    pub map: i32,
    /// −1: skins of the last sample, drawn into the first one's channel; 1: the other way round.
    pub side: i32,
    /// 1: transition by the w of the surface behind the skin; 0: by that of the surface beside the edge.
    pub rational: i32,
}

/// Adds the passes that find where occluders end in one sample's map, and draw skins into the other's channel.
fn skins(graph: &mut Graph, ctx: &LineContext, skins: &SkinSide) {
    let LineContext { resources, settings, inputs, line, .. } = *ctx;
    let map = settings.map as i32;
    graph.push(Pass {
        name: skins.edges,
        work: Work::Indirect {
            shader: module!("linear_light/edges.comp"),
            arguments: resources.groups,
            offset: SEGMENT,
        },
        push: Push::new(&Edges { u_window: line.u_window(), map, side: skins.side }),
        uses: smallvec![
            Use::fixed(resources.groups, Access::Indirect),
            Use::bound(0, resources.layers.seen, Access::SampledCompute),
            Use::bound(1, resources.segment, Access::BufferReadCompute),
            Use::bound(2, skins.skins, Access::BufferWriteCompute),
            Use::bound(3, resources.draws, Access::BufferUpdate),
        ],
        need: *inputs.need,
    });
    graph.push(Pass {
        name: skins.draw,
        uses: smallvec![
            Use::fixed(skins.channel, Access::DepthTarget),
            Use::fixed(resources.draws, Access::Indirect),
            Use::bound(0, skins.skins, Access::BufferReadVertex),
            Use::bound(1, resources.segment, Access::BufferReadVertex),
            Use::bound(2, resources.layers.seen, Access::SampledFragment),
        ],
        push: Push::new(&Skins {
            u_window: line.u_window(),
            line: line.length(),
            w_far: (1.0 / inputs.receivers.far) as f32,
            map,
            side: skins.side,
            rational: i32::from(settings.transition == Transition::Rational),
        }),
        work: Work::Raster {
            vertex: module!("linear_light/skins.vert"),
            fragment: Some(module!("linear_light/skins.frag")),
            cut: None,
            cull: vk::CullModeFlags::NONE,
            target: Target::Depth { clear: 1.0, compare: vk::CompareOp::LESS },
            draw: Draw::Indirect { arguments: resources.draws, offset: skins.offset },
        },
        need: *inputs.need,
    });
}

/// The push constants of `keep.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Keep {
    /// The maps' side in texels.
    pub map: i32,
    /// The layer to write.
    pub layer: i32,
}

/// Adds the pass that keeps the map of the sample before a sample.
pub(super) fn keep(graph: &mut Graph, ctx: &LineContext, nth: u32) {
    let LineContext { resources, settings, inputs, row, .. } = *ctx;
    let layer = row * settings.samples + nth - 1;
    // The first sample has no segment before it.
    let (name, before) = match nth {
        1 => ("linear_light.keep_first", resources.left.channel),
        _ => ("linear_light.keep", resources.right.channel),
    };
    graph.push(Pass {
        name,
        work: Work::Indirect {
            shader: module!("linear_light/keep.comp"),
            arguments: resources.groups,
            offset: SAMPLE_BEFORE,
        },
        push: Push::new(&Keep { map: settings.map as i32, layer: layer as i32 }),
        uses: smallvec![
            Use::fixed(resources.groups, Access::Indirect),
            Use::bound(0, resources.layers.seen, Access::SampledCompute),
            Use::bound(1, before, Access::SampledCompute),
            Use::bound(2, resources.left.channel, Access::SampledCompute),
            Use::bound(3, resources.segment, Access::BufferReadCompute),
            Use::bound(4, resources.maps, Access::ImageWrite),
        ],
        need: *inputs.need,
    });
}
