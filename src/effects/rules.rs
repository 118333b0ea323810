//! The effects that the node can simulate, one entry each: when it is needed, what leaving it out costs, and why.
//!
//! `docs/planner.md` shows the list and derives the bounds. A bound is of the mean error of the visible fraction over
//! the pixels that shadow touches, beyond the error that the size of the maps' texels causes.

use super::Situation;
use crate::graph::Why;
use crate::techniques::room::{Noise, Shows};

/// An effect that the node can simulate, or leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Effect {
    /// Some shadow falls on some receiver.
    Shadow,
    /// Occluders that can shadow no receiver are drawn all the same.
    OutOfReach,
    /// Points that see only a part of the light have a fraction between 0 and 1.
    Penumbra,
    /// The penumbra reaches behind the edge of the shadow that the light's centre casts.
    InnerPenumbra,
    /// The light has a height as well as a width.
    Area,
    /// Back faces of occluders block light that front faces let pass.
    BackSide,
    /// Occluders behind other occluders add to their shadows.
    Fusion,
    /// Occluders thinner than a slice let no light through.
    ThinOccluders,
    /// Meshes that block shadow themselves and each other.
    SelfShadowing,
    /// Rays pass where the camera sees through what the light's layers take for solid.
    EyeLayer,
    /// Occluders have holes that are in their textures and not in their triangles.
    CutOuts,
    /// Parts of the light emit light of different color or strength.
    Emission,
    /// The noise of few rays is filtered.
    Noise,
}

/// The number of effects.
pub const COUNT: usize = 13;

/// The widest penumbra that a hard shadow may replace, pixels: narrower than the pixels that sample it.
pub const HARD_PIXELS: f64 = 1.0;

/// One frame as its effects are judged: its situation, the technique's means, and the error allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Case {
    pub situation: Situation,
    pub technique: &'static str,
    pub shows: Shows,
    /// The most error that leaving an effect out may add; `None` where every effect that may show is needed.
    pub max_error: Option<f64>,
    /// Whether the light has a texture.
    pub texture: bool,
}

/// Whether an effect is needed, and the error that leaving it out adds at most, 0 to 1.
type Judgement = (bool, f64);

/// An effect's entry: for people its name and texts, for the node the functions that judge it.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// The effect.
    pub effect: Effect,
    /// The effect's name in explanations and reports.
    pub name: &'static str,
    /// When the effect is needed.
    pub needed: &'static str,
    /// The most error that leaving the effect out adds where it is not needed.
    pub bound: &'static str,
    /// The passes that simulate it.
    pub passes: &'static str,
    /// Whether only a soft shadow has the effect: a hard one needs no `judge` and has its own reason.
    pub(super) soft: bool,
    pub(super) judge: fn(&Case) -> Judgement,
    /// Why the effect is needed (`true`) or not.
    pub(super) why: fn(&Case, bool) -> Why,
    /// Whether the technique has means for it.
    pub(super) simulated: fn(&Case) -> bool,
}

impl Case {
    fn exceeds(&self, bound: f64) -> bool {
        self.max_error.is_none_or(|most| bound > most)
    }

    /// Whether the penumbra is needed, and the bound of leaving it out.
    pub fn penumbra(&self) -> Judgement {
        let s = &self.situation;
        if s.is_point() {
            return (false, 0.0);
        }
        let bound = (0.5 * s.penumbra_pixels * s.edges_a_pixel).min(1.0);
        (s.penumbra_pixels > HARD_PIXELS || self.exceeds(bound) || self.texture, bound)
    }

    fn why_penumbra(&self) -> Why {
        if self.situation.is_point() {
            return "the light is a point".into();
        }
        Why::from("the widest penumbra spans ")
            .number(self.situation.penumbra_pixels, 2)
            .and(" pixels, with at most ")
            .number(self.situation.edges_a_pixel, 2)
            .and(" edges in a pixel's width")
    }

    /// Whether surfaces behind an occluder's front are needed, and the bound of leaving them out: no two surfaces of
    /// one occluder are further apart than it is thick.
    fn inside(&self) -> Judgement {
        let bound = if self.situation.overlap { 1.0 } else { self.situation.thickness };
        (self.exceeds(bound), bound)
    }

