//! The report's charts.

use super::headline::views;
use super::{Report, ms, once};
use crate::findings;
use crate::pareto::{self, front};
use crate::plot::{self, Axis, Chart, PALETTE, Point, Series, Style};
use crate::store::Row;
use crate::sweeps;
use crate::techniques::CURVES;
use maud::{Markup, html};

pub(super) const MS: &str = "time of a frame, ms";
/// Errors below this, in percent, are drawn here: nobody sees them, and they would squeeze the rest.
const LEAST_SHOWN: f64 = 0.1;
pub(super) const ERROR: &str = "mean |error|, % of the light";

/// Dash and mark of a technique's first, second … curve.
const VARIANTS: [(&str, u8); 6] =
    [("", 0), ("6 3", 1), ("2 3", 2), ("8 3 2 3", 3), ("1 2", 0), ("12 2 2 2", 1)];

/// How a curve of the matrix is drawn: a color a technique, a dash and a mark a curve of it.
pub fn style(label: &str) -> Style {
    let Some(place) = CURVES.iter().position(|c| c.label == label) else {
        return swept_style(label);
    };
    let technique = CURVES[place].technique;
    let techniques = once(CURVES.iter().map(|c| c.technique));
    let color = techniques.iter().position(|t| *t == technique).unwrap_or(0);
    let variant = CURVES[..place].iter().filter(|c| c.technique == technique).count();
    let (dash, mark) = VARIANTS[variant % VARIANTS.len()];
    Style { color: PALETTE[color % PALETTE.len()], dash, mark }
}

/// How a curve of a sweep is drawn.
fn swept_style(label: &str) -> Style {
    match label {
        "one side" => Style { color: PALETTE[5], dash: "6 3", mark: 1 },
        "N = 64" | "512²" => Style { color: PALETTE[4], dash: "2 3", mark: 2 },
        "N = 256" | "1024²" => Style { color: PALETTE[3], dash: "8 3 2 3", mark: 3 },
        "256²" => Style { color: PALETTE[5], dash: "6 3", mark: 1 },
        _ => Style { color: PALETTE[0], dash: "", mark: 0 },
    }
}

/// What a pointer over a row's point shows.
fn tip(row: &Row) -> String {
    let Some((e, t)) = row.measured() else { return String::new() };
    let seen =
        e.seen_error.map_or_else(String::new, |seen| format!(", seen {:.2} %", 100.0 * seen));
    format!(
        "{} {}: {:.2} %{seen} in {} ms (quartiles {} to {})",
        row.technique,
        row.settings,
        100.0 * e.summary.mean_abs_error,
        ms(t.frame_ms[1]),
        ms(t.frame_ms[0]),
        ms(t.frame_ms[2])
    )
}

/// Rows joined into curves by their name.
pub(super) fn series<'a>(
    rows: &[&'a Row],
    point: impl Fn(&'a Row) -> Option<(f64, f64)>,
    spread: bool,
) -> Vec<Series> {
    let curve = |label: &str| {
        let own = rows.iter().filter(|r| r.curve == label);
        let mut points: Vec<Point> = own
            .filter_map(|row| {
                let (x, y) = point(row)?;
                let quartiles = row.measured().filter(|_| spread).map(|m| m.1.frame_ms);
                let x_spread = quartiles.map(|[a, _, b]| [a, b]);
                Some(Point { x, y, x_spread, tip: tip(row), front: false })
            })
            .collect();
        if !spread {
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
        }
        Series { label: label.into(), style: style(label), points }
    };
    let curves = once(rows.iter().map(|r| r.curve.as_str())).into_iter().map(curve);
    curves.filter(|s| !s.points.is_empty()).collect()
}

/// The sides of the light of some rows, in brackets; nothing of a sun.
fn sides(rows: &[&Row]) -> String {
    match rows.first().map_or([0.0; 2], |row| row.light_m) {
        [0.0, 0.0] => String::new(),
        [width, height] => format!(" ({width:.2} × {height:.2} m)"),
    }
}

/// Error against time, for each scene a chart a light; all on the same axes, so that they compare.
pub fn matrix(report: &Report) -> Vec<Vec<Markup>> {
    let measured: Vec<&Row> = report.matrix().collect();
    let x = Axis::log(MS, measured.iter().filter_map(|r| r.ms()));
    let error = |r: &Row| Some((100.0 * r.mean()?).max(LEAST_SHOWN));
    let y = Axis::log(ERROR, measured.iter().filter_map(|r| error(r)));
    let chart = |&(scene, light): &(&str, &str)| {
        let rows: Vec<&Row> =
            measured.iter().copied().filter(|r| r.scene == scene && r.light == light).collect();
        let mut series = series(&rows, |r| Some((r.ms()?, error(r)?)), true);
        let mut points: Vec<&mut Point> = series.iter_mut().flat_map(|s| &mut s.points).collect();
        let costs: Vec<_> = points.iter().map(|p| pareto::Point { ms: p.x, error: p.y }).collect();
        front(&costs).into_iter().for_each(|i| points[i].front = true);
        let floor =
            rows.iter().filter_map(|r| Some(r.measured()?.0.noise_floor)).fold(0.0, f64::max);
        Chart {
            title: format!("{scene}, {light} light{}", sides(&rows)),
            x: x.clone(),
            y: y.clone(),
            series,
            floor: (floor > 0.0).then_some(100.0 * floor),
            legend: false,
        }
        .svg()
    };
    let scenes = views(report);
    scenes.chunk_by(|a, b| a.0 == b.0).map(|own| own.iter().map(chart).collect()).collect()
}

/// The legend that the matrix's charts share.
pub fn legend(report: &Report) -> Markup {
    let labels = once(report.matrix().map(|r| r.curve.as_str()));
    html! {
        p.legend {
            @for label in labels {
                span { svg width="28" height="16" fill="none" { (plot::sample(style(label), 1.0, 8.0)) } " " (label) }
            }
            span {
                svg width="28" height="16" fill="none" { circle cx="14" cy="8" r="6.5" stroke="#555" {} }
                " nobody is both faster and nearer to the truth"
            }
        }
    }
}

/// What a figure of the paper plots.
struct Figure {
    name: &'static str,
    study: &'static str,
    /// What lies on x.
    x: &'static str,
    curves: &'static [&'static str],
    time: bool,
    /// x squared: texels instead of a side.
    squared: bool,
}

