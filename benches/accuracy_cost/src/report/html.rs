//! The page: everything in one file.

use super::{Report, charts, curtis, strip, tables};
use crate::groups::MATRIX;
use crate::hard_cases;
use crate::plot::escape;

const STYLE: &str = "
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, sans-serif; color: #1a1a1a; background: #fff;
       margin: 1.5em auto; padding: 0 1.2em; max-width: 1290px; }
h1 { font-size: 1.7em; margin: 0 0 .2em; } h2 { margin: 1.8em 0 .4em; font-size: 1.3em; }
h3 { margin: 1.2em 0 .2em; font-size: 1.05em; }
p { margin: .4em 0; max-width: 75em; } small { color: #555; }
table { border-collapse: collapse; font-size: .87em; }
th, td { border: 1px solid #ddd; padding: .2em .55em; text-align: left; vertical-align: top; }
th { background: #f4f4f4; } .n td { font-variant-numeric: tabular-nums; white-space: nowrap; }
i { color: #999; } .wide { overflow-x: auto; }
.strip th, .strip td { border: 0; padding: .15em .3em; text-align: center; background: none; }
.strip img { width: 142px; display: inline-block; }
.strip.figure img { width: 290px; }
.strip th:first-child { text-align: right; vertical-align: middle; max-width: 8em; }
.strip td { line-height: 1.1; padding: 1px 2px; }
.charts { display: flex; flex-wrap: wrap; gap: .4em 1em; }
.legend span { white-space: nowrap; margin-right: 1.2em; } .legend svg { vertical-align: -3px; }
.yes { color: #00724f; } .no { color: #b03a00; } .open { color: #666; }
.part { color: #7a5c00; } .yes, .part, .no, .open { font-weight: 600; }
svg text { fill: #333; } svg .t { font-weight: 600; font-size: 12.5px; }
svg .m { text-anchor: middle; } svg .e { text-anchor: end; }
svg .g { stroke: #e6e6e6; } svg .a { stroke: #666; }
svg .p { stroke: #c9c9c9; stroke-width: 6; stroke-linejoin: round; }
svg path.f { stroke: #b03a00; stroke-dasharray: 2 3; } svg text.f { fill: #b03a00; font-size: 10px; }
";

/// The whole page.
pub fn page(report: &Report) -> String {
    let head = report.header;
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width\">\n<title>What accuracy costs in time</title>\n\
         <style>{STYLE}</style></head><body>\n<h1>What accuracy costs in time</h1>\n<p><small>{} · \
         {}×{} pixels · truth by {} rays a pixel · commit {} · <code>{}</code></small></p>\n",
        escape(&head.driver),
        head.extent[0],
        head.extent[1],
        head.truth_rays,
        escape(&head.commit),
        escape(&head.command)
    );
    out += &tables::in_short(report);
    out += "<h2>What it looks like</h2>\n<p>Medium lights. Under each picture where it is wrong, and \
            its mean error and time.</p>\n";
    out += &strip::strip(report);
    out += &matrix(report);
    out += "<h2>Milliseconds for 5 / 3 / 2 % mean error</h2>\n<p>By the fastest of the settings that \
            were measured; the fastest technique in bold.</p>\n";
    out += &tables::headline(report);
    out += "<h2>Soft shadow maps against Atty 2006</h2>\n<p>The set-up is the paper's: an object of 1 \
            m at a height of 2 m (the tall box on the ground), a square light at 4 m facing down, \
            pixels a regular grid on the ground, N = 128 and a light of 0.4 m where they are not \
            swept. The card is held against its closed form, the others against traced truth.</p>\n";
    out += &tables::wrong(report);
    for (name, charts) in charts::figures(report) {
        let findings = tables::findings_of(report, name);
        out += &format!(
            "<h3>{name}</h3>\n{findings}<div class=\"charts\">{}</div>\n",
            charts.concat()
        );
    }
    out += "<h2>Ray marching against Curtis 2009</h2>\n<p>Published times are of a GPU of their year; \
            what compares is how they grow, and which of two is faster.</p>\n";
    out += &curtis::tables(report);
    out += "<h3>Kinds of levels</h3>\n";
    out += &curtis::levels(report);
    out += "<h2>Eisemann 2008</h2>\n<details><summary>The table</summary>\n";
    out += &tables::eisemann(report);
    out += "</details>\n<h2>Hard cases</h2>\n";
    if report.hard_cases.is_empty() {
        out += "<p>Not measured yet; <code>--hard-cases</code> does, as does a full run.</p>\n";
    }
    for (driver, rows) in report.hard_cases {
        out += "<details><summary>Each with its bound and why</summary>\n";
        out += &hard_cases::table::html(rows, driver);
        out += "</details>\n";
    }
    out += "<h2>What is missing</h2>\n";
    out += &tables::gaps(report);
    out += &method();
    out += "<h2>Every row</h2>\n<details><summary>Error against time in numbers; \
            <code>accuracy_cost.csv</code> has all</summary>\n";
    out += &tables::all(report);
    out += "</details>\n</body></html>\n";
    out
}

fn matrix(report: &Report) -> String {
    let mut out = String::from(
        "<h2>Error against time</h2>\n<p>Down and left is better. Each curve is a technique whose \
         quality sweeps (a pointer over a point shows its settings); bars are the quartiles of the \
         time. Errors under 0.1 % are drawn as 0.1 %.</p>\n",
    );
    let failed = report.study(MATRIX).all(|r| r.mean().is_none());
    if failed {
        return out + "<p class=\"no\">Nothing was measured.</p>\n";
    }
    out += &charts::legend(report);
    for (_, charts) in charts::matrix(report) {
        out += &format!("<div class=\"charts\">{}</div>\n", charts.concat());
    }
    out
}

fn method() -> String {
    String::from(
        "<h2>How it was measured</h2>\n<p>The <b>visible fraction</b> of the light, by each technique \
         and by the truth, at the same pixels of one G-buffer. <b>Mean error</b>: mean |error| over \
         the pixels that either puts in shadow or penumbra (Atty 2006 section 5.2.1), in percent of \
         the light. <b>FLIP</b>: mean over the whole shaded image, visibility × unshadowed \
         irradiance. The card's truth is its closed form; the others' is traced, with random \
         numbers that are not the measured ray tracer's. The dotted line is what the \
         truth's own noise adds up to in a mean error.</p>\n<p><b>Time</b>: from submit to fence, \
         G-buffer not counted, after a frame of warm-up, techniques in turns in one process, the \
         median of all rounds. The ray tracer's is the wall time of its rays on all cores, its \
         hierarchy built beforehand.</p>\n",
    )
}
