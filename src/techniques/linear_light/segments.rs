//! The rows that make channels of a line's samples, segment by segment.

use super::passes::OfLine;
use super::push;
use super::settings::Transition;
use crate::graph::{Access, Draw, Graph, Pass, Push, ResourceId, Target, Use, Work};
use crate::shaders;
use crate::stages::visibility::grid;
use ash::vk;
use smallvec::smallvec;

/// Where in [`super::passes::Made::groups`] the grids of a segment's rows are, and of the row that keeps the sample before.
const SEGMENT: u64 = 16;
const SAMPLE_BEFORE: u64 = 32;

/// What one sample of a segment makes of the other's occluders.
pub(super) struct Skins {
    pub edges: &'static str,
    pub draw: &'static str,
    /// Which ends of occluders are seen past: -1, those towards −x.
    pub side: i32,
    pub skins: ResourceId,
    /// Of the draw's arguments in [`super::passes::Made::draws`].
    pub offset: u64,
    pub channel: ResourceId,
}

/// Adds the rows of the segment before a sample, and what they leave of the sample before it.
pub(super) fn declare(graph: &mut Graph, of: &OfLine, nth: u32) {
    // The first one's neighbour sees what ends towards it. Only then is what the segment before drew into the first
    // one's other channel done with.
    skins(graph, of, &of.made.left);
    keep(graph, of, nth);
    skins(graph, of, &of.made.right);
}

/// Adds the row that says which of the rows of a sample and of the segment before it have anything to do.
pub(super) fn start(graph: &mut Graph, of: &OfLine, nth: u32) {
    let OfLine { made, settings, inputs, line, row } = *of;
    let [c, s] = line.along;
    let [x, y] = line.middle;
    graph.push(Pass::compute(
        "linear_light.start",
        shaders::SKIN_START,
        [1, 1, 1],
        Push::new(&push::Start {
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
            Use::bound(0, made.layers.of, Access::BufferReadCompute),
            Use::bound(1, made.here, Access::BufferWriteCompute),
            Use::bound(2, made.draws, Access::BufferWriteCompute),
            Use::bound(3, made.groups, Access::BufferWriteCompute),
            Use::bound(4, made.places, Access::ImageWrite),
        ],
        inputs.need,
    ));
}

/// Adds the rows that find where occluders end as one sample sees them, and draw that into the other's channel.
fn skins(graph: &mut Graph, of: &OfLine, skins: &Skins) {
    let OfLine { made, settings, inputs, line, .. } = *of;
    let map = settings.map as i32;
    graph.push(Pass {
        name: skins.edges,
        work: Work::Indirect { shader: shaders::EDGES, arguments: made.groups, offset: SEGMENT },
        push: Push::new(&push::Edges { u_window: line.u_window(), map, side: skins.side }),
        uses: smallvec![
            Use::fixed(made.groups, Access::Indirect),
            Use::bound(0, made.layers.seen, Access::SampledCompute),
            Use::bound(1, made.here, Access::BufferReadCompute),
            Use::bound(2, skins.skins, Access::BufferWriteCompute),
            Use::bound(3, made.draws, Access::BufferUpdate),
        ],
        need: *inputs.need,
    });
    graph.push(Pass {
        name: skins.draw,
        uses: smallvec![
            Use::fixed(skins.channel, Access::DepthTarget),
            Use::fixed(made.draws, Access::Indirect),
            Use::bound(0, skins.skins, Access::BufferReadVertex),
            Use::bound(1, made.here, Access::BufferReadVertex),
            Use::bound(2, made.layers.seen, Access::SampledFragment),
        ],
        push: Push::new(&push::Skins {
            u_window: line.u_window(),
            line: line.length(),
            w_far: (1.0 / inputs.receivers.far) as f32,
            map,
            side: skins.side,
            rational: i32::from(settings.transition == Transition::Rational),
        }),
        work: Work::Raster {
            vertex: shaders::SKINS_VERT,
            fragment: Some(shaders::SKINS_FRAG),
            cull: vk::CullModeFlags::NONE,
            target: Target::Depth { clear: 1.0, compare: vk::CompareOp::LESS },
            draw: Draw::Indirect { arguments: made.draws, offset: skins.offset },
        },
        need: *inputs.need,
    });
}

/// Adds the row that keeps the map of the sample before a sample.
pub(super) fn keep(graph: &mut Graph, of: &OfLine, nth: u32) {
    let OfLine { made, settings, inputs, row, .. } = *of;
    let layer = row * settings.samples + nth - 1;
    // Nothing was drawn for a segment before the first sample.
    let (name, before) = match nth {
        1 => ("linear_light.keep_first", made.left.channel),
        _ => ("linear_light.keep", made.right.channel),
    };
    graph.push(Pass {
        name,
        work: Work::Indirect {
            shader: shaders::KEEP,
            arguments: made.groups,
            offset: SAMPLE_BEFORE,
        },
        push: Push::new(&push::Keep { map: settings.map as i32, layer: layer as i32 }),
        uses: smallvec![
            Use::fixed(made.groups, Access::Indirect),
            Use::bound(0, made.layers.seen, Access::SampledCompute),
            Use::bound(1, before, Access::SampledCompute),
            Use::bound(2, made.left.channel, Access::SampledCompute),
            Use::bound(3, made.here, Access::BufferReadCompute),
            Use::bound(4, made.maps, Access::ImageWrite),
        ],
        need: *inputs.need,
    });
}
