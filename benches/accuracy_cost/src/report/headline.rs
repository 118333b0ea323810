//! The time that each technique needs for 5, 3 and 2 % mean error.

use super::{Report, ms, once};
use crate::pareto::{Point, time_for};
use crate::store::Row;

/// The mean errors that times are given for.
pub const GOALS: [f64; 3] = [0.05, 0.03, 0.02];

/// One line: scene, light, and for each technique its times for [`GOALS`].
pub struct Line<'a> {
    pub scene: &'a str,
    pub light: &'a str,
    /// For each technique, the ms that each goal takes; none for never.
    pub times: Vec<[Option<f64>; 3]>,
}

/// The techniques measured in the matrix, in the order of their curves.
pub fn techniques<'a>(report: &'a Report) -> Vec<&'a str> {
    once(report.matrix().map(|r| r.technique.as_str()))
}

/// All lines, in the order of the rows. A technique's time is that of the fastest among all its
/// settings that were measured.
pub fn lines<'a>(report: &'a Report) -> Vec<Line<'a>> {
    let techniques = techniques(report);
    let mut lines = Vec::new();
    for (scene, light) in views(report) {
        let here = |r: &&Row| r.scene == scene && r.light == light;
        let time = |technique: &str, goal| {
            let rows = report.matrix().filter(here).filter(|r| r.technique == technique);
            let points = rows.filter_map(|r| Some(Point { ms: r.ms()?, error: r.mean()? }));
            time_for(points, goal)
        };
        let times = techniques.iter().map(|t| GOALS.map(|goal| time(t, goal))).collect();
        lines.push(Line { scene, light, times });
    }
    lines
}

/// Scene and light of every measured view: scenes in the order of the rows, lights by size.
pub fn views<'a>(report: &'a Report) -> Vec<(&'a str, &'a str)> {
    let scenes = once(report.matrix().map(|r| r.scene.as_str()));
    let mut views = Vec::new();
    for scene in scenes {
        let mut own: Vec<&Row> = report.matrix().filter(|r| r.scene == scene).collect();
        let area = |r: &Row| r.light_m[0] * r.light_m[1];
        own.sort_by(|a, b| area(a).total_cmp(&area(b)));
        let lights = once(own.into_iter().map(|r| r.light.as_str()));
        views.extend(lights.into_iter().map(|light| (scene, light)));
    }
    views
}

/// The three times of one cell.
pub fn cell(times: &[Option<f64>; 3]) -> String {
    if times.iter().all(Option::is_none) {
        return "never".into();
    }
    times.map(|t| t.map_or_else(|| "never".into(), ms)).join(" / ")
}

/// The table as Markdown, with what made it.
pub fn markdown(report: &Report) -> String {
    let techniques = techniques(report);
    let head = report.header;
    let mut text = format!(
        "Milliseconds for 5 / 3 / 2 % mean error, by the fastest settings measured; `{}`, commit {}, \
         {}, {}×{} pixels, truth of {} rays a pixel.\n\n",
        head.command, head.commit, head.driver, head.extent[0], head.extent[1], head.truth_rays
    );
    let missing = report.not_there();
    if !missing.is_empty() {
        text.push_str(&format!("Not there yet: {}.\n\n", missing.join(", ")));
    }
    text.push_str(&format!("| scene | light | {} |\n", techniques.join(" | ")));
    text.push_str(&format!("|---|---|{}\n", "---|".repeat(techniques.len())));
    for line in lines(report) {
        let cells: Vec<String> = line.times.iter().map(cell).collect();
        text.push_str(&format!("| {} | {} | {} |\n", line.scene, line.light, cells.join(" | ")));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::tests::{rows, with};
    use super::*;

    #[test]
    fn times_are_of_settings_that_reach_the_goal() {
        let text = with(&rows(), markdown);
        assert!(text.contains("| card | medium | 10.0 / 40.0 / 40.0 |"), "{text}");
        assert!(text.contains("Not there yet: ray-march."));
        assert_eq!(cell(&[Some(1.0), None, None]), "1.00 / never / never");
        assert_eq!(cell(&[None; 3]), "never");
    }
}
