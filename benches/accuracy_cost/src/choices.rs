//! The table that `auto` chooses by: what every candidate did in every view, as text for the crate.

use crate::Problem;
use crate::groups::Group;
use crate::options::Options;
use crate::report::csv_of;
use crate::stats::{median, quantile};
use crate::store::{Row, Store, Times};
use crate::studies::{self, YARDSTICKS};
use antumbra::Technique;
use antumbra::auto::{
    Auto, Budget, CANDIDATES, COLUMNS, Candidate, Costs, Features, Measured, PROBE,
};
use antumbra::effects::Situation;
use antumbra::scene::Instance;
use antumbra_harness::{HeadlessDevice, HeadlessOptions, Stage, probe, technique};

/// Passes in light space, by what their names begin with; all others run at the pixels.
const MAPS: [&str; 14] = [
    "hierarchy.",
    "depth_layers.",
    "soft_shadow_map.blocks",
    "soft_shadow_map.superblocks",
    "ray_march.columns",
    "ray_march.level",
    "occlusion_textures.place",
    "occlusion_textures.histogram",
    "occlusion_textures.mask",
    "occlusion_textures.squares",
    "occlusion_textures.sum_",
    "occlusion_textures.front_slices",
    "occlusion_textures.back_slices",
    "many_lights.point_depth",
];

/// A view that a run of `--choices` has measured.
struct View {
    group: Group,
    situation: Situation,
    rows: Vec<Row>,
}

/// The views that a run of `--choices` in --out has measured.
fn views(options: &Options, device: &HeadlessDevice) -> Result<Vec<View>, Problem> {
    let (_, all) = Store::read(&options.out.join("measured.jsonl"))?;
    let mut views = Vec::new();
    for group in studies::choices(&options.choice(), options.renew.as_deref())? {
        let own = |r: &&Row| r.scene == group.scene && r.light == group.light;
        let rows: Vec<Row> = all.iter().filter(own).cloned().collect();
        if !rows.is_empty() {
            views.push(View { situation: situation(device, &group)?, group, rows });
        }
    }
    Ok(views)
}

/// The milliseconds of a row's passes in light space, or of those at the pixels.
fn passes_ms(times: &Times, maps: bool) -> f64 {
    let is_map = |name: &str| MAPS.iter().any(|m| name.starts_with(m));
    times.passes.iter().filter(|(n, _)| is_map(n) == maps).map(|(_, ms)| ms).sum()
}

/// The table's line of a measured row, its times multiplied by `factor`.
fn line(situation: &Situation, row: &Row, factor: f64) -> Option<Vec<String>> {
    let (errors, times) = row.measured()?;
    let mut line = vec![row.scene.clone(), row.light.clone(), situation.triangles.to_string()];
    line.extend(Features::of(situation).values().map(|p| format!("{p:.3}")));
    line.extend([row.technique.clone(), row.settings.clone()]);
    line.extend([errors.summary.mean_abs_error, errors.noise_floor].map(|e| format!("{e:.5}")));
    line.extend([true, false].map(|maps| format!("{:.3}", factor * passes_ms(times, maps))));
    Some(line)
}

/// Writes what a run of `--choices` has measured as the crate's table, or into it where one technique is renewed.
///
/// # Errors
/// A sentence where the run or the table's file cannot be read or written.
pub fn write(options: &Options) -> Result<(), Problem> {
    let device = HeadlessDevice::new(&HeadlessOptions::default())?;
    let views = views(options, &device)?;
    let groups = studies::choices(&options.choice(), options.renew.as_deref())?.len();
    if views.len() < groups {
        return Err(format!(
            "{} of {groups} views are measured; go on with --choices",
            views.len()
        )
        .into());
    }
    let path = Options::root().join("src/auto/table.csv");
    let lines = match &options.renew {
        None => all_lines(&device, &views)?,
        Some(technique) => {
            let old = std::fs::read_to_string(&path).map_err(Problem::of(path.display()))?;
            renewed(&old, technique, &views)?
        }
    };
    std::fs::write(&path, csv_of(lines)?).map_err(Problem::of(path.display()))?;
    println!("{}", path.display());
    Ok(())
}

/// The lines of a table of everything that was measured.
fn all_lines(device: &HeadlessDevice, views: &[View]) -> Result<Vec<Vec<String>>, Problem> {
    let Measured { maps_ms, pixels_ms, .. } = probe(device)?;
    let mut lines = vec![
        COLUMNS.split(',').map(String::from).collect(),
        vec![PROBE.into(), format!("{maps_ms:.3}"), format!("{pixels_ms:.3}")],
    ];
    let of = |view: &View| -> Vec<_> {
        view.rows.iter().filter_map(|row| line(&view.situation, row, 1.0)).collect()
    };
    lines.extend(views.iter().flat_map(of));
    Ok(lines)
}

/// A line of the table.
type Cells = Vec<String>;

fn is(candidate: &Candidate, technique: &str, settings: &str) -> bool {
    candidate.technique == technique && candidate.words == settings
}

