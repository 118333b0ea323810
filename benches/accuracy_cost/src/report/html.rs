//! The page: everything in one file.

use super::{Report, charts, curtis, strip, tables, views};
use crate::hard_cases;
use maud::{DOCTYPE, Markup, PreEscaped, html};

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
    let Report { header: head, .. } = report;
    let [width, height] = head.extent;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { "What accuracy costs in time" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "What accuracy costs in time" }
                p { small {
                    (head.driver) " · " (width) "×" (height) " pixels · truth by " (head.truth_rays)
                    " rays a pixel · commit " (head.commit) " · " code { (head.command) }
                } }
                (tables::in_short(report))
                h2 { "What it looks like" }
                p { "Medium lights, or a scene's own. Under each picture where it is wrong, and its mean error, that as an eye \
                     sees it, and its time." }
                (strip::strip(report))
                (matrix(report))
                h2 { "Milliseconds for 5 / 3 / 2 % mean error" }
                p { "By the fastest of the settings that were measured; the fastest technique in bold." }
                (tables::headline(report))
                h2 { "Views and maps" }
                (views::charts(report))
                h2 { "How still shadows stay" }
                (views::stability(report))
                h2 { "Soft shadow maps against Atty 2006" }
                p {
                    "The set-up is the paper's: an object of 1 m at a height of 2 m (the tall box on the ground), \
                     a square light at 4 m facing down, pixels a regular grid on the ground, N = 128 and a light \
                     of 0.4 m where they are not swept. The card is held against its closed form, the others \
                     against traced truth."
                }
                (tables::wrong(report))
                @for (name, charts) in charts::figures(report) {
                    h3 { (name) }
                    (tables::findings_of(report, name))
                    div.charts { @for chart in charts { (chart) } }
                }
                h2 { "Ray marching against Curtis 2009" }
                p {
                    "Published times are of a GPU of their year; what compares is how they grow, and which of two \
                     is faster."
                }
                (curtis::tables(report))
                h3 { "Kinds of levels" }
                (curtis::levels(report))
                h2 { "Eisemann 2008" }
                details { summary { "The table" } (tables::eisemann(report)) }
                h2 { "Hard cases" }
                @if report.hard_cases.is_empty() {
                    p { "Not measured yet; " code { "--hard-cases" } " does, as does a full run." }
                }
                @for (driver, rows) in report.hard_cases {
                    details {
                        summary { "Each with its bound and why" }
                        (hard_cases::table::html(rows, driver))
                    }
                }
                h2 { "What is missing" }
                (tables::gaps(report))
                (method())
                h2 { "Every row" }
                details {
                    summary { "Error against time in numbers; " code { "accuracy_cost.csv" } " has all" }
                    (tables::all(report))
                }
            }
        }
    };
    page.into_string()
}

fn matrix(report: &Report) -> Markup {
    html! {
        h2 { "Error against time" }
        p {
            "Scenes with lights of their own are measured under one light at a time, and there the node is lent the \
             triangles' normals, as " code { "render" } " does; elsewhere it finds them from depth. Down and left is \
             better. Each curve is a technique whose quality sweeps (a pointer over a point shows \
             its settings); bars are the quartiles of the time. Errors under 0.1 % are drawn as 0.1 %."
        }
        @if report.matrix().next().is_none() {
            p.no { "Nothing was measured." }
        } @else {
            (charts::legend(report))
            @for charts in charts::matrix(report) {
                div.charts { @for chart in charts { (chart) } }
            }
        }
    }
}

fn method() -> Markup {
    html! {
        h2 { "How it was measured" }
        p {
            "The " b { "visible fraction" } " of the light, by each technique and by the truth, at the same pixels of \
             one G-buffer. " b { "Mean error" } ": mean |error| over the pixels that either puts in shadow or \
             penumbra (Atty 2006 section 5.2.1), in percent of the light; what both see lit is no part of it, and what \
             is in umbra in both is. " b { "Seen error" } ": the mean over the same pixels, each weighed by the \
             irradiance that the light alone would give it with nothing in between: an error where the light grazes \
             a surface or is far away is hardly seen. " b { "FLIP" } ": mean over the whole \
             shaded image, visibility × unshadowed irradiance. The card's truth is its closed form; the others' is \
             traced, by another tracer than the one that is measured. The dotted line is what the truth's own noise \
             adds up to in a mean error."
        }
        p {
            b { "Time" } ": from submit to fence, G-buffer not counted, after a frame of warm-up, techniques in turns \
             in one process, the median of all rounds. The ray tracer's is the wall time of its rays on all cores; \
             that of its tree, which outlives the frame, stands among its passes as " code { "rays.tree_built_once" }
            " and is not in it."
        }
    }
}
