//! Push structs, byte for byte as the shaders declare them; a test holds them against the SPIR-V.

use bytemuck::{Pod, Zeroable};

/// `edges.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Edges {
    /// Tangent of the map's first texel border.
    pub u_first: f32,
    /// Of a texel.
    pub u_step: f32,
    /// 1 over the map's near plane, 1/m.
    pub inv_near: f32,
    /// Its side in texels.
    pub map: i32,
    /// Where it is.
    pub slot: i32,
    /// -1: occluders that end towards -x; 1: towards +x.
    pub side: i32,
}

/// `skins.vert` and `skins.frag`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Skins {
    /// Of the map that is drawn into.
    pub texels_per_u: f32,
    /// Texel coordinate of u = 0.
    pub first: f32,
    /// From its sample to the one that saw the skins, m along x.
    pub apart: f32,
    /// No receiver is further than 1/w_far.
    pub w_far: f32,
    /// 1 over the map's near plane, 1/m.
    pub inv_near: f32,
    /// Its side in texels.
    pub map: i32,
    /// Where it is.
    pub slot: i32,
    /// 1: by the w of what is behind; 0: by that of what lies beside the edge.
    pub rational: i32,
}

/// `keep.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Keep {
    /// 1 over the maps' near plane, 1/m.
    pub inv_near: f32,
    /// Their side in texels.
    pub map: i32,
    /// Of the segment's first sample.
    pub slot: i32,
    /// Which.
    pub segment: i32,
}

/// `visibility.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Visibility {
    /// The G-buffer's NDC to light space, by column.
    pub light_from_ndc: [f32; 16],
    /// Least and largest u at the line's first end, at its last.
    pub u_window: [f32; 4],
    /// Least and largest v at the light's least y, at its largest.
    pub v_window: [f32; 4],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// Of the G-buffer.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// The maps' side in texels.
    pub map: i32,
    /// Samples, lines and what is switched on, see `visibility.comp`.
    pub flags: i32,
}
