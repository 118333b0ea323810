//! Soft shadow maps (Atty, Holzschuch, Lapierre, Hasenfratz, Hansen, Sillion 2006).
//!
//! ```text
//!   light    ├──────── L ────────┤          seen from the receiver at (v, w_r), the patch that is
//!             \        |        /           occluder-map texel [u, u+Δu] at w_o covers
//!              \       |       /
//!   patch       \   ├──┼──┤   /  w_o          [(u − v) k/L, (u + Δu − v) k/L] ∩ [−½, ½]
//!                \     |     /
//!                 \    |    /               of the light in x, likewise in y, with the
//!   receiver ──────\───●───/────  w_r       magnification k = 1/(w_o − w_r). Sum over all patches.
//! ```
//! Every texel of the occluder map is a micro-patch parallel to the light (section 3.2). What it
//! hides of the light is a product of two interval overlaps (section 3.4), and the occlusion of a
//! receiver is the sum over all patches. Two layers, nearest and furthest faces, are summed apart
//! and the larger counts (section 3.5).
//!
//! Two ways to add up:
//!
//! * **blend**: as published, but on the GPU from end to end (section 4.3). Texels become a buffer
//!   of patches in a fixed order, drawn indirectly as penumbra rectangles and blended into a soft
//!   shadow map.
//! * **gather**: each receiver visits the texels. A texel wholly inside the light's window counts
//!   (Δu/Lx)(Δv/Ly)k², wherever it is, so a whole node (a square of 8² or 32² texels) inside it is
//!   one closed form in its moments: with r = 1/(w̄ − w_r) and S₂, S₃ the sums of (w − w̄)² and
//!   (w − w̄)³ over its n occupied texels, r²(n + 3 S₂ r² − 4 S₃ r³). Nodes outside the window cost
//!   nothing. Of an 8² node across its rim, the rectangle of texels inside the window is a closed form
//!   as well: four entries of a table of prefix sums of 1, δ, δ² and δ³ (δ = w − w̄) give its moments,
//!   and its sum is r²(n − 2 S₁ r + 3 S₂ r² − 4 S₃ r³). Only texels on the rim itself are evaluated.
//!
//! **The gather's tolerance.** The closed form is the Taylor series of 1/(1 + δ)², δ = (w − w̄)r, cut
//! behind δ³. With |δ| ≤ q < 1 the rest is at most f(q) = Σ_{j≥4} (j+1) q^j = (5q⁴ − 4q⁵)/(1 − q)² of
//! a node's n r². Each 1/(1 + δ)² is at least 1/(1 + q)², so that is at most g(q) = f(q) (1 + q)² of
//! what the node hides. All nodes together are wrong by at most g(q) of the occlusion, which is
//! g(q)/(1 − g(q)) of the visible fraction at most. [`spread_of`] inverts g. That is of patches parallel to the light: the
//! slopes of sloped ones are kept to the first order alone, which adds 3e-4 with the default tolerance (measured on
//! spheres). The float sums add 2e-6 at most to that, whatever the tolerance (measured; `docs/rounding.md` derives a bound).
//!
//! **Sloped patches.** A patch parallel to the light stands for a surface that leans, and the patches of a leaning surface
//! overlap or leave gaps (eq. 3): an edge-on one, which hides nothing, still counts all of its treads. Where we depart, at
//! the pixels: a patch has the slope g of w from texel to texel, along each axis the lesser step to its two neighbours.
//! From a receiver its projection's determinant is k²(1 − k (c − t)·g), with c its centre in texels, so that is what it
//! counts; it is below 0 where the receiver sees the side that the light sees. Inside a node that is linear in moments of
//! c·g and g: Σ −k³(c − t)·g, to the first order in δ for texels of a plane. Mean errors with patches parallel to the
//! light and with sloped ones, defaults, 640×480: bunny 2.3 and 1.7 %, Suzanne 1.6 and 1.0, a room behind a window that is
//! the light 36 and 6.2.
//!
//! **At the pixels.** The same gather, evaluated at the G-buffer's pixels, needs no receiver map and
//! no split into occluders and receivers, which the authors name as their largest limitation
//! (section 7). A plane of light space is linear in (u, v, w), so whether a texel lies above the
//! pixel's own plane is one multiply-add each: texels that do not are left out, and the part of the
//! light under the plane, which the pixel's own surface hides, is a closed form. The bias is the
//! rounding of that test, how far a raster may shift a vertex, and how far a bent surface of the
//! pixel's own rises above its plane within a texel (0.15 of its diagonal, measured); there is nothing
//! to tune.
//!
//! **Tiles.** One query of the nodes finds for all pixels of a tile whether an occluder lies before any of them within
//! the light's window (`stages/tiles`); the gather runs only for tiles with one. The query walks the nodes in the
//! gather's own order, and a node that it rejects adds exactly 0 to each pixel's sum.
//!
//! **The mean of both sides.** The paper merges the shadows of the nearest and of the furthest faces by
//! their maximum (section 3.5). But neighbouring patches at different distances overlap or leave a gap
//! that grows with their step in w (eq. 3), and on a solid that bulges the steps of its back are those of
//! its front with the other sign: where the one sums to 1 + e, the other sums to about 1 − e. The maximum
//! is then always too dark, by |e|; the mean cancels e. A back face that does not lie before the receiver
//! (a thing that stands on it) is stood in for by the front face of the same texel, receiver by receiver;
//! where the front is flat there is no e to cancel, and the back is left out; and what either side hides
//! wholly is umbra, since a depth step inside a silhouette leaves a gap in one side alone. Mean errors
//! against those of the maximum, of patches parallel to the light, N = 256, L = 0.4 and 1, windows fitted: spheres 0.8 and 1.0 % for 2.0
//! and 2.9, bunny 1.3 and 1.8 for 2.3 and 2.7, Suzanne 1.0 and 1.5 for 1.6 and 2.5, tall box 0.6 and 3.4
//! for 1.3 and 4.1, stacked cards 1.3 and 2.3 for 1.5 and 2.4.
//!
//! **Blending in 32 bits.** Thousands of equal patches added to one float round the same way each time:
//! 2e-5 of the light at N = 256, growing with N². So contributions are rounded to multiples of 2⁻²⁴
//! first, up or down by a plane-filling sequence of thresholds; sums of those are exact, and the error
//! is under 7e-6 up to N = 4096. In 16 bits nothing helps (appendix A), which `blend-fp16` shows.
//!
//! Where we read the paper: "one pass with bottom patches" (Fig. 11b) is not described there. Here
//! each front texel's patch is put at the distance of the furthest back face behind it, which costs
//! what one pass costs, as the figure's frame rates do, and closes contact shadows.
//!
//! **Limits.** On a soft shadow map, whose patches are as published, neighbours at different distances overlap or leave
//! gaps (eq. 3): full umbra sums to 0.89 … 1.13. What the light's centre cannot see casts nothing. A ray that enters and
//! leaves a solid by sides that the light's centre sees counts once below 0 and once above: beside tall boxes under a light
//! that reaches over them, shadows are too light by 2 % in the mean.
//!
//! Mesa's CPU driver (llvmpipe, 22.3) cuts a shader invocation off after 65,535 turns of all its loops
//! together, and says nothing: light leaks in where the rest of the sum is missing. The gather takes
//! eight texels a turn for that reason, which is enough up to N = 2048 for pixels that lie as close as an
//! image's do. With N = 4096 it is enough for those under one side; both sides may lose some umbra there.
//! A coarse receiver map, whose texels share no nodes, may lose most of it under a light whose window is half
//! of the occluder map: of three texels a side from N = 1024 on, of eight from N = 2048. Other drivers have no
//! such limit.

