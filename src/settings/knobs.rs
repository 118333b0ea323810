//! Every knob: unit, range, default, and what 0 means.

use super::Technique;

/// One knob, as data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Knob {
    /// The key, as in `--set key=value`.
    pub key: &'static str,
    /// The techniques that have it; empty for all of them.
    pub techniques: &'static [Technique],
    /// The unit of the value.
    pub unit: &'static str,
    /// The values that are legal.
    pub range: &'static str,
    /// The value that stands where none is given.
    pub default: &'static str,
    /// What it does, and what 0 means where 0 is legal.
    pub about: &'static str,
}

impl Knob {
    /// Whether a technique has it.
    pub fn serves(&self, technique: Technique) -> bool {
        self.techniques.is_empty() || self.techniques.contains(&technique)
    }

    /// The names of the techniques that have it, or `all`.
    pub fn techniques(&self) -> String {
        match self.techniques {
            [] => "all".into(),
            some => some.iter().map(|t| t.name()).collect::<Vec<_>>().join(", "),
        }
    }
}

/// The knobs of every technique.
pub const KNOBS: &[Knob] = &[
    Knob {
        key: "map",
        techniques: &[],
        unit: "texels",
        range: "1 to 4096",
        default: "256",
        about: "side of the occluder map, or of each of them; any whole number",
    },
    Knob {
        key: "receiver_map",
        techniques: &[Technique::SoftShadowMap],
        unit: "texels",
        range: "1 to 4096",
        default: "256",
        about: "side of the soft shadow map, with receivers=map",
    },
    Knob {
        key: "receivers",
        techniques: &[Technique::SoftShadowMap],
        unit: "choice",
        range: "pixels, map",
        default: "pixels",
        about: "where visibility is computed: at the G-buffer's pixels, with self-shadowing, or on a \
                soft shadow map that is projected onto them, without",
    },
    Knob {
        key: "sides",
        techniques: &[Technique::SoftShadowMap],
        unit: "choice",
        range: "one, bottom, two, mean",
        default: "mean",
        about: "occluders seen as their nearest faces, as those at the distance of the furthest back \
                faces, as the larger shadow of both layers, or as the mean of both, which is nearer the \
                truth (blending takes the larger)",
    },
    Knob {
        key: "accumulate",
        techniques: &[Technique::SoftShadowMap],
        unit: "choice",
        range: "gather, blend, blend-fp16",
        default: "gather",
        about: "how micro-patches are added up; the blends need receivers=map, and blend-fp16 is for \
                studying what goes wrong with it",
    },
    Knob {
        key: "tolerance",
        techniques: &[Technique::SoftShadowMap],
        unit: "visible fraction",
        range: "0 to 0.1",
        default: "0.0001",
        about: "most that the gather's shortcut for far texels may add to the error; 0 uses it \
                only where it is exact",
    },
    Knob {
        key: "taps",
        techniques: &[Technique::Pcss],
        unit: "taps",
        range: "1 to 64",
        default: "16",
        about: "places of the map that a pixel looks at to find blockers, and as many again to filter",
    },
    Knob {
        key: "samples",
        techniques: &[Technique::ManyLights],
        unit: "points",
        range: "1 to 4096",
        default: "256",
        about: "points on the light, each with a map of its own; any whole number",
    },
    Knob {
        key: "samples",
        techniques: &[Technique::LinearLight],
        unit: "points",
        range: "2 to 16",
        default: "8",
        about: "most points on a line, each with maps of its own, between which skins are drawn; any whole number",
    },
    Knob {
        key: "lines",
        techniques: &[Technique::LinearLight],
        unit: "lines",
        range: "1 to 16",
        default: "4",
        about: "most lines that a light with an area is taken for; a line light is one. Any whole number",
    },
    Knob {
        key: "across",
        techniques: &[Technique::LinearLight],
        unit: "choice",
        range: "stack, edges",
        default: "stack",
        about: "which lines those are: side by side all over the light, or its edges, as published for \
                polygons, which is a coarse thing to do",
    },
    Knob {
        key: "error",
        techniques: &[Technique::LinearLight],
        unit: "visible fraction",
        range: "0 to 1",
        default: "0.01",
        about: "mean error asked for: points are added where light is lost between others, and lines to a light \
                with an area, until what is missed is no more; 0 uses as many as there may be, evenly",
    },
    Knob {
        key: "transition",
        techniques: &[Technique::LinearLight],
        unit: "choice",
        range: "linear, rational",
        default: "rational",
        about: "how visibility grows behind a skin: evenly up to the receiver beside the occluder's edge, as \
                published, or as the receiver's own distance has it, which is exact",
    },
    Knob {
        key: "seed",
        techniques: &[Technique::ManyLights, Technique::RayMarch],
        unit: "whole number",
        range: "0 to 4294967295",
        default: "1",
        about: "which random places of the light are looked at; for many-lights 0 puts the points into the \
                middle of their cells",
    },
    Knob {
        key: "rays",
        techniques: &[Technique::RayMarch],
        unit: "rays a pixel",
        range: "1 to 256",
        default: "16",
        about: "rays that a pixel in penumbra sends to the light; any whole number",
    },
    Knob {
        key: "layers",
        techniques: &[Technique::RayMarch],
        unit: "choice",
        range: "2, 3, 4",
        default: "4",
        about: "depth layers that say what is solid: 2 from the nearest to the furthest faces, 3 but for \
                what the eye looks through, 4 two pieces, each from a front to a back face",
    },
    Knob {
        key: "search",
        techniques: &[Technique::RayMarch],
        unit: "choice",
        range: "hierarchical, linear",
        default: "hierarchical",
        about: "how a ray looks for what stops it: by windows of the N-buffer, or a texel at a time",
    },
    Knob {
        key: "sampling",
        techniques: &[Technique::RayMarch],
        unit: "choice",
        range: "jittered, random, low-discrepancy",
        default: "low-discrepancy",
        about: "where the rays of a pixel go: each to a random place in a cell of its own, each anywhere, or \
                to the points of a scrambled sequence",
    },
    Knob {
        key: "hash",
        techniques: &[Technique::RayMarch],
        unit: "choice",
        range: "pcg, md5",
        default: "pcg",
        about: "what makes random numbers of pixels; md5 is the one of 16 rounds that Curtis 2009 published",
    },
    Knob {
        key: "levels",
        techniques: &[Technique::RayMarch],
        unit: "choice",
        range: "n-buffer, thirds, mip",
        default: "n-buffer",
        about: "the windows of the hierarchical search: 2^k texels a side at every texel, 3^k, or 2^k side by \
                side; mip where map is above 1024",
    },
    Knob {
        key: "projection",
        techniques: &[Technique::RayMarch],
        unit: "choice",
        range: "behind, centre, orthographic",
        default: "behind",
        about: "where the layers are seen from: a point behind the light, its centre, or infinitely far",
    },
    Knob {
        key: "classify",
        techniques: &[Technique::RayMarch],
        unit: "switch",
        range: "on, off",
        default: "on",
        about: "whether pixels that a window of the N-buffer shows to be lit or in umbra send no rays, and \
                rays are cut to the heights that matter; off is for measuring what that saves",
    },
    Knob {
        key: "classify",
        techniques: &[Technique::SoftShadowMap, Technique::Pcss, Technique::OcclusionTextures],
        unit: "switch",
        range: "on, off",
        default: "on",
        about: "whether tiles of pixels before which no occluder lies are told at once, where pixels are \
                what is computed; the image is the same, and off is for measuring what that saves",
    },
    Knob {
        key: "filter",
        techniques: &[Technique::RayMarch],
        unit: "switch",
        range: "on, off",
        default: "on",
        about: "whether noise is filtered, as widely as takes more noise away than it blurs: less with many \
                rays, and not at all where penumbrae are narrow",
    },
    Knob {
        key: "slices",
        techniques: &[Technique::OcclusionTextures],
        unit: "slices",
        range: "4 to 32",
        default: "16",
        about: "parts of the occluders, from the light on, that are each flattened into a texture; any whole \
                number",
    },
    Knob {
        key: "placement",
        techniques: &[Technique::OcclusionTextures],
        unit: "choice",
        range: "uniform, fitted",
        default: "fitted",
        about: "where slices begin and end: all as thick, or thin where many nearest and furthest faces are",
    },
    Knob {
        key: "prefilter",
        techniques: &[Technique::OcclusionTextures],
        unit: "choice",
        range: "mip, n-buffer, sat",
        default: "sat",
        about: "where means over a slice's part come from: textures of 2^k texels a side side by side, the \
                same at every texel, or summed-area tables, which are exact",
    },
    Knob {
        key: "combine",
        techniques: &[Technique::OcclusionTextures],
        unit: "choice",
        range: "product, sum, max, correlated",
        default: "correlated",
        about: "what slices hide together: as if they knew nothing of each other (as published), as if none \
                lay behind another, as if all did, or by what they have in common where the light's rays \
                come through",
    },
    Knob {
        key: "fill",
        techniques: &[Technique::OcclusionTextures],
        unit: "switch",
        range: "on, off",
        default: "off",
        about: "whether a slice blocks in the next one too, which closes the leaks of thin occluders; the \
                product takes that for twice as much, combine=correlated does not",
    },
];
