//! The passes of an audit: candidates, a list of those that may be in shadow, their exact fraction, and the figures.

use super::FIGURE_BYTES;
use crate::Shape;
use crate::frame::Space;
use crate::graph::{Access, Graph, Need, Pass, Push, ResourceId, Use, Uses, Work};
use crate::light::Light;
use crate::shaders::module;
use crate::stages::hierarchy::Hierarchy;
use crate::techniques::room::PassInputs;
use crate::techniques::traced::constants::{LightConstants, PixelConstants};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use smallvec::smallvec;

/// Candidates for each pixel that is traced: so many that shadow on an eighth of the image fills an audit.
const CANDIDATES_A_PIXEL: u32 = 8;
/// The candidates of a block (`audit/list.comp`).
const CANDIDATES_A_BLOCK: u32 = 256;
/// The traced pixels of a block (`audit/blocks.comp`).
const PIXELS_A_BLOCK: u32 = 64;
/// The corners of a polygon.
const CORNERS: usize = 16;
/// The largest whole number of a corner's coordinate (`audit/light.glsl`).
const CORNER_STEPS: f64 = 65535.0;

/// The light, for the passes that trace (`audit/light.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LightPush {
    /// The light's centre in the hierarchy's space.
    pub center: [f32; 3],
    /// How far it reaches, m; 0 for a light without limit.
    pub reach: f32,
    /// The light's kind: 0 rectangle or line, 1 stadium in its plane, 2 polygon, 3 sphere, 4 capsule, 5 point, 6 sun.
    pub kind: u32,
    /// How many corners a polygon has.
    pub corner_count: u32,
    /// Half the length of a stadium's or a capsule's segment, m.
    pub half_length: f32,
    /// The radius, m; a sun's is a tangent.
    pub radius: f32,
    /// Cells along the image's width and height.
    pub cells: [u32; 2],
    /// 1 for a light that shines to all sides.
    pub all_sides: u32,
    /// Bytes that no shader reads.
    pub unused: u32,
    /// A polygon's corners as shares of the light's width and height, 16 bits each.
    pub corners: [u32; CORNERS],
}

/// The push constants of the passes that list candidates (`audit/list.comp`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ListPush {
    /// How many candidates there are.
    pub candidates: u32,
    /// How many blocks they make.
    pub blocks: u32,
    /// The most that are traced.
    pub pixels: u32,
}

/// What is audited.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Audited {
    /// The pixels that are traced, at most.
    pub pixels: u32,
    /// How far the light reaches, m.
    pub reach: Option<f64>,
}

/// Cells along the image's width and height, about as wide as high: one for each candidate, and none without a pixel.
fn cells([width, height]: [u32; 2], candidates: u32) -> [u32; 2] {
    let (w, h) = (f64::from(width), f64::from(height));
    let columns = (f64::from(candidates) * w / h).sqrt().round() as u32;
    let columns = columns.clamp(1, width);
    [columns, candidates.div_ceil(columns).clamp(1, height)]
}

impl LightPush {
    fn of(audited: &Audited, space: &Space, cells: [u32; 2]) -> Self {
        let light = &space.light;
        let corners = match light.shape() {
            Shape::Polygon(corners) => corners,
            _ => &[],
        };
        let (kind, half_length, radius) = match light.shape() {
            Shape::Disc { radius } => (1, 0.0, radius),
            Shape::Polygon(_) => (2, 0.0, 0.0),
            Shape::Sphere { radius } => (3, 0.0, radius),
            Shape::Capsule { half_length, radius } => (4, half_length, radius),
            Shape::Point => (5, 0.0, 0.0),
            Shape::Sun { angular_size } => (6, 0.0, (0.5 * angular_size).tan()),
            _ => (0, 0.0, 0.0),
        };
        // A sun has no centre, and so nothing beyond its reach.
        let reach = audited.reach.filter(|_| kind != 6).map_or(0.0, |r| r.min(1e18) as f32);
        Self {
            center: space.light_from_here.inverse().transform_point3(DVec3::ZERO).as_vec3().into(),
            reach,
            kind,
            corner_count: corners.len().min(CORNERS) as u32,
            half_length: half_length as f32,
            radius: radius as f32,
            cells,
            all_sides: u32::from(light.is_round()),
            unused: 0,
            corners: packed(corners, light),
        }
    }
}

fn packed(corners: &[[f64; 2]], light: &Light) -> [u32; CORNERS] {
    let half = light.rectangle().half_extents();
    let mut packed = [0; CORNERS];
    for (packed, corner) in packed.iter_mut().zip(corners) {
        let share = |i: usize| (0.5 + 0.5 * corner[i] / half[i]).clamp(0.0, 1.0) * CORNER_STEPS;
        *packed = share(0).round() as u32 | (share(1).round() as u32) << 16;
    }
    packed
}

/// The workgroups of 64 invocations for a number of them: at most 2¹⁹, and so 8,192 along x.
fn groups(invocations: u32) -> [u32; 3] {
    [invocations.div_ceil(64), 1, 1]
}

