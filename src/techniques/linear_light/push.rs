//! Push structs, byte for byte as the shaders declare them; a test holds them against the SPIR-V.

use bytemuck::{Pod, Zeroable};

/// `view.glsl`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Sample {
    /// By column; each mesh pushes its own.
    pub line_from_mesh: [f32; 16],
    /// Least and largest u at the line's first end, at its last.
    pub u_window: [f32; 4],
    /// Its length, m.
    pub line: f32,
    /// Which sample.
    pub nth: i32,
}

/// `take.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Take {
    /// 1 over the map's near plane, 1/m.
    pub inv_near: f32,
    /// Its side in texels.
    pub map: i32,
    /// Where it goes.
    pub layer: i32,
}

/// `mask.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Mask {
    /// Least and largest u at the line's first end, at its last.
    pub u_window: [f32; 4],
    /// Its length, m.
    pub line: f32,
    /// The maps' side in texels.
    pub map: i32,
}

/// `place.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Place {
    /// Asked for, as a share of the line.
    pub error: f32,
    /// Samples.
    pub most: i32,
    /// 1: as many as may be, evenly.
    pub even: i32,
}

/// `spread.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Spread {
    /// Samples.
    pub count: i32,
}

/// `start.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Start {
    /// The line's x along the light's x and y; its middle, m.
    pub turn: [f32; 4],
    /// Least and largest u at its first end, at its last.
    pub u_window: [f32; 4],
    /// Least and largest v.
    pub v_window: [f32; 2],
    /// Its length, m.
    pub line: f32,
    /// Its share of the light.
    pub weight: f32,
    /// Which sample, and the segment before it.
    pub nth: i32,
    /// Of the image of places.
    pub row: i32,
    /// Workgroups along a side of a map.
    pub groups: i32,
}

/// `edges.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Edges {
    /// Least and largest u at the line's first end, at its last.
    pub u_window: [f32; 4],
    /// The maps' side in texels.
    pub map: i32,
    /// -1: occluders that end towards -x; 1: towards +x.
    pub side: i32,
}

/// `skins.vert` and `skins.frag`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Skins {
    /// Least and largest u at the line's first end, at its last.
    pub u_window: [f32; 4],
    /// Its length, m.
    pub line: f32,
    /// No receiver is further than 1/w_far.
    pub w_far: f32,
    /// The maps' side in texels.
    pub map: i32,
    /// -1: skins that the last sample saw, as the first one sees them; 1: the other way round.
    pub side: i32,
    /// 1: by the w of what is behind; 0: by that of what lies beside the edge.
    pub rational: i32,
}

/// `keep.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Keep {
    /// The maps' side in texels.
    pub map: i32,
    /// Where the sample's goes.
    pub layer: i32,
}

/// `visibility.comp`
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Visibility {
    /// The G-buffer's NDC to light space, by column.
    pub light_from_ndc: [f32; 16],
    /// Of the G-buffer.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// The maps' side in texels.
    pub map: i32,
    /// Samples that a line may have.
    pub most: i32,
    /// How many there are.
    pub lines: i32,
    /// 1: the mask holds the receivers' roles.
    pub masked: i32,
}
