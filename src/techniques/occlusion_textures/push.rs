//! Push structs, byte for byte as the shaders declare them; a test holds them against the SPIR-V.

use bytemuck::{Pod, Zeroable};

/// `histogram.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Histogram {
    /// The layers' side in texels.
    pub map: i32,
    /// Distance of the near plane from the projection point, m.
    pub near: f32,
    /// Of the occluders, m.
    pub span: f32,
}

/// `place.comp` and `place_fitted.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Place {
    /// Of the occluders from the light's plane, m.
    pub near: f32,
    /// Of the furthest of them.
    pub far: f32,
    /// How far behind the light the projection point is, m.
    pub eye: f32,
    /// Where in a slice its texture lies: 0 above, 1 below.
    pub plane: f32,
    /// How many.
    pub slices: i32,
}

/// `mask.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Mask {
    /// The map's side in texels.
    pub map: i32,
    /// How many.
    pub slices: i32,
    /// 1: what lies between front and back faces blocks.
    pub solid: i32,
    /// 1: a slice blocks in the next one too.
    pub fill: i32,
}

/// `sum_rows.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SumRows {
    /// The map's side in texels.
    pub map: i32,
    /// 1: a tile a slice; 0: a tile four slices.
    pub correlated: i32,
}

/// `sum_columns.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SumColumns {
    /// The map's side in texels.
    pub map: i32,
}

/// `first_level.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FirstLevel {
    /// The map's side in texels.
    pub map: i32,
    /// Of levels.
    pub kind: i32,
    /// 1: a tile a slice; 0: a tile four slices.
    pub correlated: i32,
}

/// `next_level.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct NextLevel {
    /// The map's side in texels.
    pub map: i32,
    /// Of levels.
    pub kind: i32,
    /// The one to make.
    pub level: i32,
}

/// `squares.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Squares {
    /// The map's side in texels.
    pub map: i32,
}

/// `visibility.comp` and `tiles.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Visibility {
    /// The G-buffer's NDC to light space, by column.
    pub light_from_ndc: [f32; 16],
    /// Map texels a unit of u and v.
    pub texels_per_uv: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// Of the G-buffer.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// How far behind the light the projection point is, m.
    pub eye: f32,
    /// The map's side in texels.
    pub map: i32,
    /// Slices and what is switched on, see `slices.glsl`.
    pub flags: i32,
}
