//! A whole run: what is left to measure, in order, and the report of what is there.

use crate::Problem;
use crate::choices;
use crate::commit::commit;
use crate::envelope;
use crate::groups::Group;
use crate::hard_cases::store;
use crate::measure::Bench;
use crate::options::{FULL, Options, QUICK};
use crate::progress::Progress;
use crate::report::docs::{ENVELOPE, HARD_CASES, HEADLINE};
use crate::report::{self, Report};
use crate::scenes::{self, SceneSpec, Source};
use crate::store::{Header, Outcome, Row, Store};
use crate::studies;
use antumbra_harness::{HeadlessDevice, HeadlessOptions};
use fnv::FnvHasher;
use indicatif::HumanDuration;
use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What the quick run may take, less what the report takes to write.
const QUICK_BUDGET: Duration = Duration::from_secs(270);

/// Measures and reports; whether every row is good.
pub fn run(options: &Options) -> Result<bool, Problem> {
    if options.write_docs {
        let page = match (options.hard_cases, options.envelope) {
            (true, _) => &HARD_CASES,
            (_, true) => &ENVELOPE,
            _ => &HEADLINE,
        };
        let path = report::docs::copy(page, &options.out, &Options::root())?;
        println!("{}", path.display());
        return Ok(true);
    }
    let Options { hard_cases: cases, envelope, exam, write_choices, .. } = *options;
    match (cases, envelope, exam, write_choices) {
        (true, ..) => return hard_cases(options),
        (_, true, ..) => return envelope::run(options),
        (_, _, true, _) => return choices::exam(options).map(|()| true),
        (.., true) => return choices::write(options).map(|()| true),
        _ => {}
    }
    let measured = options.out.join("measured.jsonl");
    if options.report {
        let (header, rows) = Store::read(&measured)?;
        let cache = kept(&options.out, &header)?;
        let (rows, hard_cases) = (&rows, &store::read(&options.out)?);
        let report = Report { header: &header, rows, left_out: &[], cache: &cache, hard_cases };
        return finish(&report, options);
    }
    let scale = match (options.choices, options.quick) {
        (true, _) => options.choice(),
        (_, true) => QUICK,
        _ => FULL,
    };
    let own = options.scenes.as_deref().map(scenes::own).transpose()?.unwrap_or_default();
    let mut groups = match options.choices {
        true => studies::choices(&scale, options.renew.as_deref())?,
        false => studies::all(&scale, &own),
    };
    if let Some(text) = &options.only {
        groups = only(groups, text)?;
    }
    let device = HeadlessDevice::new(&HeadlessOptions::default())?;
    let header = Header {
        command: options.command(),
        commit: commit(),
        driver: device.name().into(),
        quick: scale.quick,
        extent: scale.view,
        truth_rays: scale.rays,
        scenes: own.iter().map(dated).collect(),
    };
    let cache = kept(&options.out, &header)?;
    let mut store = Store::open(&measured, &header)?;
    let [width, height] = scale.view;
    println!("{}: {width}×{height} pixels, commit {}", header.driver, header.commit);
    let started = Instant::now();
    let left_out = measure(&Bench { device: &device, scale, cache: &cache }, &groups, &mut store)?;
    let keys: Vec<String> = groups.iter().map(Group::key).collect();
    let rows = store.rows(keys.iter().map(String::as_str));
    println!("{} rows in {}", rows.len(), HumanDuration(started.elapsed()));
    // The quick run has no time for them, and shows those of a longer one.
    let mut held = true;
    if !scale.quick && !options.choices && options.only.is_none() {
        held = store::measure(&device, &options.out)?;
    }
    let hard_cases = &store::read(&options.out)?;
    let report =
        Report { header: &header, rows: &rows, left_out: &left_out, cache: &cache, hard_cases };
    Ok(finish(&report, options)? && held)
}

