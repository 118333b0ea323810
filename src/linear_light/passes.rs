//! The rows: two samples' maps → skins → channels, segment by segment; pixels → visible fractions.

use super::push;
use super::settings::{Settings, Transition, skin_bytes};
use super::view::Windows;
use crate::RectangleLight;
use crate::baseline::many_lights::LightPoint;
use crate::depth_layers;
use crate::graph::{
    Access, Draw, Graph, Layer, Need, Owner, Pass, Push, ResourceId, Target, Use, Work,
};
use crate::shaders;
use crate::visibility::{GBuffer, grid};
use ash::vk;

/// What a frame gives the technique.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// The light, longer along x than along y.
    pub light: &'a RectangleLight,
    /// The samples of all lines, line by line.
    pub samples: &'a [LightPoint],
    /// What they see.
    pub windows: &'a Windows,
    /// The w of the furthest receiver, 1/m.
    pub w_far: f64,
    /// The host's pixels.
    pub gbuffer: &'a GBuffer,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// Whether anything can be shadowed.
    pub need: &'a Need,
}

/// The maps of a segment's samples.
#[derive(Clone, Copy)]
struct Slots {
    occluders: [ResourceId; 2],
    receivers: [ResourceId; 2],
}

/// What one side of a segment makes of the other's occluders.
struct Side {
    edges: &'static str,
    draw: &'static str,
    /// Which ends of occluders are seen past.
    towards: i32,
    skins: ResourceId,
    arguments: ResourceId,
    channel: ResourceId,
}

/// What a segment is made in, and what is made of all of them.
struct Made {
    slots: Slots,
    left: Side,
    right: Side,
    maps: ResourceId,
}

/// Adds the rows that turn the meshes, as the samples see them, into `visibility`.
pub fn declare(graph: &mut Graph, visibility: ResourceId, settings: &Settings, inputs: &Inputs) {
    let side = inputs.samples.first().map_or(16, |s| s.view.side);
    let depth = |graph: &mut Graph, name| {
        graph.image(name, depth_layers::FORMAT, [side; 2], Owner::Transient)
    };
    let slots = Slots {
        occluders: ["linear_light.occluders_0", "linear_light.occluders_1"]
            .map(|n| depth(graph, n)),
        receivers: ["linear_light.receivers_0", "linear_light.receivers_1"]
            .map(|n| depth(graph, n)),
    };
    let bytes = skin_bytes(side);
    let left = Side {
        edges: "linear_light.left_edges",
        draw: "linear_light.left_skins",
        towards: -1,
        skins: graph.buffer("linear_light.left_skins", bytes),
        arguments: graph.buffer("linear_light.left_draw", 16),
        channel: depth(graph, "linear_light.left_channel"),
    };
    let right = Side {
        edges: "linear_light.right_edges",
        draw: "linear_light.right_skins",
        towards: 1,
        skins: graph.buffer("linear_light.right_skins", bytes),
        arguments: graph.buffer("linear_light.right_draw", 16),
        channel: depth(graph, "linear_light.right_channel"),
    };
    let format = vk::Format::R32G32B32A32_SFLOAT;
    let maps = graph.image_array("linear_light.maps", format, [side; 2], settings.segments());
    let made = Made { slots, left, right, maps };
    let samples = settings.samples as usize;
    for (line, of_line) in inputs.samples.chunks(samples).enumerate() {
        for (nth, sample) in of_line.iter().enumerate() {
            let view = (line * samples + nth) as u32;
            draw_maps(graph, &made.slots, nth % 2, view, inputs);
            let Some(before) = nth.checked_sub(1).and_then(|b| of_line.get(b)) else { continue };
            let segment = (line * (samples - 1) + nth - 1) as i32;
            // The first sample's neighbour sees what ends towards it, and the other way round.
            let ends = [(before, (nth - 1) % 2), (sample, nth % 2)];
            declare_segment(graph, &made, &ends, segment, settings, inputs);
        }
    }
    let gbuffer = inputs.gbuffer;
    let f32s = |w: &[[f64; 2]; 2]| [w[0][0], w[0][1], w[1][0], w[1][1]].map(|x| x as f32);
    graph.push(Pass::compute(
        "linear_light.visibility",
        shaders::LINE_VISIBILITY,
        grid(gbuffer.extent),
        Push::new(&push::Visibility {
            light_from_ndc: gbuffer.light_from_ndc,
            u_window: f32s(&inputs.windows.u),
            v_window: f32s(&inputs.windows.v),
            half_light: inputs.light.half_extents().map(|x| x as f32),
            extent: gbuffer.extent.map(|e| e as i32),
            background: gbuffer.background,
            snap: inputs.snap,
            map: side as i32,
            flags: (settings.samples | settings.lines << 8) as i32
                | i32::from(gbuffer.mask.is_some()) << 16,
        }),
        vec![
            Use::bound(0, gbuffer.depth, Access::SampledCompute),
            Use::bound(1, gbuffer.mask.unwrap_or(gbuffer.depth), Access::SampledCompute),
            Use::bound(2, maps, Access::SampledCompute),
            Use::bound(3, visibility, Access::ImageWrite),
        ],
        inputs.need,
    ));
}

