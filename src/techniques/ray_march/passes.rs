//! The passes: layers → columns → levels; pixels → list → rays.

use super::settings::{Hash, Layers, Sampling, Search, Settings};
use crate::Shape;
use crate::graph::{Access, Graph, Need, Owner, Pass, Push, ResourceId, Use, Uses, Work};
use crate::light::outline::{CORNERS, doubled_area, triangles};
use crate::shaders::{self, Module, module};
use crate::stages::depth_layers::{DepthLayers, Eye};
use crate::stages::nbuffer::{self, Levels};
use crate::stages::visibility::{self, COLOR_FORMAT, grid};
use crate::techniques::room::PassInputs;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;
use std::f64::consts::PI;

/// The bytes of the list of pixels: its head with the light's outline, and for each pixel its place and the heights that its rays must search.
pub(super) fn list_bytes([width, height]: [u32; 2]) -> u64 {
    END + 12 * u64::from(width) * u64::from(height)
}

/// The shaders that some settings need.
struct Shaders {
    classify: Module,
    trace: Module,
    rows: Module,
    columns: Module,
}

/// The shaders for some settings. Usual settings have shaders of their own, without the code that only others need.
fn shaders_of(settings: &Settings, inputs: &PassInputs) -> Shaders {
    let usual = settings.levels == nbuffer::Kind::NBuffer
        && settings.search == Search::Hierarchical
        && settings.layers != Layers::Eye;
    let classify = match (inputs.light_texture, inputs.color, usual) {
        (_, true, true) => module!("ray_march/classify_color.comp"),
        (_, true, false) => module!("ray_march/classify_color_any.comp"),
        (None, false, true) => module!("ray_march/classify.comp"),
        _ => module!("ray_march/classify_any.comp"),
    };
    let trace = match (inputs.light_texture, inputs.color, usual) {
        (Some(_), true, true) => module!("ray_march/trace_color.comp"),
        (Some(_), true, false) => module!("ray_march/trace_color_any.comp"),
        (Some(_), false, true) => module!("ray_march/trace_textured.comp"),
        (Some(_), false, false) => module!("ray_march/trace_textured_any.comp"),
        (None, _, true) => shaders::TRACE,
        (None, _, false) => module!("ray_march/trace_any.comp"),
    };
    let (rows, columns) = if inputs.color {
        (
            module!("ray_march/filter_rows_color.comp"),
            module!("ray_march/filter_columns_color.comp"),
        )
    } else {
        (module!("ray_march/filter_rows.comp"), module!("ray_march/filter_columns.comp"))
    };
    Shaders { classify, trace, rows, columns }
}

/// The push constants of `start.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Start {
    /// The matrix from light space to the G-buffer's NDC, by columns.
    pub ndc_from_light: [f32; 16],
}

