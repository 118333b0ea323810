//! Slices: their placement, the faces drawn into them, and a mask of one bit a slice.

use super::settings::Settings;
use crate::graph::{
    Access, COLOR_ATTACHMENTS, Draw, Graph, Layer, Need, Owner, Pass, Push, ResourceId, Target,
    Use, Work,
};
use crate::shaders::{self, module};
use crate::stages::depth_layers::{self, DepthLayers, Eye, Wanted};
use crate::stages::visibility::grid;
use crate::techniques::room::PassInputs;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::{SmallVec, smallvec};

/// The number of bins of distances (`slices.glsl`).
const BINS: u32 = 960;

/// The size of the placement's image: bins and planes of slices in one row of texels.
const PLACEMENT: [u32; 2] = [1024, 1];

/// The most texels a side of the layers of which the histogram is made.
const HISTOGRAM_MAP: u32 = 128;

/// The number of slices that one draw counts.
const SLICES_A_DRAW: u32 = 4 * COLOR_ATTACHMENTS as u32;

/// The side of the layers of nearest and furthest faces, texels; for the histogram alone few are enough.
pub(super) fn layers_side(settings: &Settings, inputs: &PassInputs) -> u32 {
    let side = inputs.occluders.side;
    if settings.looks_near(inputs.served) { side } else { side.min(HISTOGRAM_MAP) }
}

/// The layers from which the histogram is made.
pub(super) fn histogram_layers(settings: &Settings) -> Wanted {
    Wanted { back: settings.is_fitted(), inner: false, middle: false, receiver_map: None }
}

/// The push constants of `place.comp` and `place_fitted.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Place {
    /// The distance of the nearest occluder from the light's plane, m.
    pub near: f32,
    /// The distance of the furthest occluder from the light's plane, m.
    pub far: f32,
    /// How far behind the light the projection point is, m.
    pub eye: f32,
    /// The place of a slice's texture: 0 at its top, 1 at its bottom.
    pub plane: f32,
    /// The number of slices.
    pub slices: i32,
    /// The range of distances that the slices share: metres, or the share of an orthographic map's heights.
    pub span: f32,
}

pub(super) fn declare_placement(
    graph: &mut Graph,
    layers: Option<&DepthLayers>,
    settings: &Settings,
    inputs: &PassInputs,
) -> ResourceId {
    let format = vk::Format::R32G32B32A32_SFLOAT;
    let name = "occlusion_textures.placement";
    let placement = graph.image(name, format, PLACEMENT, Owner::Transient);
    let view = inputs.occluders;
    // Slices of an orthographic map are at heights, whose distances from the light begin below 0.
    let [near, far, eye] = match view.eye {
        Eye::Behind(behind) => [view.near - behind, inputs.deepest - behind, behind],
        Eye::Infinity => [-view.top(), inputs.deepest - view.far, view.top()],
    };
    let span = spanned(inputs);
    let pushed = Push::new(&Place {
        near: near as f32,
        far: far as f32,
        eye: eye as f32,
        // The published place is the bottom; in the middle the error is smaller.
        plane: if settings.is_correlated() { 0.5 } else { 1.0 },
        slices: settings.sizes(inputs.served).slices as i32,
        span: span as f32,
    });
    let mut uses = smallvec![Use::bound(0, placement, Access::ImageWrite)];
    let (name, shader, groups) = match layers {
        Some(layers) => {
            let histogram = declare_histogram(graph, layers, settings, inputs);
            uses.push(Use::bound(1, histogram, Access::BufferReadCompute));
            ("occlusion_textures.place_fitted", module!("occlusion_textures/place_fitted.comp"), 1)
        }
        None => (
            "occlusion_textures.place",
            module!("occlusion_textures/place.comp"),
            PLACEMENT[0].div_ceil(64),
        ),
    };
    graph.push(Pass::compute(name, shader, [groups, 1, 1], pushed, uses, inputs.need));
    placement
}

