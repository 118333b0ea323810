//! The list of what the node can simulate: when each effect is needed, what leaving it out costs, what it pulls in.
//!
//! For people, one entry an effect; [`super::Verdicts::judge`] has an arm for each. `docs/planner.md` shows the list and
//! derives the bounds, which are of the mean error over the pixels that shadow touches, in visible fractions, beyond what
//! the maps' own texels make of it.

/// Something that the node can simulate, or leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Effect {
    /// Any shadow at all.
    Shadow,
    /// Occluders that can shadow no receiver.
    OutOfReach,
    /// The part of the light that a receiver sees, where that is neither all nor nothing.
    Penumbra,
    /// The part of the penumbra behind the edge that the light's centre sees.
    InnerPenumbra,
    /// Both extents of the light.
    Area,
    /// The back faces of occluders.
    BackSide,
    /// Occluders behind other ones.
    Fusion,
    /// Occluders thinner than what the technique tells apart.
    ThinOccluders,
    /// Shadows of meshes on themselves and on others that block.
    SelfShadowing,
    /// What the camera sees through, which the light's layers take for solid.
    EyeLayer,
    /// Occluders with holes that their triangles do not have.
    CutOuts,
    /// Light of different color or strength from different parts of the light.
    Emission,
    /// The noise of few rays.
    Noise,
}

/// What a reader must know of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rule {
    /// The effect.
    pub effect: Effect,
    /// Its name in explanations and reports.
    pub name: &'static str,
    /// When it is needed.
    pub needed: &'static str,
    /// What leaving it out costs at most where it is not needed.
    pub bound: &'static str,
    /// What it pulls in.
    pub passes: &'static str,
}

/// How many effects there are.
pub const COUNT: usize = 13;

/// Every effect, in the order of [`Effect`].
pub const RULES: [Rule; COUNT] = [
    Rule {
        effect: Effect::Shadow,
        name: "shadow",
        needed: "some occluder may lie between the light and a receiver",
        bound: "0",
        passes: "every pass but `visibility.lit`",
    },
    Rule {
        effect: Effect::OutOfReach,
        name: "occluders out of reach",
        needed: "never",
        bound: "0",
        passes: "none; their draws are left out",
    },
    Rule {
        effect: Effect::Penumbra,
        name: "penumbra",
        needed: "the widest penumbra spans more than a pixel, or ½ s e is above the error asked for: s its width \
                 in pixels, e the most edges a pixel's width of shadow may have",
        bound: "½ s e",
        passes: "all of the technique's; `hard.visibility` stands for them where it is left out",
    },
    Rule {
        effect: Effect::InnerPenumbra,
        name: "inner penumbra",
        needed: "wherever the penumbra is",
        bound: "the penumbra's",
        passes: "none of its own",
    },
    Rule {
        effect: Effect::Area,
        name: "area of the light",
        needed: "the light has two extents",
        bound: "0",
        passes: "`linear-light`'s further lines; techniques for areas alone take no line",
    },
    Rule {
        effect: Effect::BackSide,
        name: "back side of occluders",
        needed: "two occluders meet in the map, or Atty 2006 eq. 3 for the whole thickness h of any, over the light's side, \
                 ½ h d_r / (d_o (d_r − d_o − h)), is above the error asked for",
        bound: "that, 0 for sheets",
        passes: "`depth_layers.back`, and the second side of `soft_shadow_map.blocks`",
    },
    Rule {
        effect: Effect::Fusion,
        name: "fusion of overlapping occluders",
        needed: "two occluders meet in the map, or the back side of one is needed",
        bound: "that of the back side",
        passes: "`depth_layers.near_back`, `depth_layers.far_front`; both faces of `soft_shadow_map`",
    },
    Rule {
        effect: Effect::ThinOccluders,
        name: "leaks of thin occluders",
        needed: "there are slices, and occluders may end within one",
        bound: "0",
        passes: "none of its own; filled slices",
    },
    Rule {
        effect: Effect::SelfShadowing,
        name: "self-shadowing",
        needed: "some mesh blocks and receives",
        bound: "0",
        passes: "none of its own; it asks for `receivers=pixels`",
    },
    Rule {
        effect: Effect::EyeLayer,
        name: "eye layer",
        needed: "`layers=3`, and occluders overlap",
        bound: "0",
        passes: "the G-buffer's depth in every ray's search",
    },
    Rule {
        effect: Effect::CutOuts,
        name: "cut-outs",
        needed: "some mesh is cut out by a texture, or drawn by the host",
        bound: "0",
        passes: "the host's draws in every layer; what the node draws it draws whole, and says so",
    },
    Rule {
        effect: Effect::Emission,
        name: "texture of the light",
        needed: "the host lends one",
        bound: "0",
        passes: "the texture in `ray_march.trace`",
    },
    Rule {
        effect: Effect::Noise,
        name: "noise filter",
        needed: "the filter's Gaussian would be wider than 0.4 pixels: penumbrae of more than 0.67 / √N pixels, N the \
                 noise of so many rays",
        bound: "0",
        passes: "`ray_march.filter_rows`, `ray_march.filter_columns`",
    },
];

impl Effect {
    /// What to know of it.
    pub fn rule(self) -> &'static Rule {
        &RULES[self as usize]
    }
}
