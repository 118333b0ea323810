//! The constants of a frame: its camera, its light, and what the light's samples weigh.

use super::{Settings, weights};
use crate::graph::{Graph, Pass, ResourceId};
use crate::techniques::room::PassInputs;
use crate::{Light, Shape};
use bytemuck::{Pod, Zeroable};

/// A raster's grid of 8 sub-pixel bits: what it moves surfaces by is within what receivers are moved for rounding.
const FINE: f32 = 1.0 / 256.0;

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
    /// 0 for a light that shines to one side, 1 for a sun, 2 for one that shines to all sides.
    pub kind: u32,
    /// How many nodes the hierarchy has.
    pub nodes: u32,
    /// The most leaves that a shaft may hold.
    pub most: u32,
    /// How much coarser than 8 sub-pixel bits the grid is that the raster moves vertices to, in pixels.
    pub snap: f32,
    /// How many rays a pixel of a dense shaft sends.
    pub samples: u32,
    /// The sum of the samples' weights; 0 where all weigh the same.
    pub weight: f32,
    /// Samples along a side of the light.
    pub side: u32,
}

/// A part of the samples' weights (`traced/frame.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct WeightConstants {
    /// A quarter of the samples' weights, row by row.
    pub weights: [[u16; 32]; 2],
}

/// Where the second part and the weights begin in the frame's constants, in bytes.
const PIXELS: u64 = size_of::<LightConstants>() as u64;
const WEIGHTS: u64 = PIXELS + size_of::<PixelConstants>() as u64;
/// The bytes of all of them; a shader's structure with a vector of four ends at a multiple of 16.
const BYTES: u64 = (WEIGHTS + 4 * size_of::<WeightConstants>() as u64).next_multiple_of(16);

/// Adds the passes that write the frame's constants, and returns the buffer that holds them.
pub(super) fn declare(graph: &mut Graph, settings: &Settings, inputs: &PassInputs) -> ResourceId {
    let constants = graph.buffer("traced.constants", BYTES);
    let need = inputs.need;
    let (_, space) = inputs.tree;
    graph.push(Pass::constants("traced.light", constants, 0, &LightConstants::of(inputs), need));
    let side = settings.samples.side();
    let cells = weights::MOST.min(side as usize);
    let weights = weights::weights(space.light.shape(), half_of(&space.light), cells);
    let weight: u32 = weights.iter().flatten().map(|&w| u32::from(w)).sum();
    // Four samples share a weight where there are more samples than weights.
    let shared = (side as usize / weights::MOST).max(1).pow(2);
    let second = PixelConstants {
        most: settings.leaves,
        samples: settings.rays.min(side * side),
        weight: weight as f32 * shared as f32,
        side,
        ..PixelConstants::of(inputs)
    };
    graph.push(Pass::constants("traced.pixels", constants, PIXELS, &second, need));
    for (nth, part) in weights.unwrap_or([0; 256]).as_chunks::<64>().0.iter().enumerate() {
        let part = WeightConstants { weights: bytemuck::cast(*part) };
        let offset = WEIGHTS + (size_of::<WeightConstants>() * nth) as u64;
        graph.push(Pass::constants("traced.weights", constants, offset, &part, need));
    }
    constants
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
            kind: match space.light.shape() {
                Shape::Sun { .. } => 1,
                _ if space.light.is_round() => 2,
                _ => 0,
            },
            nodes: space.nodes,
            most: 0,
            snap: (inputs.snap - FINE).max(0.0),
            samples: 0,
            weight: 0.0,
            side: 0,
        }
    }
}

/// Half the width and height of the rectangle of the light's samples, m; of a sun the tangents of half its angular size.
fn half_of(light: &Light) -> [f64; 2] {
    match light.shape() {
        Shape::Sun { angular_size } => [(0.5 * angular_size).tan(); 2],
        Shape::Sphere { radius } => [radius; 2],
        Shape::Capsule { half_length, radius } => [half_length + radius, radius],
        Shape::Point => [0.0; 2],
        _ => light.rectangle().half_extents(),
    }
}
