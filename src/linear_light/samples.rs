//! The rows that draw what samples see, and those that say which samples a line needs.

use super::passes::{Inputs, Made};
use super::settings::Settings;
use super::view::Line;
use super::push;
use crate::depth_layers;
use crate::graph::{Access, Draw, Graph, Layer, Pass, Push, ResourceId, Target, Use, Work};
use crate::shaders;
use crate::visibility::grid;

/// What samples see.
pub(super) struct Layers {
    /// The nearest occluders and receivers as one of them sees them: drawn into, and taken from.
    pub occluders: ResourceId,
    pub receivers: ResourceId,
    /// A layer each.
    pub seen: ResourceId,
    /// Which of them there are.
    pub tree: ResourceId,
}

/// Adds the row that starts a line.
pub(super) fn begin(graph: &mut Graph, made: &Made, inputs: &Inputs) {
    graph.push(Pass::compute(
        "linear_light.begin",
        shaders::LINE_BEGIN,
        [1, 1, 1],
        Push::NONE,
        vec![Use::bound(0, made.layers.tree, Access::BufferWriteCompute)],
        inputs.make,
    ));
}

/// Adds the rows that draw what a node of a line sees, and take it into a layer.
pub(super) fn draw(
    graph: &mut Graph,
    made: &Made,
    settings: &Settings,
    (nth, node): (usize, u32),
    layer: u32,
    line: &Line,
    inputs: &Inputs,
) {
    let layers = &made.layers;
    let view = nth as u32 * settings.nodes().len() as u32 + node;
    for (name, image, kind) in [
        ("linear_light.occluders", layers.occluders, Layer::Front),
        ("linear_light.receivers", layers.receivers, Layer::Receivers),
    ] {
        if settings.is_even() {
            depth_layers::draw(graph, name, image, kind, view, inputs.make);
            continue;
        }
        let depth_layers::Raster { cull, clear, compare } = depth_layers::raster_of(kind);
        graph.push(Pass {
            name,
            uses: vec![
                Use::fixed(image, Access::DepthTarget),
                Use::bound(0, layers.tree, Access::BufferReadVertex),
            ],
            push: Push::new(&push::Sample { clip_from_mesh: [0.0; 16], node: node as i32 }),
            work: Work::Raster {
                vertex: shaders::SAMPLE_VERT,
                fragment: None,
                cull,
                target: Target::Depth { clear, compare },
                draw: Draw::Layer { layer: kind, view },
            },
            need: inputs.make.clone(),
        });
    }
    graph.push(Pass::compute(
        "linear_light.take",
        shaders::LINE_TAKE,
        grid([inputs.side; 2]),
        Push::new(&push::Take {
            inv_near: (1.0 / line.near) as f32,
            map: inputs.side as i32,
            layer: layer as i32,
        }),
        vec![
            Use::bound(0, layers.occluders, Access::SampledCompute),
            Use::bound(1, layers.receivers, Access::SampledCompute),
            Use::bound(2, layers.seen, Access::ImageWrite),
        ],
        inputs.make,
    ));
}

/// Adds the rows that find a line's samples: the ends, and round by round what lies between two of them.
pub(super) fn declare_tree(
    graph: &mut Graph,
    made: &Made,
    settings: &Settings,
    nth: usize,
    line: &Line,
    inputs: &Inputs,
) {
    let layers = &made.layers;
    for end in 0..2 {
        draw(graph, made, settings, (nth, end), end, line, inputs);
    }
    for round in 1..=settings.rounds() {
        let (first, count) = ((1 << (round - 1)) + 1, 1 << (round - 1));
        for node in first..first + count {
            draw(graph, made, settings, (nth, node), node, line, inputs);
        }
        let [x, y, _] = grid([inputs.side; 2]);
        graph.push(Pass::compute(
            "linear_light.measure",
            shaders::LINE_MEASURE,
            [x, y, count],
            Push::new(&push::Measure {
                u_window: line.u_window(),
                line: (2.0 * line.half) as f32,
                map: inputs.side as i32,
                round: round as i32,
            }),
            vec![
                Use::bound(0, layers.seen, Access::SampledCompute),
                Use::bound(1, layers.tree, Access::BufferUpdate),
            ],
            inputs.make,
        ));
        graph.push(Pass::compute(
            "linear_light.choose",
            shaders::LINE_CHOOSE,
            [1, 1, 1],
            Push::new(&push::Choose {
                error: settings.error,
                most: settings.samples as i32,
                round: round as i32,
                rounds: settings.rounds() as i32,
            }),
            vec![Use::bound(0, layers.tree, Access::BufferUpdate)],
            inputs.make,
        ));
    }
}
