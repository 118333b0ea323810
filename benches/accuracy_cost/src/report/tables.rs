//! The report's tables.

use super::headline::{self, GOALS};
use super::{Report, ms};
use crate::findings::{Finding, Verdict, findings};
use crate::groups::MATRIX;
use crate::plot::escape;
use crate::store::{Outcome, Row};
use crate::sweeps;

/// Eisemann 2008 Figure 2's table, in ms: mip, summed-area table and N-buffer at 256², 512², 1024².
const EISEMANN: [[&str; 3]; 3] =
    [["under 1", "under 1", "under 1"], ["5.1", "21.9", "96.8"], ["under 1", "1.7", "7.3"]];

/// A row of cells.
pub(super) fn row_of(cells: impl IntoIterator<Item = String>, tag: &str) -> String {
    let cells: String = cells.into_iter().map(|c| format!("<{tag}>{c}</{tag}>")).collect();
    format!("<tr>{cells}</tr>\n")
}

/// The time for 5, 3 and 2 %, a view a row.
pub fn headline(report: &Report) -> String {
    let names = headline::techniques(report);
    let mut out = String::from("<table class=\"n\">");
    let head = ["scene".to_string(), "light".into()];
    out += &row_of(head.into_iter().chain(names.iter().map(|n| escape(n))), "th");
    for line in headline::lines(report) {
        // The fastest at each goal stands out.
        let best: Vec<f64> = (0..GOALS.len())
            .map(|g| line.times.iter().filter_map(|t| t[g]).fold(f64::INFINITY, f64::min))
            .collect();
        let cell = |times: &[Option<f64>; 3]| {
            if times.iter().all(Option::is_none) {
                return "<i>never</i>".to_string();
            }
            let one = |(g, time): (usize, &Option<f64>)| match time {
                Some(t) if *t <= best[g] => format!("<b>{}</b>", ms(*t)),
                Some(t) => ms(*t),
                None => "<i>never</i>".into(),
            };
            times.iter().enumerate().map(one).collect::<Vec<_>>().join(" / ")
        };
        let first = [escape(line.scene), escape(line.light)];
        out += &row_of(first.into_iter().chain(line.times.iter().map(cell)), "td");
    }
    out + "</table>\n"
}

/// In how many views each technique reaches 3 %, and in how many it is the fastest to.
pub fn in_short(report: &Report) -> String {
    const GOAL: usize = 1;
    let lines = headline::lines(report);
    let mut out = String::from("<ul>\n");
    for (i, name) in headline::techniques(report).iter().enumerate() {
        let reached = lines.iter().filter(|l| l.times[i][GOAL].is_some()).count();
        let fastest = lines.iter().filter(|l| {
            let times = l.times.iter().filter_map(|t| t[GOAL]);
            let least = times.min_by(f64::total_cmp);
            least.is_some() && l.times[i][GOAL] == least
        });
        out += &format!(
            "<li><b>{}</b> comes within {:.0} % of the truth in {reached} of {} views, and is the \
             fastest to do so in {}.</li>\n",
            escape(name),
            100.0 * GOALS[GOAL],
            lines.len(),
            fastest.count()
        );
    }
    out + "</ul>\n"
}

/// What the paper says of a figure, whether it holds, and what was measured.
pub fn findings_of(report: &Report, figure: &str) -> String {
    let all = findings(report.rows);
    all.iter().filter(|f| f.figure == figure).map(found).collect()
}

/// One finding.
pub(super) fn found(finding: &Finding) -> String {
    let (class, verdict) = match finding.verdict {
        Verdict::Holds => ("yes", "holds"),
        Verdict::InPart => ("part", "holds in part"),
        Verdict::Refuted => ("no", "does not hold"),
        Verdict::Unmeasured => ("open", "not measured"),
    };
    format!(
        "<p><b>{}</b> <span class=\"{class}\">{verdict}</span>: {}.</p>\n",
        escape(finding.claim),
        escape(&finding.sentence)
    )
}

/// The technique that is wrong on purpose, in a sentence.
pub fn wrong(report: &Report) -> String {
    let mean =
        |curve: &str| report.study(sweeps::WRONG).find(|r| r.curve == curve).and_then(Row::mean);
    let (Some(right), Some(wrong)) = (mean("right"), mean("light 10 % too big")) else {
        return String::new();
    };
    let verdict = if wrong > right { "sees it" } else { "does NOT see it" };
    format!(
        "<p>A light 10 % too big, handed to the node on purpose (card, exact truth): {:.2} % mean \
         error where the right one has {:.2} %. The report {verdict}.</p>\n",
        100.0 * wrong,
        100.0 * right
    )
}

