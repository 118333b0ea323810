//! The visible fraction from the blocking triangles themselves: exact but for the light's samples, and without noise.
//!
//! ```text
//!        light, n × n samples              1. a tile's receivers and the light make a shaft
//!       ▔▔▔▔▔▔▔▔▔▔▔▔▔▔                    2. the hierarchy of triangles is walked once a shaft
//!        \\    ◣      //                    3. each pixel tests what is in it against all samples at once:
//!         \\  ◥█◣   //                        three planes through the pixel and a triangle's edges are three
//!          \\  ▀▀ //                          lines across the samples, and between them the hidden samples
//!           ▁▁▁▁▁▁                           of a row are an interval of bits
//!         a tile of 4×4 pixels
//! ```
//! The hidden samples of all triangles are united by OR. Nothing is counted twice and nothing is missed, the order does
//! not matter, and the image has the same bits in each run. Frusta of rays and masks of samples are the ray tracing
//! literature's (Reshetov and others 2005; Laine and others 2005 mask the samples of an area light by silhouettes).
//!
//! **Samples.** They lie on a grid turned by a step in n, so that no two share a row or a column of the light: an edge
//! along the light's sides, as floors and boxes have them, is as fine as n² steps and not n. Each counts for the share of
//! its cell that the light's shape covers, so that a disc, a polygon, a sphere's disc or a capsule's stadium is nothing
//! but weights. Measured at 480×360, mean error in % with 64 samples, first with straight rows whose columns differ, then
//! on the turned grid: a furnished room 0.73 / 0.28, its window 1.60 / 0.90, a bunny 0.63 / 0.76, Suzanne 0.78 / 0.88.
//!
//! **No bias.** A receiver is moved towards the viewer by what its depth and the arithmetic may be off, so that it lies on
//! the viewer's side of its own surface. What its surface hides then follows from the surface's own triangles, and no
//! plane of the pixel is needed: creases and facets as small as a pixel make no dots. A triangle in whose plane a receiver
//! lies, to within rounding, hides nothing from it.
//!
//! **Lists.** A test of a pixel and a triangle costs the most, so that a shaft's list keeps no triangle that a look at the
//! whole shaft can leave out: one with all receivers and the whole light on one side of its plane, or of the plane of an
//! edge, or one that is seen between two rows or columns of samples. Where one triangle hides the whole light from all
//! receivers, that is the end of it. Of the others, those that span two rows of samples have a list of their own, because
//! they need two of eight intervals. Receivers are bounded by a box that turns with the surface, as tight as a box in
//! world axes is not. Measured, triangles listed before and after, in thousands: a bunny 388 / 315, a street under a sun
//! 318 / 43, a hall 483 / 158, where a few shafts more send rays. A flat surface that blocks and has the whole light behind
//! it is hidden by its own triangles, so that its tiles have no shaft: in the hall a seventh of them, which had a fourth of
//! the leaves and a fifth of the listed triangles.
//!
//! **Dense shafts.** A shaft's leaves are counted before anything else is done. Where there are too many, or where the
//! lists of an image are full, its pixels send rays to the same samples through the same hierarchy (`segment.glsl`: does
//! anything block this segment), so that the image does not change but by rounding.
//!
//! **Lights.** A sun is a shaft along directions, wherever the scene ends. A sphere or capsule turns the disc or stadium
//! that it shows towards the receivers of each shaft. The texture of a flat light weighs its samples by what the light
//! emits around them, by color where the result is.
//!
//! **What it costs.** A walk costs 30 to 40 ns a node and eight shafts side by side, a look at a listed triangle some 40 ns
//! and a test of it some 30 (two rows of samples) to 50 (all), for eight pixels and 64 samples, on a core of the machine that
//! `docs/accuracy.md` names; so the frame's time goes with the tiles and with the triangles in their shafts, which is their
//! density times the light's area. 256 samples cost a fourth to a half more. `docs/traced.md` has measurements.
//!
//! **Limits.** Meshes that the host draws itself are no triangles to it, and are refused. Fine penumbrae show n² steps.

pub mod constants;
pub mod passes;
pub mod settings;
mod weights;

pub use settings::Settings;

use super::room::{HostDraws, Maps, PassInputs, Room, Shapes, Shows, Takes};
use crate::graph::{Graph, ResourceId};

/// The side of the maps that the technique does not have; a placeholder's.
const NO_MAP: u32 = 16;

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes {
            host_draws: HostDraws::Receivers(
                "has no triangles for the hierarchy that traced reads",
            ),
            shapes: Shapes::ALL,
            texture: true,
            lent_maps: Err("works with triangles, and does not read depth images of occluders"),
        }
    }

    fn shows(&self) -> Shows {
        Shows { back_side: true, fusion: true, ..Shows::SOFT }
    }

    fn maps(&self) -> Maps {
        Maps::own_views(NO_MAP)
    }

    fn pixel_list(&self, extent: [u32; 2]) -> Option<(u64, &'static str)> {
        Some((passes::slot_bytes(extent), "give it fewer than 8.3 million pixels"))
    }

    fn reads_triangles(&self) -> bool {
        true
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        let constants = constants::declare(graph, self, inputs);
        passes::declare(graph, self, &inputs.hierarchy?, constants, inputs);
        None
    }
}
