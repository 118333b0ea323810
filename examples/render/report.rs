//! The report of a run: which passes ran or did not, why, and what they cost.

use crate::notes;
use crate::options::Options;
use antumbra::audit::MeasuredError;
use antumbra::auto::Choice;
use antumbra::effects::{Outcome, Verdict};
use antumbra::graph::Run;
use antumbra::knob::Knob;
use antumbra::scene::{AreaLight, Scene};
use antumbra::{FramePlan, PassTime, ResourceBytes, Technique};
use antumbra_harness::{FrameTimes, HeadlessDevice};
use serde_json::{Map, Value, json};
use std::time::Duration;

/// The rounding of an allowed error in single precision, as a share of it.
const ROUNDING: f64 = 1e-4;

/// A light that is drawn, and what belongs to it alone.
pub struct Drawn<'a> {
    pub light: &'a AreaLight,
    /// The technique that ran, given or chosen.
    pub settings: &'a Technique,
    pub choice: Option<&'a Choice>,
    pub plan: &'a FramePlan,
    /// The times of the passes of each frame, by timestamps; empty where the device has none.
    pub times: Vec<Vec<PassTime>>,
    /// The error of all frames together; `None` without an audit.
    pub measured: Option<MeasuredError>,
}

/// Everything the report is made of.
pub struct Report<'a> {
    pub device: &'a HeadlessDevice,
    pub options: &'a Options,
    pub scene: &'a Scene,
    /// The lights in the order of their indices, at least one.
    pub lights: &'a [Drawn<'a>],
    pub frames: Vec<FrameTimes>,
    pub memory: Vec<ResourceBytes>,
    /// The error of all lights and frames together; `None` without an audit.
    pub measured: Option<MeasuredError>,
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}

fn settings_of(technique: &Technique) -> Map<String, Value> {
    let entry = |knob: Knob| {
        let value = technique.get(knob.key)?;
        // Numbers are numbers, names are strings.
        let value = serde_json::from_str::<Value>(&value).unwrap_or_else(|_| json!(value));
        Some((knob.key.to_string(), value))
    };
    technique.knobs().into_iter().filter_map(entry).collect()
}

/// A measured error for people.
fn measured(error: &MeasuredError) -> String {
    let [mean, low, high] = [error.mean, error.low, error.high].map(notes::percent);
    match error.pixels {
        0 => ", no shadow to measure an error in".into(),
        pixels => format!(", error {mean} measured ({low} to {high}, at {pixels} pixels)"),
    }
}

/// A measured error for programs.
fn error_of(e: &MeasuredError) -> Value {
    json!({ "mean": e.mean, "low": e.low, "high": e.high, "pixels": e.pixels })
}

impl Drawn<'_> {
    /// The median over the frames of a pass's milliseconds.
    fn pass_ms(&self, name: &str) -> Option<f64> {
        let passes = self.times.iter().flatten().filter(|p| p.name == name);
        let times: Vec<f64> = passes.map(|p| p.ms).collect();
        (!times.is_empty()).then(|| median(times))
    }

    /// The passes that run, each with its time and its reason.
    fn passes(&self) -> Vec<Value> {
        let plan = self.plan.plan();
        let row = |run: &Run| {
            let name = run.pass.name;
            let why = plan.graph.why(run.pass).to_string();
            json!({ "name": name, "ms": self.pass_ms(name), "times": run.times, "why": why })
        };
        plan.runs().iter().map(row).collect()
    }

    fn skipped(&self) -> Vec<Value> {
        self.plan.skipped().map(|(name, why)| json!({ "name": name, "why": why })).collect()
    }

    fn effects(&self) -> Vec<Value> {
        let verdicts = self.plan.verdicts();
        let row = |v: &Verdict| {
            let outcome = match v.outcome {
                Outcome::Simulated => "simulated",
                Outcome::LeftOut => "left out",
                Outcome::NotSimulated => "missing",
            };
            let (name, why) = (v.effect.rule().name, verdicts.why(v.effect));
            json!({ "name": name, "outcome": outcome, "bound": v.bound, "why": why.to_string() })
        };
        verdicts.all().iter().map(row).collect()
    }
}