/// The groups whose name holds a text.
fn only(groups: Vec<Group>, text: &str) -> Result<Vec<Group>, Problem> {
    let names = |of: fn(&Group) -> &str| report::once(groups.iter().map(of)).join(", ");
    let problem = format!(
        "--only {text}: no group's name holds it; a name is \"STUDY: SCENE, LIGHT light\", of the studies {}, the \
         scenes {} and the lights {}",
        names(|g| g.study),
        names(|g| &g.scene),
        names(|g| &g.light)
    );
    let kept: Vec<_> = groups.into_iter().filter(|g| g.key().contains(text)).collect();
    if kept.is_empty() { Err(problem.into()) } else { Ok(kept) }
}

/// Measures the table of hard cases; whether nothing is broken.
fn hard_cases(options: &Options) -> Result<bool, Problem> {
    std::fs::create_dir_all(&options.out).map_err(Problem::of(options.out.display()))?;
    let device = HeadlessDevice::new(&HeadlessOptions::default())?;
    store::measure(&device, &options.out)
}

/// Writes the report and tells where it is and what failed; whether nothing did.
fn finish(report: &Report, options: &Options) -> Result<bool, Problem> {
    report::write(report, &options.out)?;
    println!("Look at {}", options.out.join("index.html").display());
    let mut good = true;
    for row in report.rows {
        if let Outcome::Failed(why) = &row.outcome {
            let Row { scene, light, technique, settings, .. } = row;
            println!("failed: {scene}, {light} light, {technique} {settings}: {why}");
            good = false;
        }
    }
    Ok(good)
}

/// Measures every group that is not there, and names those that the quick run has no time for.
fn measure(bench: &Bench, groups: &[Group], store: &mut Store) -> Result<Vec<String>, Problem> {
    let missing: Vec<&Group> = groups.iter().filter(|g| !store.has(&g.key())).collect();
    let progress = Progress::new(missing.iter().map(|g| g.entries.len()).sum());
    progress.say(&format!(
        "{} of {} groups are to be measured; a run that is stopped goes on where it was",
        missing.len(),
        groups.len()
    ));
    let mut left_out = Vec::new();
    for group in missing {
        let (key, count) = (group.key(), group.entries.len());
        if bench.scale.quick && progress.elapsed() + progress.expected(count) > QUICK_BUDGET {
            progress.say(&format!("left out, for the time is up: {key}"));
            left_out.push(key);
            continue;
        }
        let started = Instant::now();
        let rows = bench.measure(group, &|what| progress.doing(&format!("{key}: {what}")));
        let took = started.elapsed();
        store.add(&key, rows, took.as_secs_f64())?;
        progress.done(&key, count, took);
    }
    progress.finish();
    Ok(left_out)
}

/// The folder of the pictures that belong to this run; those of other runs are removed.
fn kept(out: &Path, header: &Header) -> Result<PathBuf, Problem> {
    let mut hash = FnvHasher::default();
    format!("{header:?}").bytes().for_each(|b| hash.write_u64(u64::from(b)));
    let all = out.join("cache");
    let own = all.join(format!("{:016x}", hash.finish()));
    std::fs::create_dir_all(&own).map_err(Problem::of(format!("--out {}", out.display())))?;
    let others = std::fs::read_dir(&all).into_iter().flatten().flatten().map(|e| e.path());
    for other in others.filter(|path| *path != own && path.is_dir()) {
        // What cannot be removed only takes room.
        let _ = std::fs::remove_dir_all(other);
    }
    Ok(own)
}

/// A scene's file with its size and date, so that a run with another one is another run.
fn dated(spec: &SceneSpec) -> String {
    let Source::File(path) = &spec.source else { return spec.name.clone() };
    let date = std::fs::metadata(path).and_then(|m| Ok((m.len(), m.modified()?)));
    format!("{} {:?}", path.display(), date.ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_named_is_measured_and_a_name_of_nothing_is_refused_with_those_there_are() {
        let groups = studies::all(&QUICK, &[]);
        let bunnies = only(groups.clone(), "bunny").unwrap();
        assert!(!bunnies.is_empty() && bunnies.len() < groups.len());
        let Problem(problem) = only(groups, "rooom").unwrap_err();
        assert!(problem.starts_with("--only rooom: no group's name holds it"), "{problem}");
        for name in ["light size", "matrix", "bunny", "medium"] {
            assert!(problem.contains(name), "{name}: {problem}");
        }
    }
}
