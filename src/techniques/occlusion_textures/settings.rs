//! The knobs of occlusion textures.

use crate::Error;
use crate::knob::{Field, Knobs, MAP_OF_256, choice, choices};
use crate::stages::nbuffer::{self, Levels};
use crate::techniques::room::Maps;

/// The prefilter that gives means of rectangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Prefilter {
    /// Levels of means of 2^k × 2^k texels side by side (Williams 1983).
    Mip,
    /// Levels of means of 2^k × 2^k texels beginning at every texel (Décoret 2005).
    NBuffer,
    /// Summed-area tables (Crow 1984) in whole numbers.
    #[default]
    Sat,
}

choices! { Prefilter: "mip" => Mip, "n-buffer" => NBuffer, "sat" => Sat }

/// The placement of the slices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// All slices have one thickness (Eisemann and Décoret 2008 section 3.4).
    Uniform,
    /// Slices are thin where there are many faces.
    #[default]
    Fitted,
}

choices! { Placement: "uniform" => Uniform, "fitted" => Fitted }

/// The combination of the parts of the light that slices hide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Combine {
    /// The product of what slices let through, for independent slices (eq. 5).
    Product,
    /// The sum of what slices hide, for disjoint slices.
    Sum,
    /// The maximum of what slices hide, for nested slices.
    Max,
    /// The slices' measured overlap in the kernel's window.
    #[default]
    Correlated,
}

choices! { Combine: "product" => Product, "sum" => Sum, "max" => Max, "correlated" => Correlated }

/// The knobs of occlusion textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The maps' side, texels, 1 to 4096; 0, the default, for 256 where one view serves a light and 512 where several do.
    pub map: u32,
    /// The most views of a light, 1 to 8; 6 by default.
    pub views: u32,
    /// The number of slices, 4 to 32; 0, the default, for 16 where one view serves a light and 32 where several do.
    pub slices: u32,
    /// The placement of the slices.
    pub placement: Placement,
    /// The prefilter of the slices.
    pub prefilter: Prefilter,
    /// The combination of the slices.
    pub combine: Combine,
    /// Whether a slice also blocks in the next one (section 3.4); off by default.
    pub fill: bool,
    /// Whether tiles of pixels whose kernels meet no occluder are skipped; on by default.
    pub classify: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            map: 0,
            views: 6,
            slices: 0,
            placement: Placement::default(),
            prefilter: Prefilter::default(),
            combine: Combine::default(),
            fill: false,
            classify: true,
        }
    }
}

/// The width of the image of prefiltered tiles: the largest that every device has (maxImageDimension2D).
pub(super) const IMAGE_WIDTH: u32 = 4096;

/// The map's side where one view serves a light, unless `map` says it.
const USUAL_MAP: u32 = 256;

/// The layers of an image that every device has (maxImageArrayLayers).
const MOST_LAYERS: u64 = 256;

/// The memory limit of prefiltered slices, bytes: that of a summed-area table of 4096².
const MOST_BYTES: u64 = 1 << 28;

impl Knobs for Settings {
    const NAME: &'static str = "occlusion-textures";
    const FIELDS: &'static [Field<Self>] = &[
        Field::map_of_views(MAP_OF_256, |s| s.map, |s, map| s.map = map),
        Field::views(|s| s.views, |s, views| s.views = views),
        Field::classify(|s| s.classify, |s, on| s.classify = on),
        Field::whole(
            "slices",
            "slices",
            [0, 32],
            "parts of the occluders, from the light on, that are each flattened into a texture: 4 to 32, and 0 for 16 \
             where one view serves a light and 32, or 16 where these do not fit, where several do",
            |s| s.slices,
            |s, slices| s.slices = slices,
        ),
        choice!(
            "placement",
            Placement,
            "where slices begin and end: all equally thick, or thin where many nearest and furthest faces are",
            placement
        ),
        choice!(
            "prefilter",
            Prefilter,
            "where means over a part of a slice come from: textures of 2^k texels a side side by side, those at every \
             texel, or summed-area tables, which are exact",
            prefilter
        ),
        choice!(
            "combine",
            Combine,
            "how slices combine: independent (product, as published), disjoint (sum), nested (max), or by measured \
             overlap (correlated)",
            combine
        ),
        Field::switch(
            "fill",
            "a slice blocks in the next one too, which closes the leaks of thin occluders; the product takes that for \
             twice as much, combine=correlated does not",
            |s| s.fill,
            |s, on| s.fill = on,
        ),
    ];
}

