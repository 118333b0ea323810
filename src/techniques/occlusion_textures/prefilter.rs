//! Means over the slices: summed-area tables, or levels of a mip pyramid or an N-buffer.

use super::settings::{IMAGE_WIDTH, Settings};
use crate::graph::{Access, Graph, Owner, Pass, Push, ResourceId, Use};
use crate::shaders::{Module, module};
use crate::stages::nbuffer::Levels;
use crate::stages::visibility::grid;
use crate::techniques::room::PassInputs;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The rows or columns of texels that a workgroup sums up (`scan.glsl`).
const LINES: u32 = 64;

/// As many in the variants whose workgroups cut each of them into parts.
const LINES_PARTED: u32 = 8;

/// The push constants of `sum_rows.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SumRows {
    /// The map's side in texels.
    pub map: i32,
    /// 1: each tile holds a slice; 0: each tile holds four slices.
    pub correlated: i32,
}

/// The push constants of `sum_columns.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SumColumns {
    /// The map's side in texels.
    pub map: i32,
}

pub(super) fn declare_sums(
    graph: &mut Graph,
    mask: ResourceId,
    settings: &Settings,
    inputs: &PassInputs,
) -> ResourceId {
    let side = inputs.occluders.side;
    let tiles = settings.tiles(settings.sizes(inputs.served).slices);
    let (values, format) = (tiles * side * side, vk::Format::R32G32B32A32_UINT);
    let extent = [IMAGE_WIDTH.min(values), values.div_ceil(IMAGE_WIDTH)];
    let sums = graph.image("occlusion_textures.filtered", format, extent, Owner::Transient);
    // A GPU has room for more invocations than there are rows or columns of texels: its shaders cut each of them into parts.
    // A processor has not, and would read every texel twice for nothing.
    let (rows, columns, lines) = match inputs.processor {
        true => (
            module!("occlusion_textures/sum_rows.comp"),
            module!("occlusion_textures/sum_columns.comp"),
            LINES,
        ),
        false => (
            module!("occlusion_textures/sum_rows_parted.comp"),
            module!("occlusion_textures/sum_columns_parted.comp"),
            LINES_PARTED,
        ),
    };
    let groups = [side.div_ceil(lines), tiles, 1];
    let mut sum = |name, shader: Module, push, uses| {
        graph.push(Pass::compute(name, shader, groups, push, uses, inputs.need));
    };
    sum(
        "occlusion_textures.sum_rows",
        rows,
        Push::new(&SumRows { map: side as i32, correlated: i32::from(settings.is_correlated()) }),
        smallvec![
            Use::bound(0, mask, Access::SampledCompute),
            Use::bound(1, sums, Access::ImageWrite)
        ],
    );
    sum(
        "occlusion_textures.sum_columns",
        columns,
        Push::new(&SumColumns { map: side as i32 }),
        smallvec![Use::bound(0, sums, Access::ImageUpdate)],
    );
    sums
}

/// The push constants of `first_level.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FirstLevel {
    /// The map's side in texels.
    pub map: i32,
    /// The kind of the levels' windows.
    pub kind: i32,
    /// 1: each tile holds a slice; 0: each tile holds four slices.
    pub correlated: i32,
}

/// The push constants of `next_level.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct NextLevel {
    /// The map's side in texels.
    pub map: i32,
    /// The kind of the levels' windows.
    pub kind: i32,
    /// The level to make.
    pub level: i32,
}

pub(super) fn declare_levels(
    graph: &mut Graph,
    mask: ResourceId,
    settings: &Settings,
    inputs: &PassInputs,
) -> ResourceId {
    let side = inputs.occluders.side;
    let tiles = settings.tiles(settings.sizes(inputs.served).slices);
    let levels = Levels { map: side, kind: settings.level_kind() };
    let format = vk::Format::R16G16B16A16_SFLOAT;
    let name = "occlusion_textures.filtered";
    // The mask holds level 0.
    let image = graph.image_array(name, format, [side; 2], tiles * (levels.layers() - 1));
    let kind = levels.kind.code();
    let groups = |level| {
        let [x, y, _] = grid([levels.side(level); 2]);
        [x, y, tiles]
    };
    graph.push(Pass::compute(
        "occlusion_textures.first_level",
        module!("occlusion_textures/first_level.comp"),
        groups(1),
        Push::new(&FirstLevel {
            map: side as i32,
            kind,
            correlated: i32::from(settings.is_correlated()),
        }),
        smallvec![
            Use::bound(0, mask, Access::SampledCompute),
            Use::bound(1, image, Access::ImageWrite)
        ],
        inputs.need,
    ));
    for level in 2..=levels.top() {
        graph.push(Pass::compute(
            "occlusion_textures.next_level",
            module!("occlusion_textures/next_level.comp"),
            groups(level),
            Push::new(&NextLevel { map: side as i32, kind, level: level as i32 }),
            smallvec![Use::bound(0, image, Access::ImageUpdate)],
            inputs.need,
        ));
    }
    image
}