/// The lines of a table in which one technique's are replaced, their times brought to those of the table by
/// [`slower`].
fn renewed(old: &str, technique: &str, views: &[View]) -> Result<Vec<Cells>, Problem> {
    let old: Vec<Cells> = old.lines().map(|l| l.split(',').map(String::from).collect()).collect();
    let mut lines: Vec<_> = old.iter().take(2).cloned().collect();
    for View { group, situation, rows } in views {
        let own = |cells: &&Cells| cells[0] == group.scene && cells[1] == group.light;
        let mut view: Vec<_> = old.iter().skip(2).filter(own).cloned().collect();
        let slower = slower(&view, rows)
            .ok_or_else(|| format!("{}: the table or the run lacks a yardstick", group.key()))?;
        println!("{}: {slower:.2} times the table's", group.key());
        view.retain(|cells| cells[10] != technique);
        let new = rows.iter().filter(|row| row.technique == technique);
        view.extend(new.filter_map(|row| line(situation, row, 1.0 / slower)));
        view.sort_by_key(|c| CANDIDATES.iter().position(|known| is(known, &c[10], &c[11])));
        lines.extend(view);
    }
    if lines.len() != 2 + views.len() * CANDIDATES.len() {
        return Err("a candidate is missing in a view; the table stays as it was".into());
    }
    Ok(lines)
}

/// How many times as long as in the table's lines of a view the rows of a run took: the median over [`YARDSTICKS`],
/// which ran in turns with the others. A machine's load differs from view to view, and so does this.
fn slower(view: &[Cells], rows: &[Row]) -> Option<f64> {
    let ratio = |yardstick: &Candidate| {
        let cells = view.iter().find(|cells| is(yardstick, &cells[10], &cells[11]))?;
        let [maps, pixels] = [14, 15].map(|i| cells.get(i)?.parse::<f64>().ok());
        let row = rows.iter().find(|row| is(yardstick, &row.technique, &row.settings))?;
        let (_, times) = row.measured()?;
        Some((passes_ms(times, true) + passes_ms(times, false)) / (maps? + pixels?))
    };
    let ratios: Vec<f64> = YARDSTICKS.iter().map(ratio).collect::<Option<_>>()?;
    Some(median(&ratios))
}

/// The errors of [`exam`]'s budgets.
const GOALS: [f64; 4] = [0.05, 0.03, 0.02, 0.01];

/// How the crate's present table would have chosen in the views that were measured now: how often the error that was
/// promised is kept, and the time of the choice over that of the fastest that is good enough.
///
/// # Errors
/// A sentence where the run cannot be read.
pub fn exam(options: &Options) -> Result<(), Problem> {
    let device = HeadlessDevice::new(&HeadlessOptions::default())?;
    let views = views(options, &device)?;
    println!(
        "| asked | promised in | kept | rightly not promised | time over the best: median, 90 % |"
    );
    println!("|---|---|---|---|---|");
    for goal in GOALS {
        let (mut promised, mut kept, mut right) = (0, 0, 0);
        let mut ratios = Vec::new();
        for View { group, situation, rows } in &views {
            let of = |settings: &Technique| {
                let same = |r: &&Row| {
                    CANDIDATES.iter().any(|c| {
                        c.technique == r.technique
                            && c.words == r.settings
                            && c.settings() == *settings
                    })
                };
                let (errors, times) = rows.iter().find(same)?.measured()?;
                let error = (errors.summary.mean_abs_error - errors.noise_floor).max(0.0);
                Some((error, times.passes.iter().map(|(_, ms)| ms).sum::<f64>()))
            };
            let all = CANDIDATES.iter().filter_map(|c| of(&c.settings()));
            let best = all.filter(|x| x.0 <= goal).map(|x| x.1).min_by(f64::total_cmp);
            let budget = Budget { max_error: Some(goal), max_ms: None };
            let choice =
                Auto::new(budget, Costs::default()).choose_in(situation, options.choice().view);
            if choice.problem.is_some() {
                right += u32::from(best.is_none());
                continue;
            }
            promised += 1;
            let Some((error, ms)) = of(&choice.technique) else { continue };
            if error <= goal {
                kept += 1;
            } else {
                println!("<!-- {}: asked {goal}, {choice}, found {error:.4} -->", group.key());
            }
            ratios.extend(best.map(|best| ms / best));
        }
        let not = views.len() - promised;
        println!(
            "| {goal} | {promised} of {} | {kept} | {right} of {not} | {:.2}, {:.2} |",
            views.len(),
            quantile(&ratios, 0.5),
            quantile(&ratios, 0.9)
        );
    }
    Ok(())
}

/// What the planner sees of a view.
///
/// # Errors
/// A sentence where the scene cannot be made, or where nothing in it can be shadowed.
pub fn situation(device: &HeadlessDevice, group: &Group) -> Result<Situation, Problem> {
    let ready = group.ready()?;
    let settings = technique("hard");
    let keep = |i: &Instance| ready.keeps(i);
    let mut stage = Stage::new(device, &ready.scene, &ready.view, group.extent, settings, keep)?;
    let light = ready.scene.light(None)?.light;
    let plan = stage.plan(light, ready.window)?;
    let situation = plan.verdicts().situation().copied();
    situation.ok_or_else(|| format!("{}: nothing can be shadowed", group.key()).into())
}
