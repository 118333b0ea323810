//! The groups of a run, in the order in which they are measured.

use crate::Problem;
use crate::curtis;
use crate::groups::{Entry, Group, MATRIX};
use crate::options::Scale;
use crate::places::{ROOM, STREET, SUN};
use crate::scenes::{self, Lit, SceneSpec, Source};
use crate::stability;
use crate::sweeps;
use crate::techniques::{self, CURVES, Curve, Step};
use crate::views;
use antumbra::auto::{CANDIDATES, Candidate};

/// The study of what `auto` chooses among.
pub const CHOICES: &str = "choices";

/// Of curves the steps that `measured` accepts; the picture strip is of one light of each scene.
fn entries_of(
    curves: impl Iterator<Item = &'static Curve>,
    in_strip: bool,
    measured: impl Fn(&Step) -> bool,
) -> Vec<Entry> {
    let mut entries = Vec::new();
    for curve in curves {
        for step in curve.steps().filter(&measured) {
            let shown = in_strip && step.shown;
            let entry = Entry::new(curve.technique, curve.label, step.words, step.x);
            entries.push(Entry { shown, ..entry });
        }
    }
    entries
}

/// The entries of error against time.
fn matrix_entries(scale: &Scale, in_strip: bool) -> Vec<Entry> {
    entries_of(CURVES.iter(), in_strip, |s| s.in_quick || !scale.quick)
}

/// The scenes with lights of their own that the quick run has, and the light of each.
const QUICK_WHOLE: [(&str, &str); 3] = [(ROOM, "ceiling panel"), (STREET, SUN), ("hall", "light6")];

/// Error against time in a scene with lights of its own: a group a light, each of fewer settings than elsewhere.
fn of_whole<'a>(scale: &'a Scale, spec: &'a SceneSpec) -> impl Iterator<Item = Group> + 'a {
    let light = |(nth, light): (usize, Lit)| {
        let measured = |s: &Step| if scale.quick { s.shown } else { s.in_quick };
        // The strip has one light of a scene.
        let in_strip = nth == 0 || QUICK_WHOLE.contains(&(&spec.name, &light.name)) && scale.quick;
        let entries = entries_of(techniques::of_whole(light.is_sun), in_strip, measured);
        Group::seen(MATRIX, spec, &light.name, scale.view, entries)
    };
    spec.lights().into_iter().enumerate().map(light)
}

/// Every group of a run: first whether the measuring can be trusted, then what a reader looks at
/// first.
pub fn all(scale: &Scale, own: &[SceneSpec]) -> Vec<Group> {
    let mut groups = vec![sweeps::wrong(scale)];
    let matrix = |spec: &SceneSpec, light: &str| {
        let entries = matrix_entries(scale, light != "small" && light != "large");
        Group::seen(MATRIX, spec, light, scale.view, entries)
    };
    groups.extend(own.iter().flat_map(|spec| own_groups(scale, spec)));
    let in_run =
        |g: &Group| !scale.quick || QUICK_WHOLE.contains(&(g.scene.as_str(), g.light.as_str()));
    let whole = scenes::whole();
    let mut whole: Vec<_> = whole.iter().flat_map(|spec| of_whole(scale, spec)).collect();
    whole.retain(in_run);
    whole.extend(views::all(scale).into_iter().chain(stability::all(scale)));
    let standard = scenes::standard();
    let standard_groups = standard.iter().map(|spec| matrix(spec, "medium")).collect();
    // On a busy machine the quick run ends early, and no kind of scene should be missing from it.
    let in_order = if scale.quick { [whole, standard_groups] } else { [standard_groups, whole] };
    groups.extend(in_order.into_iter().flatten());
    groups.extend(sweeps::all(scale));
    groups.extend(curtis::groups(scale));
    groups.push(sweeps::eisemann());
    for light in ["large", "small"] {
        groups.extend(standard.iter().map(|spec| matrix(spec, light)));
    }
    groups
}

/// Anyone's scene: everything under a light that it has alone, and a group a light where it has several.
fn own_groups(scale: &Scale, spec: &SceneSpec) -> Vec<Group> {
    match &spec.lights()[..] {
        [light] if !light.is_sun => {
            let entries = matrix_entries(scale, true);
            vec![Group::seen(MATRIX, spec, &light.name, scale.view, entries)]
        }
        _ => of_whole(scale, spec).collect(),
    }
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