const N: &str = "side of the occluder map N, texels";
const SIDES: &[&str] = &[sweeps::SIDES[0].0, sweeps::SIDES[1].0];
const SIZES: &[&str] = &["N = 64", sweeps::SIDES[1].0, "N = 256"];

const fn figure(name: &'static str, study: &'static str, x: &'static str) -> Figure {
    Figure { name, study, x, curves: SIDES, time: false, squared: false }
}

const LIGHT: &str = "side of the light, m (the object is 1 m)";

const FIGURES: &[Figure] = &[
    figure("Fig. 17", sweeps::SIDE, N),
    figure("Fig. 18", sweeps::LIGHT, LIGHT),
    figure("Fig. 19", sweeps::LATERAL, "object's distance from under the light's centre, m"),
    figure("Fig. 20", sweeps::VERTICAL, "height of the object's centre, m (the light is at 4)"),
    Figure {
        time: true,
        curves: &[sweeps::SIDES[1].0],
        ..figure("Fig. 21", sweeps::POLYGONS, "triangles")
    },
    Figure {
        time: true,
        squared: true,
        ..figure("Fig. 22", sweeps::SIDE, "texels of the occluder map, N²")
    },
    Figure { time: true, curves: SIZES, ..figure("Fig. 24a", sweeps::LIGHT, LIGHT) },
    Figure { curves: SIZES, ..figure("Fig. 24b", sweeps::LIGHT, LIGHT) },
];

/// The paper's figures: each its name and a chart an object.
pub fn figures(report: &Report) -> Vec<(&'static str, Vec<Markup>)> {
    FIGURES.iter().map(|f| (f.name, f.charts(report))).filter(|f| !f.1.is_empty()).collect()
}

impl Figure {
    fn charts(&self, report: &Report) -> Vec<Markup> {
        let value = |r: &Row| if self.time { r.ms() } else { Some(100.0 * r.mean()?) };
        let point = |r: &Row| Some((if self.squared { r.x * r.x } else { r.x }, value(r)?));
        let mine = |r: &&Row| self.curves.contains(&r.curve.as_str()) && r.mean().is_some();
        let all: Vec<&Row> = report.study(self.study).filter(mine).collect();
        // One height for all objects, so that they compare.
        let heights = || all.iter().filter_map(|r| value(r));
        let chart = |scene: &&str| {
            let rows: Vec<&Row> = all.iter().copied().filter(|r| r.scene == *scene).collect();
            let places = rows.iter().filter_map(|r| point(r)).map(|p| p.0);
            let mut series = series(&rows, point, false);
            for s in &mut series {
                if self.curves == SIZES && s.label == sweeps::SIDES[1].0 {
                    s.label = "N = 128".into();
                }
            }
            Chart {
                title: format!("{}: {scene}", self.name),
                x: Axis::linear(self.x, places),
                y: Axis::linear(if self.time { MS } else { ERROR }, heights()),
                series,
                floor: None,
                legend: self.curves.len() > 1,
            }
            .svg()
        };
        let scenes = findings::scenes(report.rows, self.study);
        let measured = scenes.iter().filter(|s| all.iter().any(|r| r.scene == **s));
        measured.map(chart).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{rows, with};
    use super::*;

    #[test]
    fn no_two_curves_look_alike() {
        for (i, a) in CURVES.iter().enumerate() {
            for b in &CURVES[..i] {
                assert_ne!(style(a.label), style(b.label), "{} and {}", a.label, b.label);
            }
        }
        let swept = ["one side", "two sides", "N = 64", "N = 256"].map(style);
        let maps = crate::views::SIDES.map(|side| style(&crate::views::curve(side)));
        for curves in [swept, maps] {
            assert!((0..4).all(|i| (0..i).all(|j| curves[i] != curves[j])));
        }
    }

    #[test]
    fn a_chart_a_view_with_its_front() {
        let charts = with(&rows(), matrix);
        assert_eq!(charts.len(), 1);
        let svg = &charts[0][0].0;
        assert!(svg.contains("card, medium light") && svg.contains("r=\"6.5\""));
        assert!(with(&rows(), figures).is_empty());
    }
}
