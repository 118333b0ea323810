//! Runs the table: each case with each technique, beside what it must be.

use super::cases::HardCase;
use super::judge::{Row, judge};
use super::pixels::{self, Maps, Range, Reach, SIDE};
use super::techniques::{self, Expected, Held};
use crate::Problem;
use crate::scenes::scaled;
use antumbra::scene::{Instance, Role, Scene};
use antumbra::{FramePlan, Technique};
use antumbra_harness::{HeadlessDevice, Stage, View, shade, technique_of};
use std::collections::BTreeMap;

/// How large a point is beside the light that it stands for.
const POINT: f64 = 1e-6;

/// Under how large a light what a guess makes of the penumbra must have ended, over the light itself.
const GUESSED: f64 = 1.5;

/// Runs all cases with all techniques, one node for as many as it serves; rows are in the order of the cases, and
/// of the techniques within them.
pub fn run(device: &HeadlessDevice, cases: &[HardCase]) -> Result<Vec<Row>, Problem> {
    let mut prepared: Vec<Prepared> = cases
        .iter()
        .map(|case| Prepared::new(case).map_err(Problem::of(case.title())))
        .collect::<Result<_, _>>()?;
    // Cases and techniques by the settings that they share.
    let mut by_settings: BTreeMap<(u32, String), Vec<(usize, usize)>> = BTreeMap::new();
    for (at, case) in cases.iter().enumerate() {
        for (technique, held) in techniques::ALL.iter().enumerate() {
            let rows = by_settings.entry((case.map, case.words_of(held))).or_default();
            rows.push((at, technique));
        }
    }
    // A node serves cases of all sizes; each mesh may need a place more than it has triangles.
    let places = |p: &Prepared| p.scene.triangles() + p.scene.instances.len();
    let most = prepared.iter().map(places).max().unwrap_or(0) as u32;
    let mut rows: BTreeMap<(usize, usize), Row> = BTreeMap::new();
    let mut stage: Option<Stage> = None;
    for ((map, words), places) in &by_settings {
        let mut fresh = true;
        for &(at, technique) in places {
            let (case, held) = (&cases[at], &techniques::ALL[technique]);
            let prepared = &mut prepared[at];
            let shown = prepared.show(device, stage.take()).map_err(Problem::of(case.title()))?;
            let shown = stage.insert(shown);
            if std::mem::take(&mut fresh) {
                let made = shown.configure_with(settings(words, *map)?, |d| {
                    d.capacity.triangles = d.capacity.triangles.max(most);
                });
                made.map_err(Problem::of(case.title()))?;
            }
            let row = prepared.row(shown, case, held).map_err(Problem::of(case.title()))?;
            rows.insert((at, technique), row);
        }
    }
    Ok(rows.into_values().collect())
}

/// Settings from the words of a command line; `map` is the side of the maps of those that have any.
pub fn settings(words: &str, map: u32) -> Result<Technique, Problem> {
    Ok(technique_of(words)?.with_map(map)?)
}

/// What ranges depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Expectation {
    expected: Expected,
    windowed: bool,
    reach: Reach,
}

/// A case's scene, and what its pixels see.
struct Prepared<'a> {
    case: &'a HardCase,
    scene: Scene,
    view: View,
    pixels: Vec<Option<pixels::Seen>>,
    /// Through the window that a host gives, and fitted.
    maps: [Maps; 2],
    /// The ranges that are known already.
    ranges: Vec<(Expectation, Vec<Range>)>,
}

impl<'a> Prepared<'a> {
    fn new(case: &'a HardCase) -> Result<Self, Problem> {
        let extent = [SIDE; 2];
        Ok(Self {
            case,
            scene: case.set.scene(case.place)?,
            view: case.set.view(case.place, extent),
            pixels: pixels::seen(&case.set, extent),
            maps: [Maps::of(case, true)?, Maps::of(case, false)?],
            ranges: Vec::new(),
        })
    }

    /// A stage that shows it.
    fn show(&self, device: &HeadlessDevice, stage: Option<Stage>) -> Result<Stage, Problem> {
        let keep = |i: &Instance| i.role != Role::Occluder;
        let Some(mut stage) = stage else {
            let settings = Technique::default();
            return Ok(Stage::new(device, &self.scene, &self.view, [SIDE; 2], settings, keep)?);
        };
        stage.show(&self.scene, &self.view, keep)?;
        Ok(stage)
    }

    fn row(
        &mut self,
        stage: &mut Stage,
        case: &HardCase,
        held: &'static Held,
    ) -> Result<Row, Problem> {
        let light = self.scene.light(None)?.light;
        let plan = stage.plan(light, case.window)?;
        stage.run(&plan)?;
        let image = stage.visibility()?;
        // Where penumbrae are narrower than a pixel, a hard shadow is all that the node makes.
        let by = if runs(&plan, "hard.visibility") { &techniques::HARD } else { held };
        let noise = case.noise_of(held);
        let irradiance = self.irradiance();
        Ok(judge(case, held, by, noise, self.ranges_of(by)?, &irradiance, &image))
    }

    /// The light that each pixel gets without shadows; what faces away and the background get none.
    fn irradiance(&self) -> Vec<f64> {
        let position = |seen: &pixels::Seen| seen.position.as_vec3().extend(1.0).to_array();
        let normal = |seen: &pixels::Seen| seen.normal.as_vec3().extend(0.0).to_array();
        let of = |to: &dyn Fn(&pixels::Seen) -> [f32; 4]| -> Vec<[f32; 4]> {
            self.pixels.iter().map(|seen| seen.as_ref().map_or([0.0; 4], to)).collect()
        };
        shade::irradiances(&self.case.set.light.into(), &of(&position), &of(&normal))
    }

    fn ranges_of(&mut self, held: &Held) -> Result<&[Range], Problem> {
        let reach = Reach { texels: held.texels, receiver_texels: held.receiver_texels };
        let wanted = Expectation { expected: held.expected, windowed: held.windowed, reach };
        let at = match self.ranges.iter().position(|(known, _)| *known == wanted) {
            Some(at) => at,
            None => {
                self.ranges.push((wanted, self.make_ranges(wanted)?));
                self.ranges.len() - 1
            }
        };
        Ok(&self.ranges[at].1)
    }

    fn make_ranges(
        &self,
        Expectation { expected, windowed, reach }: Expectation,
    ) -> Result<Vec<Range>, Problem> {
        let maps = &self.maps[usize::from(!windowed)];
        let set = if windowed { self.case.truth_set() } else { self.case.set.clone() };
        let of = |scale: f64| {
            let light = scaled(&self.case.set.light, scale)?;
            pixels::ranges(&set, maps, &light, &self.pixels, reach)
        };
        match expected {
            Expected::Light => of(1.0),
            Expected::Centre => of(POINT),
            Expected::Plateaus => {
                let (near, wide) = (of(1.0)?, of(GUESSED)?);
                let guess = |(near, wide): (&Range, &Range)| match (wide.least, wide.most) {
                    (1.0, _) | (_, 0.0) => *near,
                    _ => Range { truth: near.truth, least: 0.0, most: 1.0 },
                };
                Ok(near.iter().zip(&wide).map(guess).collect())
            }
        }
    }
}

fn runs(plan: &FramePlan, pass: &str) -> bool {
    plan.plan().steps.iter().any(|step| plan.plan().graph.passes()[step.pass].name == pass)
}