/// The range of distances that the slices share, metres; for an orthographic map the share of its heights.
fn spanned(inputs: &PassInputs) -> f64 {
    let view = inputs.occluders;
    match view.eye {
        Eye::Behind(_) => inputs.deepest - view.near,
        Eye::Infinity => (inputs.deepest - view.near) / view.top(),
    }
}

/// The push constants of `histogram.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Histogram {
    /// The layers' side in texels.
    pub map: i32,
    /// The distance in texels of those that are counted.
    pub step: i32,
    /// Distance of the near plane from the projection point, m.
    pub near: f32,
    /// The distance of the furthest occluder from the nearest, m.
    pub span: f32,
}

fn declare_histogram(
    graph: &mut Graph,
    layers: &DepthLayers,
    settings: &Settings,
    inputs: &PassInputs,
) -> ResourceId {
    let histogram = graph.buffer("occlusion_textures.histogram", 4 * u64::from(BINS));
    graph.push(Pass::compute(
        "occlusion_textures.histogram_start",
        module!("occlusion_textures/histogram_start.comp"),
        [BINS.div_ceil(64), 1, 1],
        Push::NONE,
        smallvec![Use::bound(0, histogram, Access::BufferWriteCompute)],
        inputs.need,
    ));
    let map = layers_side(settings, inputs);
    let step = map.div_ceil(HISTOGRAM_MAP);
    graph.push(Pass::compute(
        "occlusion_textures.histogram",
        module!("occlusion_textures/histogram.comp"),
        grid([map.div_ceil(step); 2]),
        Push::new(&Histogram {
            map: map as i32,
            step: step as i32,
            near: match inputs.occluders.eye {
                Eye::Behind(_) => inputs.occluders.near as f32,
                Eye::Infinity => 0.0,
            },
            span: spanned(inputs) as f32,
        }),
        smallvec![
            Use::bound(0, layers.front, Access::SampledCompute),
            Use::bound(1, layers.back.unwrap_or(layers.front), Access::SampledCompute),
            Use::bound(2, histogram, Access::BufferUpdate),
        ],
        inputs.need,
    ));
    histogram
}

