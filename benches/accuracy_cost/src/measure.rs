//! One group: its stages, its truth, its frames in turns, its errors.

use crate::Problem;
use crate::groups::{Entry, Group, Ready, Stage as Place};
use crate::options::Scale;
use crate::picture::{self, Pictures};
use crate::report::once;
use crate::runner::Runner;
use crate::stability;
use crate::stats::{median, quartiles};
use crate::store::{Errors, Outcome, Row, Times};
use crate::techniques::{Method, method};
use crate::truth::{self, mask};
use antumbra::scene::AreaLight;
use antumbra::truth::{ErrorSummary, Receiver, Traced, Tracer, seen_error};
use antumbra::{Shape, Technique};
use antumbra_harness::rays::RayTracer;
use antumbra_harness::shade;
use antumbra_harness::{FrameTimes, HeadlessDevice, Stage};
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Duration;

/// Fewest frames that quartiles are made of.
const FEWEST_FRAMES: usize = 3;

/// Groups of fewer rows than this take as many frames as if they had that many.
const SMALL_GROUP: usize = 8;

/// What is measured with, and where pictures are kept.
pub struct Bench<'a> {
    pub device: &'a HeadlessDevice,
    pub scale: Scale,
    /// The folder of kept pictures.
    pub cache: &'a Path,
}

/// One row in the making.
struct Candidate<'a> {
    entry: &'a Entry,
    state: Result<Option<Runner<'a>>, Problem>,
    frames: Vec<FrameTimes>,
    image: Vec<f32>,
}

impl Bench<'_> {
    /// Measures a group. Whatever fails, panics included, is a row that says so.
    pub fn measure(&self, group: &Group, say: &dyn Fn(&str)) -> Vec<Row> {
        let work = || self.try_measure(group, say);
        let done = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Err(format!("it panicked: {}", text.unwrap_or("without a word")).into())
        });
        done.unwrap_or_else(|problem| vec![failed(group, problem)])
    }

    fn try_measure(&self, group: &Group, say: &dyn Fn(&str)) -> Result<Vec<Row>, Problem> {
        if matches!(group.stage, Place::Walk { .. }) {
            return stability::measure(self, group, say);
        }
        // Where nothing of it is there yet, nothing is loaded either.
        let methods: Vec<_> = group.entries.iter().map(|e| method(e.technique, &e.words)).collect();
        if methods.iter().all(|m| matches!(m, Ok(None))) {
            return Ok(group.entries.iter().map(|entry| blank(group).of(entry)).collect());
        }
        say("scene");
        let ready = group.ready()?;
        let light = ready.scene.light(None)?.clone();
        let pixels = ready.stage(self.device, group.extent, Technique::default())?;
        let receivers = truth::receivers(pixels.gbuffer())?;
        let tracer = Tracer::new(&ready.scene)?;
        let sends_rays = methods.iter().any(|m| matches!(m, Ok(Some(Method::Rays(_)))));
        let rays = sends_rays.then(|| RayTracer::new(&ready.scene)).transpose()?;
        let views = (rays.as_ref(), receivers.as_slice());
        let candidate = |(entry, method)| Candidate {
            entry,
            state: Runner::new(self.device, &ready, group, entry, method, &light.light, views),
            frames: Vec::new(),
            image: Vec::new(),
        };
        let mut candidates: Vec<_> = group.entries.iter().zip(methods).map(candidate).collect();
        for candidate in &mut candidates {
            say(&format!("warming up {} {}", candidate.entry.technique, candidate.entry.words));
            candidate.warm_up();
        }
        self.take_turns(&mut candidates, say);
        say("truth");
        let (against, rays) = (group.against, self.scale.rays);
        let truth = truth::truth(&ready.scene, &tracer, &receivers, against, rays)?;
        say("errors");
        let seen = Seen::of(&pixels, &light, ready.occluders_seen)?;
        let template = template(group, &ready, &light);
        if seen.is_picture && candidates.iter().any(|c| c.entry.shown) {
            self.paint(group, &candidates, &truth, &seen, &mask(&receivers));
        }
        let rows: Vec<_> = candidates.iter_mut().map(Candidate::result).collect();
        let compared = rows.into_par_iter().map(|(entry, result)| {
            let outcome = result.and_then(|result| {
                let Some((times, image)) = result else { return Ok(Outcome::NotThere) };
                let errors = errors(&truth, &image, &receivers, &seen, group)?;
                Ok(Outcome::Measured { errors, times })
            });
            let outcome = outcome.unwrap_or_else(|problem| Outcome::Failed(problem.0));
            Row { outcome, ..template.of(entry) }
        });
        Ok(compared.collect())
    }

    /// Every candidate once a round. Those that have cost more than their share stop once they have
    /// as many frames as quartiles need.
    fn take_turns(&self, candidates: &mut [Candidate], say: &dyn Fn(&str)) {
        let share = Duration::from_secs(if self.scale.quick { 1 } else { 12 });
        // Small groups, whose times are compared with those of others, take more frames.
        let rounds = self.scale.rounds * (SMALL_GROUP / candidates.len().max(1)).max(1);
        for round in 0..rounds {
            say(&format!("round {} of {rounds}", round + 1));
            for candidate in candidates.iter_mut() {
                let spent: Duration = candidate.frames.iter().map(|f| f.frame).sum();
                let enough = candidate.frames.len() >= FEWEST_FRAMES && spent > share;
                if !enough {
                    candidate.run();
                }
            }
        }
    }

    /// Keeps the pictures of the strip; what cannot be kept is missing there and nowhere else.
    fn paint(&self, group: &Group, all: &[Candidate], truth: &Traced, seen: &Seen, mask: &[bool]) {
        let pictures = Pictures::new(self.cache);
        let shaded = seen.shade(&truth.visible);
        pictures.keep(&group.scene, picture::TRUTH, group.extent, &shaded);
        for c in all.iter().filter(|c| c.entry.shown && !c.image.is_empty()) {
            let curve = c.entry.curve.as_str();
            pictures.keep(&group.scene, curve, group.extent, &seen.shade(&c.image));
            let difference = picture::difference(&truth.visible, &c.image, mask);
            pictures.keep(&group.scene, &picture::error_of(curve), group.extent, &difference);
        }
    }
}

