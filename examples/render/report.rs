//! The report of a run: which passes ran or did not, why, and what they cost.

use crate::notes;
use crate::options::Options;
use antumbra::audit::MeasuredError;
use antumbra::auto::Choice;
use antumbra::effects::Outcome;
use antumbra::knob::Knob;
use antumbra::scene::Scene;
use antumbra::{FramePlan, ResourceBytes, Technique};
use antumbra_harness::{FrameTimes, HeadlessDevice};
use serde_json::{Map, Value, json};
use std::time::Duration;

/// The rounding of an allowed error in single precision, as a share of it.
const ROUNDING: f64 = 1e-4;

/// Everything the report is made of.
pub struct Report<'a> {
    pub device: &'a HeadlessDevice,
    pub options: &'a Options,
    /// The technique that ran, given or chosen.
    pub settings: &'a Technique,
    pub choice: Option<&'a Choice>,
    pub scene: &'a Scene,
    pub plan: &'a FramePlan,
    pub frames: Vec<FrameTimes>,
    pub memory: Vec<ResourceBytes>,
    /// The error of all frames together; `None` without an audit.
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

impl Report<'_> {
    fn median_ms(&self, of: impl Fn(&FrameTimes) -> Duration) -> f64 {
        median(self.frames.iter().map(|f| of(f).as_secs_f64() * 1e3).collect())
    }

    /// Milliseconds of a frame, from the submit to the fence.
    pub fn frame_ms(&self) -> f64 {
        self.median_ms(|f| f.frame)
    }

    fn pass_ms(&self, name: &str) -> Option<f64> {
        let times: Vec<f64> = self
            .frames
            .iter()
            .flat_map(|f| f.passes.iter().filter(|p| p.0 == name).map(|p| p.1))
            .collect();
        (!times.is_empty()).then(|| median(times))
    }

    fn gpu_bytes(&self) -> u64 {
        self.memory.iter().map(|r| r.bytes).sum()
    }

    /// Whether the error promised and the time measured are within the budget.
    fn met(&self, choice: &Choice) -> bool {
        let budget = self.options.auto.unwrap_or_default();
        let within = |most: Option<f64>, value: Option<f64>| {
            most.zip(value).is_none_or(|(most, value)| value <= most * (1.0 + ROUNDING))
        };
        within(notes::asked_error(&budget), choice.error)
            && within(budget.max_ms, Some(self.frame_ms()))
    }

    /// The text of report.json.
    pub fn json(&self) -> String {
        let graph = &self.plan.plan().graph;
        let passes: Vec<_> = self
            .plan
            .plan()
            .runs()
            .iter()
            .map(|run| {
                let name = run.pass.name;
                let why = graph.why(run.pass);
                json!({ "name": name, "ms": self.pass_ms(name), "times": run.times, "why": why.to_string() })
            })
            .collect();
        let skipped = self.plan.skipped();
        let skipped: Vec<_> =
            skipped.map(|(name, why)| json!({ "name": name, "why": why })).collect();
        let memory: Map<String, Value> =
            self.memory.iter().map(|r| (r.name.into(), json!(r.bytes))).collect();
        let verdicts = self.plan.verdicts();
        let effects: Vec<_> = verdicts
            .all()
            .iter()
            .map(|v| {
                let outcome = match v.outcome {
                    Outcome::Simulated => "simulated",
                    Outcome::LeftOut => "left out",
                    Outcome::NotSimulated => "missing",
                };
                let (name, why) = (v.effect.rule().name, verdicts.why(v.effect));
                json!({ "name": name, "outcome": outcome, "bound": v.bound, "why": why.to_string() })
            })
            .collect();
        let model = self.choice.map(|c| {
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
        let mut report = json!({
            "driver": self.device.name(),
            "auto": model,
            "effects": effects,
            "technique": self.settings.name(),
            "settings": settings_of(self.settings),
            "size": self.options.size,
            "passes": passes,
            "skipped": skipped,
            "frame_ms": self.frame_ms(),
            "record_us": self.median_ms(|f| f.record) * 1e3,
            "gpu_bytes": self.gpu_bytes(),
            "memory": memory,
            "triangles": self.scene.triangles(),
            "lights": self.scene.lights.len(),
        });
        if let (Some(e), Some(report)) = (&self.measured, report.as_object_mut()) {
            let error = json!({ "mean": e.mean, "low": e.low, "high": e.high, "pixels": e.pixels });
            report.insert("measured_error".into(), error);
        }
        format!("{report:#}\n")
    }

    /// A summary for people: the files to look at, and the times.
    pub fn summary(&self) -> String {
        let [width, height] = self.options.size;
        let frames = match self.frames.len() {
            1 => "one frame".into(),
            n => format!("median of {n} frames"),
        };
        let foretold = self.choice.and_then(|c| c.ms).map(|ms| format!(", {ms:.1} ms foretold"));
        let error = self.choice.and_then(|c| c.error);
        let promised = error.map(|e| format!(", error ≤ {} promised", notes::percent(e)));
        format!(
            "{}: {} triangles, {width}×{height} pixels, {}{}{}, {:.1} ms ({frames}{}) on {}, {:.1} MB",
            self.options.out.join("shaded.png").display(),
            self.scene.triangles(),
            self.settings,
            promised.unwrap_or_default(),
            self.measured.as_ref().map(measured).unwrap_or_default(),
            self.frame_ms(),
            foretold.unwrap_or_default(),
            self.device.name(),
            self.gpu_bytes() as f64 / 1e6,
        )
    }
}