impl Report<'_> {
    fn median_ms(&self, of: impl Fn(&FrameTimes) -> Duration) -> f64 {
        median(self.frames.iter().map(|f| of(f).as_secs_f64() * 1e3).collect())
    }

    /// Milliseconds of a frame of all lights, from the submit to the fence.
    pub fn frame_ms(&self) -> f64 {
        self.median_ms(|f| f.frame)
    }

    fn gpu_bytes(&self) -> u64 {
        self.memory.iter().map(|r| r.bytes).sum()
    }

    /// Whether the error promised for a light and the time measured for all are within the budget.
    fn met(&self, choice: &Choice) -> bool {
        let budget = self.options.auto.unwrap_or_default();
        let within = |most: Option<f64>, value: Option<f64>| {
            most.zip(value).is_none_or(|(most, value)| value <= most * (1.0 + ROUNDING))
        };
        within(notes::asked_error(&budget), choice.error)
            && within(budget.max_ms, Some(self.frame_ms()))
    }

    /// What belongs to a light alone.
    fn of_light(&self, drawn: &Drawn) -> Map<String, Value> {
        let auto = drawn.choice.map(|c| {
            json!({
                "error": c.error,
                "ms": c.ms,
                "measured_ms": self.frame_ms(),
                "alike": c.nearest,
                "max_error": self.options.auto.and_then(|b| b.max_error),
                "max_ms": self.options.auto.and_then(|b| b.max_ms),
                "met": self.met(c),
                "problem": c.problem,
                "left_out": c.left_out,
            })
        });
        let parts = [
            ("auto", json!(auto)),
            ("effects", drawn.effects().into()),
            ("technique", drawn.settings.name().into()),
            ("settings", settings_of(drawn.settings).into()),
            ("passes", drawn.passes().into()),
            ("skipped", drawn.skipped().into()),
        ];
        let measured = drawn.measured.as_ref().map(|e| ("measured_error", error_of(e)));
        parts.into_iter().chain(measured).map(|(key, value)| (key.to_string(), value)).collect()
    }

    /// The passes of all lights: the time and the number of those of one name together, with the reason of the first
    /// light that runs it.
    fn all_passes(&self) -> Vec<Value> {
        let mut all: Vec<Value> = Vec::new();
        for pass in self.lights.iter().flat_map(Drawn::passes) {
            match all.iter_mut().find(|p| p["name"] == pass["name"]) {
                Some(same) => {
                    let ms = same["ms"].as_f64().zip(pass["ms"].as_f64()).map(|(a, b)| a + b);
                    let times = same["times"].as_u64().zip(pass["times"].as_u64());
                    same["ms"] = json!(ms);
                    same["times"] = json!(times.map(|(a, b)| a + b));
                }
                None => all.push(pass),
            }
        }
        all
    }

    /// The passes that no light runs, with the reason of the first light.
    fn all_skipped(&self, passes: &[Value]) -> Vec<Value> {
        let mut all: Vec<Value> = Vec::new();
        for pass in self.lights.iter().flat_map(Drawn::skipped) {
            let known = |list: &[Value]| list.iter().any(|p| p["name"] == pass["name"]);
            if !known(passes) && !known(&all) {
                all.push(pass);
            }
        }
        all
    }

    /// The text of report.json. With several lights the technique, its settings, the choice and the effects are those of
    /// the first, passes are those of all, and `per_light` has what belongs to each.
    pub fn json(&self) -> String {
        let memory: Map<String, Value> =
            self.memory.iter().map(|r| (r.name.into(), json!(r.bytes))).collect();
        let mut report = self.of_light(&self.lights[0]);
        let passes = self.all_passes();
        let skipped = self.all_skipped(&passes);
        let more = [
            ("driver", self.device.name().into()),
            ("size", json!(self.options.size)),
            ("passes", passes.into()),
            ("skipped", skipped.into()),
            ("frame_ms", self.frame_ms().into()),
            ("record_us", (self.median_ms(|f| f.record) * 1e3).into()),
            ("gpu_bytes", self.gpu_bytes().into()),
            ("memory", memory.into()),
            ("triangles", self.scene.triangles().into()),
            ("lights", self.lights.len().into()),
            ("notes", json!(self.scene.notes)),
        ];
        report.extend(more.map(|(key, value)| (key.to_string(), value)));
        if let Some(error) = &self.measured {
            report.insert("measured_error".into(), error_of(error));
        }
        if self.lights.len() > 1 {
            let of = |drawn: &Drawn| {
                let mut row = self.of_light(drawn);
                row.insert("light".into(), drawn.light.name.clone().into());
                Value::from(row)
            };
            report.insert("per_light".into(), self.lights.iter().map(of).collect());
        }
        format!("{:#}\n", Value::from(report))
    }

    /// The techniques of all lights, each once.
    fn techniques(&self) -> String {
        let mut all: Vec<String> = Vec::new();
        for settings in self.lights.iter().map(|l| l.settings.to_string()) {
            if !all.contains(&settings) {
                all.push(settings);
            }
        }
        all.join(" and ")
    }

    /// A summary for people: the files to look at, and the times.
    pub fn summary(&self) -> String {
        let [width, height] = self.options.size;
        let frames = match self.frames.len() {
            1 => "one frame".into(),
            n => format!("median of {n} frames"),
        };
        let choices = || self.lights.iter().filter_map(|l| l.choice);
        let foretold: f64 = choices().filter_map(|c| c.ms).sum();
        let foretold =
            choices().any(|c| c.ms.is_some()).then(|| format!(", {foretold:.1} ms foretold"));
        let error = choices().filter_map(|c| c.error).reduce(f64::max);
        let promised = error.map(|e| format!(", error ≤ {} promised", notes::percent(e)));
        let lights = match self.lights.len() {
            1 => String::new(),
            n => format!(" under {n} lights"),
        };
        format!(
            "{}: {} triangles, {width}×{height} pixels{lights}, {}{}{}, {:.1} ms ({frames}{}) on {}, {:.1} MB",
            self.options.out.join("shaded.png").display(),
            self.scene.triangles(),
            self.techniques(),
            promised.unwrap_or_default(),
            self.measured.as_ref().map(measured).unwrap_or_default(),
            self.frame_ms(),
            foretold.unwrap_or_default(),
            self.device.name(),
            self.gpu_bytes() as f64 / 1e6,
        )
    }
}
