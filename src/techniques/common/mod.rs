//! What users would pick instead: the techniques that soft shadows are measured against.
//!
//! Each is done as its authors would, at the G-buffer's pixels, with the meaning of the result, the
//! roles and the mask that every technique here has:
//!
//! | | | |
//! |---|---|---|
//! | [`hard`] | a shadow map from the light's centre, 3×3 percentage-closer filtered | Reeves 1987 |
//! | [`pcss`] | a filter as wide as the blockers' mean distance says | Fernando 2005 |
//! | [`back_projection`] | occluder texels projected back onto the light, gaps filled | Guennebaud 2006 |
//! | [`many_lights`] | the mean of hard shadow maps from points all over the light | the GPU's own truth |
//!
//! **One bias for all of them.** A texel's surface hides a pixel where it lies above the pixel's own
//! plane, which the G-buffer's depth gives: the receiver-plane bias, exact for flat receivers at any
//! slope and filter width. It may be off by the rounding of that test and by how far the raster moves a
//! vertex, and a bent surface of the pixel's own rises above its plane by up to 0.3 of the distance
//! within the map (`glsl/common/light_space.glsl`); that much higher a texel must lie. The distance is half a
//! texel's diagonal where a texel stands for itself, and how far away it is where it stands for a whole
//! filter. Nothing is to be tuned.
//!
//! **Limits.** The maps of all but [`many_lights`] see what the light's centre sees.

pub mod push;
mod settings;
pub mod twin;

pub use settings::Settings;

use crate::RectangleLight;
use crate::graph::{Access, Graph, Need, Pass, Push, ResourceId, Use, Uses};
use crate::shaders::Module;
use crate::stages::depth_layers::MapView;
use crate::stages::visibility::{GBuffer, grid};
use smallvec::smallvec;

/// What a frame gives the techniques.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// The light.
    pub light: &'a RectangleLight,
    /// How the occluder map looks at the scene.
    pub occluders: &'a MapView,
    /// The host's pixels.
    pub gbuffer: &'a GBuffer,
    /// 2^−(sub-pixel bits): how far the device's rasters move a vertex, in texels.
    pub snap: f32,
    /// How far off the w of an occluder may be beyond its rounding, 1/m.
    pub depth_error: f64,
    /// Whether anything can be shadowed.
    pub need: &'a Need,
}

/// What `one_map.glsl` says; `count` is the technique's own.
pub(crate) fn pixel_push(count: u32, inputs: &Inputs) -> Push {
    let Inputs { occluders, gbuffer, .. } = inputs;
    Push::new(&push::Pixels {
        light_from_ndc: gbuffer.light_from_ndc,
        texels_per_uv: occluders.texels_per_uv().map(|x| x as f32),
        first: occluders.first().map(|x| x as f32),
        half_light: inputs.light.half_extents().map(|x| x as f32),
        extent: gbuffer.extent.map(|e| e as i32),
        background: gbuffer.background,
        inv_near: (1.0 / occluders.near) as f32,
        snap: inputs.snap,
        depth_error: inputs.depth_error as f32,
        map: occluders.side as i32,
        masked: i32::from(gbuffer.mask.is_some()),
        count: count as i32,
    })
}

/// What the passes over the pixels read: `one_map.glsl`, but for the image that they write.
pub(crate) fn pixel_uses(front: ResourceId, gbuffer: &GBuffer) -> Uses {
    smallvec![
        Use::bound(0, gbuffer.depth, Access::SampledCompute),
        Use::bound(1, gbuffer.mask.unwrap_or(gbuffer.depth), Access::SampledCompute),
        Use::bound(2, front, Access::SampledCompute),
    ]
}

/// Adds the row that turns the map from the light's centre into visibility, as `one_map.glsl` has it;
/// `count` and the uses beyond the common ones are the technique's own.
pub(crate) fn one_map(
    graph: &mut Graph,
    name: &'static str,
    shader: Module,
    (front, visibility): (ResourceId, ResourceId),
    count: u32,
    more: &[Use],
    inputs: &Inputs,
) {
    let mut uses = pixel_uses(front, inputs.gbuffer);
    uses.push(Use::bound(3, visibility, Access::ImageWrite));
    uses.extend_from_slice(more);
    let (groups, push) = (grid(inputs.gbuffer.extent), pixel_push(count, inputs));
    graph.push(Pass::compute(name, shader, groups, push, uses, inputs.need));
}
