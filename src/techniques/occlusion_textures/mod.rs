//! Occlusion textures (Eisemann and Décoret 2008): the visible fraction from prefiltered slices of the occluders.
//!
//! ```text
//!        projection point           once         place      where slices begin and end
//!              ·                                 slices     every face counted in its slice
//!          ────┴────  light                      mask       one number a texel, a bit a slice
//!          \       /                             sums       means of any rectangle
//!   - - - - \-----/ - - - - -       each pixel   visibility for each slice between the pixel and the light
//!      ┌──┐  \   /                                          the mean over its kernel, combined
//!   - -│  │- -\-/- ┌─┐- - - -   ┐
//!      └──┘    │   └─┘          │ a slice, flattened into its texture
//!   - - - - - -│- - - - - - -   ┘
//!              ● pixel
//! ```
//! The light's rays to a point fill a rectangle in every plane between them (section 3.1, eq. 4); the share of it that
//! a flattened slice covers is the share of the light that the slice hides. The mean of a rectangle costs the same for
//! any size, so the cost does not grow with the light, and there is no noise.
//!
//! **Slices** (section 3.4). The map is seen from so far behind the light that the light fits its window. Every face is
//! counted, whatever lies in front of it: faces are drawn into four times four channels of eight bits at once and
//! blending adds, which every device can; a second draw counts from the seventeenth slice on. Then a texel is one
//! number, a bit a slice, and filling a slice into the next one (`fill=on`) is a shift. The product counts a filled
//! slice twice, which doubles its error; `correlated` recognizes the overlap, and its error stays as it is.
//!
//! **Filtering** (section 3.2). `prefilter=sat`, the default: summed-area tables of whole numbers, exact for maps up to
//! 4096², and with parts of texels at a rectangle's rim counted in proportion, so that nothing jumps. `n-buffer` and
//! `mip` interpolate between levels of windows of 2^k × 2^k texels as published; a rectangle that is longer than wide
//! is covered by up to eight windows side by side. The authors prefer N-buffers, for their speed; on the driver
//! measured the table is not only the exact one of the three but also the fastest to query, with four fetches in most
//! cases where the others take eight (their Fig. 2, four slices, lavapipe):
//!
//! | to make, and 480² pixels, ms | mip | table | N-buffer |
//! |---|---|---|---|
//! | 256² | 1.1 + 90 | 1.1 + 38 | 8.2 + 115 |
//! | 512² | 2.6 + 134 | 3.2 + 50 | 36 + 192 |
//! | 1024² | 8.4 + 137 | 19 + 61 | 231 + 199 |
//!
//! **Combination** (section 3.3). As published the visible fraction is the product of what each slice lets through
//! (eq. 5), as if slices were independent; `sum` and `max` are the paper's others. But a closed solid lies in two
//! slices at least, and these hide the same part of the light: the product counts it twice. Where we depart
//! (`combine=correlated`, the default):
//! * Fronts and backs are counted apart. Matter lies where more has been entered than left: a solid blocks in each
//!   slice from its front to its back. A column in which not everything entered is left goes through an open mesh, and
//!   only its faces block. Both sides of a double-sided face are counted, so that it is a sheet.
//! * The model: over the kernel's rectangle, let a be the share of texels that the slice blocks, b the share that any
//!   slice nearer the light blocks, and j the share of both. j is ab where they are independent, min(a, b) where one
//!   lies behind the other, max(0, a + b − 1) where they are side by side. Where j lies between these bounds is the
//!   correlation. The part of the light that is already hidden, h, was seen through other rectangles; the overlap of a
//!   and h is put at the same place between their bounds, and h grows by a less the overlap. That is right for
//!   independent, nested and disjoint slices, however many, up to a constant that keeps small shares from being
//!   divided (`FEW`). A window that is covered wholly or not at all gives no correlation; then the part that may
//!   continue from the slice right above decides. The share that any slice above the next one blocks is a + b − j, so
//!   two slices and three sums of the slices above them describe a pair: five sums of 25 bits in the 128 of a texel,
//!   exact up to 4096², at no further fetch for a slice.
//! * A slice's texture lies in its middle instead of its lower plane, or (`placement=fitted`) at the mean distance of
//!   its nearest and furthest faces.
//!
//! **Placement.** Uniform as published, or, the default and the authors' future work (section 5), by a histogram of
//! the distances of nearest and furthest faces, made on the device: half of a slice's share is distance, half is
//! faces. `combine=product placement=uniform` is what was published, and a test holds it against an independent
//! version.
//!
//! **Self-shadowing** (section 3.4). There is no split into occluders and receivers. A point's own slice does not
//! count, and the slice above fades in with the point's distance from it: an occluder nearer than a slice's thickness
//! shadows too little or not at all, so creases and contacts of an occluder with itself are too light. The part of the
//! light below the pixel's own plane is a closed form, as for the other techniques here. Where we depart (`correlated`
//! only): pixels that receive and do not block, as a ground does, are in no slice, and everything nearer the light
//! counts (which the authors suggest in section 4.1). And where several views serve a light, as in rooms, the map's
//! nearest faces are compared with the pixel's plane over its kernel, and a face before it counts for the share that
//! its slice does not (`hidden_near` of `visibility.comp`; with summed-area tables alone): light that grazes a wall
//! meets nothing but what lies in the wall's own slice.
//! Mean error with and without: kitchen 2.6 and 3.2, yard 4.0 and 7.8, three lamps of the hall 3.3 and 8.5. One
//! view shows a scene whose parts lie next to each other; there it changed no mean error by more than 0.2.
//!
//! **Tiles.** A tile whose pixels' kernels touch nothing in any slice that counts for them is lit. With summed-area
//! tables one rectangle a slice that holds the kernels of all its pixels decides. With levels squares of the mask
//! decide, because windows around a kernel reach further than the kernel, and a mean does not distinguish nothing from
//! little. The other tiles are listed (`stages/tiles`) with a bit for each slice that they may meet: their pixels
//! query no others. The image is the same to the bit.
//!
//! **A sun**'s light is parallel: slices are at heights, between the highest occluder over what a view serves and its
//! lowest receiver, and a kernel is as wide as the sun's angle makes it at the point's depth below the slice.
//!
//! **Slices by views.** A light that one view serves has 16 slices by default, and one that several serve has 32: their
//! second draw of the faces is skipped in frames with one view.
//!
//! **Measured** (lavapipe, 256² maps, 16 slices; mean error in percent over shadow and penumbra, published,
//! filled, ours): tall box 5.3, 10.3, 0.5; bunny 8.2, 17.0, 1.0; Suzanne 8.8, 21.3, 0.6; stacked cards 3.8,
//! 12.5, 1.2; slats 19, 31, 1.2, the last being the truth's noise. Leaves at random 1.3, 13.3, 1.3: there the
//! product is right, and ours finds the same. The bunny and Suzanne as their own occluders 6.4, 10.5, 2.1 and
//! 8.2, 13.6, 1.3. Four fitted slices do better than sixteen published ones on all of them but leaves. With the
//! same slices ours takes 1.14 to 1.28 times the time of the product at 256² (stacked cards in four slices 1.33),
//! 1.3 at 512² and 1.4 at 1024², where its tables, twice as many, weigh more. Time grows with the slices' number
//! to the power of 0.6, and with the map's side to that of 0.6 as published and 0.7 with ours. Behind an occluder
//! a pixel costs the same for every light from 0.2 object sizes on as published and from 0.7 on with ours, to
//! within 3 %, and down to 0.6 of that for one of 0.05 sizes, whose kernels are more
//! often empty or full; one whose kernels meet nothing costs next to nothing, so a view costs what its shadows
//! are large.
//!
//! **Limits.** What lies within a slice is one plane: the error is half a slice's thickness at most, so thin
//! slices near the receiver matter. A mesh drawn by the host and ready-made occluder maps are refused, as
//! neither can be sorted into slices. Two open meshes over one texel may make what is between them solid. More
//! than 255 faces over a texel in one slice count as 255. Another occluder may lighten a pixel, where it makes
//! two slices look more alike than they are. What is filtered takes 256 MiB at most: by summed-area tables 16
//! slices of 1448² or 32 of 1024², by N-buffers 16 of 511². A host's fixed window is not looked at, as with
//! `ray-march`.

