//! The knobs of ray marching.

use crate::Error;
use crate::knob::{Field, Knobs, MAP_OF_256, choice, choices};
use crate::stages::depth_layers::Projection;
use crate::stages::nbuffer::{self, Levels};
use crate::techniques::room::Room as _;

/// The depth layers, which decide what is solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layers {
    /// Two layers: solid from the nearest faces to the furthest back faces (section 3.3).
    Two,
    /// Three layers: without the part that the eye looks through (section 3.4).
    Eye,
    /// Four layers: solid from the nearest faces to the nearest back faces, and from the furthest front faces to the
    /// furthest back faces. Where several views serve a light there are two more, of a third piece between these.
    #[default]
    Four,
}

choices! { Layers: "2" => Two, "3" => Eye, "4" => Four }

/// The search of a ray for the matter that stops it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Search {
    /// A search by windows of the N-buffer (section 3.5).
    #[default]
    Hierarchical,
    /// A search a texel at a time, refined by halving (section 3.3).
    Linear,
}

choices! { Search: "hierarchical" => Hierarchical, "linear" => Linear }

/// The points of the light that a pixel's rays go to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// Each ray goes to a random place in a cell of its own.
    Jittered,
    /// Each ray goes to a random place on the light.
    Random,
    /// The rays go to the points of Sobol's sequence, scrambled for each pixel.
    #[default]
    LowDiscrepancy,
}

choices! { Sampling: "jittered" => Jittered, "random" => Random, "low-discrepancy" => LowDiscrepancy }

/// The hash that makes a pixel's random numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hash {
    /// A hash of integers (Jarzynski and Olano 2020).
    #[default]
    Pcg,
    /// The hash MD5, reduced to 16 rounds (Curtis 2009, appendix A).
    Md5,
}

choices! { Hash: "pcg" => Pcg, "md5" => Md5 }

/// The knobs of ray marching.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The maps' side, texels, 1 to 4096; 0, the default, for 256 where one view serves a light and 512 where several do.
    pub map: u32,
    /// The most views of a light, 1 to 8; 6 by default.
    pub views: u32,
    /// Rays a pixel, 1 to 256; 16 by default.
    pub rays: u32,
    /// The points of the light that rays go to.
    pub sampling: Sampling,
    /// The hash that makes the random numbers.
    pub hash: Hash,
    /// The seed of the random numbers; another one each frame changes the noise.
    pub seed: u32,
    /// The search of a ray for the matter that stops it.
    pub search: Search,
    /// The windows of the hierarchical search.
    pub levels: nbuffer::Kind,
    /// The depth layers, which decide what is solid.
    pub layers: Layers,
    /// The projection of the layers.
    pub projection: Projection,
    /// Whether rays are traced only where the N-buffer cannot decide without them; on by default.
    pub classify: bool,
    /// Whether noise is filtered, where the filter removes more noise than it blurs; on by default.
    pub filter: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            map: 0,
            views: 6,
            rays: 16,
            sampling: Sampling::default(),
            hash: Hash::default(),
            seed: 1,
            search: Search::default(),
            levels: nbuffer::Kind::default(),
            layers: Layers::default(),
            projection: Projection::default(),
            classify: true,
            filter: true,
        }
    }
}

impl Knobs for Settings {
    const NAME: &'static str = "ray-march";
    const FIELDS: &'static [Field<Self>] = &[
        Field::map_of_views(MAP_OF_256, |s| s.map, |s, map| s.map = map),
        Field::views(|s| s.views, |s, views| s.views = views),
        Field::whole(
            "seed",
            "whole number",
            [0, u32::MAX],
            "which random numbers place the rays",
            |s| s.seed,
            |s, seed| s.seed = seed,
        ),
        Field::whole(
            "rays",
            "rays a pixel",
            [1, 256],
            "rays that a pixel in penumbra sends to the light; any whole number",
            |s| s.rays,
            |s, rays| s.rays = rays,
        ),
        choice!(
            "layers",
            Layers,
            "depth layers that say what is solid: 2, from the nearest to the furthest faces; 3, that but for what the \
             eye looks through; 4, two pieces, each from a front to a back face, and with several views a third between",
            layers
        ),
        choice!(
            "search",
            Search,
            "how a ray looks for what stops it: by windows of the N-buffer, or a texel at a time",
            search
        ),
        choice!(
            "sampling",
            Sampling,
            "where the rays of a pixel go: each to a random place in a cell of its own, each anywhere, or to the \
             points of a scrambled sequence",
            sampling
        ),
        choice!(
            "hash",
            Hash,
            "what makes random numbers of pixels; md5 is the one of 16 rounds that Curtis 2009 published",
            hash
        ),
        choice!(
            "levels",
            nbuffer::Kind,
            "the windows of the hierarchical search: 2^k texels a side at every texel, 3^k, or 2^k side by side; mip \
             where map is above 1024",
            levels
        ),
        choice!(
            "projection",
            Projection,
            "where the layers are seen from: a point behind the light, its centre, or infinitely far",
            projection
        ),
        Field::switch(
            "classify",
            "pixels that a window of the N-buffer shows to be lit or in umbra send no rays, and rays are cut to the \
             heights that matter; off is for measuring what that saves",
            |s| s.classify,
            |s, on| s.classify = on,
        ),
        Field::switch(
            "filter",
            "noise is filtered, as widely as takes more noise away than it blurs: less with many rays, and not at all \
             where penumbrae are narrow",
            |s| s.filter,
            |s, on| s.filter = on,
        ),
    ];
}

impl Settings {
    /// Whether a frame of several views has the piece of matter between the first and the last over each texel.
    pub(super) fn has_middle(&self) -> bool {
        self.layers == Layers::Four && self.views > 1
    }

    /// Checks the knobs that must agree with each other.
    pub(super) fn check_together(&self) -> Result<(), Error> {
        let map = self.maps().largest();
        let levels = Levels { map, kind: self.levels };
        // Mip levels lie side by side, so that they take two layers for any map.
        if levels.kind == nbuffer::Kind::Mip || levels.texels() * TEXEL_BYTES <= MOST_BYTES {
            return Ok(());
        }
        Err(Error::Setting {
            key: "levels".into(),
            problem: format!(
                "the windows of a map of {} texels a side need {} MiB, more than the {} that they may \
                 have; set levels=mip or map=1024",
                map,
                (levels.texels() * TEXEL_BYTES) >> 20,
                MOST_BYTES >> 20
            ),
        })
    }

    /// The least width of a penumbra, in pixels, that the noise filter changes: its Gaussian's standard deviation a
    /// follows from a³ = N W² / (4 √π), `noise.glsl`.
    pub(super) fn filtered_from(&self) -> f64 {
        let random = self.sampling == Sampling::Random;
        let noise = 0.33 * f64::from(self.rays).powf(if random { -0.5 } else { -0.75 });
        (LEAST_FILTER.powi(3) * 7.09 / noise).sqrt()
    }
}

/// The standard deviation, in pixels, below which the noise filter changes nothing (`noise.glsl`).
const LEAST_FILTER: f64 = 0.4;

/// The bytes of a window's bounds, and of a column.
const TEXEL_BYTES: u64 = 16;

/// The memory limit of all levels, bytes. Windows at every texel take a layer as large as the map for each of their
/// sizes.
const MOST_BYTES: u64 = 1 << 28;
