//! The passes over tiles and pixels, and their constants.

use super::{Settings, weights};
use crate::graph::{Access, Graph, Pass, Push, ResourceId, Use, Uses, Work};
use crate::shaders::module;
use crate::stages::hierarchy::{Hierarchy, groups};
use crate::stages::visibility::grid;
use crate::techniques::room::PassInputs;
use crate::{Light, Shape};
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The pixels along a tile's side (`traced/frame.glsl`).
const TILE_SIDE: u32 = 4;
/// The shafts of a tile (`traced/frame.glsl`).
const SHAFTS_A_TILE: u32 = 2;
/// The slots of a block (`traced/lists.glsl`).
const BLOCK: u32 = 256;
/// The places in the lists of triangles for each pixel of the image, on average.
const LISTED_A_PIXEL: u32 = 16;

/// The first part of the frame's constants (`traced/frame.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LightConstants {
    /// Normalized device coordinates to the hierarchy's space, relative to the eye.
    pub eye_from_ndc: [f32; 16],
    /// Light space's x, y and z of a point of the hierarchy's space, each as a plane.
    pub light_from_here: [[f32; 4]; 3],
    /// Half the light's width and height, m; for a sun the tangents of half its angular size.
    pub half_light: [f32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// How far a pixel's depth may be from the surface's.
    pub depth_step: f32,
}

/// The second part of the frame's constants (`traced/frame.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PixelConstants {
    /// The viewer.
    pub eye: [f32; 4],
    /// The direction towards an orthographic camera.
    pub towards: [f32; 4],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// 1 where the G-buffer has a mask of roles.
    pub masked: u32,
    /// 1 for a light without a place.
    pub sun: u32,
    /// How many nodes the hierarchy has.
    pub nodes: u32,
    /// The most leaves that a shaft may hold.
    pub most: u32,
    /// How many triangles all lists hold together.
    pub capacity: u32,
    /// How many rays a pixel of a dense shaft sends.
    pub samples: u32,
    /// The sum of the samples' weights; 0 where all weigh the same.
    pub weight: f32,
}

/// The third part of the frame's constants (`traced/frame.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SampleConstants {
    /// The samples' weights, row by row.
    pub weights: [[u16; 32]; 2],
}

/// The push constants of the passes that make the lists (`traced/sums.comp`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ListPush {
    /// How many slots for shafts there are.
    pub slots: u32,
    /// How many blocks they make.
    pub blocks: u32,
    /// The most leaves that a shaft may hold.
    pub most: u32,
    /// How many triangles all lists hold together.
    pub capacity: u32,
}

/// Adds the passes from the hierarchy to the visible fraction.
pub(super) fn declare(
    graph: &mut Graph,
    settings: &Settings,
    tree: &Hierarchy,
    inputs: &PassInputs,
) {
    let PassInputs { gbuffer, need, visibility, .. } = *inputs;
    let extent = gbuffer.extent;
    let tiles = extent.map(|e| e.div_ceil(TILE_SIDE));
    let slots = SHAFTS_A_TILE * tiles[0] * tiles[1];
    let blocks = slots.div_ceil(BLOCK);
    let capacity = LISTED_A_PIXEL * extent[0] * extent[1];
    let push = Push::new(&ListPush { slots, blocks, most: settings.leaves, capacity });

    let constants = graph.buffer("traced.constants", 336);
    declare_constants(graph, settings, constants, capacity, inputs);
    let of_slots = |bytes: u64| bytes * u64::from(slots);
    let shafts = graph.buffer("traced.shafts", of_slots(64));
    let counts = graph.buffer("traced.counts", of_slots(4));
    let sums = graph.buffer("traced.sums", 16 * u64::from(blocks));
    let totals = graph.buffer("traced.totals", 16);
    let arguments = graph.buffer("traced.arguments", 48);
    let listed = graph.buffer("traced.listed", of_slots(8));
    let dense = graph.buffer("traced.dense", of_slots(4));
    let found = graph.buffer("traced.found", of_slots(16));
    let lists = graph.buffer("traced.lists", 4 * u64::from(capacity));

    let read = |binding, id| Use::bound(binding, id, Access::BufferReadCompute);
    let write = |binding, id| Use::bound(binding, id, Access::BufferWriteCompute);
    let image = |binding, id| Use::bound(binding, id, Access::ImageRead);
    let of_frame = || {
        let mut uses = Uses::from_slice(&gbuffer.bound());
        uses.push(read(2, constants));
        uses
    };
    let mut uses = of_frame();
    uses.extend([
        image(3, tree.nodes),
        read(4, tree.header),
        write(5, shafts),
        write(6, counts),
        Use::bound(7, visibility, Access::ImageWrite),
    ]);
    let (name, shader) = ("traced.tiles", module!("traced/tiles.comp"));
    graph.push(Pass::compute(name, shader, grid(tiles), Push::NONE, uses, need));
    graph.push(Pass::compute(
        "traced.sums",
        module!("traced/sums.comp"),
        groups(blocks),
        push,
        smallvec![read(0, counts), write(1, sums)],
        need,
    ));
    graph.push(Pass::compute(
        "traced.totals",
        module!("traced/totals.comp"),
        [1, 1, 1],
        push,
        smallvec![
            Use::bound(0, sums, Access::BufferUpdate),
            write(1, totals),
            write(2, arguments),
        ],
        need,
    ));
    graph.push(Pass::compute(
        "traced.list",
        module!("traced/list.comp"),
        groups(blocks),
        push,
        smallvec![read(0, counts), read(1, sums), write(2, listed), write(3, dense)],
        need,
    ));
    let mut uses = of_frame();
    uses.extend([
        image(3, tree.nodes),
        read(4, tree.header),
        read(5, shafts),
        image(6, tree.triangles),
        read(7, totals),
        read(8, listed),
        write(9, found),
        write(10, lists),
        Use::fixed(arguments, Access::Indirect),
    ]);
    let shader = module!("traced/gather.comp");
    let work = Work::Indirect { shader, arguments, offset: 0 };
    graph.push(Pass { name: "traced.gather", uses, push: Push::NONE, work, need: *need });
    let mut uses = of_frame();
    uses.extend([
        read(3, shafts),
        image(4, tree.triangles),
        read(5, totals),
        read(6, listed),
        read(7, found),
        read(8, lists),
        Use::bound(9, visibility, Access::ImageUpdate),
        Use::fixed(arguments, Access::Indirect),
    ]);
    let shader = module!("traced/cover.comp");
    let work = Work::Indirect { shader, arguments, offset: 16 };
    graph.push(Pass { name: "traced.cover", uses, push: Push::NONE, work, need: *need });
    let mut uses = of_frame();
    uses.extend([
        image(3, tree.nodes),
        read(4, tree.header),
        read(5, shafts),
        image(6, tree.triangles),
        read(7, totals),
        read(8, dense),
        Use::bound(9, visibility, Access::ImageUpdate),
        Use::fixed(arguments, Access::Indirect),
    ]);
    let shader = module!("traced/rays.comp");
    let work = Work::Indirect { shader, arguments, offset: 32 };
    graph.push(Pass { name: "traced.rays", uses, push: Push::NONE, work, need: *need });
}