const DRAWN: [(Layer, [&str; 2]); 2] = [
    (Layer::Front, ["linear_light.occluders_0", "linear_light.occluders_1"]),
    (Layer::Receivers, ["linear_light.receivers_0", "linear_light.receivers_1"]),
];

/// Adds the rows that draw what a sample sees.
fn draw_maps(graph: &mut Graph, slots: &Slots, slot: usize, view: u32, inputs: &Inputs) {
    for ((layer, names), images) in DRAWN.into_iter().zip([slots.occluders, slots.receivers]) {
        depth_layers::draw(graph, names[slot], images[slot], layer, view, inputs.need);
    }
}

/// Adds the rows that make a segment's channels of the maps of its ends, of which each is in a slot.
fn declare_segment(
    graph: &mut Graph,
    Made { slots, left, right, maps }: &Made,
    ends: &[(&LightPoint, usize); 2],
    segment: i32,
    settings: &Settings,
    inputs: &Inputs,
) {
    graph.push(Pass::compute(
        "linear_light.start",
        shaders::SKIN_START,
        [1, 1, 1],
        Push::NONE,
        vec![
            Use::bound(0, left.arguments, Access::BufferWriteCompute),
            Use::bound(1, right.arguments, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    let [first, last] = ends;
    declare_skins(graph, slots, left, *last, *first, settings, inputs);
    declare_skins(graph, slots, right, *first, *last, settings, inputs);
    let view = &first.0.view;
    graph.push(Pass::compute(
        "linear_light.keep",
        shaders::KEEP,
        grid([view.side; 2]),
        Push::new(&push::Keep {
            inv_near: (1.0 / view.near) as f32,
            map: view.side as i32,
            slot: first.1 as i32,
            segment,
        }),
        vec![
            Use::bound(0, slots.occluders[0], Access::SampledCompute),
            Use::bound(1, slots.occluders[1], Access::SampledCompute),
            Use::bound(2, left.channel, Access::SampledCompute),
            Use::bound(3, right.channel, Access::SampledCompute),
            Use::bound(4, *maps, Access::ImageWrite),
        ],
        inputs.need,
    ));
}

/// Adds the rows that find where occluders end as `from` sees them, and draw that into the channel of `to`.
fn declare_skins(
    graph: &mut Graph,
    slots: &Slots,
    side: &Side,
    from: (&LightPoint, usize),
    to: (&LightPoint, usize),
    settings: &Settings,
    inputs: &Inputs,
) {
    let bound = |first: u32, access| {
        [slots.occluders[0], slots.receivers[0], slots.occluders[1], slots.receivers[1]]
            .into_iter()
            .zip(first..)
            .map(move |(image, binding)| Use::bound(binding, image, access))
    };
    let (seen, drawn) = (&from.0.view, &to.0.view);
    let mut uses: Vec<_> = bound(0, Access::SampledCompute).collect();
    uses.push(Use::bound(4, side.skins, Access::BufferWriteCompute));
    uses.push(Use::bound(5, side.arguments, Access::BufferUpdate));
    graph.push(Pass::compute(
        side.edges,
        shaders::EDGES,
        grid([seen.side; 2]),
        Push::new(&push::Edges {
            u_first: seen.min[0] as f32,
            u_step: (1.0 / seen.texels_per_uv()[0]) as f32,
            inv_near: (1.0 / seen.near) as f32,
            map: seen.side as i32,
            slot: from.1 as i32,
            side: side.towards,
        }),
        uses,
        inputs.need,
    ));
    let mut uses = vec![
        Use::fixed(side.channel, Access::DepthTarget),
        Use::fixed(side.arguments, Access::Indirect),
        Use::bound(0, side.skins, Access::BufferReadVertex),
    ];
    uses.extend(bound(1, Access::SampledFragment));
    graph.push(Pass {
        name: side.draw,
        uses,
        push: Push::new(&push::Skins {
            texels_per_u: drawn.texels_per_uv()[0] as f32,
            first: drawn.first()[0] as f32,
            apart: (from.0.at[0] - to.0.at[0]) as f32,
            w_far: inputs.w_far as f32,
            inv_near: (1.0 / drawn.near) as f32,
            map: drawn.side as i32,
            slot: to.1 as i32,
            rational: i32::from(settings.transition == Transition::Rational),
        }),
        work: Work::Raster {
            vertex: shaders::SKINS_VERT,
            fragment: Some(shaders::SKINS_FRAG),
            cull: vk::CullModeFlags::NONE,
            target: Target::Depth { clear: 1.0, compare: vk::CompareOp::LESS },
            draw: Draw::Indirect { arguments: side.arguments },
        },
        need: inputs.need.clone(),
    });
}
