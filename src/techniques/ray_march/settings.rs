//! The knobs of ray marching.

use crate::Error;
use crate::stages::nbuffer::{self, Levels};

/// The depth layers that say what is solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layers {
    /// From the nearest faces to the furthest back faces (section 3.3).
    Two,
    /// The same, but for what the eye looks through (section 3.4).
    Eye,
    /// From the nearest faces to the nearest back faces, and from the furthest front faces to the furthest
    /// back faces.
    #[default]
    Four,
}

impl Layers {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] = &[("2", Self::Two), ("3", Self::Eye), ("4", Self::Four)];
}

/// Where the layers are seen from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// A point behind the light (eq. 3.1).
    #[default]
    Behind,
    /// The light's centre.
    Centre,
    /// Infinitely far (section 5.1).
    Orthographic,
}

impl Projection {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] =
        &[("behind", Self::Behind), ("centre", Self::Centre), ("orthographic", Self::Orthographic)];
}

/// How a ray looks for what stops it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Search {
    /// By windows of the N-buffer (section 3.5).
    #[default]
    Hierarchical,
    /// A texel at a time, refined by halving (section 3.3).
    Linear,
}

impl Search {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] =
        &[("hierarchical", Self::Hierarchical), ("linear", Self::Linear)];
}

/// Where on the light a pixel's rays go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// Each to a random place in a cell of its own.
    Jittered,
    /// Each to a random place on the light.
    Random,
    /// To the points of Sobol's sequence, scrambled for each pixel.
    #[default]
    LowDiscrepancy,
}

impl Sampling {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] = &[
        ("jittered", Self::Jittered),
        ("random", Self::Random),
        ("low-discrepancy", Self::LowDiscrepancy),
    ];
}

/// What makes random numbers of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hash {
    /// A hash of integers (Jarzynski and Olano 2020).
    #[default]
    Pcg,
    /// MD5 reduced to 16 rounds (appendix A).
    Md5,
}

impl Hash {
    /// Every choice and its name.
    pub const ALL: &[(&str, Self)] = &[("pcg", Self::Pcg), ("md5", Self::Md5)];
}

/// Every knob of ray marching but the maps' side, which all techniques share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Rays a pixel, 1 to 256; 16 by default.
    pub rays: u32,
    /// Where they go.
    pub sampling: Sampling,
    /// What the random numbers come from.
    pub hash: Hash,
    /// Which random numbers; another one each frame changes the noise.
    pub seed: u32,
    /// How they look for what stops them.
    pub search: Search,
    /// The windows of the hierarchical search.
    pub levels: nbuffer::Kind,
    /// What is solid.
    pub layers: Layers,
    /// Where the layers are seen from.
    pub projection: Projection,
    /// Whether rays are only spent where a window of the N-buffer cannot say that they are not needed.
    pub classify: bool,
    /// Whether noise is filtered, where filtering takes more of it away than it blurs.
    pub filter: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
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

/// Of a window's bounds, or a column.
const TEXEL_BYTES: u64 = 16;

/// Windows at every texel take a layer as large as the map for each of their sizes: more than this for them
/// is more than a shadow should have.
const MOST_BYTES: u64 = 1 << 28;

impl Settings {
    /// Whether the knob with this key is within its range; keys of other techniques pass.
    pub(crate) fn in_range(&self, key: &str) -> bool {
        key != "rays" || (1..=256).contains(&self.rays)
    }

    /// Checks the knobs that must agree with each other and with the maps' side.
    pub(crate) fn check_agreement(&self, map: u32) -> Result<(), Error> {
        let levels = Levels { map, kind: self.levels };
        // Levels side by side are two layers, whatever the map.
        if levels.kind == nbuffer::Kind::Mip || levels.texels() * TEXEL_BYTES <= MOST_BYTES {
            return Ok(());
        }
        Err(Error::Setting {
            key: "levels".into(),
            problem: format!(
                "the windows of a map of {map} texels a side need {} MiB, more than the {} that they may \
                 have; set levels=mip or map=1024",
                (levels.texels() * TEXEL_BYTES) >> 20,
                MOST_BYTES >> 20
            ),
        })
    }

    /// The switches' names.
    pub(crate) const SWITCH: &[(&str, bool)] = &[("on", true), ("off", false)];
}