impl Candidate<'_> {
    /// The first frame compiles what the driver compiles, and is not counted; its image is kept.
    fn warm_up(&mut self) {
        self.run();
        self.frames.clear();
        if let Ok(Some(runner)) = &mut self.state {
            match runner.image() {
                Ok(image) => self.image = image.unwrap_or_else(|| std::mem::take(&mut self.image)),
                Err(problem) => self.state = Err(problem),
            }
        }
    }

    /// One frame, where there is a runner whose frames have not failed.
    fn run(&mut self) {
        let Ok(Some(runner)) = &mut self.state else { return };
        match runner.run() {
            Ok((times, image)) => {
                self.image = image.unwrap_or_else(|| std::mem::take(&mut self.image));
                self.frames.push(times);
            }
            Err(problem) => self.state = Err(problem),
        }
    }

    /// Times and image, or nothing where the technique is not there.
    #[allow(clippy::type_complexity, reason = "a name would only be used here")]
    fn result(&mut self) -> (&Entry, Result<Option<(Times, Vec<f32>)>, Problem>) {
        let gpu_bytes = match &mut self.state {
            Err(problem) => return (self.entry, Err(problem.clone())),
            Ok(None) => return (self.entry, Ok(None)),
            Ok(Some(runner)) => match runner.bytes() {
                Ok(bytes) => bytes,
                Err(problem) => return (self.entry, Err(problem)),
            },
        };
        let ms = |of: fn(&FrameTimes) -> Duration| -> Vec<f64> {
            self.frames.iter().map(|f| of(f).as_secs_f64() * 1e3).collect()
        };
        let passes = || self.frames.iter().flat_map(|f| &f.passes);
        let median_of =
            |name: &str| median(&passes().filter(|p| p.0 == name).map(|p| p.1).collect::<Vec<_>>());
        let names = once(passes().map(|p| p.0));
        let times = Times {
            frame_ms: quartiles(&ms(|f| f.frame)),
            frames: self.frames.len(),
            passes: names.into_iter().map(|n| (n.into(), median_of(n))).collect(),
            record_us: 1e3 * median(&ms(|f| f.record)),
            gpu_bytes,
        };
        (self.entry, Ok(Some((times, std::mem::take(&mut self.image)))))
    }
}