/// Adds the passes of an audit behind those that write the visible fraction.
pub(crate) fn declare(
    graph: &mut Graph,
    audited: Audited,
    tree: &Hierarchy,
    inputs: &PassInputs,
    need: &Need,
) {
    let Audited { pixels, .. } = audited;
    let (_, space) = inputs.tree;
    let cells = cells(inputs.gbuffer.extent, pixels * CANDIDATES_A_PIXEL);
    let candidates = cells[0] * cells[1];
    let blocks = candidates.div_ceil(CANDIDATES_A_BLOCK);
    let pixel_blocks = pixels.div_ceil(PIXELS_A_BLOCK);
    let frame = constants(graph, inputs, need);
    let number = graph.buffer("audit.number", 16);
    graph.push(Pass::frame_number("audit.number", number, need));
    let chosen = graph.buffer("audit.candidates", 16 * u64::from(candidates));
    let sums = graph.buffer("audit.sums", 4 * u64::from(blocks));
    let listed = graph.buffer("audit.listed", 16 * (1 + u64::from(pixels)));
    let arguments = graph.buffer("audit.arguments", 16);
    let parts = graph.buffer("audit.parts", 4 * u64::from(pixels));
    let errors = graph.buffer("audit.errors", 32 * u64::from(pixel_blocks));
    let figures = graph.host_read_buffer("audit.figures", FIGURE_BYTES);

    let read = |binding, id| Use::bound(binding, id, Access::BufferReadCompute);
    let write = |binding, id| Use::bound(binding, id, Access::BufferWriteCompute);
    let image = |binding, id| Use::bound(binding, id, Access::ImageRead);
    let light = Push::new(&LightPush::of(&audited, space, cells));
    let mut uses = Uses::from_slice(&inputs.gbuffer.bound());
    uses.extend([
        read(2, frame),
        image(3, tree.nodes),
        image(4, inputs.visibility),
        image(5, tree.triangles),
        read(6, number),
        write(7, chosen),
    ]);
    let (name, shader) = ("audit.choose", module!("audit/choose.comp"));
    graph.push(Pass::compute(name, shader, groups(candidates), light, uses, need));
    let push = Push::new(&ListPush { candidates, blocks, pixels });
    let (name, shader) = ("audit.sums", module!("audit/sums.comp"));
    let uses = smallvec![read(0, chosen), write(1, sums)];
    graph.push(Pass::compute(name, shader, groups(blocks), push, uses, need));
    let (name, shader) = ("audit.list", module!("audit/list.comp"));
    let uses = smallvec![read(0, chosen), read(1, sums), write(2, listed), write(3, arguments)];
    graph.push(Pass::compute(name, shader, groups(blocks), push, uses, need));
    let mut uses = Uses::from_slice(&inputs.gbuffer.bound());
    uses.extend([
        read(2, frame),
        image(3, tree.nodes),
        read(4, listed),
        image(5, tree.triangles),
        write(6, parts),
        Use::fixed(arguments, Access::Indirect),
    ]);
    let [whole, cut] = tree.needs(graph, need);
    let mut trace = |name, shader, uses, need| {
        let work = Work::Indirect { shader, arguments, offset: 0 };
        graph.push(Pass { name, uses, push: light, work, need });
    };
    trace("audit.trace", module!("audit/trace.comp"), uses.clone(), whole);
    if let Some(cut_outs) = tree.cut_outs {
        uses.extend(cut_outs.bound(7));
        trace("audit.trace_cut", module!("audit/trace_cut.comp"), uses, cut);
    }
    let push = Push::new(&ListPush { candidates, blocks: pixel_blocks, pixels });
    let (name, shader) = ("audit.errors", module!("audit/errors.comp"));
    let uses = smallvec![read(0, listed), read(1, parts), write(2, errors)];
    graph.push(Pass::compute(name, shader, groups(pixel_blocks), push, uses, need));
    let (name, shader) = ("audit.figures", module!("audit/figures.comp"));
    let uses = smallvec![read(0, listed), read(1, errors), read(2, number), write(3, figures)];
    graph.push(Pass::compute(name, shader, [1, 1, 1], push, uses, need));
}

/// Adds the passes that write the constants of `traced/frame.glsl`, and returns their buffer.
fn constants(graph: &mut Graph, inputs: &PassInputs, need: &Need) -> ResourceId {
    let constants = graph.buffer("audit.constants", 720);
    let first = LightConstants::of(inputs);
    graph.push(Pass::constants("audit.light", constants, 0, &first, need));
    let second = PixelConstants::of(inputs);
    graph.push(Pass::constants("audit.pixels", constants, 128, &second, need));
    constants
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_as_many_as_candidates_and_no_smaller_than_pixels() {
        for extent in [[640, 360], [1920, 1080], [360, 640], [37, 16384]] {
            for candidates in [64, 1024, 4096] {
                let [columns, lines] = cells(extent, candidates);
                assert!(
                    (candidates..candidates + columns).contains(&(columns * lines)),
                    "{extent:?}"
                );
            }
        }
        assert_eq!(cells([8, 4], 1024), [8, 4]);
        assert_eq!(cells([1, 1], 64), [1, 1]);
    }
}
