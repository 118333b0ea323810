//! Which effects a frame simulates and which it leaves out, by the entries of [`RULES`].

use super::rules::Case;
use super::{COUNT, Effect, RULES, Situation};
use crate::graph::Why;
use crate::techniques::room::Room;
use std::fmt;

/// What happens to an effect in one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The effect is needed and simulated.
    Simulated,
    /// The effect is not needed.
    LeftOut,
    /// The effect is needed, and the technique cannot simulate it.
    NotSimulated,
}

/// The decision about one effect in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// The effect.
    pub effect: Effect,
    /// What happens to it.
    pub outcome: Outcome,
    /// The most mean error of the visible fraction, 0 to 1, that leaving the effect out adds or would add.
    pub bound: f64,
}

/// The decisions about all effects in one frame, and what they follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdicts {
    all: [Verdict; COUNT],
    /// `None` where nothing can be shadowed.
    case: Option<Case>,
}

impl Verdicts {
    /// Decides about each effect for a technique in a situation, which is `None` where nothing can be shadowed.
    ///
    /// `max_error` is the most mean error, 0 to 1, that leaving out one effect may add; with `None` every effect that
    /// may show is needed. `texture` says whether the light has a texture.
    pub fn judge(
        situation: Option<Situation>,
        room: &dyn Room,
        max_error: Option<f64>,
        texture: bool,
    ) -> Self {
        let case = situation.map(|situation| Case {
            situation,
            technique: room.name(),
            shows: room.shows(),
            max_error,
            texture,
        });
        let all = RULES.map(|rule| {
            let effect = rule.effect;
            let Some(case) = &case else {
                return Verdict { effect, outcome: Outcome::LeftOut, bound: 0.0 };
            };
            let (needed, bound) = (rule.judge)(case);
            let outcome = if !needed || rule.soft && !case.penumbra().0 {
                Outcome::LeftOut
            } else if (rule.simulated)(case) {
                Outcome::Simulated
            } else {
                Outcome::NotSimulated
            };
            Verdict { effect, outcome, bound }
        });
        Self { all, case }
    }

    /// Every verdict, in the order of [`Effect`].
    pub fn all(&self) -> &[Verdict; COUNT] {
        &self.all
    }

    /// The verdict on one effect.
    pub fn of(&self, effect: Effect) -> Verdict {
        self.all[effect as usize]
    }

    /// Whether an effect is needed.
    pub fn needs(&self, effect: Effect) -> bool {
        self.of(effect).outcome != Outcome::LeftOut
    }

    /// The frame's situation; `None` where nothing can be shadowed.
    pub fn situation(&self) -> Option<&Situation> {
        self.case.as_ref().map(|case| &case.situation)
    }

    /// Why an effect is simulated or left out, as part of a sentence.
    pub fn why(&self, effect: Effect) -> Why {
        let Some(case) = &self.case else { return "nothing can be shadowed".into() };
        let rule = effect.rule();
        if rule.soft && !self.needs(Effect::Penumbra) {
            if case.situation.is_point() {
                return "shadows are hard: the light is a point".into();
            }
            return Why::from("shadows are hard: the widest penumbra spans ")
                .number(case.situation.penumbra_pixels, 2)
                .and(" pixels");
        }
        (rule.why)(case, self.needs(effect))
    }
}

/// Writes one line for each effect: what happens to it, the bound unless it is simulated, its name, and why.
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
