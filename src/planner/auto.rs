//! `auto`: technique and settings by a budget.
//!
//! ```text
//!   frame ─► Situation ─► Likeness ─► the table's views that are most like it
//!                                        │ their worst error, their mean time × Costs
//!   Budget ──────────────────────────────┴─► the fastest that is good enough ─► hysteresis ─► Choice
//! ```
//! The promise of an error is that of the views of the report that are most alike, the worst of them, and more the
//! less alike they are. How often it is kept is told in `docs/planner.md`, for scenes of the table and for scenes that
//! the table has never seen.

use super::budget::Sound;
use super::table::{Table, View};
use super::{Budget, CANDIDATES, Costs, Likeness, Situation};
use crate::frame::{self, Description, Frame};
use crate::settings::{KNOBS, Settings, Technique};
use crate::{Error, linear_light};
use std::fmt;

/// Views no further than this from a situation count, and the further the nearest one is the more others do.
const AS_NEAR: f64 = 0.3;
const AS_FAR: f64 = 1.6;

/// What a unit of distance to the nearest view adds to the error that is promised, as a share of it. Chosen with
/// [`AS_FAR`] so that scenes the table has not seen keep promises of 2 % and more in 95 of 100 cases (docs/planner.md).
const DOUBT: f64 = 0.4;

/// What images of other sizes err by more than the table's, as a share.
const MARGIN: f64 = 1.05;

/// How much faster another choice must be to replace one that is good enough.
const FASTER: f64 = 0.8;

/// For how many frames in a row.
const PATIENCE: u32 = 30;

/// What `linear-light` errs by at most where `error` is set, as measured over the report's lines: a share of it, and
/// what is lost between the occluders of open meshes whatever the samples.
const LINE_SHARE: f64 = 1.4;
const LINE_OPEN: f64 = 0.012;

/// What to compute a light's shadow with.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Technique and settings.
    pub settings: Settings,
    /// The mean error over shadow and penumbra that the model promises, a visible fraction; none where nothing can be
    /// shadowed.
    pub error: Option<f64>,
    /// Milliseconds that the model expects; none where it knows nothing of it.
    pub ms: Option<f64>,
    /// Scene and light of the report that the situation is most like.
    pub alike: Option<[String; 2]>,
    /// Whether it is another one than in the frame before.
    pub changed: bool,
    /// What of the budget makes no sense or cannot be met; the choice is then the nearest to it.
    pub problem: Option<String>,
}

/// What a candidate is expected to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Expected {
    /// Its place among [`CANDIDATES`].
    pub candidate: usize,
    /// Mean error, a visible fraction.
    pub error: f64,
    /// Milliseconds.
    pub ms: f64,
}

/// What is remembered of a light.
#[derive(Clone, Copy, Debug, Default)]
struct Held {
    candidate: Option<usize>,
    /// For how many frames another one would have been better.
    waited: u32,
    /// What the last frame was to take.
    expected: Option<(Technique, f64)>,
    settings: Option<Settings>,
}

/// Chooses technique and settings for the lights of a node, frame by frame.
///
/// It holds no Vulkan objects and makes no calls. The host asks it, reconfigures the node where the answer changes
/// ([`crate::ShadowNode::adapt`] does both), and tells it what frames took.
#[derive(Clone, Debug)]
pub struct Auto {
    budget: Budget,
    costs: Costs,
    held: Vec<Held>,
}

impl Auto {
    /// By a budget, on a device of these costs.
    pub fn new(budget: Budget, costs: Costs) -> Self {
        Self { budget, costs, held: Vec::new() }
    }

    /// What is known of the device, to be kept.
    pub fn costs(&self) -> &Costs {
        &self.costs
    }

    /// Another budget from the next frame on.
    pub fn set_budget(&mut self, budget: Budget) {
        self.budget = budget;
    }

    /// What to compute a light's shadow with.
    ///
    /// # Errors
    /// Those of planning the frame.
    pub fn choose(&mut self, description: &Description, frame: &Frame) -> Result<Choice, Error> {
        let mut all = self.choose_all(description, std::slice::from_ref(frame))?;
        Ok(all.swap_remove(0))
    }