/// What shading needs of the pixels.
struct Seen {
    light: AreaLight,
    positions: Vec<[f32; 4]>,
    normals: Vec<[f32; 4]>,
    /// The unshadowed irradiance of each pixel.
    irradiance: Vec<f64>,
    /// Whether the pixels are a picture of the scene.
    is_picture: bool,
}

impl Seen {
    fn of(stage: &Stage, light: &AreaLight, is_picture: bool) -> Result<Self, Problem> {
        let (positions, normals) = (stage.gbuffer().positions()?, stage.gbuffer().normals()?);
        let irradiance = shade::irradiances(&light.light, &positions, &normals);
        Ok(Self { light: light.clone(), positions, normals, irradiance, is_picture })
    }

    /// Visibility × unshadowed irradiance, exposed alike for every image of these pixels.
    fn shade(&self, visible: &[f32]) -> Vec<u8> {
        shade::shade(&self.light, visible, &self.positions, &self.normals)
    }
}

fn errors(
    truth: &Traced,
    image: &[f32],
    receivers: &[Receiver],
    seen: &Seen,
    group: &Group,
) -> Result<Errors, Problem> {
    let mask = mask(receivers);
    let summary = ErrorSummary::between(&truth.visible, image, Some(&mask))?;
    let seen_error = Some(seen_error(&truth.visible, image, &seen.irradiance, Some(&mask))?);
    // E|noise| of a normal error, in the penumbra alone, over all that is counted.
    let noise_floor =
        (2.0 / std::f64::consts::PI).sqrt() * truth.noise * summary.penumbra_pixels as f64
            / summary.pixels.max(1) as f64;
    let flip = seen
        .is_picture
        .then(|| picture::flip(group.extent, &seen.shade(&truth.visible), &seen.shade(image)));
    let truth_noise = truth.noise;
    Ok(Errors { summary, seen_error, flip, truth_noise, noise_floor, ..Errors::default() })
}

/// A row of a group without an entry, of which nothing is known but what was asked for.
pub(crate) fn blank(group: &Group) -> Row {
    Row {
        study: group.study.into(),
        scene: group.scene.clone(),
        light: group.light.clone(),
        extent: group.extent,
        technique: "all".into(),
        x: group.at.unwrap_or(0.0),
        ..Row::default()
    }
}

/// A row without an entry, with what is known of the group's scene under its light.
pub(crate) fn template(group: &Group, ready: &Ready, light: &AreaLight) -> Row {
    let is_sun = matches!(light.light.shape(), Shape::Sun { .. });
    let sides = light.light.rectangle().half_extents().map(|h| 2.0 * h);
    Row {
        light_m: if is_sun { [0.0; 2] } else { sides },
        triangles: ready.scene.triangles(),
        normals: ready.normals,
        ..blank(group)
    }
}

impl Row {
    /// This row of an entry.
    pub(crate) fn of(&self, entry: &Entry) -> Self {
        Self {
            technique: entry.technique.into(),
            curve: entry.curve.clone(),
            settings: entry.words.clone(),
            x: entry.x,
            ..self.clone()
        }
    }
}

/// The row of a group that could not be measured at all.
fn failed(group: &Group, problem: Problem) -> Row {
    Row { outcome: Outcome::Failed(problem.0), ..blank(group) }
}
