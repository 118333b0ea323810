//! The groups of a run, in the order in which they are measured.

use crate::Problem;
use crate::curtis;
use crate::groups::{Entry, Group, MATRIX};
use crate::options::Scale;
use crate::scenes::{self, SceneSpec, Source};
use crate::sweeps;
use crate::techniques::{CURVES, Curve, Step};
use antumbra::auto::{CANDIDATES, Candidate};

/// The study of what `auto` chooses among.
pub const CHOICES: &str = "choices";

/// The entries of error against time; the picture strip is of one light of each scene.
fn matrix_entries(scale: &Scale, in_strip: bool) -> Vec<Entry> {
    let step = |curve: &'static Curve, step: Step| Entry {
        shown: in_strip && step.shown,
        ..Entry::new(curve.technique, curve.label, step.words, step.x)
    };
    let measured = |s: &Step| s.in_quick || !scale.quick;
    let of = |curve: &'static Curve| {
        curve.steps().filter(measured).map(move |s| step(curve, s)).collect::<Vec<_>>()
    };
    CURVES.iter().flat_map(of).collect()
}

/// Every group of a run: first whether the measuring can be trusted, then what a reader looks at
/// first.
pub fn all(scale: &Scale, own: &[SceneSpec]) -> Vec<Group> {
    let mut groups = vec![sweeps::wrong(scale)];
    let matrix = |spec: &SceneSpec, light: &'static str| {
        let entries = matrix_entries(scale, light != "small" && light != "large");
        Group::seen(MATRIX, spec, light, scale.view, entries)
    };
    let standard = scenes::standard();
    groups.extend(standard.iter().map(|spec| matrix(spec, "medium")));
    groups.extend(
        own.iter()
            .flat_map(|spec| spec.lights().into_iter().map(move |l| (spec, l)))
            .map(|(spec, light)| matrix(spec, light)),
    );
    groups.extend(sweeps::all(scale));
    groups.extend(curtis::groups(scale));
    groups.push(sweeps::eisemann());
    for light in ["large", "small"] {
        groups.extend(standard.iter().map(|spec| matrix(spec, light)));
    }
    groups
}

/// The scenes that `auto` is made from beyond the report's: what touches, and what shadows itself.
const MORE_SCENES: [&str; 4] =
    ["spheres", "contact", "spheres on themselves", "suzanne on herself"];

/// The candidates by whose times in the table those of a technique that is measured alone are scaled.
pub const YARDSTICKS: [Candidate; 3] = [
    Candidate { technique: "pcss", words: "taps=32" },
    Candidate { technique: "occlusion-textures", words: "slices=16" },
    Candidate { technique: "ray-march", words: "rays=16" },
];

/// Everything that `auto` chooses among, in every view; with a technique to renew, only what it chooses among of that,
/// and [`YARDSTICKS`].
///
/// # Errors
/// A sentence for a technique that `auto` does not choose among.
pub fn choices(scale: &Scale, renew: Option<&str>) -> Result<Vec<Group>, Problem> {
    let known = |name: &str| CANDIDATES.iter().any(|c| c.technique == name);
    if let Some(name) = renew.filter(|name| !known(name)) {
        return Err(
            format!("--renew {name}: auto has no such technique among its candidates").into()
        );
    }
    let wanted =
        |c: &&Candidate| renew.is_none_or(|name| c.technique == name || YARDSTICKS.contains(c));
    let entry = |c: &Candidate| Entry::new(c.technique, c.technique, c.words.into(), 0.0);
    let more = MORE_SCENES.map(|name| SceneSpec { name: name.into(), source: Source::Made(name) });
    let scenes: Vec<_> = scenes::standard().into_iter().chain(more).collect();
    let lights = scenes::LIGHTS.iter().map(|l| l.0);
    let entries: Vec<_> = CANDIDATES.iter().filter(wanted).map(entry).collect();
    let of = |light| scenes.iter().map(move |spec| (spec, light));
    let group = |(spec, light)| Group::seen(CHOICES, spec, light, scale.view, entries.clone());
    Ok(lights.flat_map(of).map(group).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{FULL, QUICK};
    use std::collections::BTreeSet;

    #[test]
    fn keys_tell_groups_apart_and_the_quick_run_is_part_of_the_full_one() {
        let [quick, full] = [QUICK, FULL].map(|scale| all(&scale, &[]));
        let keys = |groups: &[Group]| groups.iter().map(Group::key).collect::<BTreeSet<_>>();
        assert_eq!(keys(&full).len(), full.len());
        assert_eq!(keys(&quick).len(), quick.len());
        assert!(quick.len() < full.len());
        for group in quick.iter().chain(&full) {
            assert!(!group.entries.is_empty(), "{}", group.key());
        }
    }

    #[test]
    fn every_scene_of_the_report_can_be_made() {
        for group in all(&QUICK, &[]) {
            let ready = group.ready().unwrap_or_else(|e| panic!("{}: {e}", group.key()));
            assert!(ready.scene.light(None).is_ok());
            assert!(ready.view.clip_from_world.is_finite());
        }
    }
}
