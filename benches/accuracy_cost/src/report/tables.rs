//! The report's tables.

use super::headline::{self, GOALS};
use super::{Report, ms};
use crate::findings::{Finding, Verdict, findings};
use crate::groups::MATRIX;
use crate::store::{Outcome, Row};
use crate::sweeps;
use maud::{Markup, Render, html};

/// Eisemann 2008 Figure 2's table, in ms: mip, summed-area table and N-buffer at 256², 512², 1024².
const EISEMANN: [[&str; 3]; 3] =
    [["under 1", "under 1", "under 1"], ["5.1", "21.9", "96.8"], ["under 1", "1.7", "7.3"]];

/// A table's head.
pub fn head_of<T: Render>(names: impl IntoIterator<Item = T>) -> Markup {
    html! { tr { @for name in names { th { (name) } } } }
}

/// A row of cells.
pub(super) fn row_of<T: Render>(cells: impl IntoIterator<Item = T>) -> Markup {
    html! { tr { @for cell in cells { td { (cell) } } } }
}

/// The time for 5, 3 and 2 %, a view a row.
pub fn headline(report: &Report) -> Markup {
    let cell = |times: &[Option<f64>; 3], best: &[f64]| {
        html! {
            @if times.iter().all(Option::is_none) { i { "never" } } @else {
                @for (g, time) in times.iter().enumerate() {
                    @if g > 0 { " / " }
                    @match time {
                        // The fastest at each goal stands out.
                        Some(t) if *t <= best[g] => b { (ms(*t)) },
                        Some(t) => (ms(*t)),
                        None => i { "never" },
                    }
                }
            }
        }
    };
    html! {
        table.n {
            (head_of(["scene", "light"].into_iter().chain(headline::techniques(report))))
            @for line in headline::lines(report) {
                @let best = [0, 1, 2].map(|g| {
                    line.times.iter().filter_map(|t| t[g]).fold(f64::INFINITY, f64::min)
                });
                tr {
                    td { (line.scene) } td { (line.light) }
                    @for times in &line.times { td { (cell(times, &best)) } }
                }
            }
        }
    }
}

/// In how many views each technique reaches 3 %, and in how many it is the fastest to.
pub fn in_short(report: &Report) -> Markup {
    const GOAL: usize = 1;
    let lines = headline::lines(report);
    let reached = |i: usize| lines.iter().filter(|l| l.times[i][GOAL].is_some()).count();
    let fastest = |i: usize| {
        let is_least = |l: &&headline::Line| {
            let least = l.times.iter().filter_map(|t| t[GOAL]).min_by(f64::total_cmp);
            least.is_some() && l.times[i][GOAL] == least
        };
        lines.iter().filter(is_least).count()
    };
    html! {
        ul {
            @for (i, name) in headline::techniques(report).iter().enumerate() {
                li {
                    b { (name) } " comes within " (format!("{:.0}", 100.0 * GOALS[GOAL])) " % of the truth in "
                    (reached(i)) " of " (lines.len()) " views, and is the fastest to do so in " (fastest(i)) "."
                }
            }
        }
    }
}

/// What the paper says of a figure, whether it holds, and what was measured.
pub fn findings_of(report: &Report, figure: &str) -> Markup {
    let all = findings(report.rows);
    html! { @for finding in all.iter().filter(|f| f.figure == figure) { (found(finding)) } }
}

/// One finding.
pub(super) fn found(finding: &Finding) -> Markup {
    let (class, verdict) = match finding.verdict {
        Verdict::Holds => ("yes", "holds"),
        Verdict::InPart => ("part", "holds in part"),
        Verdict::Refuted => ("no", "does not hold"),
        Verdict::Unmeasured => ("open", "not measured"),
    };
    html! { p { b { (finding.claim) } " " span class=(class) { (verdict) } ": " (finding.sentence) "." } }
}

/// The technique that is wrong on purpose, in a sentence.
pub fn wrong(report: &Report) -> Markup {
    let mean =
        |curve: &str| report.study(sweeps::WRONG).find(|r| r.curve == curve).and_then(Row::mean);
    let (Some(right), Some(wrong)) = (mean("right"), mean("light 10 % too big")) else {
        return Markup::default();
    };
    let verdict = if wrong > right { "sees it" } else { "does NOT see it" };
    html! {
        p {
            "A light 10 % too big, handed to the node on purpose (card, exact truth): " (percent(wrong))
            " % mean error where the right one has " (percent(right)) " %. The report " (verdict) "."
        }
    }
}

