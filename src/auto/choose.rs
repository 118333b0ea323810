//! Chooses a technique with its settings for each light by a budget of error and time.
//!
//! ```text
//!   frame ─► Situation ─► Features ─► the nearest views of the table
//!                                        │ their worst error, their mean time × Costs
//!   Budget ──────────────────────────────┴─► the fastest whose error is allowed ─► hysteresis ─► Choice
//! ```
//! The promised error is the worst of the nearest views, and grows with their distance. `docs/planner.md` says how
//! often the promise is kept, for scenes of the table and for scenes that the table does not have.

use super::budget::ValidBudget;
use super::candidates::techniques;
use super::expected::{Expected, drop_the_slow, expect, nearest_views, share, unmet};
use super::table::Table;
use super::{Budget, CANDIDATES, Choice, Costs, Features};
use crate::Error;
use crate::effects::Situation;
use crate::frame::{self, Description, Frame, MeshBoxes, SituationCache};
use crate::technique::Technique;
use crate::techniques::room::{self, HostDraws};

/// Another candidate replaces one that meets the budget where its time or error is below this share of that one's.
const BETTER: f64 = 0.8;

/// The number of successive frames in which it must be better.
const PATIENCE: u32 = 30;

/// The measured error bound of `linear-light` over the report's lines: `LINE_SHARE` × its `error` setting, plus
/// `LINE_OPEN` for gaps in open meshes.
const LINE_SHARE: f64 = 1.4;
const LINE_OPEN: f64 = 0.012;

/// The error that the few lines of a polygon add to that bound.
const POLYGON: f64 = 0.01;

/// The state of one light from frame to frame.
#[derive(Clone, Debug)]
struct LightState {
    /// Describes the light's situation in each frame.
    situations: SituationCache,
    /// The chosen candidate's index in [`CANDIDATES`].
    candidate: Option<usize>,
    /// The number of successive frames in which another candidate was better.
    waited: u32,
    /// The worst error of each candidate in the last frames.
    worst: [f64; CANDIDATES.len()],
    /// The technique of the last frame, and the milliseconds it was expected to take.
    expected: Option<(&'static str, f64)>,
    technique: Option<Technique>,
}

impl Default for LightState {
    fn default() -> Self {
        Self {
            situations: SituationCache::default(),
            candidate: None,
            waited: 0,
            worst: [0.0; CANDIDATES.len()],
            expected: None,
            technique: None,
        }
    }
}

impl LightState {
    /// Replaces each candidate's error by the worst of the last frames, so that an occluder that moves to and fro does
    /// not change the choice each time. A peak decays within some [`PATIENCE`] frames.
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
/// It holds no Vulkan objects and makes no Vulkan calls. The host gets its choices, reconfigures the node where they
/// change ([`crate::ShadowNode::adapt`] does both), and reports the times of frames to [`Self::observe`].
#[derive(Clone, Debug)]
pub struct Auto {
    budget: Budget,
    costs: Costs,
    lights: Vec<LightState>,
    mesh_boxes: MeshBoxes,
}

impl Auto {
    /// A chooser with a budget, for a device with these costs.
    pub fn new(budget: Budget, costs: Costs) -> Self {
        Self { budget, costs, lights: Vec::new(), mesh_boxes: MeshBoxes::default() }
    }

    /// The costs learnt so far, which the host may store for the next start.
    pub fn costs(&self) -> &Costs {
        &self.costs
    }

    /// Sets the budget for the frames from now on.
    pub fn set_budget(&mut self, budget: Budget) {
        self.budget = budget;
    }

    /// Chooses the technique for the frame of a single light.
    ///
    /// # Errors
    /// See [`Self::choose_all`].
    pub fn choose(&mut self, description: &Description, frame: &Frame) -> Result<Choice, Error> {
        let mut all = self.choose_all(description, std::slice::from_ref(frame))?;
        Ok(all.swap_remove(0))
    }

    /// Chooses the technique for a light with an area from its situation and the image's size in pixels, with no host
    /// to restrict the techniques: to study how choices are made.
    pub fn choose_in(&mut self, situation: &Situation, [width, height]: [u32; 2]) -> Choice {
        self.lights.resize(1, LightState::default());
        let budget = self.budget.valid();
        let pixels = f64::from(width) * f64::from(height);
        let triangles = situation.triangles as f64;
        let features = Features::of(situation);
        let mut expected = expect(Table::own(), &self.costs, &features, pixels, triangles);
        drop_the_slow(&mut expected, &budget);
        match share(std::slice::from_ref(&expected), &budget)[0] {
            Some(best) => self.settle(0, situation, &expected, best, &budget),
            None => {
                let kept = self.lights[0].technique.unwrap_or_default();
                self.unshadowed(0, &kept)
            }
        }
    }

