//! The envelope: over what lights, distances and resolutions a technique errs about as it does in between.
//!
//! ```text
//!   error │ ╲                      ╱
//!   1.5 × ┤┄┄┄╲┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄╱┄┄┄
//!    1 ×  ┤     ╲___________●____╱           ● the centre, which every sweep goes through
//!         └──────┊───────────────┊────────
//!                └── envelope ───┘
//! ```
//! One variable at a time leaves the centre, [`CENTRE`]; the truth is exact, so that there is no noise but
//! that of where pixels are. The techniques compute what they can compute: what a node's planner would
//! leave out for costing next to nothing ([`antumbra::Description::omit`]) is not left out.

mod page;
mod place;
mod range;

use crate::commit::commit;
use crate::options::Options;
use crate::techniques::{Method, method};
use crate::truth::{mask, receivers};
use crate::{Problem, report};
use antumbra::Omit;
use antumbra::scene::{Instance, Role};
use antumbra::truth::ErrorSummary;
use antumbra_harness::{HeadlessDevice, HeadlessOptions, Stage};
use indicatif::HumanDuration;
use place::{CENTRE, FLAT, Place, Ready, SOLID};
pub use range::{Envelope, FACTOR, FLOOR, Step};
use serde::Serialize;
use std::time::Instant;

/// The scenes.
const SCENES: [&str; 2] = [FLAT, SOLID];

/// The node's five, then what users would pick instead. All as they are by default, but for the maps' side.
const TECHNIQUES: [&str; 9] = [
    "soft-shadow-map",
    "ray-march",
    "occlusion-textures",
    "linear-light",
    "traced",
    "hard",
    "pcss",
    "back-projection",
    "many-lights",
];

/// One variable of a [`Place`].
struct Axis {
    /// What it is called, in its table's heading.
    name: &'static str,
    /// What its numbers are, after a colon.
    unit: &'static str,
    /// Where the sweep looks, rising; the centre is among them.
    steps: &'static [f64],
    /// The variable.
    of: fn(&mut Place) -> &mut f64,
}

const AXES: [Axis; 5] = [
    Axis {
        name: "Light size",
        unit: "the light's side over the object's",
        steps: &[
            0.001, 0.002, 0.004, 0.01, 0.02, 0.04, 0.1, 0.2, 0.4, 1.0, 2.0, 4.0, 10.0, 20.0, 40.0,
            100.0,
        ],
        of: |place| &mut place.light,
    },
    Axis {
        name: "Distance from the receiver",
        unit: "where the object is on its way from the ground, 0, to the light, 1",
        steps: &[
            0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.97, 0.99, 0.997, 0.999,
        ],
        of: |place| &mut place.height,
    },
    Axis {
        name: "Distance of the light",
        unit: "from the ground to the light over the object's size, the object halfway",
        steps: &[1.01, 1.1, 1.5, 2.0, 4.0, 10.0, 30.0, 100.0, 1e3, 1e4, 1e5],
        of: |place| &mut place.gap,
    },
    Axis {
        name: "Maps",
        unit: "the side of the technique's maps in texels",
        steps: &[16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0],
        of: |place| &mut place.map,
    },
    Axis {
        name: "Image",
        unit: "pixels across all that is shadowed",
        steps: &[12.0, 24.0, 48.0, 96.0, 192.0],
        of: |place| &mut place.pixels,
    },
];

impl Axis {
    /// The centre, but for the variable.
    fn place(&self, at: f64) -> Place {
        let mut place = CENTRE;
        *(self.of)(&mut place) = at;
        place
    }

    /// The centre's index among the steps.
    fn centre(&self) -> Option<usize> {
        self.steps.iter().position(|step| self.place(*step) == CENTRE)
    }
}

/// What one technique did at one place.
#[derive(Clone, Debug, Serialize)]
struct Row {
    scene: &'static str,
    axis: &'static str,
    at: f64,
    technique: &'static str,
    /// The mean |error| over the pixels in shadow or penumbra, 0 without any; none where it was not measured.
    mean_abs_error: Option<f64>,
    /// Pixels that the mean is of.
    pixels: usize,
    /// Pixels in penumbra.
    penumbra_pixels: usize,
    /// The greatest share of the light that is hidden from a pixel, by the truth.
    darkest: f64,
    /// A pixel's side in metres.
    pixel_m: f64,
    /// Whether it was measured, and why not.
    status: Status,
}

