//! The result of a light: one image that holds its visible fraction for each pixel.
//!
//! `visibility` is R32_SFLOAT, as large as the G-buffer: 1 is lit, 0 is umbra; 1 where nothing receives. Techniques
//! that work at the pixels write it themselves; results in the light's space are resolved onto the pixels here.

mod gbuffer;

pub use gbuffer::{Constants, GBuffer, NormalConstants};
pub(crate) use gbuffer::{nearest_at, plane_to_normal};

use crate::graph::{Access, Graph, Need, Owner, Pass, Push, ResourceId, Use, Uses, Work};
use crate::shaders::{self, module};
use crate::stages::depth_layers::MapView;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The visibility image's format.
pub const FORMAT: vk::Format = vk::Format::R32_SFLOAT;

/// The visibility image's format for a visible fraction of red, green and blue each; alpha is 1.
pub const COLOR_FORMAT: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// The uses of a node's own visibility image by hosts: they sample it, or copy it out.
pub(crate) const USAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::STORAGE.as_raw()
        | vk::ImageUsageFlags::SAMPLED.as_raw()
        | vk::ImageUsageFlags::TRANSFER_SRC.as_raw(),
);

/// The visibility image's format, with `color` or without.
pub fn format(color: bool) -> vk::Format {
    if color { COLOR_FORMAT } else { FORMAT }
}

/// The push constants of `lit.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LitPush {
    /// The image's width and height.
    pub extent: [i32; 2],
}

/// The push constants of `resolve.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ResolvePush {
    /// Receiver texels a unit of u and v.
    pub texels_per_uv: [f32; 2],
    /// The receiver-texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// 1 over the receiver map's near plane, 1/m.
    pub receiver_inv_near: f32,
    /// The map's side in texels.
    pub receiver_map: i32,
    /// 1: the mean of both maps, not their maximum.
    pub mean: i32,
}

/// The soft shadow map that is projected onto the pixels.
#[derive(Clone, Copy, Debug)]
pub struct Resolve<'a> {
    /// The receiver map.
    pub receiver_depth: ResourceId,
    /// The receiver map's view.
    pub view: &'a MapView,
    /// The occlusion by both sides; the same map twice where there is one.
    pub maps: [ResourceId; 2],
    /// Whether the occlusion is the mean of the two instead of their maximum.
    pub mean: bool,
}

/// Declares the visibility image: the node's own, or `lent` by the host.
pub fn declare(graph: &mut Graph, extent: [u32; 2], color: bool, lent: bool) -> ResourceId {
    let owner = if lent { Owner::Lent } else { Owner::Exported };
    graph.image("visibility", format(color), extent, owner)
}

/// The workgroups for one invocation a pixel, in groups of 8×8.
pub(crate) fn grid(extent: [u32; 2]) -> [u32; 3] {
    [extent[0].div_ceil(8), extent[1].div_ceil(8), 1]
}

/// Adds the pass that makes every pixel lit.
pub fn lit(graph: &mut Graph, visibility: ResourceId, extent: [u32; 2], color: bool, need: Need) {
    graph.push(Pass {
        name: "visibility.lit",
        uses: smallvec![Use::bound(0, visibility, Access::ImageWrite)],
        push: Push::new(&LitPush { extent: extent.map(|e| e as i32) }),
        work: Work::Dispatch {
            shader: if color { module!("visibility/lit_color.comp") } else { shaders::LIT },
            groups: grid(extent),
        },
        need,
    });
}

/// Adds the pass that projects a soft shadow map onto the pixels.
pub fn resolve(
    graph: &mut Graph,
    visibility: ResourceId,
    what: &Resolve,
    gbuffer: &GBuffer,
    need: &Need,
) {
    let mut uses = Uses::from_slice(&gbuffer.all_bound());
    uses.extend([
        Use::bound(2, what.receiver_depth, Access::SampledCompute),
        Use::bound(3, what.maps[0], Access::SampledCompute),
        Use::bound(4, what.maps[1], Access::SampledCompute),
        Use::bound(5, visibility, Access::ImageWrite),
    ]);
    graph.push(Pass {
        name: "visibility.resolve",
        uses,
        push: Push::new(&ResolvePush {
            texels_per_uv: what.view.texels_per_uv().map(|x| x as f32),
            first: what.view.first().map(|x| x as f32),
            receiver_inv_near: what.view.top() as f32,
            receiver_map: what.view.side as i32,
            mean: i32::from(what.mean),
        }),
        work: Work::Dispatch {
            shader: module!("visibility/resolve.comp"),
            groups: grid(gbuffer.extent),
        },
        need: *need,
    });
}