/// Adds the passes that turn depth layers into the visible fraction.
pub(super) fn declare(
    graph: &mut Graph,
    layers: &DepthLayers,
    settings: &Settings,
    inputs: &PassInputs,
) {
    let visibility = inputs.visibility;
    let windows = declare_levels(graph, layers, settings, inputs);
    let gbuffer = inputs.gbuffer;
    let arguments = graph.buffer("ray_march.arguments", 16);
    let pixels = graph.buffer("ray_march.pixels", list_bytes(gbuffer.extent));
    // Without a filter no pass reads these images.
    let filtered = if settings.filter { gbuffer.extent } else { [1, 1] };
    let mut image = |name, format| graph.image(name, format, filtered, Owner::Transient);
    let noisy = image("ray_march.noisy", COLOR_FORMAT);
    let halfway = image("ray_march.halfway", visibility::format(inputs.color));
    // The image of the pixels' normals, where the noisy image has no channels for them.
    let surfaces = inputs.color.then(|| image("ray_march.surfaces", COLOR_FORMAT));
    graph.push(Pass::compute(
        "ray_march.start",
        module!("ray_march/start.comp"),
        [1, 1, 1],
        Push::new(&Start { ndc_from_light: inputs.ndc_from_light }),
        smallvec![
            Use::bound(0, arguments, Access::BufferWriteCompute),
            Use::bound(1, pixels, Access::BufferWriteCompute),
        ],
        inputs.need,
    ));
    declare_outline(graph, pixels, inputs);
    let pushed = Push::new(&pixel_push(settings, inputs, layers.middle.is_some()));
    let shaders = shaders_of(settings, inputs);
    let mut common = Uses::from_slice(&gbuffer.all_bound());
    common.push(Use::bound(2, windows, Access::SampledCompute));
    let mut uses = common.clone();
    uses.extend([
        Use::bound(3, visibility, Access::ImageWrite),
        Use::bound(4, arguments, Access::BufferUpdate),
        Use::bound(5, pixels, Access::BufferUpdate),
        Use::bound(6, halfway, Access::ImageWrite),
        Use::bound(7, noisy, Access::ImageWrite),
    ]);
    uses.extend(surfaces.map(|s| Use::bound(8, s, Access::ImageWrite)));
    let name = "ray_march.classify";
    let groups = grid(gbuffer.extent);
    graph.push(Pass::compute(name, shaders.classify, groups, pushed, uses, inputs.need));

    let mut uses = common;
    uses.extend([
        Use::bound(3, visibility, Access::ImageUpdate),
        Use::bound(4, pixels, Access::BufferReadCompute),
        Use::bound(5, noisy, Access::ImageUpdate),
    ]);
    uses.extend(surfaces.map(|s| Use::bound(6, s, Access::ImageUpdate)));
    uses.extend(inputs.light_texture.map(|t| Use::bound(7, t, Access::SampledCompute)));
    listed(graph, "ray_march.trace", shaders.trace, arguments, pushed, uses, inputs.need);

    if settings.filter {
        let mut common: Uses = smallvec![
            gbuffer.constants_use(),
            Use::bound(0, gbuffer.depth, Access::SampledCompute),
            Use::bound(1, pixels, Access::BufferReadCompute),
            Use::bound(2, noisy, Access::SampledCompute),
        ];
        common.extend(surfaces.map(|s| Use::bound(5, s, Access::SampledCompute)));
        let mut uses = common.clone();
        uses.push(Use::bound(3, halfway, Access::ImageUpdate));
        let name = "ray_march.filter_rows";
        listed(graph, name, shaders.rows, arguments, Push::NONE, uses, inputs.filter);
        let mut uses = common;
        uses.push(Use::bound(3, halfway, Access::SampledCompute));
        uses.push(Use::bound(4, visibility, Access::ImageUpdate));
        let name = "ray_march.filter_columns";
        listed(graph, name, shaders.columns, arguments, Push::NONE, uses, inputs.filter);
    }
}

/// Adds a pass that runs for the listed pixels.
fn listed(
    graph: &mut Graph,
    name: &'static str,
    shader: Module,
    arguments: ResourceId,
    push: Push,
    mut uses: Uses,
    need: &Need,
) {
    uses.push(Use::fixed(arguments, Access::Indirect));
    let work = Work::Indirect { shader, arguments, offset: 0 };
    graph.push(Pass { name, uses, push, work, need: *need });
}

/// The push constants of `columns.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Columns {
    /// The map's side in texels.
    pub map: i32,
    /// The number of layers: 2; 4 with the nearest back and the furthest front faces; 6 with those of the piece between.
    pub layers: i32,
    /// The height of a stored 1.
    pub height: f32,
    /// The layer of the windows for the pieces of matter between the first and the last over each texel.
    pub middle: i32,
}

/// The push constants of `level.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Level {
    /// The map's side in texels.
    pub map: i32,
    /// The kind of the levels' windows.
    pub kind: i32,
    /// The level to make.
    pub level: i32,
}