pub(super) fn percent(fraction: f64) -> String {
    format!("{:.2}", 100.0 * fraction)
}

/// Why there is no measured frame.
pub(super) fn unmeasured(row: &Row) -> Markup {
    match &row.outcome {
        Outcome::Failed(why) => html! { "failed: " (why) },
        _ => html! { i { "not there yet" } },
    }
}

/// The passes that filter slices.
const FILTERS: [&str; 4] = ["sum_rows", "sum_columns", "first_level", "next_level"];

/// What filtering took of a row's frame, the frame, and the error.
fn filtering(row: &Row) -> Markup {
    let Some((errors, times)) = row.measured() else { return unmeasured(row) };
    let filters = |name: &str| FILTERS.iter().any(|f| name == format!("occlusion_textures.{f}"));
    let filter: f64 = times.passes.iter().filter(|(name, _)| filters(name)).map(|p| p.1).sum();
    html! {
        (ms(filter)) " ms of a frame of " (ms(times.frame_ms[1])) " ms; mean error "
        (percent(errors.summary.mean_abs_error)) " %"
    }
}

/// Eisemann 2008's table, filled in as far as its technique is there.
pub fn eisemann(report: &Report) -> Markup {
    html! {
        table {
            (head_of(["table", "scene", "image", "settings", "published", "here"]))
            @for row in report.study(sweeps::EISEMANN) {
                @let filter = ["mip", "sat", "n-buffer"].iter().position(|f| *f == row.curve).unwrap_or(0);
                @let map = [256.0, 512.0, 1024.0].iter().position(|m| *m == row.x).unwrap_or(0);
                tr {
                    td { "Eisemann 2008 Fig. 2 (the filter alone)" } td { (row.scene) }
                    td { (row.extent[0]) "×" (row.extent[1]) } td { (row.settings) }
                    td { (EISEMANN[filter][map]) " ms" } td { (filtering(row)) }
                }
            }
        }
    }
}

/// What failed, what is not there, what the time did not suffice for.
pub fn gaps(report: &Report) -> Markup {
    html! {
        ul {
            @for row in report.rows {
                @if let Outcome::Failed(why) = &row.outcome {
                    li.no {
                        "failed: " (row.scene) ", " (row.light) " light, " (row.technique) " " (row.settings) ": "
                        (why)
                    }
                }
            }
            @for technique in report.not_there() { li { "not there yet: " (technique) } }
            @for group in report.left_out {
                li { "left out, for the quick run's time was up: " (group) }
            }
        }
    }
}

/// The columns of [`all`].
const COLUMNS: &str = "scene|light|technique|settings|mean %|seen %|RMSE %|p99 %|worst %|bias %|false umbra %|false light %|\
                       on lit %|FLIP|noise of truth %|ms|q1–q3|passes, ms";

/// Every measured row of error against time.
pub fn all(report: &Report) -> Markup {
    html! {
        div.wide {
            table.n {
                (head_of(COLUMNS.split('|')))
                @for row in report.study(MATRIX) {
                    @if let Some((e, t)) = row.measured() {
                        tr {
                            @for name in [&row.scene, &row.light, &row.technique, &row.settings] { td { (name) } }
                            @let s = &e.summary;
                            td { (percent(s.mean_abs_error)) }
                            td { @if let Some(seen) = e.seen_error { (percent(seen)) } }
                            @for error in [
                                s.rmse, s.p99, s.worst, s.bias, s.false_umbra, s.false_light, s.lit_error,
                            ] { td { (percent(error)) } }
                            td { @if let Some(flip) = e.flip { (format!("{flip:.4}")) } }
                            td { (percent(e.truth_noise)) }
                            td { (ms(t.frame_ms[1])) }
                            td { (ms(t.frame_ms[0])) "–" (ms(t.frame_ms[2])) }
                            td { small {
                                @for (i, (name, time)) in t.passes.iter().enumerate() {
                                    @if i > 0 { ", " } (name) " " (ms(*time))
                                }
                            } }
                        }
                    }
                }
            }
        }
    }
}