/// The names of the passes and images of faces drawn into slices.
struct Drawn {
    layer: Layer,
    passes: [&'static str; 2],
    images: [&'static str; 8],
}

const ALL_FACES: Drawn = Drawn {
    layer: Layer::Slices,
    passes: ["occlusion_textures.slices", "occlusion_textures.lower_slices"],
    images: [
        "occlusion_textures.faces_0",
        "occlusion_textures.faces_1",
        "occlusion_textures.faces_2",
        "occlusion_textures.faces_3",
        "occlusion_textures.faces_4",
        "occlusion_textures.faces_5",
        "occlusion_textures.faces_6",
        "occlusion_textures.faces_7",
    ],
};

const FRONTS: Drawn = Drawn {
    layer: Layer::FrontSlices,
    passes: ["occlusion_textures.front_slices", "occlusion_textures.lower_front_slices"],
    images: [
        "occlusion_textures.fronts_0",
        "occlusion_textures.fronts_1",
        "occlusion_textures.fronts_2",
        "occlusion_textures.fronts_3",
        "occlusion_textures.fronts_4",
        "occlusion_textures.fronts_5",
        "occlusion_textures.fronts_6",
        "occlusion_textures.fronts_7",
    ],
};

const BACKS: Drawn = Drawn {
    layer: Layer::BackSlices,
    passes: ["occlusion_textures.back_slices", "occlusion_textures.lower_back_slices"],
    images: [
        "occlusion_textures.backs_0",
        "occlusion_textures.backs_1",
        "occlusion_textures.backs_2",
        "occlusion_textures.backs_3",
        "occlusion_textures.backs_4",
        "occlusion_textures.backs_5",
        "occlusion_textures.backs_6",
        "occlusion_textures.backs_7",
    ],
};

/// The images that faces are drawn into: four slices each.
type Slabs = SmallVec<[ResourceId; 8]>;

/// Adds the passes that count faces, and returns the images that they fill; four slices an image.
fn draw(
    graph: &mut Graph,
    drawn: &Drawn,
    placement: ResourceId,
    settings: &Settings,
    inputs: &PassInputs,
) -> Slabs {
    let draws = |slices: u32| slices.div_ceil(SLICES_A_DRAW) as usize;
    let (of_frame, of_any) =
        (draws(settings.sizes(inputs.served).slices), draws(settings.most_slices()));
    let fewer = graph.because("one view serves every receiver, and has fewer slices");
    let rest = if inputs.need.is_yes() { Need::No(fewer) } else { *inputs.need };
    let raster = depth_layers::raster_of(drawn.layer);
    let mut images = Slabs::new();
    for nth in 0..of_any {
        let targets: Slabs = drawn.images[COLOR_ATTACHMENTS * nth..][..COLOR_ATTACHMENTS]
            .iter()
            .map(|name| {
                let format = vk::Format::R8G8B8A8_UNORM;
                graph.image(name, format, [inputs.occluders.side; 2], Owner::Transient)
            })
            .collect();
        let mut uses = smallvec![Use::bound(0, placement, Access::SampledFragment)];
        uses.extend(targets.iter().map(|&t| Use::fixed(t, Access::ColorTarget)));
        graph.push(Pass {
            name: drawn.passes[nth],
            uses,
            push: Push::NONE,
            work: Work::Raster {
                vertex: shaders::DEPTH_VERT,
                fragment: Some(
                    [
                        module!("occlusion_textures/slice.frag"),
                        module!("occlusion_textures/slice_lower.frag"),
                    ][nth],
                ),
                cut: Some([
                    shaders::DEPTH_CUT_VERT,
                    [
                        module!("occlusion_textures/slice_cut.frag"),
                        module!("occlusion_textures/slice_lower_cut.frag"),
                    ][nth],
                ]),
                cull: raster.cull,
                target: Target::Add,
                draw: Draw::Layer { layer: drawn.layer, view: inputs.view },
            },
            need: if nth < of_frame { *inputs.need } else { rest },
        });
        if nth < of_frame {
            images.extend(targets);
        }
    }
    images
}

/// The push constants of `mask.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Mask {
    /// The map's side in texels.
    pub map: i32,
    /// The number of slices.
    pub slices: i32,
    /// 1: matter between front and back faces blocks.
    pub solid: i32,
    /// 1: a slice also blocks in the next one.
    pub fill: i32,
}

/// Adds the passes that make the mask: one number a texel, a bit a slice.
pub(super) fn declare_mask(
    graph: &mut Graph,
    placement: ResourceId,
    settings: &Settings,
    inputs: &PassInputs,
) -> ResourceId {
    let (fronts, backs) = if settings.is_correlated() {
        let fronts = draw(graph, &FRONTS, placement, settings, inputs);
        (fronts, draw(graph, &BACKS, placement, settings, inputs))
    } else {
        let faces = draw(graph, &ALL_FACES, placement, settings, inputs);
        (faces.clone(), faces)
    };
    let side = inputs.occluders.side;
    let format = vk::Format::R32_UINT;
    let mask = graph.image("occlusion_textures.mask", format, [side; 2], Owner::Transient);
    let mut uses = smallvec![Use::bound(0, mask, Access::ImageWrite)];
    for (images, first) in [(&fronts, 1), (&backs, 9)] {
        // An image without a slice is bound and not read.
        let bound = |i| images.get(i).or(images.first()).copied();
        uses.extend(
            (0..8).filter_map(|i| {
                Some(Use::bound(first + i as u8, bound(i)?, Access::SampledCompute))
            }),
        );
    }
    graph.push(Pass::compute(
        "occlusion_textures.mask",
        module!("occlusion_textures/mask.comp"),
        grid([side; 2]),
        Push::new(&Mask {
            map: side as i32,
            slices: settings.sizes(inputs.served).slices as i32,
            solid: i32::from(settings.is_correlated()),
            fill: i32::from(settings.fill),
        }),
        uses,
        inputs.need,
    ));
    mask
}