mod nodes;
mod pixels;
mod receiver_map;
pub mod settings;
pub mod twin;

pub use nodes::{Blocks, Superblocks};
pub use pixels::GatherPixels;
pub use receiver_map::{
    BLEND_STEPS, GatherMap, PatchCount, PatchDraw, PatchEmit, PatchScan, receiver_grid,
};
pub use settings::{Accumulate, Receivers, Settings, Sides, spread_of};

use self::nodes::{combination, declare_nodes, sides};
use self::receiver_map::{blend_map, gather_map};
use super::room::{Maps, PassInputs, Room, Shows, Takes};
use crate::Error;
use crate::graph::{Graph, ResourceId};
use crate::stages::depth_layers::{DepthLayers, Wanted};
use crate::stages::visibility;
use smallvec::SmallVec;

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes::RECTANGLES
    }

    fn shows(&self) -> Shows {
        let both = self.sides != Sides::One;
        let self_shadowing = self.receivers == Receivers::Pixels;
        Shows { back_side: both, fusion: both, self_shadowing, ..Shows::SOFT }
    }

    fn maps(&self) -> Maps {
        let at_pixels = self.receivers == Receivers::Pixels;
        Maps {
            layers: Wanted {
                back: self.sides != Sides::One,
                inner: false,
                middle: false,
                receiver_map: (!at_pixels).then_some(self.receiver_map),
            },
            // A soft shadow map has passes for each side.
            back_can_be_dropped: at_pixels,
            ..Maps::by_views(self.map, 128, self.most_served())
        }
    }

    fn most_served(&self) -> u32 {
        // A soft shadow map has a view of its own.
        if self.receivers == Receivers::Map { 1 } else { self.views }
    }

    fn takes_parallel(&self) -> bool {
        true
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        let layers = inputs.depth_layers(graph, self.maps().layers, inputs.occluders.side);
        declare(graph, &layers, self, inputs);
        Some(layers.front)
    }

    fn check_agreement(&self) -> Result<(), Error> {
        self.check_together()
    }

    fn blends_f32(&self) -> bool {
        self.accumulate == Accumulate::Blend
    }
}

/// Adds the passes that turn depth layers into the visible fraction.
fn declare(graph: &mut Graph, layers: &DepthLayers, settings: &Settings, inputs: &PassInputs) {
    let (visibility, view) = (inputs.visibility, inputs.receivers);
    // Without a back layer both sides are the front. A receiver map keeps the passes of each side.
    let one = Settings { sides: Sides::One, ..*settings };
    let at_pixels = settings.receivers == Receivers::Pixels;
    let settings = if at_pixels && layers.back.is_none() { &one } else { settings };
    let gather = settings.accumulate == Accumulate::Gather;
    let nodes = declare_nodes(graph, layers, settings, inputs, gather);
    match (settings.receivers, layers.receivers) {
        (Receivers::Map, Some(receiver_depth)) => {
            let maps: SmallVec<[_; 2]> = sides(settings)
                .iter()
                .map(|&side| {
                    if gather {
                        gather_map(graph, &nodes, receiver_depth, side, settings, inputs, view)
                    } else {
                        blend_map(graph, &nodes, receiver_depth, side, settings, inputs, view)
                    }
                })
                .collect();
            let both = [maps[0], maps[maps.len() - 1]];
            let mean = combination(settings) == Sides::Mean;
            let resolve = visibility::Resolve { receiver_depth, view, maps: both, mean };
            visibility::resolve(graph, visibility, &resolve, inputs.gbuffer, inputs.need);
        }
        _ => pixels::gather(graph, &nodes, settings, inputs),
    }
}
