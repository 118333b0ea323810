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
use super::expected::{Expected, alike, expect, share, unmet};
use super::table::Table;
use super::{Budget, CANDIDATES, Choice, Costs, Likeness};
use crate::Error;
use crate::effects::Situation;
use crate::frame::{Description, Frame, MeshBoxes, SituationCache};
use crate::technique::Technique;
use crate::techniques::room::HostDraws;

/// How much faster another choice must be to replace one that is good enough.
const FASTER: f64 = 0.8;

/// For how many frames in a row.
const PATIENCE: u32 = 30;

/// What `linear-light` errs by at most where `error` is set, as measured over the report's lines: a share of it, and
/// what is lost between the occluders of open meshes whatever the samples.
const LINE_SHARE: f64 = 1.4;
const LINE_OPEN: f64 = 0.012;

/// What so few lines of a polygon may miss beyond that.
const POLYGON: f64 = 0.01;

/// What is remembered of a light.
#[derive(Clone, Debug)]
struct Held {
    /// What its boxes tell.
    situation: SituationCache,
    candidate: Option<usize>,
    /// For how many frames another one would have been better.
    waited: u32,
    /// The error of each candidate, at its worst in the last frames.
    worst: [f64; CANDIDATES.len()],
    /// What the last frame was to take.
    expected: Option<(&'static str, f64)>,
    technique: Option<Technique>,
}

impl Default for Held {
    fn default() -> Self {
        Self {
            situation: SituationCache::default(),
            candidate: None,
            waited: 0,
            worst: [0.0; CANDIDATES.len()],
            expected: None,
            technique: None,
        }
    }
}

impl Held {
    /// Remembers each candidate's error and puts the worst of the last frames in its place: what moves to and fro is
    /// judged by all of its way. What is over is forgotten within some [`PATIENCE`].
    fn remember(&mut self, expected: &mut [Expected]) {
        for e in expected {
            let worst = &mut self.worst[e.candidate];
            *worst = e.error + (*worst - e.error).max(0.0) * (1.0 - 1.0 / f64::from(PATIENCE));
            e.error = *worst;
        }
    }
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
    mesh_boxes: MeshBoxes,
}

impl Auto {
    /// By a budget, on a device of these costs.
    pub fn new(budget: Budget, costs: Costs) -> Self {
        Self { budget, costs, held: Vec::new(), mesh_boxes: MeshBoxes::default() }
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
            None => self.nothing(0, &Technique::default()),
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
        self.held.resize(frames.len(), Held::default());
        self.mesh_boxes.forget();
        let lights = self.held.iter_mut().zip(frames);
        let situations: Vec<_> = lights
            .map(|(held, frame)| held.situation.situation(description, frame, &mut self.mesh_boxes))
            .collect::<Result<_, _>>()?;
        let sound = self.budget.sound();
        let pixels = f64::from(description.extent[0]) * f64::from(description.extent[1]);
        let mut expected: Vec<Vec<Expected>> = frames
            .iter()
            .zip(&situations)
            .map(|(frame, situation)| match situation {
                Some(s) if !is_line(frame) => {
                    let can = |e: &Expected| {
                        takes(&CANDIDATES[e.candidate].settings(), description, frame, s)
                    };
                    let likeness = Likeness::of(s);
                    expect(Table::own(), &self.costs, &likeness, pixels, s.triangles as f64)
                        .into_iter()
                        .filter(can)
                        .collect()
                }
                _ => Vec::new(),
            })
            .collect();
        for (held, expected) in self.held.iter_mut().zip(&mut expected) {
            held.remember(expected);
        }
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
        // What is held must fit together too.
        let held = |(i, best): (usize, &Option<Expected>)| {
            best.map(|best| self.held_of(i, &expected[i]).unwrap_or(best).ms)
        };
        let together: f64 = picked.iter().enumerate().filter_map(held).sum();
        if together > sound.max_ms {
            self.held.iter_mut().for_each(|held| held.candidate = None);
        }
        let mut choices = Vec::with_capacity(frames.len());
        for (i, (frame, situation)) in frames.iter().zip(&situations).enumerate() {
            choices.push(match (situation, picked[i]) {
                (Some(s), Some(best)) => self.settle(i, s, &expected[i], best, &sound),
                // What is there stays where it takes the light, and costs nothing.
                (None, _) if !is_line(frame) => self.nothing(i, &description.technique),
                (s, _) => self.of_line(i, frame, s.as_ref(), &sound),
            });
        }
        if description.occluder_maps.is_some() {
            // They are as large as the host has them.
            for choice in &mut choices {
                choice.technique = choice.technique.with_map(description.technique.map())?;
            }
        }
        Ok(choices)
    }

