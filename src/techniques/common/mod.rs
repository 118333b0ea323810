//! Passes and push constants of the techniques with one map from the light's centre.
//!
//! **One bias for all of them.** A texel's surface hides a pixel where it lies above the pixel's own plane, which the
//! G-buffer gives: the receiver-plane bias, exact for flat receivers at any slope and filter width. The bias
//! is the rounding of that test, the distance by which a raster moves a vertex, and the height by which a bent surface
//! rises above the pixel's plane: up to 0.3 of the distance within the map (`glsl/common/light_space.glsl`). That
//! distance is half a texel's diagonal where a texel stands for itself, and the distance to the texel where it stands
//! for a whole filter. Nothing is to be tuned.
//!
//! **Limits.** A map from the light's centre misses occluders that the centre does not see.

pub mod twin;

use super::room::PassInputs;
use crate::graph::{Access, Graph, Pass, Push, ResourceId, Use, Uses};
use crate::shaders::Module;
use crate::stages::visibility::{GBuffer, grid};
use bytemuck::{Pod, Zeroable};

/// The push constants of passes over the pixels with one occluder map (`one_map.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Pixels {
    /// Map texels a unit of u and v.
    pub texels_per_uv: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// 1 over the map's near plane, 1/m; no occluder is nearer.
    pub inv_near: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// The error of an occluder's w beyond its rounding, 1/m.
    pub depth_error: f32,
    /// The map's side in texels.
    pub map: i32,
    /// The number of taps or levels.
    pub count: i32,
}

/// The push constants of `finest_level.comp` and `nearest.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FinestLevel {
    /// The map's side in texels.
    pub map: i32,
    /// 1 over the map's near plane, 1/m.
    pub inv_near: f32,
}

/// The push constants of a pass over the pixels; `count` is the technique's own.
pub(crate) fn pixel_push(count: u32, inputs: &PassInputs) -> Push {
    let PassInputs { occluders, .. } = inputs;
    Push::new(&Pixels {
        texels_per_uv: occluders.texels_per_uv().map(|x| x as f32),
        first: occluders.first().map(|x| x as f32),
        half_light: inputs.light.half_extents().map(|x| x as f32),
        inv_near: occluders.top() as f32,
        snap: inputs.snap,
        depth_error: inputs.depth_error as f32,
        map: occluders.side as i32,
        count: count as i32,
    })
}

/// The inputs of a pass over the pixels, as `one_map.glsl` binds them; the image that it writes is bound after them.
pub(crate) fn pixel_uses(front: ResourceId, gbuffer: &GBuffer) -> Uses {
    let mut uses = Uses::from_slice(&gbuffer.all_bound());
    uses.push(Use::bound(2, front, Access::SampledCompute));
    uses
}

/// Adds the pass that turns the map from the light's centre into the visible fraction (`one_map.glsl`); `count` and the
/// uses in `more` are the technique's own.
pub(crate) fn one_map(
    graph: &mut Graph,
    name: &'static str,
    shader: Module,
    front: ResourceId,
    count: u32,
    more: &[Use],
    inputs: &PassInputs,
) {
    let mut uses = pixel_uses(front, inputs.gbuffer);
    uses.push(Use::bound(3, inputs.visibility, Access::ImageWrite));
    uses.extend_from_slice(more);
    let (groups, push) = (grid(inputs.gbuffer.extent), pixel_push(count, inputs));
    graph.push(Pass::compute(name, shader, groups, push, uses, inputs.need));
}