    /// Chooses the technique for each light of a frame, in the order of `frames`. The lights share `max_ms`, which goes
    /// where it reduces errors most.
    ///
    /// # Errors
    /// [`Error::Frame`] for a frame that every technique refuses.
    pub fn choose_all(
        &mut self,
        description: &Description,
        frames: &[Frame],
    ) -> Result<Vec<Choice>, Error> {
        self.lights.resize(frames.len(), LightState::default());
        self.mesh_boxes.forget();
        let lights = self.lights.iter_mut().zip(frames);
        let situations: Vec<_> = lights
            .map(|(state, frame)| {
                state.situations.situation(description, frame, &mut self.mesh_boxes)
            })
            .collect::<Result<_, _>>()?;
        let budget = self.budget.valid();
        let pixels = f64::from(description.extent[0]) * f64::from(description.extent[1]);
        let kept_out: Vec<Option<String>> =
            frames.iter().map(|frame| no_triangles(description, frame)).collect();
        let mut expected: Vec<Vec<Expected>> = frames
            .iter()
            .zip(&situations)
            .zip(&kept_out)
            .map(|((frame, situation), kept_out)| match situation {
                Some(s) if !is_line(frame) => {
                    let can = |e: &Expected| {
                        let technique = &techniques()[e.candidate];
                        takes(technique, description, frame, s)
                            && (kept_out.is_none() || !technique.room().reads_triangles())
                    };
                    let features = Features::of(s);
                    expect(Table::own(), &self.costs, &features, pixels, s.triangles as f64)
                        .into_iter()
                        .filter(can)
                        .collect()
                }
                _ => Vec::new(),
            })
            .collect();
        for (state, expected) in self.lights.iter_mut().zip(&mut expected) {
            state.remember(expected);
            drop_the_slow(expected, &budget);
        }
        let picked = share(&expected, &budget);
        let least: f64 = picked.iter().flatten().map(|e| e.ms).sum();
        let lights = picked.iter().flatten().count();
        let too_slow = (lights > 1 && least > budget.max_ms).then(|| {
            format!(
                "the {lights} lights together take no less than {least:.1} ms here, and max_ms is {}; \
                 the fastest is chosen for each",
                budget.max_ms
            )
        });
        let budget = ValidBudget { problem: budget.problem.or(too_slow), ..budget };
        // The candidates that lights keep must fit the time together too.
        let kept = |(i, best): (usize, &Option<Expected>)| {
            best.map(|best| self.current(i, &expected[i]).unwrap_or(best).ms)
        };
        let together: f64 = picked.iter().enumerate().filter_map(kept).sum();
        if together > budget.max_ms {
            self.lights.iter_mut().for_each(|state| state.candidate = None);
        }
        let mut choices = Vec::with_capacity(frames.len());
        for (i, (frame, situation)) in frames.iter().zip(&situations).enumerate() {
            choices.push(match (situation, picked[i]) {
                (Some(s), Some(best)) => self.settle(i, s, &expected[i], best, &budget),
                // An unshadowed light keeps its technique, which then costs nothing.
                (None, _) if !is_line(frame) => {
                    let kept = self.lights[i].technique.unwrap_or(description.technique);
                    let holds = |t: &&Technique| t.room().takes().shapes.hold(&frame.light);
                    let another = || techniques().iter().find(holds);
                    let technique = Some(&kept).filter(holds).or_else(another);
                    self.unshadowed(i, technique.unwrap_or(&kept))
                }
                (s, _) => self.for_line(i, frame, s.as_ref(), &budget),
            });
        }
        for ((choice, frame), kept_out) in choices.iter_mut().zip(frames).zip(kept_out) {
            // Where nothing is promised, and for lines, nothing is missed.
            choice.left_out = kept_out.filter(|_| choice.error.is_some() && !is_line(frame));
        }
        if description.occluder_maps.is_some() {
            // Lent maps have the size that the host gave them.
            for choice in &mut choices {
                choice.technique = choice.technique.with_map(description.technique.map())?;
            }
        }
        Ok(choices)
    }

    /// Reports the device's time for the last choice: the milliseconds of all passes of light number `light`. Does
    /// nothing for a light without a choice.
    pub fn observe(&mut self, light: usize, ms: f64) {
        if let Some((technique, expected)) = self.lights.get(light).and_then(|state| state.expected)
        {
            self.costs.learn(technique, expected, ms);
        }
    }

    /// The expectation of the candidate that a light has, in the present frame.
    fn current(&self, light: usize, expected: &[Expected]) -> Option<Expected> {
        let candidate = self.lights.get(light)?.candidate?;
        expected.iter().find(|e| e.candidate == candidate).copied()
    }

    /// The choice where nothing can be shadowed: the technique that the light has.
    fn unshadowed(&mut self, light: usize, technique: &Technique) -> Choice {
        let state = &mut self.lights[light];
        state.expected = None;
        Choice {
            technique: *technique,
            error: None,
            ms: None,
            nearest: None,
            changed: false,
            problem: None,
            left_out: None,
        }
    }