/// A measured frame, or why there is none.
fn frame(row: &Row) -> String {
    match &row.outcome {
        Outcome::Measured { times, .. } => {
            format!("{} ms ({} fps)", ms(times.frame_ms[1]), ms(1e3 / times.frame_ms[1]))
        }
        Outcome::NotThere => "<i>not there yet</i>".into(),
        Outcome::Failed(why) => format!("failed: {}", escape(why)),
    }
}

/// The passes that filter slices.
const FILTERS: [&str; 4] = ["sum_rows", "sum_columns", "first_level", "next_level"];

/// What filtering took of a row's frame, the frame, and the error.
fn filtering(row: &Row) -> String {
    let Some((errors, times)) = row.measured() else { return frame(row) };
    let filters = |name: &str| FILTERS.iter().any(|f| name == format!("occlusion_textures.{f}"));
    let filter: f64 = times.passes.iter().filter(|(name, _)| filters(name)).map(|p| p.1).sum();
    format!(
        "{} ms of a frame of {} ms; mean error {:.2} %",
        ms(filter),
        ms(times.frame_ms[1]),
        100.0 * errors.mean_abs_error
    )
}

/// Eisemann 2008's table, filled in as far as its technique is there.
pub fn eisemann(report: &Report) -> String {
    let mut out = String::from("<table>");
    let head = ["table", "scene", "image", "settings", "published", "here"];
    out += &row_of(head.map(String::from), "th");
    for row in report.study(sweeps::EISEMANN) {
        let filter = ["mip", "sat", "n-buffer"].iter().position(|f| *f == row.curve).unwrap_or(0);
        let map = [256.0, 512.0, 1024.0].iter().position(|m| *m == row.x).unwrap_or(0);
        out += &row_of(
            [
                "Eisemann 2008 Fig. 2 (the filter alone)".to_string(),
                escape(&row.scene),
                format!("{}×{}", row.extent[0], row.extent[1]),
                escape(&row.settings),
                format!("{} ms", EISEMANN[filter][map]),
                filtering(row),
            ],
            "td",
        );
    }
    out + "</table>\n"
}

/// What failed, what is not there, what the time did not suffice for.
pub fn gaps(report: &Report) -> String {
    let mut out = String::from("<ul>\n");
    for row in report.rows {
        if let Outcome::Failed(why) = &row.outcome {
            out += &format!(
                "<li class=\"no\">failed: {}, {} light, {} {}: {}</li>\n",
                escape(&row.scene),
                escape(&row.light),
                escape(&row.technique),
                escape(&row.settings),
                escape(why)
            );
        }
    }
    for technique in report.not_there() {
        out += &format!("<li>not there yet: {}</li>\n", escape(technique));
    }
    for group in report.left_out {
        out += &format!("<li>left out, for the quick run's time was up: {}</li>\n", escape(group));
    }
    out + "</ul>\n"
}

/// Every measured row of error against time.
pub fn all(report: &Report) -> String {
    let mut out = String::from("<div class=\"wide\"><table class=\"n\">");
    let head = [
        "scene",
        "light",
        "technique",
        "settings",
        "mean %",
        "RMSE %",
        "p99 %",
        "worst %",
        "bias %",
        "false umbra %",
        "false light %",
        "on lit %",
        "FLIP",
        "noise of truth %",
        "ms",
        "q1–q3",
        "passes, ms",
    ];
    out += &row_of(head.map(String::from), "th");
    for row in report.study(MATRIX) {
        let Some((e, t)) = row.measured() else { continue };
        let passes: Vec<String> =
            t.passes.iter().map(|(name, time)| format!("{} {}", escape(name), ms(*time))).collect();
        let percent = |v: f64| format!("{:.2}", 100.0 * v);
        out += &row_of(
            [
                escape(&row.scene),
                escape(&row.light),
                escape(&row.technique),
                escape(&row.settings),
                percent(e.mean_abs_error),
                percent(e.rmse),
                percent(e.p99),
                percent(e.worst),
                percent(e.bias),
                percent(e.false_umbra),
                percent(e.false_light),
                percent(e.lit_error),
                e.flip.map_or_else(String::new, |f| format!("{f:.4}")),
                percent(e.truth_noise),
                ms(t.frame_ms[1]),
                format!("{}–{}", ms(t.frame_ms[0]), ms(t.frame_ms[2])),
                format!("<small>{}</small>", passes.join(", ")),
            ],
            "td",
        );
    }
    out + "</table></div>\n"
}