/// Adds the passes that write the frame's constants.
fn declare_constants(
    graph: &mut Graph,
    settings: &Settings,
    constants: ResourceId,
    capacity: u32,
    inputs: &PassInputs,
) {
    let need = inputs.need;
    let (_, space) = inputs.tree;
    let weights = weights::weights(space.light.shape(), half_of(&space.light));
    let weight: u32 = weights.iter().flatten().map(|&w| u32::from(w)).sum();
    graph.push(Pass::constants("traced.light", constants, 0, &LightConstants::of(inputs), need));
    let second = PixelConstants {
        most: settings.leaves,
        capacity,
        samples: settings.rays,
        weight: weight as f32,
        ..PixelConstants::of(inputs)
    };
    graph.push(Pass::constants("traced.pixels", constants, 128, &second, need));
    let weights = weights.unwrap_or([0; 64]);
    let third = SampleConstants { weights: bytemuck::cast(weights) };
    graph.push(Pass::constants("traced.weights", constants, 196, &third, need));
}

impl LightConstants {
    /// The first part of a frame's constants.
    pub(crate) fn of(inputs: &PassInputs) -> Self {
        let (_, space) = inputs.tree;
        let row = |i: usize| space.light_from_here.row(i).as_vec4().to_array();
        Self {
            eye_from_ndc: space.eye_from_ndc.as_mat4().to_cols_array(),
            light_from_here: [row(0), row(1), row(2)],
            half_light: half_of(&space.light).map(|half| half as f32),
            background: inputs.gbuffer.background,
            depth_step: space.depth_step,
        }
    }
}

impl PixelConstants {
    /// The second part of a frame's constants, with zeros for the technique's own.
    pub(crate) fn of(inputs: &PassInputs) -> Self {
        let (_, space) = inputs.tree;
        Self {
            eye: space.eye.as_vec3().extend(0.0).to_array(),
            towards: space.towards.as_vec4().to_array(),
            extent: inputs.gbuffer.extent.map(|e| e as i32),
            masked: u32::from(inputs.gbuffer.mask.is_some()),
            sun: u32::from(matches!(space.light.shape(), Shape::Sun { .. })),
            nodes: space.nodes,
            most: 0,
            capacity: 0,
            samples: 0,
            weight: 0.0,
        }
    }
}

/// Half the width and height of the rectangle of the light's samples, m; of a sun the tangents of half its angular size.
fn half_of(light: &Light) -> [f64; 2] {
    match light.shape() {
        Shape::Sun { angular_size } => [(0.5 * angular_size).tan(); 2],
        _ => light.rectangle().half_extents(),
    }
}