/// How it went.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Status {
    /// It was measured.
    Measured,
    /// The settings are none that the node takes, and it says why.
    Refused(String),
    /// Something that should have worked did not.
    Failed(String),
}

impl<E: Into<Problem>> From<E> for Status {
    fn from(problem: E) -> Self {
        Self::Failed(problem.into().0)
    }
}

/// Measures every sweep, and writes envelope.md, .csv and .json; whether nothing failed.
///
/// # Errors
/// A sentence for what stops the run: no device, a folder that cannot be written.
pub fn run(options: &Options) -> Result<bool, Problem> {
    let device = HeadlessDevice::new(&HeadlessOptions::default())?;
    std::fs::create_dir_all(&options.out)
        .map_err(Problem::of(format!("--out {}", options.out.display())))?;
    let started = Instant::now();
    let mut rows = Vec::new();
    for scene in SCENES {
        let mut bench = Bench { device: &device, scene, kept: TECHNIQUES.map(|_| None) };
        let centre = bench.measure("", f64::NAN, &CENTRE)?;
        for axis in &AXES {
            for &at in axis.steps {
                let place = axis.place(at);
                if place == CENTRE {
                    let here = |row: &Row| Row { axis: axis.name, at, ..row.clone() };
                    rows.extend(centre.iter().map(here));
                } else {
                    rows.extend(bench.measure(axis.name, at, &place)?);
                }
            }
            let took = HumanDuration(started.elapsed());
            println!("{scene}: {} ({took} so far)", axis.name.to_lowercase());
        }
    }
    let made = page::Made { commit: commit(), driver: device.name().into(), rows };
    report::write_files(
        &options.out,
        [
            ("envelope.md", made.markdown()),
            ("envelope.csv", made.csv()?),
            ("envelope.json", made.json()?),
        ],
    )?;
    println!("Look at {}", options.out.join("envelope.md").display());
    let mut good = true;
    for Row { scene, axis, at, technique, status, .. } in &made.rows {
        if let Status::Failed(why) = status {
            println!("failed: {scene}, {axis} {at}, {technique}: {why}");
            good = false;
        }
    }
    Ok(good)
}

/// One scene, and its techniques' stages at the centre's resolutions, so that nothing is compiled twice.
struct Bench<'a> {
    device: &'a HeadlessDevice,
    scene: &'static str,
    kept: [Option<Stage>; TECHNIQUES.len()],
}

