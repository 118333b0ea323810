//! The rows that say where a line's samples are, and those that draw what they see.

use super::passes::{Inputs, Made};
use super::push;
use super::settings::Settings;
use super::view::Line;
use crate::depth_layers::{self, Raster};
use crate::graph::{Access, Draw, Graph, Layer, Pass, Push, ResourceId, Target, Use, Work};
use crate::shaders;
use crate::visibility::grid;

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
pub(super) fn place(
    graph: &mut Graph,
    made: &Made,
    settings: &Settings,
    view: u32,
    line: &Line,
    inputs: &Inputs,
) {
    let layers = &made.layers;
    if settings.is_even() {
        graph.push(Pass::compute(
            "linear_light.spread",
            shaders::LINE_SPREAD,
            [1, 1, 1],
            Push::new(&push::Spread { count: settings.samples as i32 }),
            vec![Use::bound(0, layers.of, Access::BufferWriteCompute)],
            inputs.need,
        ));
        return;
    }
    let middle = |kind| match kind {
        Layer::Front => ("linear_light.middle_occluders", layers.occluders),
        _ => ("linear_light.middle_receivers", layers.receivers),
    };
    for kind in [Layer::Front, Layer::Receivers] {
        let (name, image) = middle(kind);
        let uses = vec![Use::fixed(image, Access::DepthTarget)];
        draw(graph, name, uses, shaders::MIDDLE_VERT, kind, -1, view, line, inputs);
    }
    let side = inputs.side;
    let taken = take(made, 0, line, inputs);
    graph.push(Pass {
        name: "linear_light.middle_take",
        uses: taken.uses.iter().copied().filter(|u| u.access != Access::Indirect).collect(),
        work: Work::Dispatch { shader: shaders::LINE_TAKE, groups: grid([side; 2]) },
        ..taken
    });
    graph.push(Pass::compute(
        "linear_light.mask",
        shaders::LINE_MASK,
        grid(RECEIVERS),
        Push::new(&push::Mask { u_window: line.u_window(), line: line.length(), map: side as i32 }),
        vec![
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
        vec![
            Use::bound(0, layers.masks, Access::BufferReadCompute),
            Use::bound(1, layers.of, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
}

/// Adds the rows that draw what a sample sees.
pub(super) fn look(
    graph: &mut Graph,
    made: &Made,
    nth: u32,
    view: u32,
    line: &Line,
    inputs: &Inputs,
) {
    let layers = &made.layers;
    for (name, image, kind) in [
        ("linear_light.occluders", layers.occluders, Layer::Front),
        ("linear_light.receivers", layers.receivers, Layer::Receivers),
    ] {
        let uses = vec![
            Use::fixed(image, Access::DepthTarget),
            Use::bound(0, layers.of, Access::BufferReadVertex),
        ];
        draw(graph, name, uses, shaders::SAMPLE_VERT, kind, nth as i32, view, line, inputs);
    }
}

#[allow(clippy::too_many_arguments, reason = "a row has as many columns")]
fn draw(
    graph: &mut Graph,
    name: &'static str,
    uses: Vec<Use>,
    vertex: shaders::Module,
    layer: Layer,
    nth: i32,
    view: u32,
    line: &Line,
    inputs: &Inputs,
) {
    let Raster { cull, clear, compare } = depth_layers::raster_of(layer);
    graph.push(Pass {
        name,
        uses,
        push: Push::new(&push::Sample {
            line_from_mesh: [0.0; 16],
            u_window: line.u_window(),
            line: line.length(),
            nth,
        }),
        work: Work::Raster {
            vertex,
            fragment: None,
            cull,
            target: Target::Depth { clear, compare },
            draw: Draw::Layer { layer, view },
        },
        need: inputs.need.clone(),
    });
}

/// The row that takes what was drawn into a layer.
pub(super) fn take(made: &Made, layer: u32, line: &Line, inputs: &Inputs) -> Pass {
    let layers = &made.layers;
    Pass {
        name: "linear_light.take",
        uses: vec![
            Use::fixed(made.groups, Access::Indirect),
            Use::bound(0, layers.occluders, Access::SampledCompute),
            Use::bound(1, layers.receivers, Access::SampledCompute),
            Use::bound(2, layers.seen, Access::ImageWrite),
        ],
        push: Push::new(&push::Take {
            inv_near: (1.0 / line.near) as f32,
            map: inputs.side as i32,
            layer: layer as i32,
        }),
        work: Work::Indirect { shader: shaders::LINE_TAKE, arguments: made.groups, offset: 0 },
        need: inputs.need.clone(),
    }
}