/// The slices of one view, unless `slices` says how many.
const USUAL_SLICES: u32 = 16;

/// The least slices of one's own: what one draw counts in an image.
const LEAST_SLICES: u32 = 4;

/// The most slices: a bit each of the mask's 32. They are what several views have, which show occluders that lie as far
/// apart as a room is high.
const MOST_SLICES: u32 = 32;

/// The sizes of what a view is seen through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sizes {
    /// The map's side, texels.
    pub map: u32,
    /// The number of slices.
    pub slices: u32,
}

impl Settings {
    /// Checks the knobs that must agree with each other.
    pub(super) fn check_together(&self) -> Result<(), Error> {
        let Sizes { map, slices } = self.sizes(1);
        if slices < LEAST_SLICES {
            return Err(Error::Setting {
                key: "slices".into(),
                problem: format!(
                    "{slices} is outside its range; give {LEAST_SLICES} to {MOST_SLICES} (slices), or 0 for the usual number"
                ),
            });
        }
        if self.fits(Sizes { map, slices }) {
            return Ok(());
        }
        let most = (1..map).rev().find(|&map| self.fits(Sizes { map, slices })).unwrap_or(1);
        Err(Error::Setting {
            key: "map".into(),
            problem: format!(
                "{slices} slices of {map} texels a side, filtered, take more than the 256 MiB that they may have; \
                 set map={most}, prefilter=mip or fewer slices"
            ),
        })
    }

    /// The sizes of the views of a frame of which `served` share the receivers. What is left open is no larger than what
    /// prefiltered slices may have.
    pub(super) fn sizes(&self, served: u32) -> Sizes {
        let usual = Maps::by_views(self.map, USUAL_MAP, self.views);
        let slices = |open| if self.slices > 0 { self.slices } else { open };
        let one = Sizes { map: usual.side, slices: slices(USUAL_SLICES) };
        if served < 2 {
            return one;
        }
        let several = [usual.several, usual.side].into_iter().flat_map(|map| {
            [MOST_SLICES, USUAL_SLICES].map(|open| Sizes { map, slices: slices(open) })
        });
        several.into_iter().find(|&sizes| self.fits(sizes)).unwrap_or(one)
    }

    /// The most slices of any frame.
    pub(super) fn most_slices(&self) -> u32 {
        self.sizes(self.views).slices.max(self.sizes(1).slices)
    }

    /// Whether slices are combined by their measured overlap.
    pub fn is_correlated(&self) -> bool {
        self.combine == Combine::Correlated
    }

    /// Whether frames may look for what slices leave out near a pixel: with correlated slices in summed-area tables.
    pub(super) fn can_look_near(&self) -> bool {
        self.is_correlated() && self.prefilter == Prefilter::Sat
    }

    /// Whether the nearest faces tell what hides the light near a pixel, which slices leave out: where several views share
    /// the receivers. One view shows a scene whose parts lie next to each other.
    pub(super) fn looks_near(&self, served: u32) -> bool {
        self.can_look_near() && served > 1
    }

    /// The number of tiles to prefilter: four slices in each; of correlated slices two, or one for levels.
    pub(super) fn tiles(&self, slices: u32) -> u32 {
        let each = match (self.is_correlated(), self.prefilter) {
            (false, _) => 4,
            (true, Prefilter::Sat) => 2,
            (true, Prefilter::Mip | Prefilter::NBuffer) => 1,
        };
        slices.div_ceil(each)
    }

    /// Whether slices are placed by a histogram of the faces.
    pub fn is_fitted(&self) -> bool {
        self.placement == Placement::Fitted
    }

    /// The kind of windows of [`Prefilter::Mip`] and [`Prefilter::NBuffer`].
    pub(super) fn level_kind(&self) -> nbuffer::Kind {
        if self.prefilter == Prefilter::Mip { nbuffer::Kind::Mip } else { nbuffer::Kind::NBuffer }
    }

    /// Whether prefiltered slices fit an image that every device has: 4096 texels a side for summed-area tables, 256
    /// layers for levels, and the memory limit.
    fn fits(&self, Sizes { map, slices }: Sizes) -> bool {
        let tiles = u64::from(self.tiles(slices));
        let texels = u64::from(map) * u64::from(map) * tiles;
        if self.prefilter == Prefilter::Sat {
            return texels <= u64::from(IMAGE_WIDTH).pow(2);
        }
        let layers = u64::from(Levels { map, kind: self.level_kind() }.layers() - 1);
        layers * tiles <= MOST_LAYERS && 8 * layers * texels <= MOST_BYTES
    }
}
