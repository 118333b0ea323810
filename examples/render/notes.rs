//! Notes on a run that goes well: facts that the picture may not show.

use crate::options::Options;
use crate::report::Drawn;
use antumbra::FramePlan;
use antumbra::auto::{Budget, Choice};
use antumbra::effects::{Effect, Outcome};
use antumbra::scene::{AreaLight, Scene};

/// One line each, for standard error.
pub fn of(options: &Options, scene: &Scene, lights: &[Drawn]) -> Vec<String> {
    let mut notes = scene.notes.clone();
    notes.extend(unpromised(options));
    for drawn in lights {
        let Drawn { light, choice, plan, .. } = *drawn;
        let left_out = choice.and_then(|c| c.left_out.as_ref());
        // One line does for all lights of which it says the same.
        let of = |note: String| match lights.len() {
            1 => note,
            _ => format!("{note} (the light {})", light.name),
        };
        notes.extend(unmet(options, choice).map(of));
        let left_out = left_out.map(|why| format!("auto: {why}"));
        notes.extend(left_out.filter(|note| !notes.contains(note)));
        notes.extend(unshadowed(light, plan));
    }
    notes.extend(namesakes(options, scene));
    notes
}

/// A fraction in percent, to three digits.
pub fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    let digits = (2.0 - percent.abs().log10().floor()).clamp(0.0, 12.0) as i32;
    let scale = 10f64.powi(digits);
    format!("{} %", (percent * scale).round() / scale)
}

/// A note that the frames took longer than the budget allows, unless a choice has said so already.
pub fn too_slow(options: &Options, lights: &[Drawn], measured_ms: f64) -> Option<String> {
    let most = options.auto?.max_ms?;
    let known = lights.iter().any(|l| l.choice.is_some_and(|c| c.problem.is_some()));
    (measured_ms > most && !known)
        .then(|| format!("auto: {measured_ms:.1} ms were measured, and {most} ms asked for"))
}

/// The error that a budget allows; `None` where it wants the least error that its time allows.
pub fn asked_error(budget: &Budget) -> Option<f64> {
    budget.max_error.or(budget.max_ms.is_none().then_some(Budget::DEFAULT_ERROR))
}

/// A note on a budget that cannot be met.
fn unmet(options: &Options, choice: Option<&Choice>) -> Option<String> {
    let (budget, choice) = (options.auto?, choice?);
    let problem = choice.problem.as_ref()?;
    let line = match (asked_error(&budget), choice.error) {
        (Some(asked), Some(error)) if budget.max_ms.is_none() && error > asked => {
            let default = if budget.max_error.is_none() { " (the default)" } else { "" };
            format!(
                "an error of {} was asked for{default}; the best promise here is {}, by {}",
                percent(asked),
                percent(error),
                choice.technique
            )
        }
        _ => problem.clone(),
    };
    Some(format!("auto: {line}"))
}

/// That an error is no promise where a technique is named.
fn unpromised(options: &Options) -> Option<String> {
    let error = percent(options.max_error?);
    let technique = options.settings.name();
    Some(format!(
        "--max-error: {technique} was named, so nothing is chosen or promised; effects of up to {error} are left out"
    ))
}

/// Lights that the first of their name hides.
fn namesakes(options: &Options, scene: &Scene) -> Option<String> {
    let name = options.light.as_ref()?;
    let number = scene.lights.iter().filter(|l| l.name == *name).count();
    (number > 1).then(|| format!("{number} lights are named {name}; the first of them is used"))
}

/// That nothing can be shadowed, which looks like a picture without a light.
fn unshadowed(light: &AreaLight, plan: &FramePlan) -> Option<String> {
    let shadow = plan.verdicts().of(Effect::Shadow).outcome;
    let [x, y, z] = light.light.emission().to_array().map(|c| (c * 100.0).round() / 100.0 + 0.0);
    let whither = if light.light.is_round() {
        "to all sides".into()
    } else {
        format!("along its node's -Z, here towards ({x}, {y}, {z})")
    };
    (shadow == Outcome::LeftOut).then(|| {
        format!(
            "nothing is shadowed: no occluder lies between the light {} and a receiver; it shines {whither}",
            light.name
        )
    })
}
