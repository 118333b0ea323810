//! The rows that say where a line's samples are, and those that draw what they see.

use super::passes::OfLine;
use super::push;
use crate::graph::{Access, Draw, Graph, Layer, Pass, Push, ResourceId, Target, Use, Work};
use crate::shaders;
use crate::stages::depth_layers::{self, Raster};
use crate::stages::visibility::grid;
use smallvec::smallvec;

/// Receivers along and across the rows of `mask.comp`'s grid.
pub(super) const RECEIVERS: [u32; 2] = [128, 32];

/// What samples see.
pub(super) struct Layers {
    /// Where they are.
    pub of: ResourceId,
    /// The nearest occluders and receivers as one of them sees them: drawn into, and taken from.
    pub occluders: ResourceId,
    pub receivers: ResourceId,
    /// Two that lie side by side.
    pub seen: ResourceId,
    /// What receivers see of the line.
    pub masks: ResourceId,
}

/// Adds the rows that place a line's samples: evenly, or where its middle tells that light is lost.
pub(super) fn place(graph: &mut Graph, of: &OfLine) {
    let OfLine { made, settings, inputs, line, .. } = *of;
    let layers = &made.layers;
    if settings.is_even() {
        graph.push(Pass::compute(
            "linear_light.spread",
            shaders::LINE_SPREAD,
            [1, 1, 1],
            Push::new(&push::Spread { count: settings.samples as i32 }),
            smallvec![Use::bound(0, layers.of, Access::BufferWriteCompute)],
            inputs.need,
        ));
        return;
    }
    graph.push(drawn("linear_light.middle_occluders", layers.occluders, Layer::Front, None, of));
    graph.push(drawn(
        "linear_light.middle_receivers",
        layers.receivers,
        Layer::Receivers,
        None,
        of,
    ));
    let taken = take(of, 0);
    graph.push(Pass {
        name: "linear_light.middle_take",
        uses: taken.uses.iter().copied().filter(|u| u.access != Access::Indirect).collect(),
        work: Work::Dispatch { shader: shaders::LINE_TAKE, groups: grid([settings.map; 2]) },
        ..taken
    });
    graph.push(Pass::compute(
        "linear_light.mask",
        shaders::LINE_MASK,
        grid(RECEIVERS),
        Push::new(&push::Mask {
            u_window: line.u_window(),
            line: line.length(),
            map: settings.map as i32,
        }),
        smallvec![
            Use::bound(0, layers.seen, Access::SampledCompute),
            Use::bound(1, layers.masks, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    graph.push(Pass::compute(
        "linear_light.place",
        shaders::LINE_PLACE,
        [1, 1, 1],
        Push::new(&push::Place {
            error: settings.error,
            most: settings.samples as i32,
            even: i32::from(line.is_touched()),
        }),
        smallvec![
            Use::bound(0, layers.masks, Access::BufferReadCompute),
            Use::bound(1, layers.of, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
}

/// Adds the rows that draw what a sample sees.
pub(super) fn look(graph: &mut Graph, of: &OfLine, nth: u32) {
    let layers = &of.made.layers;
    graph.push(drawn("linear_light.occluders", layers.occluders, Layer::Front, Some(nth), of));
    graph.push(drawn("linear_light.receivers", layers.receivers, Layer::Receivers, Some(nth), of));
}

/// The row that draws a layer as a sample sees it, or as the line's middle does.
fn drawn(
    name: &'static str,
    image: ResourceId,
    layer: Layer,
    sample: Option<u32>,
    of: &OfLine,
) -> Pass {
    let Raster { cull, clear, compare } = depth_layers::raster_of(layer);
    let mut uses = smallvec![Use::fixed(image, Access::DepthTarget)];
    uses.extend(sample.map(|_| Use::bound(0, of.made.layers.of, Access::BufferReadVertex)));
    Pass {
        name,
        uses,
        push: Push::new(&push::Sample {
            line_from_mesh: [0.0; 16],
            u_window: of.line.u_window(),
            line: of.line.length(),
            nth: sample.map_or(-1, |nth| nth as i32),
        }),
        work: Work::Raster {
            vertex: if sample.is_some() { shaders::SAMPLE_VERT } else { shaders::MIDDLE_VERT },
            fragment: None,
            cull,
            target: Target::Depth { clear, compare },
            draw: Draw::Layer { layer, view: of.row },
        },
        need: *of.inputs.need,
    }
}

/// The row that takes what was drawn into a layer.
pub(super) fn take(of: &OfLine, layer: u32) -> Pass {
    let layers = &of.made.layers;
    Pass {
        name: "linear_light.take",
        uses: smallvec![
            Use::fixed(of.made.groups, Access::Indirect),
            Use::bound(0, layers.occluders, Access::SampledCompute),
            Use::bound(1, layers.receivers, Access::SampledCompute),
            Use::bound(2, layers.seen, Access::ImageWrite),
        ],
        push: Push::new(&push::Take {
            inv_near: (1.0 / of.line.near) as f32,
            map: of.settings.map as i32,
            layer: layer as i32,
        }),
        work: Work::Indirect { shader: shaders::LINE_TAKE, arguments: of.made.groups, offset: 0 },
        need: *of.inputs.need,
    }
}
