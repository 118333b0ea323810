//! What a frame simulates and what it leaves out, by the rules of [`RULES`].

use super::{COUNT, Effect, RULES, Situation};
use crate::graph::Why;
use crate::techniques::room::{Noise, Room, Shows};
use std::fmt;

/// What comes of an effect in one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is needed and simulated.
    Simulated,
    /// It is not needed.
    LeftOut,
    /// It is needed, and the technique has no means for it.
    NotSimulated,
}

/// What a frame decides of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// The effect.
    pub effect: Effect,
    /// What comes of it.
    pub outcome: Outcome,
    /// What it costs at most that it is left out, or would cost: a mean of visible fractions, 0 to 1.
    pub bound: f64,
}

/// What a frame decides of all effects, and what from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdicts {
    all: [Verdict; COUNT],
    situation: Option<Situation>,
    technique: &'static str,
    shows: Shows,
}

/// The widest penumbra that a hard shadow may stand for, pixels: narrower than the pixels that sample it.
pub const HARD_PIXELS: f64 = 1.0;

/// Why nothing need be cut.
const UNCUT: &str = "no occluder is cut out by a texture, or drawn by the host";

impl Verdicts {
    /// Decides by a situation, none where nothing can be shadowed.
    ///
    /// `max_error` is the most that each effect may add to the mean error to be left out, and where there is none, all
    /// that may show is needed; `texture` says whether the light has one.
    pub fn judge(
        situation: Option<Situation>,
        room: &dyn Room,
        max_error: Option<f64>,
        texture: bool,
    ) -> Self {
        let shows = room.shows();
        let exceeds = |bound: f64| max_error.is_none_or(|most| bound > most);
        let mut all = RULES.map(|rule| {
            let effect = rule.effect;
            Verdict { effect, outcome: Outcome::LeftOut, bound: 0.0 }
        });
        let mut set = |effect: Effect, needed: bool, bound: f64| {
            let can = simulates(&shows, effect);
            all[effect as usize].bound = bound;
            all[effect as usize].outcome = match (needed, can) {
                (false, _) => Outcome::LeftOut,
                (true, true) => Outcome::Simulated,
                (true, false) => Outcome::NotSimulated,
            };
        };
        if let Some(s) = &situation {
            set(Effect::Shadow, true, 1.0);
            let penumbra = (0.5 * s.penumbra_pixels * s.edges_a_pixel).min(1.0);
            let soft = s.penumbra_pixels > HARD_PIXELS || exceeds(penumbra) || texture;
            set(Effect::Penumbra, soft, penumbra);
            set(Effect::InnerPenumbra, soft, penumbra);
            set(Effect::Area, soft && s.light[1] > 0.0, if s.light[1] > 0.0 { 1.0 } else { 0.0 });
            // Within one occluder no two surfaces are further apart than it is thick.
            let layers = if s.overlap { 1.0 } else { s.thickness };
            let fused = soft && exceeds(layers);
            set(Effect::Fusion, fused, layers);
            set(Effect::BackSide, fused, layers);
            let slices = shows.slices.is_some();
            set(Effect::ThinOccluders, soft && slices, if slices { 1.0 } else { 0.0 });
            set(Effect::SelfShadowing, s.both > 0, if s.both > 0 { 1.0 } else { 0.0 });
            let eye = shows.eye_layer;
            set(Effect::EyeLayer, fused && eye, if eye { layers } else { 0.0 });
            let cut = s.host_drawn + s.cut_out > 0;
            set(Effect::CutOuts, cut, if cut { 1.0 } else { 0.0 });
            set(Effect::Emission, texture, if texture { 1.0 } else { 0.0 });
            if let Noise::FilteredFrom(width) = shows.noise {
                let narrow = s.penumbra_pixels <= width;
                set(
                    Effect::Noise,
                    soft && !(narrow && max_error.is_some()),
                    if narrow { 0.0 } else { 1.0 },
                );
            }
        }
        if situation.is_some_and(|s| s.cut_out > 0) {
            // The node has no textures: these are the host's to draw.
            all[Effect::CutOuts as usize].outcome = Outcome::NotSimulated;
        }
        Self { all, situation, technique: room.name(), shows }
    }

    /// Every verdict, in the order of [`Effect`].
    pub fn all(&self) -> &[Verdict; COUNT] {
        &self.all
    }

    /// What is decided of one effect.
    pub fn of(&self, effect: Effect) -> Verdict {
        self.all[effect as usize]
    }

    /// Whether an effect is needed.
    pub fn needs(&self, effect: Effect) -> bool {
        self.of(effect).outcome != Outcome::LeftOut
    }

    /// What the boxes told; none where nothing can be shadowed.
    pub fn situation(&self) -> Option<&Situation> {
        self.situation.as_ref()
    }