    fn why_inside(&self) -> Why {
        let s = &self.situation;
        match (s.overlap, s.sheets) {
            (true, _) => "occluders may lie before each other".into(),
            (false, true) => "every occluder is a sheet, and none lies before another".into(),
            (false, false) => Why::from("eq. 3 for the thickest occluder is ")
                .number(s.thickness, 4)
                .and(", and none lies before another"),
        }
    }
}

/// An effect that is needed wherever it is there at all: leaving it out may then be wrong everywhere.
fn where_present(present: bool) -> Judgement {
    (present, if present { 1.0 } else { 0.0 })
}

/// Every effect, in the order of [`Effect`].
pub const RULES: [Rule; COUNT] = [
    Rule {
        effect: Effect::Shadow,
        name: "shadow",
        needed: "some occluder may lie between the light and a receiver",
        bound: "0",
        passes: "every pass but `visibility.lit`",
        soft: false,
        judge: |_| (true, 1.0),
        why: |case, _| {
            Why::default()
                .and(case.situation.occluders)
                .and(" occluder meshes may shadow some of ")
                .and(case.situation.receivers)
                .and(" receiver meshes")
        },
        simulated: |_| true,
    },
    Rule {
        effect: Effect::OutOfReach,
        name: "occluders out of reach",
        needed: "never",
        bound: "0",
        passes: "none; their draws are left out",
        soft: false,
        judge: |_| (false, 0.0),
        why: |Case { situation: s, .. }, _| {
            Why::default().and(s.given.saturating_sub(s.occluders)).and(" of ").and(s.given).and(
                " occluder meshes lie outside the hull of light and receivers or the light's reach, or are flat, \
                 with all on one side",
            )
        },
        simulated: |_| true,
    },
    Rule {
        effect: Effect::Penumbra,
        name: "penumbra",
        needed: "the light is no point, and the widest penumbra spans more than a pixel, or ½ s e is above what may be \
                 omitted: s its width in pixels, e the most edges a pixel's width of shadow may have",
        bound: "½ s e",
        passes: "all of the technique's; `hard.visibility` stands for them where it is left out",
        soft: false,
        judge: Case::penumbra,
        why: |case, _| case.why_penumbra(),
        simulated: |case| case.shows.penumbra,
    },
    Rule {
        effect: Effect::InnerPenumbra,
        name: "inner penumbra",
        needed: "wherever the penumbra is",
        bound: "the penumbra's",
        passes: "none of its own",
        soft: true,
        judge: Case::penumbra,
        why: |case, _| case.why_penumbra(),
        simulated: |case| case.shows.penumbra,
    },
    Rule {
        effect: Effect::Area,
        name: "area of the light",
        needed: "the light has two extents",
        bound: "0",
        passes: "`linear-light`'s further lines; techniques for areas alone take no line",
        soft: true,
        judge: |case| where_present(case.situation.light[1] > 0.0),
        why: |case, _| match case.situation.light {
            [0.0, 0.0] => "the light is a point".into(),
            [_, 0.0] => "the light is a line".into(),
            [w, h] => Why::from("the light is ").number(w, 3).and(" by ").number(h, 3).and(" m"),
        },
        simulated: |case| case.shows.penumbra,
    },
    Rule {
        effect: Effect::BackSide,
        name: "back side of occluders",
        needed: "two occluders meet in the map, or Atty 2006 eq. 3 for the whole thickness h of any, over the light's side, \
                 ½ h d_r / (d_o (d_r − d_o − h)), is above what may be omitted",
        bound: "that, 0 for sheets",
        passes: "`depth_layers.back`, and the second side of `soft_shadow_map.blocks`",
        soft: true,
        judge: Case::inside,
        why: |case, _| case.why_inside(),
        simulated: |case| case.shows.back_side,
    },
    Rule {
        effect: Effect::Fusion,
        name: "fusion of overlapping occluders",
        needed: "two occluders meet in the map, or the back side of one is needed",
        bound: "that of the back side",
        passes: "`depth_layers.near_back`, `depth_layers.far_front`, and with several views `depth_layers.middle_front` and \
                 `middle_back`; both faces of `soft_shadow_map`",
        soft: true,
        judge: Case::inside,
        why: |case, _| case.why_inside(),
        simulated: |case| case.shows.fusion,
    },
    Rule {
        effect: Effect::ThinOccluders,
        name: "leaks of thin occluders",
        needed: "there are slices, and occluders may end within one",
        bound: "0",
        passes: "none of its own; filled slices",
        soft: true,
        judge: |case| where_present(case.shows.slices.is_some()),
        why: |case, needed| match needed {
            true => "occluders may end within a slice".into(),
            false => Why::from(case.technique).and(" has no slices"),
        },
        simulated: |case| case.shows.slices == Some(true),
    },
    Rule {
        effect: Effect::SelfShadowing,
        name: "self-shadowing",
        needed: "some mesh blocks and receives",
        bound: "0",
        passes: "none of its own; it needs `receivers=pixels`",
        soft: false,
        judge: |case| where_present(case.situation.both > 0),
        why: |case, needed| match needed {
            true => Why::default().and(case.situation.both).and(" meshes block and receive"),
            false => "no mesh both blocks and receives".into(),
        },
        simulated: |case| case.shows.self_shadowing,
    },
    Rule {
        effect: Effect::EyeLayer,
        name: "eye layer",
        needed: "`layers=3`, and occluders overlap",
        bound: "0",
        passes: "the G-buffer's depth in every ray's search",
        soft: true,
        judge: |case| match case.shows.eye_layer {
            true => case.inside(),
            false => (false, 0.0),
        },
        why: |_, needed| match needed {
            true => "layers=3, and occluders have insides".into(),
            false => "layers=3 is not set, or no occluder has an inside".into(),
        },
        simulated: |_| true,
    },
    Rule {
        effect: Effect::CutOuts,
        name: "cut-outs",
        needed: "some mesh is cut out by a texture, or drawn by the host",
        bound: "0",
        passes: "`cut_outs.write`, and lookups in every draw and ray; the host's draws; what no texture is lent for is drawn whole",
        soft: false,
        judge: |case| {
            let Situation { host_drawn, cut_out, textured, .. } = case.situation;
            where_present(host_drawn + cut_out + textured > 0)
        },
        why: |Case { situation: s, shows, .. }, needed| match (s.cut_out, s.translucent, s.textured)
        {
            _ if !needed => "no occluder is cut out by a texture, or drawn by the host".into(),
            (0, 0, 0) => Why::from("the host draws ").and(s.host_drawn).and(" meshes"),
            (0, count @ 1.., _) if !shows.translucent => Why::default()
                .and(count)
                .and(" meshes let a part of the light through, which is drawn as none"),
            (0, _, count) => Why::default().and(count).and(" meshes have opacity textures"),
            (count, ..) => {
                Why::default().and(count).and(" meshes are cut out by textures, and drawn whole")
            }
        },
        // Without a texture of the host's, only the host can draw what a texture cuts out.
        simulated: |case| {
            case.situation.cut_out == 0
                && (case.situation.translucent == 0 || case.shows.translucent)
        },
    },
    Rule {
        effect: Effect::Emission,
        name: "texture of the light",
        needed: "the host lends one",
        bound: "0",
        passes: "the texture in `ray_march.trace`; `traced.emission`",
        soft: false,
        judge: |case| where_present(case.texture),
        why: |_, needed| match needed {
            true => "the host lends a texture of the light".into(),
            false => "the light is the same all over".into(),
        },
        simulated: |_| true,
    },
    Rule {
        effect: Effect::Noise,
        name: "noise filter",
        needed: "the filter's Gaussian would be wider than 0.4 pixels: penumbrae of more than 0.67 / √N pixels, N the \
                 noise of so many rays",
        bound: "0",
        passes: "`ray_march.filter_rows`, `ray_march.filter_columns`",
        soft: true,
        judge: |case| match case.shows.noise {
            Noise::FilteredFrom(width) if case.situation.penumbra_pixels <= width => {
                (case.max_error.is_none(), 0.0)
            }
            Noise::FilteredFrom(_) => (true, 1.0),
            Noise::None | Noise::Unfiltered => (false, 0.0),
        },
        why: |case, _| match case.shows.noise {
            Noise::None => Why::from(case.technique).and(" has no noise"),
            Noise::Unfiltered => "filter=off".into(),
            Noise::FilteredFrom(width) => Why::from("penumbrae span up to ")
                .number(case.situation.penumbra_pixels, 2)
                .and(" pixels, and the filter acts on those of more than ")
                .number(width, 2),
        },
        simulated: |_| true,
    },
];

impl Effect {
    /// The effect's entry in [`RULES`].
    pub fn rule(self) -> &'static Rule {
        &RULES[self as usize]
    }
}
