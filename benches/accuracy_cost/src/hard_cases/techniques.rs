//! What is held of each technique, and why so much and no more.

use super::set::Block;

/// What an image is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// The visible fraction of the light.
    Light,
    /// That of a point at its centre, which is all that a hard shadow knows.
    Centre,
    /// 1 and 0 where those are it under a light 1.5 times as large; its penumbra is a guess.
    Plateaus,
}

/// A technique with its settings, and how far off it may be.
#[derive(Clone, Copy, Debug)]
pub struct Held {
    /// What the table calls it.
    pub name: &'static str,
    /// Its settings, as on a command line.
    pub words: &'static str,
    /// What its image is compared with.
    pub expected: Expected,
    /// Whether its map is seen from the light's centre, through the window that a host gives.
    pub windowed: bool,
    /// How far off an occluder's outline may be, in texels of the map at its distance.
    pub texels: f64,
    /// How far off in texels of the soft shadow map, which is seen through a filter.
    pub receiver_texels: f64,
    /// What rounding and shortcuts may add to a pixel that is not lit.
    pub sums: f64,
    /// What sampling the light may add to a pixel in penumbra.
    pub noise: f64,
    /// What sampling may add to the mean over the pixels in penumbra.
    pub mean_noise: f64,
    /// How many pixels to either side a filter spreads that.
    pub spread: usize,
    /// What a solid may add where the model flattens it, and in the mean.
    pub solids: [f64; 2],
    /// Why.
    pub why: &'static str,
}

/// Half a texel's diagonal: an outline is drawn where texels' centres are within.
const DRAWN: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Neighbouring patches at different distances overlap or leave gaps, by which one side's umbra sums to 0.89
/// to 1.13 of the light (Atty 2006 eq. 3); in the mean a tall box is wrong by 5 %.
const PATCHES: [f64; 2] = [0.13, 0.05];

/// What is held of a technique that adds nothing of its own: no filter, no noise, no model of solids.
const EXACT: Held = Held {
    name: "",
    words: "",
    expected: Expected::Light,
    windowed: true,
    texels: DRAWN,
    receiver_texels: 0.0,
    sums: 1e-6,
    noise: 0.0,
    mean_noise: 0.0,
    spread: 0,
    solids: [0.0; 2],
    why: "",
};

/// Hard shadows, which the node also falls back to where a penumbra is no wider than a pixel.
pub const HARD: Held = Held {
    name: "hard",
    words: "technique=hard",
    expected: Expected::Centre,
    texels: DRAWN + 1.5,
    why: "against a point: half a texel's diagonal, and the 3 × 3 texels of its filter",
    ..EXACT
};

/// The techniques that the table holds, each a column.
pub const ALL: &[Held] = &[
    Held {
        name: "soft-shadow-map",
        words: "technique=soft-shadow-map",
        // The gather's tolerance, and the rounding of its sums that tests/sums.rs holds.
        sums: 1e-4 + 2e-5,
        solids: PATCHES,
        why: "an outline is known to half a texel's diagonal; tolerance and sums 1.2e-4",
        ..EXACT
    },
    Held {
        name: "soft-shadow-map, blended",
        words: "technique=soft-shadow-map receivers=map sides=one accumulate=blend receiver_map=64",
        // Bilinear: from texels up to one away along either axis.
        receiver_texels: std::f64::consts::SQRT_2,
        sums: 2e-5,
        solids: PATCHES,
        why: "half a texel's diagonal, and a texel of the soft shadow map; sums 2e-5",
        ..EXACT
    },
    Held {
        name: "ray-march",
        words: "technique=ray-march",
        windowed: false,
        // An edge meets at most 7 of the 4 × 4 cells that hold a ray each.
        noise: 7.0 / 16.0,
        // Each of which is off by up to 1/16, evenly; two edges; E|x| of a normal x.
        mean_noise: 0.054,
        spread: 12,
        solids: PATCHES,
        why: "half a texel's diagonal; 16 rays, of which an edge meets 7 cells: 7/16, in the mean 0.054; the \
              filter spreads that by 12 pixels",
        ..EXACT
    },
    Held {
        name: "occlusion-textures",
        words: "technique=occlusion-textures",
        windowed: false,
        // A texel's mean is all that is known within it.
        texels: DRAWN + 1.0,
        sums: 1e-4,
        solids: PATCHES,
        why: "half a texel's diagonal, and a texel, within which only the mean is known; sums 1e-4",
        ..EXACT
    },
    Held {
        name: "linear-light",
        words: "technique=linear-light",
        windowed: false,
        // Skins begin and end at texels, and are read through a bilinear filter.
        texels: DRAWN + 2.0,
        sums: 2e-3,
        // Four lines side by side: an edge along them is known to half a line's share, and there are two.
        noise: 2.0 / 8.0,
        mean_noise: 1.0 / 16.0 + 0.01,
        solids: PATCHES,
        why: "half a texel's diagonal, the texel that a skin ends at and that of a bilinear filter; four lines, so \
              that each of two edges is off by up to 1/8, in the mean 1/32; 0.01 along the lines; 8 bits a skin 2e-3",
        ..EXACT
    },
    Held {
        name: "many-lights",
        words: "technique=many-lights samples=64",
        windowed: false,
        // An edge meets at most 15 of 8 × 8 cells.
        noise: 2.0 * 15.0 / 64.0,
        mean_noise: 0.02,
        why: "half a texel's diagonal; 64 points, of which each of two edges meets 15 cells: 30/64, in the mean 0.02",
        ..EXACT
    },
    Held {
        name: "traced",
        words: "technique=traced",
        windowed: false,
        // It has no map: an outline is where the triangles have it.
        texels: 0.0,
        // An edge meets at most 15 of the 8 × 8 cells, turned or not.
        noise: 2.0 * 15.0 / 64.0,
        mean_noise: 0.02,
        why: "64 samples, of which each of two edges meets 15 cells: 30/64, in the mean 0.02; outlines are exact",
        ..EXACT
    },
    HARD,
    Held {
        name: "pcss",
        words: "technique=pcss",
        expected: Expected::Plateaus,
        texels: DRAWN + 1.0,
        noise: 1.0,
        mean_noise: 1.0,
        why: "1 and 0 where a light 1.5 times as large has them; its penumbra guesses one distance for all that blocks",
        ..EXACT
    },
    Held {
        name: "back-projection",
        words: "technique=back-projection",
        texels: DRAWN + 1.0,
        sums: 2e-5,
        solids: PATCHES,
        why: "half a texel's diagonal, and the neighbour that a texel reaches to over a gap; sums 2e-5",
        ..EXACT
    },
];

impl Held {
    /// What blocks that are not flat and parallel to the light may add, and in the mean.
    pub fn of_solids(&self, blocks: &[Block]) -> [f64; 2] {
        if blocks.iter().all(Block::faces_light) { [0.0; 2] } else { self.solids }
    }
}