/// Adds the passes that turn the layers into columns, and these into the bounds of windows.
fn declare_levels(
    graph: &mut Graph,
    layers: &DepthLayers,
    settings: &Settings,
    inputs: &PassInputs,
) -> ResourceId {
    let map = inputs.occluders.side;
    let levels = Levels { map, kind: settings.levels };
    // The last layer has the third pieces of matter.
    let layers_of_windows = levels.layers() + u32::from(settings.has_middle());
    let windows = graph.image_array("ray_march.windows", COLOR_FORMAT, [map; 2], layers_of_windows);
    let back = layers.back.unwrap_or(layers.front);
    let [near_back, far_front] = layers.inner.unwrap_or([layers.front; 2]);
    let [middle_front, middle_back] = layers.middle.unwrap_or([layers.front; 2]);
    graph.push(Pass::compute(
        "ray_march.columns",
        module!("ray_march/columns.comp"),
        grid([map; 2]),
        Push::new(&Columns {
            map: map as i32,
            layers: match (layers.middle, layers.inner) {
                (Some(_), _) => 6,
                (None, Some(_)) => 4,
                (None, None) => 2,
            },
            height: inputs.occluders.top() as f32,
            middle: levels.layers() as i32,
        }),
        smallvec![
            Use::bound(0, layers.front, Access::SampledCompute),
            Use::bound(1, back, Access::SampledCompute),
            Use::bound(2, near_back, Access::SampledCompute),
            Use::bound(3, far_front, Access::SampledCompute),
            Use::bound(4, windows, Access::ImageWrite),
            Use::bound(5, middle_front, Access::SampledCompute),
            Use::bound(6, middle_back, Access::SampledCompute),
        ],
        inputs.need,
    ));
    let kind = settings.levels.code();
    let shader = match settings.levels {
        nbuffer::Kind::NBuffer => module!("ray_march/level.comp"),
        _ => module!("ray_march/level_any.comp"),
    };
    for level in 1..=levels.top() {
        graph.push(Pass::compute(
            "ray_march.level",
            shader,
            grid([levels.side(level); 2]),
            Push::new(&Level { map: map as i32, kind, level: level as i32 }),
            smallvec![Use::bound(0, windows, Access::ImageUpdate)],
            inputs.need,
        ));
    }
    windows
}

/// The most corners.
const MOST: usize = *CORNERS.end();

/// Where the outline begins in the list of pixels, and where it ends, in bytes.
const START: u64 = 80;
const END: u64 = START + (size_of::<Corners>() + size_of::<Pieces>()) as u64;

/// The corners of the light's outline (`pixel.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Corners([[f32; 2]; MOST]);

/// The triangles that the outline is cut into: the share of the area before each, and its corners' numbers by 4 bits. Behind
/// the last one the share is 1; the last of all has 1 over the area and the number of corners.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Pieces([[u32; 2]; MOST]);

/// The corners of a light that is a polygon; none of others.
fn outline_of<'a>(inputs: &PassInputs<'a>) -> Option<&'a [[f64; 2]]> {
    inputs.tree.1.light.outline()
}

/// Adds the passes that write the outline into the list of pixels, where the light has one.
fn declare_outline(graph: &mut Graph, pixels: ResourceId, inputs: &PassInputs) {
    let (mut corners, mut pieces) = (Corners::zeroed(), Pieces::zeroed());
    let need = match outline_of(inputs) {
        Some(outline) => {
            (corners, pieces) = written(outline);
            *inputs.need
        }
        None => Need::No(graph.because("the light is no polygon")),
    };
    let name = "ray_march.outline";
    graph.push(Pass::constants(name, pixels, START, &corners, &need));
    let behind = START + size_of::<Corners>() as u64;
    graph.push(Pass::constants(name, pixels, behind, &pieces, &need));
}