mod pixels;
mod prefilter;
pub mod settings;
mod slices;
pub mod twin;

pub use settings::{Combine, Placement, Prefilter, Settings};

pub use pixels::{Squares, Visibility};
pub use prefilter::{FirstLevel, NextLevel, SumColumns, SumRows};
pub use slices::{Histogram, Mask, Place};

use self::pixels::{PrefilteredSlices, declare_pixels};
use self::prefilter::{declare_levels, declare_sums};
use self::slices::{declare_mask, declare_placement, histogram_layers, layers_side};
use super::room::{HostDraws, Maps, PassInputs, Room, Shows, Takes};
use crate::Error;
use crate::graph::{Graph, ResourceId};
use crate::stages::depth_layers::{DepthLayers, Projection};

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes {
            host_draws: HostDraws::Receivers(
                "cannot sort it into the slices of occlusion-textures",
            ),
            lent_maps: Err(
                "sorts every face of the occluders into slices, and occluder maps hold two of them",
            ),
            ..Takes::RECTANGLES
        }
    }

    fn shows(&self) -> Shows {
        Shows {
            back_side: true,
            fusion: true,
            slices: Some(self.fill || self.is_correlated()),
            ..Shows::SOFT
        }
    }

    fn maps(&self) -> Maps {
        Maps {
            several: self.sizes(self.views).map,
            layers: histogram_layers(self),
            eye: Projection::Behind,
            front_is_whole: false,
            ..Maps::front(self.sizes(1).map)
        }
    }

    fn takes_parallel(&self) -> bool {
        true
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        let wanted = self.maps().layers;
        let side = layers_side(self, inputs);
        let draws = self.is_fitted() || self.can_look_near();
        let layers = draws.then(|| inputs.depth_layers(graph, wanted, side));
        declare(graph, layers.as_ref(), self, inputs);
        None
    }

    fn most_served(&self) -> u32 {
        self.views
    }

    fn check_agreement(&self) -> Result<(), Error> {
        self.check_together()
    }
}

/// Adds the passes that turn meshes into the visible fraction; `layers` where slices are fitted to them or leave out what is
/// near a pixel.
fn declare(
    graph: &mut Graph,
    layers: Option<&DepthLayers>,
    settings: &Settings,
    inputs: &PassInputs,
) {
    let fitted = layers.filter(|_| settings.is_fitted());
    let placement = declare_placement(graph, fitted, settings, inputs);
    let mask = declare_mask(graph, placement, settings, inputs);
    let sums = settings.prefilter == Prefilter::Sat;
    let means = if sums {
        declare_sums(graph, mask, settings, inputs)
    } else {
        declare_levels(graph, mask, settings, inputs)
    };
    let front = layers.filter(|_| settings.can_look_near()).map(|layers| layers.front);
    let slices = PrefilteredSlices { placement, mask, means, front };
    declare_pixels(graph, &slices, settings, inputs);
}