    /// The same for a light with an area whose situation is known, on a node that takes every technique, at so many pixels:
    /// for studying how it chooses.
    pub fn choose_in(&mut self, situation: &Situation, [width, height]: [u32; 2]) -> Choice {
        self.held.resize(1, Held::default());
        let sound = self.budget.sound();
        let pixels = f64::from(width) * f64::from(height);
        let triangles = situation.triangles as f64;
        let likeness = Likeness::of(situation);
        let expected = expect(Table::own(), &self.costs, &likeness, pixels, triangles);
        match share(std::slice::from_ref(&expected), &sound)[0] {
            Some(best) => self.settle(0, situation, &expected, best, &sound),
            None => self.nothing(0, &Settings::default()),
        }
    }

    /// The same for several lights, which share `max_ms` by what more time would better.
    ///
    /// # Errors
    /// Those of planning the frames.
    pub fn choose_all(
        &mut self,
        description: &Description,
        frames: &[Frame],
    ) -> Result<Vec<Choice>, Error> {
        let situations: Vec<_> = frames
            .iter()
            .map(|frame| frame::situation(description, frame))
            .collect::<Result<_, _>>()?;
        self.held.resize(frames.len(), Held::default());
        let sound = self.budget.sound();
        let pixels = f64::from(description.extent[0]) * f64::from(description.extent[1]);
        let expected: Vec<Vec<Expected>> = frames
            .iter()
            .zip(&situations)
            .map(|(frame, situation)| match situation {
                Some(s) if !is_line(frame) => {
                    let can =
                        |e: &Expected| takes(CANDIDATES[e.candidate].technique, description, s);
                    let likeness = Likeness::of(s);
                    expect(Table::own(), &self.costs, &likeness, pixels, s.triangles as f64)
                        .into_iter()
                        .filter(can)
                        .collect()
                }
                _ => Vec::new(),
            })
            .collect();
        let picked = share(&expected, &sound);
        let least: f64 = picked.iter().flatten().map(|e| e.ms).sum();
        let lights = picked.iter().flatten().count();
        let too_slow = (lights > 1 && least > sound.max_ms).then(|| {
            format!(
                "the {lights} lights together take no less than {least:.1} ms here, and max_ms is {}; \
                 the fastest is chosen for each",
                sound.max_ms
            )
        });
        let sound = Sound { problem: sound.problem.or(too_slow), ..sound };
        let mut choices = Vec::with_capacity(frames.len());
        for (i, (frame, situation)) in frames.iter().zip(&situations).enumerate() {
            choices.push(match (situation, picked[i]) {
                (Some(s), Some(best)) => self.settle(i, s, &expected[i], best, &sound),
                // What is there stays where it takes the light, and costs nothing.
                (None, _) if !is_line(frame) => self.nothing(i, &description.settings),
                (s, _) => self.of_line(i, frame, s.as_ref(), &sound),
            });
        }
        Ok(choices)
    }

    /// What frames of the last choice took, in milliseconds of the device: all passes of light `light` together.
    pub fn observe(&mut self, light: usize, ms: f64) {
        if let Some((technique, expected)) = self.held.get(light).and_then(|h| h.expected) {
            self.costs.learn(technique, expected, ms);
        }
    }

    /// Nothing can be shadowed.
    fn nothing(&mut self, light: usize, settings: &Settings) -> Choice {
        let held = &mut self.held[light];
        held.expected = None;
        let settings = held.settings.unwrap_or(*settings);
        Choice { settings, error: None, ms: None, alike: None, changed: false, problem: None }
    }