impl Bench<'_> {
    /// Every technique at one place.
    fn measure(&mut self, axis: &'static str, at: f64, place: &Place) -> Result<Vec<Row>, Problem> {
        let ready = place.ready(self.scene)?;
        let mut truth: Option<(Vec<f32>, Vec<bool>)> = None;
        let mut rows = Vec::new();
        for (index, technique) in TECHNIQUES.into_iter().enumerate() {
            let done = self.compare(index, place, &ready, &mut truth);
            let visible = truth.iter().flat_map(|(visible, _)| visible);
            let summary = done.as_ref().copied().unwrap_or_default();
            rows.push(Row {
                scene: self.scene,
                axis,
                at,
                technique,
                mean_abs_error: done.is_ok().then_some(summary.mean_abs_error),
                pixels: summary.pixels,
                penumbra_pixels: summary.penumbra_pixels,
                darkest: visible.map(|v| 1.0 - f64::from(*v)).fold(0.0, f64::max),
                pixel_m: 2.0 * ready.half / place.pixels,
                status: done.err().unwrap_or(Status::Measured),
            });
        }
        Ok(rows)
    }

    /// One technique's error; the truth is computed once, at the first one's pixels.
    fn compare(
        &mut self,
        index: usize,
        place: &Place,
        ready: &Ready,
        truth: &mut Option<(Vec<f32>, Vec<bool>)>,
    ) -> Result<ErrorSummary, Status> {
        let mut stage = self.stage(index, place, ready)?;
        let (truth, mask) = match truth {
            Some(known) => known,
            None => {
                let pixels = receivers(stage.gbuffer())?;
                truth.insert((ready.truth(&pixels)?, mask(&pixels)))
            }
        };
        let image = image(&mut stage, ready)?;
        if is_kept(place) {
            self.kept[index] = Some(stage);
        }
        Ok(ErrorSummary::between(truth, &image, Some(mask))?)
    }

    /// The technique's stage, showing this place.
    fn stage(&mut self, index: usize, place: &Place, ready: &Ready) -> Result<Stage, Status> {
        if is_kept(place)
            && let Some(mut stage) = self.kept[index].take()
        {
            stage.show(&ready.scene, &ready.view, seen)?;
            return Ok(stage);
        }
        let name = TECHNIQUES[index];
        let Some(Method::Node(settings)) = method(name, "")? else {
            return Err(Status::Failed(format!("{name} is none of the node's techniques")));
        };
        let settings = settings
            .with_map(place.map as u32)
            .and_then(|settings| settings.check().map(|()| settings))
            .map_err(|problem| Status::Refused(problem.to_string()))?;
        let extent = [place.pixels as u32; 2];
        let Ready { scene, view, .. } = ready;
        let mut stage = Stage::new(self.device, scene, view, extent, settings, seen)?;
        stage.configure_with(settings, |d| d.omit = Omit::Nothing)?;
        Ok(stage)
    }
}

/// Whether a place has the resolutions that stages are kept of.
fn is_kept(place: &Place) -> bool {
    place.map == CENTRE.map && place.pixels == CENTRE.pixels
}

/// Pixels look at the ground alone.
fn seen(instance: &Instance) -> bool {
    instance.role == Role::Receiver
}

/// The visible fraction of every pixel, by the node.
fn image(stage: &mut Stage, ready: &Ready) -> Result<Vec<f32>, Problem> {
    let light = ready.scene.light(None)?.light;
    let plan = stage.plan(light, None)?;
    stage.run(&plan)?;
    Ok(stage.visibility()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use antumbra::truth::Receiver;
    use glam::DVec3;

    #[test]
    fn every_sweep_rises_through_the_centre_and_sets_its_own_variable_alone() {
        for axis in &AXES {
            assert!(axis.steps.is_sorted_by(|a, b| a < b), "{}", axis.name);
            let centre = axis.centre().unwrap_or_else(|| panic!("{}", axis.name));
            assert_ne!(axis.place(axis.steps[0]), CENTRE, "{}", axis.name);
            assert_eq!(axis.place(axis.steps[centre]), CENTRE, "{}", axis.name);
        }
    }

    #[test]
    fn a_view_holds_the_shadow_and_not_much_more() {
        // The solid's truth takes minutes where the crate is not optimized.
        for (light, height) in [(0.4, 0.5), (10.0, 0.5), (0.4, 0.97)] {
            let place = Place { light, height, ..CENTRE };
            let ready = place.ready(FLAT).unwrap();
            let dark = |half: f64| {
                let on = |i: u32| half * (f64::from(i) / 16.0 - 1.0);
                let at = |i: u32| Receiver {
                    position: DVec3::new(on(i % 33), 0.0, on(i / 33)),
                    normal: DVec3::Y,
                };
                let all: Vec<_> = (0..33 * 33).map(at).collect();
                let inside = |r: &Receiver| {
                    let clip = ready.view.clip_from_world.project_point3(r.position);
                    clip.truncate().abs().max_element() <= 1.0
                };
                let truth = ready.truth(&all).unwrap();
                let of = all.iter().zip(truth).filter(|(_, v)| *v < 0.999);
                let (within, beyond): (Vec<_>, Vec<_>) = of.partition(|(r, _)| inside(r));
                (within.len(), beyond.len())
            };
            let (within, beyond) = dark(1.5 * ready.half);
            assert_eq!(beyond, 0, "{place:?}");
            // Of the grid, a view's square is 4/9.
            assert!(within > 33 * 33 / 20, "{place:?}: {within}");
        }
    }
}