    /// Why an effect is simulated or left out, as part of a sentence.
    pub fn why(&self, effect: Effect) -> Why {
        let Some(s) = &self.situation else { return "nothing can be shadowed".into() };
        let needs = self.needs(effect);
        let hard = !self.needs(Effect::Penumbra);
        if hard
            && !matches!(effect, Effect::Shadow | Effect::OutOfReach | Effect::Penumbra)
            && !needs
        {
            return match effect {
                Effect::SelfShadowing => "no mesh both blocks and receives".into(),
                Effect::CutOuts => UNCUT.into(),
                Effect::Emission => "the light is the same all over".into(),
                _ => Why::from("shadows are hard: the widest penumbra spans ")
                    .number(s.penumbra_pixels, 2)
                    .and(" pixels"),
            };
        }
        let technique = self.technique;
        match effect {
            Effect::Shadow => Why::default()
                .and(s.occluders)
                .and(" occluder meshes may shadow some of ")
                .and(s.receivers)
                .and(" receiver meshes"),
            Effect::OutOfReach => Why::default()
                .and(s.given.saturating_sub(s.occluders))
                .and(" of ")
                .and(s.given)
                .and(" occluder meshes lie outside the hull of light and receivers or the light's reach, or are flat, with all on one side"),
            Effect::Penumbra | Effect::InnerPenumbra => Why::from("the widest penumbra spans ")
                .number(s.penumbra_pixels, 2)
                .and(" pixels, with at most ")
                .number(s.edges_a_pixel, 2)
                .and(" edges in a pixel's width"),
            Effect::Area if s.light[1] == 0.0 => "the light is a line".into(),
            Effect::Area => Why::from("the light is ")
                .number(s.light[0], 3)
                .and(" by ")
                .number(s.light[1], 3)
                .and(" m"),
            Effect::BackSide | Effect::Fusion if s.overlap => {
                "occluders may lie before each other".into()
            }
            Effect::BackSide | Effect::Fusion if s.sheets => {
                "every occluder is a sheet, and none lies before another".into()
            }
            Effect::BackSide | Effect::Fusion => Why::from("eq. 3 for the thickest occluder is ")
                .number(s.thickness, 4)
                .and(", and none lies before another"),
            Effect::ThinOccluders if needs => "occluders may end within a slice".into(),
            Effect::ThinOccluders => Why::from(technique).and(" has no slices"),
            Effect::SelfShadowing if needs => {
                Why::default().and(s.both).and(" meshes block and receive")
            }
            Effect::SelfShadowing => "no mesh both blocks and receives".into(),
            Effect::EyeLayer if needs => "layers=3, and occluders have insides".into(),
            Effect::EyeLayer => "layers=3 is not set, or no occluder has an inside".into(),
            Effect::CutOuts if s.cut_out > 0 => Why::default()
                .and(s.cut_out)
                .and(" meshes are cut out by textures, and drawn whole"),
            Effect::CutOuts if needs => {
                Why::from("the host draws ").and(s.host_drawn).and(" meshes")
            }
            Effect::CutOuts => UNCUT.into(),
            Effect::Emission if needs => "the host lends a texture of the light".into(),
            Effect::Emission => "the light is the same all over".into(),
            Effect::Noise => match self.shows.noise {
                Noise::None => Why::from(technique).and(" has no noise"),
                Noise::Unfiltered => "filter=off".into(),
                Noise::FilteredFrom(width) => Why::from("penumbrae span up to ")
                    .number(s.penumbra_pixels, 2)
                    .and(" pixels, and the filter acts on those of more than ")
                    .number(width, 2),
            },
        }
    }
}

/// One line an effect: what comes of it, the bound, and why.
impl fmt::Display for Verdicts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = RULES.iter().map(|r| r.name.len()).max().unwrap_or(0);
        for v in &self.all {
            let outcome = match v.outcome {
                Outcome::Simulated => "simulated",
                Outcome::LeftOut => "left out",
                Outcome::NotSimulated => "missing",
            };
            let bound = match v.outcome {
                Outcome::Simulated => String::new(),
                _ => format!("≤ {:.4}", v.bound),
            };
            let (name, why) = (v.effect.rule().name, self.why(v.effect));
            writeln!(f, "{outcome:9}  {name:width$}  {bound:8}  {why}")?;
        }
        Ok(())
    }
}

/// Whether a technique has means for an effect.
fn simulates(shows: &Shows, effect: Effect) -> bool {
    match effect {
        Effect::Penumbra | Effect::InnerPenumbra | Effect::Area => shows.penumbra,
        Effect::BackSide => shows.back_side,
        Effect::Fusion => shows.fusion,
        Effect::ThinOccluders => shows.slices == Some(true),
        Effect::SelfShadowing => shows.self_shadowing,
        Effect::Shadow
        | Effect::OutOfReach
        | Effect::EyeLayer
        | Effect::CutOuts
        | Effect::Emission
        | Effect::Noise => true,
    }
}