    /// Keeps what is held where it is good enough, unless another one has been better for long.
    fn settle(
        &mut self,
        light: usize,
        s: &Situation,
        expected: &[Expected],
        best: Expected,
        sound: &Sound,
    ) -> Choice {
        let held = &mut self.held[light];
        let kept = held.candidate.and_then(|c| expected.iter().find(|e| e.candidate == c));
        let taken = match kept {
            Some(kept) if kept.candidate != best.candidate => {
                let good = kept.error <= sound.max_error.max(best.error)
                    && kept.ms <= sound.max_ms.max(best.ms);
                let better = best.ms < FASTER * kept.ms || best.error < FASTER * kept.error;
                held.waited = if better { held.waited + 1 } else { 0 };
                if good && held.waited < PATIENCE { *kept } else { best }
            }
            _ => best,
        };
        if held.candidate != Some(taken.candidate) {
            held.waited = 0;
        }
        let technique = CANDIDATES[taken.candidate].technique;
        held.candidate = Some(taken.candidate);
        held.expected = Some((technique, taken.ms));
        let settings = CANDIDATES[taken.candidate].settings();
        let changed = held.settings.replace(settings).is_some_and(|before| before != settings);
        let (_, like) = alike(Table::own(), &Likeness::of(s));
        Choice {
            settings,
            error: Some(taken.error),
            ms: Some(taken.ms),
            alike: like.first().map(|v| v.name.clone()),
            changed,
            problem: sound.problem.clone().or_else(|| unmet(&taken, expected, sound)),
        }
    }

    /// A line or a polygon: its technique places samples until what is lost is below an error.
    fn of_line(
        &mut self,
        light: usize,
        frame: &Frame,
        situation: Option<&Situation>,
        sound: &Sound,
    ) -> Choice {
        let open = if situation.is_some_and(|s| s.open) { LINE_OPEN } else { 0.0 };
        let asked = ((sound.max_error - open) / LINE_SHARE).clamp(0.005, 0.1);
        let error = LINE_SHARE * asked + open;
        let defaults = Settings::default();
        let settings = Settings {
            technique: Technique::LinearLight,
            linear_light: linear_light::Settings {
                error: asked as f32,
                samples: 16,
                lines: if frame.light.is_line() { 1 } else { 16 },
                ..defaults.linear_light
            },
            ..defaults
        };
        let held = &mut self.held[light];
        held.candidate = None;
        held.expected = None;
        let changed = held.settings.replace(settings).is_some_and(|before| before != settings);
        let met = error <= sound.max_error * 1.0001 || situation.is_none();
        let problem = (!met).then(|| {
            format!("no error below {error:.3} can be promised for a line or a polygon here")
        });
        Choice {
            settings,
            error: situation.map(|_| error),
            ms: None,
            alike: None,
            changed,
            problem: sound.problem.clone().or(problem),
        }
    }
}

/// What each candidate would do in a situation like this.
pub(super) fn expect(
    table: &Table,
    costs: &Costs,
    likeness: &Likeness,
    pixels: f64,
    triangles: f64,
) -> Vec<Expected> {
    let (nearest, like) = alike(table, likeness);
    let doubt = MARGIN * (1.0 + DOUBT * nearest);
    let of = |candidate: usize| {
        let technique = CANDIDATES[candidate].technique;
        let mut error: f64 = 0.0;
        let mut ms = 0.0;
        for view in &like {
            let measured = &view.measured[candidate];
            error = error.max(measured.error);
            ms += costs.ms(technique, measured, pixels, triangles - view.triangles);
        }
        Expected { candidate, error: (error * doubt).min(1.0), ms: ms / like.len() as f64 }
    };
    // Without a table nothing is known.
    (0..if like.is_empty() { 0 } else { CANDIDATES.len() }).map(of).collect()
}

fn is_line(frame: &Frame) -> bool {
    frame.light.is_line() || frame.outline.is_some()
}

/// The settings of some choices, each once and the most accurate first, as many as a node may have.
pub(crate) fn distinct(choices: &[Choice]) -> (Settings, Vec<Settings>) {
    let mut by_error: Vec<&Choice> = choices.iter().collect();
    by_error.sort_by(|a, b| {
        let [a, b] = [a, b].map(|c| c.error.unwrap_or(f64::INFINITY));
        a.total_cmp(&b)
    });
    let mut all: Vec<Settings> = Vec::new();
    for choice in by_error {
        if !all.contains(&choice.settings) {
            all.push(choice.settings);
        }
    }
    all.truncate(frame::MOST_SETTINGS);
    let mut all = all.into_iter();
    (all.next().unwrap_or_default(), all.collect())
}

