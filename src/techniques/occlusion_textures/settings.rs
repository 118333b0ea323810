//! The knobs of occlusion textures.

use crate::Error;
use crate::stages::nbuffer::{self, Levels};

/// How means of rectangles are made ready.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Prefilter {
    /// Means of 2^k × 2^k texels side by side (Williams 1983).
    Mip,
    /// Means of 2^k × 2^k texels beginning at every texel (Décoret 2005).
    NBuffer,
    /// Summed-area tables (Crow 1984) in whole numbers.
    #[default]
    Sat,
}

impl Prefilter {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] =
        &[("mip", Self::Mip), ("n-buffer", Self::NBuffer), ("sat", Self::Sat)];
}

/// Where slices begin and end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// All are as thick (section 3.4).
    Uniform,
    /// Thin where there is much in them.
    #[default]
    Fitted,
}

impl Placement {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] = &[("uniform", Self::Uniform), ("fitted", Self::Fitted)];
}

/// What slices hide together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Combine {
    /// As if they knew nothing of each other (eq. 5).
    Product,
    /// As if none lay behind another.
    Sum,
    /// As if all did.
    Max,
    /// By what they have in common in the kernel's window.
    #[default]
    Correlated,
}

impl Combine {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] = &[
        ("product", Self::Product),
        ("sum", Self::Sum),
        ("max", Self::Max),
        ("correlated", Self::Correlated),
    ];
}

/// Every knob of occlusion textures but the maps' side, which all techniques share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// How many slices, 4 to 32; 16 by default.
    pub slices: u32,
    /// Where they begin and end.
    pub placement: Placement,
    /// How they are filtered.
    pub prefilter: Prefilter,
    /// How they are combined.
    pub combine: Combine,
    /// Whether a slice blocks in the next one too (section 3.4).
    pub fill: bool,
    /// Whether tiles of pixels whose kernels meet nothing are told at once.
    pub classify: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            slices: 16,
            placement: Placement::default(),
            prefilter: Prefilter::default(),
            combine: Combine::default(),
            fill: false,
            classify: true,
        }
    }
}

/// Layers of an image that every device has (maxImageArrayLayers).
const MOST_LAYERS: u64 = 256;

/// Of what is filtered: as much as a summed-area table of 4096² has.
const MOST_BYTES: u64 = 1 << 28;

impl Settings {
    /// Whether the knob with this key is within its range; keys of other techniques pass.
    pub(crate) fn in_range(&self, key: &str) -> bool {
        key != "slices" || (4..=32).contains(&self.slices)
    }

    /// The switches' names.
    pub(crate) const SWITCH: &[(&str, bool)] = &[("on", true), ("off", false)];

    /// Whether slices are combined by what they have in common.
    pub fn is_correlated(&self) -> bool {
        self.combine == Combine::Correlated
    }

    /// What is filtered side by side: four slices each; correlated two, or one of levels.
    pub fn tiles(&self) -> u32 {
        let each = match (self.is_correlated(), self.prefilter) {
            (false, _) => 4,
            (true, Prefilter::Sat) => 2,
            (true, Prefilter::Mip | Prefilter::NBuffer) => 1,
        };
        self.slices.div_ceil(each)
    }

    /// Whether slices are placed by what there is.
    pub fn is_fitted(&self) -> bool {
        self.placement == Placement::Fitted
    }

    /// The windows of [`Prefilter::Mip`] and [`Prefilter::NBuffer`].
    pub(super) fn level_kind(&self) -> nbuffer::Kind {
        if self.prefilter == Prefilter::Mip { nbuffer::Kind::Mip } else { nbuffer::Kind::NBuffer }
    }

    /// Whether what is filtered of a map of `map` texels a side is an image that every device has: of
    /// 4096 rows as long for summed-area tables, of 256 layers for levels, and of no more bytes.
    fn fits(&self, map: u32) -> bool {
        let tiles = u64::from(self.tiles());
        let texels = u64::from(map) * u64::from(map) * tiles;
        if self.prefilter == Prefilter::Sat {
            return texels <= u64::from(super::passes::IMAGE_WIDTH).pow(2);
        }
        let layers = u64::from(Levels { map, kind: self.level_kind() }.layers() - 1);
        layers * tiles <= MOST_LAYERS && 8 * layers * texels <= MOST_BYTES
    }

    /// Checks the knobs that must agree with the maps' side.
    pub(crate) fn check_agreement(&self, map: u32) -> Result<(), Error> {
        if self.fits(map) {
            return Ok(());
        }
        let most = (1..map).rev().find(|&m| self.fits(m)).unwrap_or(1);
        Err(Error::Setting {
            key: "map".into(),
            problem: format!(
                "{} slices of {map} texels a side, filtered, take more than the 256 MiB that they may have; \
                 set map={most}, prefilter=mip or fewer slices",
                self.slices
            ),
        })
    }
}
