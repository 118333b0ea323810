//! The passes: samples' maps → needed samples → skins → channels, line by line; then pixels → visible fractions.

use super::line::{Layers, LineContext, LineResources, SkinSide};
use super::samples;
use super::segments;
use super::settings::{MOST_SAMPLES, Settings, skin_bytes};
use crate::graph::{Access, Graph, Owner, Pass, Push, Use, Uses};
use crate::shaders::module;
use crate::stages::depth_layers;
use crate::stages::views::Line;
use crate::stages::visibility::grid;
use crate::techniques::room::PassInputs;
use ash::vk;
use bytemuck::{Pod, Zeroable};

/// The texels of a row of the image of places before its samples.
pub(super) const SAMPLES_AT: u32 = 4;

/// The push constants of `visibility.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Visibility {
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// The maps' side in texels.
    pub map: i32,
    /// The most samples of a line.
    pub most: i32,
    /// The number of lines.
    pub lines: i32,
}

/// Adds the passes that turn the meshes, as the samples see them, into the visible fraction.
pub(super) fn declare(graph: &mut Graph, settings: &Settings, inputs: &PassInputs) {
    let (side, visibility) = (settings.map, inputs.visibility);
    let format = vk::Format::R32G32B32A32_SFLOAT;
    let depth = |graph: &mut Graph, name| {
        graph.image(name, depth_layers::FORMAT, [side; 2], Owner::Transient)
    };
    let layers = Layers {
        occluders: depth(graph, "linear_light.occluders"),
        receivers: depth(graph, "linear_light.receivers"),
        samples: graph.buffer("linear_light.samples", 4 + 4 * u64::from(MOST_SAMPLES)),
        seen: graph.image_array("linear_light.seen", format, [side; 2], 2),
        masks: graph.buffer(
            "linear_light.masks",
            4 * samples::RECEIVERS.map(u64::from).iter().product::<u64>(),
        ),
    };
    let bytes = skin_bytes(side);
    let left = SkinSide {
        edges: "linear_light.left_edges",
        draw: "linear_light.left_skins",
        side: -1,
        skins: graph.buffer("linear_light.left_skins", bytes),
        offset: 0,
        channel: depth(graph, "linear_light.left_channel"),
    };
    let right = SkinSide {
        edges: "linear_light.right_edges",
        draw: "linear_light.right_skins",
        side: 1,
        skins: graph.buffer("linear_light.right_skins", bytes),
        offset: 16,
        channel: depth(graph, "linear_light.right_channel"),
    };
    let kept = settings.lines * settings.samples;
    let maps = graph.image_array("linear_light.maps", format, [side; 2], kept);
    let size = [SAMPLES_AT + settings.samples, settings.lines];
    let places = graph.image("linear_light.places", format, size, Owner::Transient);
    let resources = LineResources {
        layers,
        left,
        right,
        segment: graph.buffer("linear_light.segment", 16),
        groups: graph.buffer("linear_light.groups", 48),
        draws: graph.buffer("linear_light.draws", 32),
        maps,
        places,
    };

    let none = [Line::NONE];
    let lines = match inputs.views.lines() {
        [] => &none,
        lines => lines,
    };
    for (row, line) in lines.iter().enumerate() {
        let ctx = LineContext { resources: &resources, settings, inputs, line, row: row as u32 };
        samples::place(graph, &ctx);
        for nth in 0..settings.samples {
            samples::look(graph, &ctx, nth);
            segments::start(graph, &ctx, nth);
            graph.push(samples::copy(&ctx, nth % 2));
            if nth > 0 {
                segments::declare(graph, &ctx, nth);
            }
        }
        segments::start(graph, &ctx, settings.samples);
        segments::keep(graph, &ctx, settings.samples);
    }

    let gbuffer = inputs.gbuffer;
    let mut uses = Uses::from_slice(&gbuffer.all_bound());
    uses.extend([
        Use::bound(2, maps, Access::SampledCompute),
        Use::bound(3, places, Access::SampledCompute),
        Use::bound(4, visibility, Access::ImageWrite),
    ]);
    graph.push(Pass::compute(
        "linear_light.visibility",
        module!("linear_light/visibility.comp"),
        grid(gbuffer.extent),
        Push::new(&Visibility {
            snap: inputs.snap,
            map: side as i32,
            most: settings.samples as i32,
            lines: lines.len() as i32,
        }),
        uses,
        inputs.need,
    ));
}