/// The views that are most like a situation, the nearest first, and how far away that one is.
fn alike<'a>(table: &'a Table, likeness: &Likeness) -> (f64, Vec<&'a View>) {
    let mut all: Vec<(f64, &View)> =
        table.views.iter().map(|v| (v.likeness.distance(likeness), v)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let nearest = all.first().map_or(0.0, |v| v.0);
    all.retain(|v| v.0 <= AS_NEAR + AS_FAR * nearest);
    (nearest, all.into_iter().map(|v| v.1).collect())
}

/// Whether a technique takes what a host gives.
fn takes(technique: Technique, description: &Description, s: &Situation) -> bool {
    let maps = description.occluder_maps.is_some();
    let draws = s.host_drawn > 0;
    match technique {
        _ if description.light_texture.is_some() => technique == Technique::RayMarch,
        Technique::ManyLights => !maps,
        Technique::OcclusionTextures | Technique::LinearLight => !maps && !draws,
        Technique::Hard
        | Technique::Pcss
        | Technique::BackProjection
        | Technique::SoftShadowMap
        | Technique::RayMarch => true,
    }
}

/// A candidate for each light: the fastest that is good enough, or, where the time does not reach, what most betters the
/// lights' errors for it.
fn share(expected: &[Vec<Expected>], sound: &Sound) -> Vec<Option<Expected>> {
    let good = |e: &Expected| e.error <= sound.max_error;
    let fastest = |all: &[Expected], which: &dyn Fn(&Expected) -> bool| {
        all.iter().filter(|e| which(e)).min_by(|a, b| a.ms.total_cmp(&b.ms)).copied()
    };
    let best = |all: &[Expected]| all.iter().min_by(|a, b| a.error.total_cmp(&b.error)).copied();
    let wanted: Vec<_> =
        expected.iter().map(|all| fastest(all, &good).or_else(|| best(all))).collect();
    let sum = |picked: &[Option<Expected>]| picked.iter().flatten().map(|e| e.ms).sum::<f64>();
    if sum(&wanted) <= sound.max_ms {
        return wanted;
    }
    let mut picked: Vec<_> = expected.iter().map(|all| fastest(all, &|_| true)).collect();
    loop {
        let left = sound.max_ms - sum(&picked);
        // Of every step that fits, the one that takes most error away for its time.
        let steps = picked.iter().enumerate().flat_map(|(light, now)| {
            let now = *now;
            expected[light].iter().filter_map(move |e| {
                let now = now?;
                let fits =
                    e.ms - now.ms <= left && e.error < now.error && !(now.error <= sound.max_error);
                let gain = (now.error - e.error) / (e.ms - now.ms).max(1e-6);
                fits.then_some((gain, light, *e))
            })
        });
        let Some((_, light, step)) = steps.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            return picked;
        };
        picked[light] = Some(step);
    }
}

/// A sentence where a choice is not what was asked for.
fn unmet(taken: &Expected, expected: &[Expected], sound: &Sound) -> Option<String> {
    if taken.ms > sound.max_ms {
        let (least, most) = (taken.ms, sound.max_ms);
        return Some(format!(
            "nothing takes less than {least:.1} ms here, and max_ms is {most}; the fastest is chosen"
        ));
    }
    if taken.error <= sound.max_error || sound.max_error == 0.0 {
        return None;
    }
    let error = taken.error;
    let could = expected.iter().any(|e| e.error <= sound.max_error);
    Some(if could {
        format!(
            "an error of {} takes more than {} ms; {error:.4} is what the time buys",
            sound.max_error, sound.max_ms
        )
    } else {
        format!("no error below {error:.4} can be promised here; that is chosen")
    })
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "auto: {}", self.settings.technique.name())?;
        let plain = Settings { technique: self.settings.technique, ..Settings::default() };
        for knob in KNOBS {
            let value = self.settings.get(knob.key);
            if value != plain.get(knob.key)
                && let Some(value) = value
            {
                write!(f, " {}={value}", knob.key)?;
            }
        }
        if let Some(error) = self.error {
            write!(f, ", error ≤ {error:.4}")?;
        }
        if let Some(ms) = self.ms {
            write!(f, ", {ms:.1} ms expected")?;
        }
        if let Some([scene, light]) = &self.alike {
            write!(f, ", as in {scene} under the {light} light")?;
        }
        if let Some(problem) = &self.problem {
            write!(f, "; {problem}")?;
        }
        Ok(())
    }
}
