//! Rays through depth layers (Curtis 2009): the visible fraction as the share of rays that arrive.
//!
//! ```text
//!             light           once         columns      what the layers say is solid over each texel
//!       ──────────────                     levels       what windows of columns have in common
//!         \  |    /           each pixel   classify     lit, umbra, or a place in a list
//!   ┌──┐   \ |  ╱  first      each listed  trace        rays to the light, through the columns
//!   │  │    \|╱│   interval                filter       noise spread over the pixel's own surface
//!   └──┘    ╱└─┘
//!         ╱  ┌─┐   second interval
//!  ──────●───┴─┴──────────    a height above the far plane, the same along every ray and column
//! ```
//! A light-space map is seen from a point so far behind the light that the light fits its window (eq. 3.1), or from
//! infinitely far. In (texels, height), with height = 1/distance, or metres where the projection is orthographic, rays
//! are straight, so that a search needs no conversions between texture and world.
//!
//! **What is solid** (section 3.3): with `layers=2` the matter between the nearest and the furthest faces of the
//! occluders; with `layers=3` without the part that the eye looks through (section 3.4; it needs a G-buffer that shows
//! the occluders). Where we depart (`layers=4`, the default): the nearest *back* faces and the furthest *front* faces
//! are drawn too, two more passes without peeling, and matter then lies in two pieces, from the nearest face to the
//! nearest back face and from the furthest front face to the furthest back face. Occluders with at most two pieces
//! over a texel, an ear over a back, a leaf over a leaf, are exact, and light falls between. A face without its other
//! side is a sheet. Where several views serve a light, a third piece between the two counts as well, from the first front
//! face beyond the first piece to the next back face: in a room the last piece is a wall or the floor, and hides nothing
//! that is seen, and the first one may be the wall around a window (a kitchen under its window, mean error 2.4 → 1.9 %).
//! Between texels a sheet or a thin plate that is steep would let rays through: each piece reaches
//! down to where its top goes on in the neighbouring texels (`step_down`). And a column is as high all over its texel
//! as at its centre, so that rays that graze a solid meet corners that stick out of it: the corners are cut off by the
//! height of the surface's slope over half a texel (`beveled`), which removes most of the excess darkness of solids
//! (the bunny's own shadows, 256 rays: bias −0.44 → 0.09 points, mean error 1.65 → 1.48 %).
//!
//! **Search** (section 3.5): windows of an N-buffer hold the highest top and the lowest bottom of their columns; a ray
//! that stays above or below passes at once, otherwise smaller windows are tested. The windows also hold the lowest
//! first top and the highest first bottom: between them all columns are solid, and a ray that passes through there is
//! stopped without a test of any column. If all rays of a pixel pass there, the pixel is in umbra. The texel that a
//! ray is over follows from the lines that it has crossed, whatever windows it came through, so that every kind of
//! windows, with classification or without, gives the same bits. `search=linear` visits the ray a texel at a time and
//! halves the step where it met something (section 3.3). Both use one hit test; [`twin::meets`] finds the same by a
//! walk over every texel. A search takes no more than 250 turns (the linear one 200 steps, longer than a texel on
//! longer rays); a ray that is not done by then passes.
//!
//! **Bias** (eq. 3.2). A pixel's own surface must not stop its rays. Curtis shortens rays by a texel over the cosine;
//! here a column counts where its top lies above the pixel's own plane, which the G-buffer's depth gives, by more than
//! a surface bent from facet to facet may rise within a texel. It is the bias of the other techniques: exact for flat
//! receivers at any slope, and nothing is lost at contact. The part of the light under that plane is a closed form;
//! its rays are not traced.
//!
//! **Noise.** Rays go to Sobol's points, scrambled for each pixel by a hash, to jittered cells (section 3.1) or
//! anywhere. The filter is a separable Gaussian over the pixel's own surface (section 3), whose width follows from the
//! penumbra's width and the noise of that number of rays: see `noise.glsl`.
//!
//! **Textured and coloured lights** (section 5.1): each ray is weighed by the light's emission at its end, and the
//! visible fraction is that of the emission: of its luminance, or of red, green and blue each
//! (`Description::light_texture`). The rays then also sample the part of the light under the pixel's own plane.
//!
//! **Discs, suns, polygons and lines**: rays go to the points of a disc, and the part of it below the pixel's own plane is
//! a segment. A sun is its disc, and its light parallel. A polygon's points are those of the triangles that it is cut into,
//! and its part above the plane is a sum over its edges. A line's rays have each a part of its length, and no filter: the
//! penumbra has no width across it.
//!
//! **Deferred** (algorithm 1): the rays are those of the G-buffer's pixels. The benchmark also measures a forward
//! renderer, which traces rays for every fragment as it is drawn: `antumbra_harness::Forward` calls the same functions
//! from a fragment shader. A cube takes about as long that way, a scan of 48 thousand triangles 1.6 to 3 times as long
//! (800×600 pixels, 4 and 9 rays, no filter, lavapipe). A fragment has its exact plane, though, which depths do not
//! give for facets as small as pixels: 1.3 instead of 2.0 % mean error on the bunny (tests/techniques/forward.rs).
//!
//! **Limits.** Three pieces of matter over one texel lose the middle one, unless they overlap; with several views four
//! lose the third, and three the middle one where the host draws occluders. Meshes are
//! expected closed or thin: an open sheet above a solid counts as solid down to the solid's back.
//! Lent occluder maps have the light's centre as their projection point and two layers.

mod passes;
pub mod settings;
pub mod twin;

pub use passes::{Columns, Level, Pixels, Start};
pub use settings::{Hash, Layers, Sampling, Search, Settings};

use self::passes::{declare, list_bytes};
use super::room::{Maps, Noise, PassInputs, Room, Shapes, Shows, Takes};
use crate::Error;
use crate::graph::{Graph, ResourceId};
use crate::stages::depth_layers::Wanted;

impl Room for Settings {
    fn takes(&self) -> Takes {
        let shapes = Shapes::LINES.and(Shapes::POLYGONS).and(Shapes::DISCS);
        Takes { shapes, texture: true, ..Takes::RECTANGLES }
    }

    fn shows(&self) -> Shows {
        Shows {
            back_side: true,
            fusion: self.layers == Layers::Four,
            eye_layer: self.layers == Layers::Eye,
            noise: if self.filter {
                Noise::FilteredFrom(self.filtered_from())
            } else {
                Noise::Unfiltered
            },
            ..Shows::SOFT
        }
    }

    fn maps(&self) -> Maps {
        let inner = self.layers == Layers::Four;
        Maps {
            layers: Wanted { back: true, inner, middle: self.has_middle(), receiver_map: None },
            eye: self.projection,
            back_can_be_dropped: true,
            ..Maps::by_views(self.map, 256, self.views)
        }
    }

    fn takes_parallel(&self) -> bool {
        true
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        let layers = inputs.depth_layers(graph, self.maps().layers, inputs.occluders.side);
        declare(graph, &layers, self, inputs);
        Some(layers.front)
    }

    fn most_served(&self) -> u32 {
        self.views
    }

    fn check_agreement(&self) -> Result<(), Error> {
        self.check_together()
    }

    fn pixel_list(&self, extent: [u32; 2]) -> Option<(u64, &'static str)> {
        Some((list_bytes(extent), "up to 11 million pixels work"))
    }
}