fn written(outline: &[[f64; 2]]) -> (Corners, Pieces) {
    let (mut corners, mut pieces) = (Corners::zeroed(), Pieces::zeroed());
    for (to, from) in corners.0.iter_mut().zip(outline) {
        *to = from.map(|x| x as f32);
    }
    let area = doubled_area(outline);
    let share =
        |[a, b, c]: [u8; 3]| doubled_area(&[a, b, c].map(|i| outline[usize::from(i)])) / area;
    let mut before = 0.0;
    let mut count = 0;
    for (to, piece) in pieces.0.iter_mut().zip(triangles(outline)) {
        let [a, b, c] = piece.map(u32::from);
        *to = [(before as f32).to_bits(), a | b << 4 | c << 8];
        before += share(piece);
        count += 1;
    }
    pieces.0[count.min(MOST - 2)] = [1.0f32.to_bits(), 0];
    pieces.0[MOST - 1] = [((2.0 / area) as f32).to_bits(), outline.len() as u32];
    (corners, pieces)
}

/// The push constants of `classify.comp` and `trace.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Pixels {
    /// Map texels a unit of u and v, or a metre where the projection is orthographic.
    pub texels_per_unit: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// How far behind the light the projection point is, m; or the far plane's distance.
    pub eye: f32,
    /// The height of the near plane.
    pub top: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// The error of an occluder's height beyond its rounding.
    pub depth_error: f32,
    /// The map's side in texels.
    pub map: i32,
    /// The number of rays, the rows of cells and what is switched on, see `pixel.glsl`.
    pub flags: i32,
    /// The seed of the hashes.
    pub seed: u32,
}

/// Half the width and height of the light, or the radius of one that is a disc, and whether it is; of a polygon those of
/// the rectangle around it.
fn disc_or_rectangle(inputs: &PassInputs) -> ([f64; 2], bool) {
    let half = inputs.light.half_extents();
    match inputs.tree.1.light.shape() {
        Shape::Disc { .. } => (half, true),
        // The square of its area stands for a sun.
        Shape::Sun { .. } if inputs.occluders.eye == Eye::Infinity => {
            (half.map(|h| h * (4.0 / PI).sqrt()), true)
        }
        _ => (half, false),
    }
}

fn pixel_push(settings: &Settings, inputs: &PassInputs, has_middle: bool) -> Pixels {
    let PassInputs { occluders: view, light, .. } = inputs;
    let (half, is_disc) = disc_or_rectangle(inputs);
    let [half_x, half_y] = light.half_extents();
    let rays = f64::from(settings.rays);
    // A point has no sides, and no number as their ratio; its shadows are hard.
    let rows = (rays * half_y / half_x).sqrt().round().max(1.0).min(rays) as i32;
    let bit = |on: bool, at: i32| i32::from(on) << at;
    let flags = (settings.rays as i32 - 1)
        | (rows - 1) << 8
        | bit(view.eye == Eye::Infinity, 17)
        | bit(settings.search == Search::Linear, 18)
        | bit(settings.hash == Hash::Pcg, 19)
        | bit(settings.layers == Layers::Eye, 20)
        | bit(settings.classify, 21)
        // Without the filter's passes the pass of the rays writes the result.
        | bit(settings.filter && inputs.filter.is_yes(), 22)
        | match settings.sampling {
            Sampling::Jittered => 0,
            Sampling::Random => 1,
            Sampling::LowDiscrepancy => 2,
        } << 23
        | settings.levels.code() << 25
        | bit(inputs.light_texture.is_some(), 27)
        | bit(is_disc, 28)
        | bit(outline_of(inputs).is_some(), 29)
        | bit(has_middle, 30);
    Pixels {
        texels_per_unit: view.texels_per_uv().map(|x| x as f32),
        first: view.first().map(|x| x as f32),
        half_light: half.map(|x| x as f32),
        eye: match view.eye {
            Eye::Behind(behind) => behind as f32,
            Eye::Infinity => view.far as f32,
        },
        top: view.top() as f32,
        snap: inputs.snap,
        depth_error: inputs.depth_error as f32,
        map: view.side as i32,
        flags,
        seed: settings.seed.wrapping_add(inputs.noise),
    }
}