    /// What frames of the last choice took, in milliseconds of the device: all passes of light `light` together.
    pub fn observe(&mut self, light: usize, ms: f64) {
        if let Some((technique, expected)) = self.held.get(light).and_then(|h| h.expected) {
            self.costs.learn(technique, expected, ms);
        }
    }

    /// What the held choice of a light is expected to do now.
    fn held_of(&self, light: usize, expected: &[Expected]) -> Option<Expected> {
        let candidate = self.held.get(light)?.candidate?;
        expected.iter().find(|e| e.candidate == candidate).copied()
    }

    /// Nothing can be shadowed.
    fn nothing(&mut self, light: usize, technique: &Technique) -> Choice {
        let held = &mut self.held[light];
        held.expected = None;
        let technique = held.technique.unwrap_or(*technique);
        Choice { technique, error: None, ms: None, alike: None, changed: false, problem: None }
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
        let kept = self.held_of(light, expected);
        let held = &mut self.held[light];
        let taken = match kept {
            Some(kept) if kept.candidate != best.candidate => {
                let good = kept.error <= sound.max_error.max(best.error)
                    && kept.ms <= sound.max_ms.max(best.ms);
                let better = best.ms < FASTER * kept.ms || best.error < FASTER * kept.error;
                held.waited = if better { held.waited + 1 } else { 0 };
                if good && held.waited < PATIENCE { kept } else { best }
            }
            _ => best,
        };
        if held.candidate != Some(taken.candidate) {
            held.waited = 0;
        }
        held.candidate = Some(taken.candidate);
        held.expected = Some((CANDIDATES[taken.candidate].technique, taken.ms));
        let technique = CANDIDATES[taken.candidate].settings();
        let changed = held.technique.replace(technique).is_some_and(|before| before != technique);
        let (_, like) = alike(Table::own(), &Likeness::of(s));
        Choice {
            technique,
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
        let is_line = frame.light.rectangle().is_line();
        let open = if situation.is_some_and(|s| s.open) { LINE_OPEN } else { 0.0 };
        let open = open + if is_line { 0.0 } else { POLYGON };
        let asked = ((sound.max_error - open) / LINE_SHARE).clamp(0.005, 0.1);
        let error = LINE_SHARE * asked + open;
        // Of a polygon's lines each has as many samples: no more than its maps have memory for.
        let (samples, lines) = if is_line { (16, 1) } else { (8, 8) };
        let technique = Technique::along_lines(asked as f32, samples, lines);
        let held = &mut self.held[light];
        held.candidate = None;
        held.expected = None;
        let changed = held.technique.replace(technique).is_some_and(|before| before != technique);
        let met = error <= sound.max_error * 1.0001 || situation.is_none();
        let problem = (!met).then(|| {
            format!("no error below {error:.3} can be promised for a line or a polygon here")
        });
        Choice {
            technique,
            error: situation.map(|_| error),
            ms: None,
            alike: None,
            changed,
            problem: sound.problem.clone().or(problem),
        }
    }
}

fn is_line(frame: &Frame) -> bool {
    frame.light.rectangle().is_line() || frame.light.outline().is_some()
}

/// Whether a technique takes what a host gives.
fn takes(technique: &Technique, description: &Description, frame: &Frame, s: &Situation) -> bool {
    let (takes, maps) = (technique.room().takes(), technique.room().maps());
    let textured = description.light_texture.is_some();
    let lent = description.occluder_maps.is_some();
    let back = frame.occluder_maps.is_some_and(|m| m.back.is_some());
    // A promise holds with finer maps than it was made for, and not with coarser ones.
    let fits = takes.lent_maps.is_ok()
        && maps.side <= description.technique.map()
        && (back || !maps.layers.back);
    (!textured || takes.texture)
        && (!lent || fits)
        && (s.host_drawn == 0 || takes.host_draws == HostDraws::Any)
}