    /// Keeps the light's candidate where it meets the budget, unless another one has been better for long.
    fn settle(
        &mut self,
        light: usize,
        s: &Situation,
        expected: &[Expected],
        best: Expected,
        budget: &ValidBudget,
    ) -> Choice {
        let kept = self.current(light, expected);
        let state = &mut self.lights[light];
        let chosen = match kept {
            Some(kept) if kept.candidate != best.candidate => {
                let good = kept.error <= budget.max_error.max(best.error)
                    && kept.ms <= budget.max_ms.max(best.ms);
                let better = best.ms < BETTER * kept.ms || best.error < BETTER * kept.error;
                state.waited = if better { state.waited + 1 } else { 0 };
                if good && state.waited < PATIENCE { kept } else { best }
            }
            _ => best,
        };
        if state.candidate != Some(chosen.candidate) {
            state.waited = 0;
        }
        state.candidate = Some(chosen.candidate);
        state.expected = Some((CANDIDATES[chosen.candidate].technique, chosen.ms));
        let technique = techniques()[chosen.candidate];
        let changed = state.technique.replace(technique).is_some_and(|before| before != technique);
        let (_, views) = nearest_views(Table::own(), &Features::of(s));
        let drawn_whole = drawn_whole(s);
        Choice {
            technique,
            error: drawn_whole.is_none().then_some(chosen.error),
            ms: Some(chosen.ms),
            nearest: views.first().map(|v| v.name.clone()),
            changed,
            problem: budget
                .problem
                .clone()
                .or(drawn_whole)
                .or_else(|| unmet(&chosen, expected, budget)),
            left_out: None,
        }
    }

    /// The choice for a line or a polygon: linear-light, which places samples until their error is below its setting.
    fn for_line(
        &mut self,
        light: usize,
        frame: &Frame,
        situation: Option<&Situation>,
        budget: &ValidBudget,
    ) -> Choice {
        let is_line = frame.light.rectangle().is_line();
        let open = if situation.is_some_and(|s| s.open) { LINE_OPEN } else { 0.0 };
        let open = open + if is_line { 0.0 } else { POLYGON };
        let share = ((budget.max_error - open) / LINE_SHARE).clamp(0.005, 0.1);
        let error = LINE_SHARE * share + open;
        // Each of a polygon's lines has this many samples, as many as the memory of their maps allows.
        let (samples, lines) = if is_line { (16, 1) } else { (8, 8) };
        let technique = Technique::along_lines(share as f32, samples, lines);
        let state = &mut self.lights[light];
        state.candidate = None;
        state.expected = None;
        let changed = state.technique.replace(technique).is_some_and(|before| before != technique);
        let drawn_whole = situation.and_then(drawn_whole);
        let met = error <= budget.max_error * 1.0001 || situation.is_none();
        let problem = (!met).then(|| {
            format!("no error below {error:.3} can be promised for a line or a polygon here")
        });
        Choice {
            technique,
            error: situation.filter(|_| drawn_whole.is_none()).map(|_| error),
            ms: None,
            nearest: None,
            changed,
            problem: budget.problem.clone().or(drawn_whole).or(problem),
            left_out: None,
        }
    }
}

/// Why no error can be promised, as a sentence, where the node draws meshes whole that textures cut out.
fn drawn_whole(s: &Situation) -> Option<String> {
    (s.cut_out > 0).then(|| {
        format!(
            "no error can be promised: textures cut out {} meshes that are drawn whole; lend their textures",
            s.cut_out
        )
    })
}

fn is_line(frame: &Frame) -> bool {
    frame.light.rectangle().is_line() || frame.light.outline().is_some()
}

/// Why no technique that works with the triangles themselves can run, as a sentence; `None` where one can.
fn no_triangles(description: &Description, frame: &Frame) -> Option<String> {
    let reader = techniques().iter().find(|t| t.room().reads_triangles())?;
    let why = match (description.occluder_maps, reader.room().takes().lent_maps) {
        (Some(_), Err(why)) => Some(format!("the host lends maps, and it {why}")),
        _ => frame::kept_out(description.capacity, frame.meshes),
    };
    why.map(|why| format!("{} is left out: {why}", reader.name()))
}

/// Whether a technique accepts what the host lends and draws.
fn takes(technique: &Technique, description: &Description, frame: &Frame, s: &Situation) -> bool {
    let (takes, maps) = (technique.room().takes(), technique.room().maps());
    let textured = description.light_texture.is_some();
    let lent = description.occluder_maps.is_some();
    let back = frame.occluder_maps.is_some_and(|m| m.back.is_some());
    // The promised error holds with finer maps than the candidate's, and not with coarser ones.
    let fits = takes.lent_maps.is_ok()
        && maps.side <= description.technique.map()
        && (back || !maps.layers.back);
    takes.shapes.hold(&frame.light)
        && (!textured || takes.texture)
        && (!lent || fits)
        && (s.host_drawn == 0 || takes.host_draws == HostDraws::Any)
        && room::check_extent(technique.room(), description.extent).is_ok()
}
