//! Push structs, byte for byte as the shaders declare them; a test holds them against the SPIR-V.

use bytemuck::{Pod, Zeroable};

/// `one_map.glsl`, for every technique with one occluder map.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Pixels {
    /// Normalized device coordinates to light space.
    pub light_from_ndc: [f32; 16],
    /// Map texels a unit of u and v.
    pub texels_per_uv: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// 1 over the map's near plane, 1/m; no occluder is nearer.
    pub inv_near: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// How far off an occluder's w may be beyond its rounding, 1/m.
    pub depth_error: f32,
    /// The map's side in texels.
    pub map: i32,
    /// 1 where the mask is there.
    pub masked: i32,
    /// Of taps or levels.
    pub count: i32,
}

/// `finest_level.comp` and `nearest.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FinestLevel {
    /// The map's side in texels.
    pub map: i32,
    /// 1 over the map's near plane, 1/m.
    pub inv_near: f32,
}

/// `next_level.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct NextLevel {
    /// The map's side in texels.
    pub map: i32,
    /// The level to make, 2 and up.
    pub level: i32,
}

/// `receivers.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Receivers {
    /// Normalized device coordinates to light space.
    pub light_from_ndc: [f32; 16],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// 1 where the mask is there.
    pub masked: i32,
}

/// `add_point.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct AddPoint {
    /// The point on the light, m from its centre.
    pub point: [f32; 2],
    /// Map texels a unit of u and v, as the point has them.
    pub texels_per_uv: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// 1 over the map's near plane, 1/m.
    pub inv_near: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// The map's side in texels.
    pub map: i32,
}

/// `average.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Average {
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// How many points there were.
    pub points: f32,
}
