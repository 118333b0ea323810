//! The passes that place a line's samples, and those that draw what each sample sees.

use super::line::LineContext;
use crate::graph::{Access, Draw, Graph, Layer, Pass, Push, ResourceId, Target, Use, Work};
use crate::shaders::{self, module};
use crate::stages::depth_layers::{self, Raster};
use crate::stages::visibility::grid;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The grid of receivers of `mask.comp`: along and across the map's rows of texels.
pub(super) const RECEIVERS: [u32; 2] = [128, 32];

/// The push constants of `spread.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Spread {
    /// The number of samples.
    pub count: i32,
}

/// The push constants of `mask.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Mask {
    /// The least and largest u at the line's first end, then at its last.
    pub u_window: [f32; 4],
    /// The line's length, m.
    pub line: f32,
    /// The maps' side in texels.
    pub map: i32,
}

/// The push constants of `place.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Place {
    /// The allowed loss, as a share of the line.
    pub error: f32,
    /// The most samples.
    pub most: i32,
    /// 1: `most` samples, evenly spaced.
    pub even: i32,
}

/// Adds the passes that place a line's samples: evenly, or where light seen from its middle would be lost.
pub(super) fn place(graph: &mut Graph, ctx: &LineContext) {
    let LineContext { resources, settings, inputs, line, .. } = *ctx;
    let layers = &resources.layers;
    if settings.is_even() {
        graph.push(Pass::compute(
            "linear_light.spread",
            module!("linear_light/spread.comp"),
            [1, 1, 1],
            Push::new(&Spread { count: settings.samples as i32 }),
            smallvec![Use::bound(0, layers.samples, Access::BufferWriteCompute)],
            inputs.need,
        ));
        return;
    }
    graph.push(drawn("linear_light.middle_occluders", layers.occluders, Layer::Front, None, ctx));
    graph.push(drawn(
        "linear_light.middle_receivers",
        layers.receivers,
        Layer::Receivers,
        None,
        ctx,
    ));
    let copied = copy(ctx, 0);
    graph.push(Pass {
        name: "linear_light.middle_copy",
        uses: copied.uses.iter().copied().filter(|u| u.access != Access::Indirect).collect(),
        work: Work::Dispatch {
            shader: module!("linear_light/copy_depth.comp"),
            groups: grid([settings.map; 2]),
        },
        ..copied
    });
    graph.push(Pass::compute(
        "linear_light.mask",
        module!("linear_light/mask.comp"),
        grid(RECEIVERS),
        Push::new(&Mask {
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
        module!("linear_light/place.comp"),
        [1, 1, 1],
        Push::new(&Place {
            error: settings.error,
            most: settings.samples as i32,
            even: i32::from(line.is_touched()),
        }),
        smallvec![
            Use::bound(0, layers.masks, Access::BufferReadCompute),
            Use::bound(1, layers.samples, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
}

/// Adds the passes that draw the depth images of a sample.
pub(super) fn look(graph: &mut Graph, ctx: &LineContext, nth: u32) {
    let layers = &ctx.resources.layers;
    graph.push(drawn("linear_light.occluders", layers.occluders, Layer::Front, Some(nth), ctx));
    graph.push(drawn("linear_light.receivers", layers.receivers, Layer::Receivers, Some(nth), ctx));
}

/// The push constants of `view.glsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Sample {
    /// The mesh's matrix to the line's clip space, by columns; each mesh has its own.
    pub line_from_mesh: [f32; 16],
    /// The mesh's origin, which each mesh has too.
    pub origin: [f32; 4],
    /// The least and largest u at the line's first end, then at its last.
    pub u_window: [f32; 4],
    /// The line's length, m.
    pub line: f32,
    /// The sample's number.
    pub nth: i32,
}

/// The pass that draws a layer as a sample sees it, or as the line's middle does.
fn drawn(
    name: &'static str,
    image: ResourceId,
    layer: Layer,
    sample: Option<u32>,
    ctx: &LineContext,
) -> Pass {
    let Raster { cull, clear, compare } = depth_layers::raster_of(layer);
    let (vertex, cut_vertex) = match sample {
        Some(_) => (module!("linear_light/sample.vert"), module!("linear_light/sample_cut.vert")),
        None => (module!("linear_light/middle.vert"), module!("linear_light/middle_cut.vert")),
    };
    let mut uses = smallvec![Use::fixed(image, Access::DepthTarget)];
    uses.extend(
        sample.map(|_| Use::bound(0, ctx.resources.layers.samples, Access::BufferReadVertex)),
    );
    Pass {
        name,
        uses,
        push: Push::new(&Sample {
            line_from_mesh: [0.0; 16],
            origin: [0.0; 4],
            u_window: ctx.line.u_window(),
            line: ctx.line.length(),
            nth: sample.map_or(-1, |nth| nth as i32),
        }),
        work: Work::Raster {
            vertex,
            fragment: None,
            cut: Some([cut_vertex, shaders::CUT_FRAG]),
            cull,
            target: Target::Depth { clear, compare },
            draw: Draw::Layer { layer, view: ctx.row },
        },
        need: *ctx.inputs.need,
    }
}

/// The push constants of `copy_depth.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CopyDepth {
    /// 1 over the map's near plane, 1/m.
    pub inv_near: f32,
    /// The map's side in texels.
    pub map: i32,
    /// The layer to write.
    pub layer: i32,
}

/// The pass that copies a sample's depth images into a layer.
pub(super) fn copy(ctx: &LineContext, layer: u32) -> Pass {
    let layers = &ctx.resources.layers;
    Pass {
        name: "linear_light.copy",
        uses: smallvec![
            Use::fixed(ctx.resources.groups, Access::Indirect),
            Use::bound(0, layers.occluders, Access::SampledCompute),
            Use::bound(1, layers.receivers, Access::SampledCompute),
            Use::bound(2, layers.seen, Access::ImageWrite),
        ],
        push: Push::new(&CopyDepth {
            inv_near: (1.0 / ctx.line.near) as f32,
            map: ctx.settings.map as i32,
            layer: layer as i32,
        }),
        work: Work::Indirect {
            shader: module!("linear_light/copy_depth.comp"),
            arguments: ctx.resources.groups,
            offset: 0,
        },
        need: *ctx.inputs.need,
    }
}
