//! What was measured, for readers and for programs.

use super::{
    AXES, Axis, CENTRE, Envelope, FACTOR, FLOOR, Place, Row, SCENES, Status, Step, TECHNIQUES,
};
use crate::Problem;
use crate::report::csv_of;
use serde_json::json;

/// The rows, and what made them.
pub struct Made {
    pub commit: String,
    pub driver: String,
    pub rows: Vec<Row>,
}

impl Made {
    fn steps(&self, scene: &str, axis: &Axis, technique: &str) -> Vec<Step> {
        let own = |r: &&Row| r.scene == scene && r.axis == axis.name && r.technique == technique;
        // What was not measured is within nothing.
        let step = |r: &Row| Step { at: r.at, error: r.mean_abs_error.unwrap_or(f64::NAN) };
        self.rows.iter().filter(own).map(step).collect()
    }

    fn envelope(&self, scene: &str, axis: &Axis, technique: &str) -> Option<Envelope> {
        Envelope::around(axis.centre()?, &self.steps(scene, axis, technique))
    }

    /// The tables.
    pub fn markdown(&self) -> String {
        let Self { commit, driver, .. } = self;
        let Place { light, gap, map, pixels, .. } = CENTRE;
        let mut text = format!(
            "Made by `cargo bench --bench accuracy_cost -- --envelope`, commit {commit}, {driver}. The centre: a light of \
             {light} object sizes, {gap} from the ground, the object halfway; maps of {map}², {pixels}² pixels. Within \
             is what is at most {FACTOR} times the error at the centre, or {} where that is more.\n",
            percent(FACTOR * FLOOR),
        );
        text.push_str("\n### At the centre\n\nMean error, and the most that is within.\n\n");
        text.push_str(&head(&SCENES.map(String::from)));
        for technique in TECHNIQUES {
            let cells = SCENES.map(|scene| {
                let found = self.envelope(scene, &AXES[0], technique);
                let errors = found.map(|e| [e.centre, e.bound].map(percent).join(", "));
                errors.unwrap_or("failed".into())
            });
            text.push_str(&row(technique, &cells));
        }
        for axis in &AXES {
            let Axis { name, unit, steps, .. } = axis;
            let [first, last] = [steps[0], steps[steps.len() - 1]];
            text.push_str(&format!(
                "
### {name}

{}, {} steps from {first} to {last}.

",
                capital(unit),
                steps.len()
            ));
            text.push_str(&head(&SCENES.map(|scene| [scene.into(), "next to it".into()]).concat()));
            for technique in TECHNIQUES {
                let cells = SCENES.map(|scene| match self.envelope(scene, axis, technique) {
                    Some(found) => [within(&found), beyond(&found)],
                    None => ["none".into(), String::new()],
                });
                text.push_str(&row(technique, &cells.concat()));
            }
        }
        text
    }

    /// Every error.
    pub fn csv(&self) -> Result<String, Problem> {
        let names =
            "scene axis at technique mean_abs_error pixels penumbra_pixels darkest pixel_m status";
        let head = names.split(' ').map(String::from).collect();
        let line = |r: &Row| {
            let status = match r.status {
                Status::Measured => "measured",
                Status::Refused(_) => "refused",
                Status::Failed(_) => "failed",
            };
            let error = r.mean_abs_error.map_or_else(String::new, |e| e.to_string());
            let [at, darkest, pixel] = [r.at, r.darkest, r.pixel_m].map(|v| v.to_string());
            let [pixels, penumbra] = [r.pixels, r.penumbra_pixels].map(|v| v.to_string());
            let [scene, axis, technique] = [r.scene, r.axis, r.technique].map(String::from);
            vec![scene, axis, at, technique, error, pixels, penumbra, darkest, pixel, status.into()]
        };
        csv_of(std::iter::once(head).chain(self.rows.iter().map(line)))
    }

    /// Every error, and every envelope.
    pub fn json(&self) -> Result<String, Problem> {
        let mut envelopes = Vec::new();
        for axis in &AXES {
            for scene in SCENES {
                for technique in TECHNIQUES {
                    let Some(found) = self.envelope(scene, axis, technique) else { continue };
                    let next =
                        found.beyond.map(|b| b.map(|s| json!({"at": s.at, "error": s.error})));
                    envelopes.push(json!({
                        "axis": axis.name, "scene": scene, "technique": technique,
                        "centre_error": found.centre, "bound": found.bound,
                        "from": found.range[0], "to": found.range[1],
                        "before": next[0], "after": next[1],
                    }));
                }
            }
        }
        let whole = json!({
            "commit": self.commit, "driver": self.driver, "rows": self.rows, "envelopes": envelopes,
        });
        serde_json::to_string_pretty(&whole).map_err(Problem::of("envelope.json"))
    }
}

/// A table's head, its first column the technique.
fn head(columns: &[String]) -> String {
    format!("| technique | {} |\n|---|{}\n", columns.join(" | "), "---|".repeat(columns.len()))
}

fn row(technique: &str, cells: &[String]) -> String {
    format!("| `{technique}` | {} |\n", cells.join(" | "))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

fn percent(error: f64) -> String {
    match 100.0 * error {
        p if p >= 9.95 => format!("{p:.0} %"),
        p if p >= 0.995 => format!("{p:.1} %"),
        p => format!("{p:.2} %"),
    }
}

fn within(found: &Envelope) -> String {
    let [from, to] = found.range;
    match found.beyond {
        [None, None] => "all".into(),
        _ if from == to => format!("{from} alone"),
        // Which end is the sweep's, and not the technique's.
        [None, _] => format!("{from} (first) to {to}"),
        [_, None] => format!("{from} to {to} (last)"),
        _ => format!("{from} to {to}"),
    }
}

/// The errors of the steps next to the range.
fn beyond(found: &Envelope) -> String {
    let step = |s: Step| match s.error.is_finite() {
        true => format!("{}: {}", s.at, percent(s.error)),
        false => format!("{}: not measured", s.at),
    };
    let all: Vec<String> = found.beyond.into_iter().flatten().map(step).collect();
    all.join(", ")
}
