//! Push structs, byte for byte as the shaders declare them; a test holds them against the SPIR-V.

use bytemuck::{Pod, Zeroable};

/// `columns.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Columns {
    /// The map's side in texels.
    pub map: i32,
    /// 2, or 4 where there are the nearest back and the furthest front faces too.
    pub layers: i32,
    /// Of what is stored as 1.
    pub height: f32,
}

/// `level.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Level {
    /// The map's side in texels.
    pub map: i32,
    /// Of levels.
    pub kind: i32,
    /// The one to make.
    pub level: i32,
}

/// `start.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Start {
    /// Light space to the G-buffer's NDC, by column.
    pub ndc_from_light: [f32; 16],
}

/// `filter.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Filter {
    /// The G-buffer's NDC to light space, by column.
    pub light_from_ndc: [f32; 16],
    /// Of the G-buffer.
    pub extent: [i32; 2],
}

/// `classify.comp` and `trace.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Pixels {
    /// The G-buffer's NDC to light space, by column.
    pub light_from_ndc: [f32; 16],
    /// Map texels a unit of u and v, or a metre where the projection is orthographic.
    pub texels_per_unit: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// Of the G-buffer.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// How far behind the light the projection point is, m; or the far plane's distance.
    pub eye: f32,
    /// The height of the near plane.
    pub top: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// How far off an occluder's height may be beyond its rounding.
    pub depth_error: f32,
    /// The map's side in texels.
    pub map: i32,
    /// Rays, rows of cells and what is switched on, see `pixel.glsl`.
    pub flags: i32,
    /// Of the hashes.
    pub seed: u32,
}
