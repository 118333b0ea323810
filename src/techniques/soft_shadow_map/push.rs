//! Push structs, byte for byte as the shaders declare them; a test holds them against the SPIR-V.

use bytemuck::{Pod, Zeroable};

/// `blocks.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Blocks {
    /// The map's side in texels.
    pub map: i32,
    /// Blocks a row.
    pub row: i32,
    /// 1 over the near plane's distance, 1/m.
    pub inv_near: f32,
    /// 0: both layers as they are; 1: front texels take the back layer's distance where it has one; 2:
    /// back texels behind a front that is flatter by far are left out.
    pub faces: i32,
}

/// `superblocks.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Superblocks {
    /// Superblocks a row.
    pub row: i32,
}

/// `gather_map.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GatherMap {
    /// (Δu/Lx, Δv/Ly), 1/m.
    pub scale: [f32; 2],
    /// Occluder texels a receiver texel.
    pub t_step: [f32; 2],
    /// The occluder-map position of the centre of receiver texel (0, 0), in texels.
    pub t_first: [f32; 2],
    /// No occluder is nearer than 1/w_max.
    pub w_max: f32,
    /// The series' limit.
    pub spread: f32,
    /// 1 over the receiver map's near plane, 1/m.
    pub receiver_inv_near: f32,
    /// The receiver map's side in texels.
    pub receiver_map: i32,
    /// Superblocks a row.
    pub row: i32,
    /// 0 front, 1 back.
    pub side: i32,
}

/// `gather_pixels.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GatherPixels {
    /// Normalized device coordinates to light space.
    pub light_from_ndc: [f32; 16],
    /// (Δu/Lx, Δv/Ly), 1/m.
    pub scale: [f32; 2],
    /// Occluder texels a unit of u and v.
    pub texels_per_uv: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// No occluder is nearer than 1/w_max.
    pub w_max: f32,
    /// The series' limit.
    pub spread: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// Superblocks a row.
    pub row: i32,
    /// Bit 0: the mask is there; bit 1: two sides; bit 2: their mean.
    pub flags: i32,
    /// How far off an occluder's w may be beyond its rounding, 1/m.
    pub depth_error: f32,
}

/// `patch_count.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PatchCount {
    /// Blocks of one side.
    pub blocks: i32,
    /// 0 front, 1 back.
    pub side: i32,
}

/// `patch_scan.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PatchScan {
    /// Groups of 64 blocks.
    pub groups: i32,
}

/// `patch_emit.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PatchEmit {
    /// Blocks a row.
    pub row: i32,
    /// 0 front, 1 back.
    pub side: i32,
}

/// `patch.vert` and `patch.frag`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PatchDraw {
    /// (Δu/Lx, Δv/Ly), 1/m.
    pub scale: [f32; 2],
    /// Occluder texels a receiver texel.
    pub t_step: [f32; 2],
    /// The occluder-map position of the centre of receiver texel (0, 0), in texels.
    pub t_first: [f32; 2],
    /// No receiver is further than 1/w_far.
    pub w_far: f32,
    /// 1 over the receiver map's near plane, 1/m.
    pub receiver_inv_near: f32,
    /// The receiver map's side in texels.
    pub receiver_map: i32,
    /// Steps a unit of occlusion that contributions are rounded to; 0 rounds none.
    pub steps: f32,
}
