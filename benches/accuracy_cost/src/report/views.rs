//! Error and time against views and maps, and how still shadows stay.

use super::charts::{ERROR, MS, series};
use super::tables::{head_of, percent};
use super::{Report, ms, once};
use crate::plot::{Axis, Chart};
use crate::stability::{CURVES, STABILITY};
use crate::store::{Changes, Row};
use crate::views::STUDIES;
use maud::{Markup, html};

const SEEN: &str = "mean |error| weighed by irradiance, %";

/// What lies on a chart's y.
type Measure = (&'static str, fn(&Row) -> Option<f64>);

const MEASURES: [Measure; 3] = [
    (ERROR, |row| Some(100.0 * row.mean()?)),
    (SEEN, |row| Some(100.0 * row.seen()?)),
    (MS, |row| row.ms()),
];

/// For each scene and technique a chart of the mean error, one of the seen error and one of the time.
pub fn charts(report: &Report) -> Markup {
    let measured = |study| report.study(study).filter(|row| row.mean().is_some());
    let all: Vec<&Row> = STUDIES.iter().flat_map(|(study, _)| measured(study)).collect();
    if all.is_empty() {
        return html! { p { "Not measured." } };
    }
    let scenes = once(all.iter().map(|row| row.scene.as_str()));
    html! {
        p {
            "The most views that a light may have (" code { "views" } "), each with maps of the side that a curve has; \
             where fewer suffice there are fewer. Of one scene all charts of a measure have the same axis."
        }
        @for scene in scenes {
            @let own: Vec<&Row> = all.iter().copied().filter(|row| row.scene == scene).collect();
            h3 { (scene) ", " (own[0].light) }
            @for (study, technique) in STUDIES {
                @let rows: Vec<&Row> = own.iter().copied().filter(|row| row.study == study).collect();
                @if !rows.is_empty() {
                    div.charts { @for measure in MEASURES { (chart(technique, measure, &rows, &own)) } }
                }
            }
        }
    }
}

fn chart(technique: &str, (label, of): Measure, rows: &[&Row], all: &[&Row]) -> Markup {
    let point = |row: &Row| Some((row.x, of(row)?));
    Chart {
        title: technique.into(),
        x: Axis::linear("most views", rows.iter().map(|row| row.x)),
        y: Axis::log(label, all.iter().filter_map(|row| of(row))),
        series: series(rows, point, false),
        floor: None,
        legend: true,
    }
    .svg()
}

/// The rows of walks, a table a scene, each with whether several views change no more than one.
pub fn stability(report: &Report) -> Markup {
    let rows: Vec<(&Row, &Changes)> = report
        .study(STABILITY)
        .filter_map(|row| Some((row, row.measured()?.0.changes.as_deref()?)))
        .collect();
    let Some((_, first)) = rows.first() else { return html! { p { "Not measured." } } };
    html! {
        p {
            "A camera walks and turns. Still points of surfaces that the light can reach are looked at in a frame and in \
             the next, where pixels show them to within a quarter of a pixel (" (first.pairs) " pairs in the first \
             scene): the change of the image, that of the truth, traced at what both pixels show, and that of the \
             error, which is the change of what is shown of the still point itself. In percent of the light."
        }
        @for scene in once(rows.iter().map(|(row, _)| row.scene.as_str())) {
            @let own: Vec<_> = rows.iter().filter(|(row, _)| row.scene == scene).collect();
            h3 { (scene) ", " (own[0].0.light) }
            table.n {
                (head_of([
                    "technique", "views", "change: mean", "99 %", "99.9 %", "largest", "error's change: mean", "99 %",
                    "99.9 %", "largest", "mean error", "seen error", "ms",
                ]))
                tr {
                    td { "truth" } td {}
                    @let c = own[0].1;
                    @for value in [
                        c.truth_change_mean, c.truth_change_p99, c.truth_change_p999, c.truth_change_worst,
                    ] { td { (percent(value)) } }
                    @for _ in 0..7 { td {} }
                }
                @for (row, c) in &own {
                    tr {
                        td { (row.technique) } td { (row.curve) }
                        @for value in [
                            c.change_mean, c.change_p99, c.change_p999, c.change_worst, c.error_change_mean,
                            c.error_change_p99, c.error_change_p999, c.error_change_worst,
                        ] { td { (percent(value)) } }
                        td { (percent(row.mean().unwrap_or_default())) }
                        td { (percent(row.seen().unwrap_or_default())) }
                        td { (ms(row.ms().unwrap_or_default())) }
                    }
                }
            }
            ul { @for sentence in law(&own) { li { (sentence) } } }
        }
    }
}

/// Whether image and error change no more with several views than with one, a sentence a technique. By mean and 99.9th
/// percentile: under a sun that is all of the light, whatever the views.
fn law(rows: &[&(&Row, &Changes)]) -> Vec<String> {
    let of = |technique: &str, curve: &str| {
        let found =
            rows.iter().find(|(row, _)| row.technique == technique && row.curve == curve)?;
        let c = found.1;
        Some([[c.change_mean, c.change_p999], [c.error_change_mean, c.error_change_p999]])
    };
    let compared = |one: [f64; 2], several: [f64; 2]| {
        let more = several.iter().zip(one).any(|(several, one)| *several > one);
        let verdict = if more { "MORE" } else { "no more" };
        let [one, several] = [one, several].map(|both| both.map(percent).join(" and "));
        format!("{verdict} (mean and 99.9th percentile {several} %, with one view {one} %)")
    };
    let sentence = |technique: &str| {
        let [one, several] = [of(technique, CURVES[0])?, of(technique, CURVES[1])?];
        let [image, error] = [0, 1].map(|i| compared(one[i], several[i]));
        Some(format!(
            "{technique}: with the default views the image changes {image}, the error {error}."
        ))
    };
    once(rows.iter().map(|(row, _)| row.technique.as_str()))
        .into_iter()
        .filter_map(sentence)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::with;
    use super::*;
    use crate::store::Outcome;
    use crate::store::tests::row;

    fn walked(technique: &str, curve: &str, change: f64) -> Row {
        let mut row = row(curve, 1.0, 1.0, 0.1);
        (row.study, row.technique) = (STABILITY.into(), technique.into());
        if let Outcome::Measured { errors, .. } = &mut row.outcome {
            let changes = Changes { pairs: 9, error_change_p999: change, ..Changes::default() };
            errors.changes = Some(Box::new(changes));
        }
        row
    }

    #[test]
    fn a_law_that_is_broken_is_said_to_be() {
        let rows = [
            walked("pcss", CURVES[0], 0.25),
            walked("pcss", CURVES[1], 0.125),
            walked("hard", CURVES[0], 0.25),
            walked("hard", CURVES[1], 0.5),
            walked("traced", CURVES[1], 0.0),
        ];
        let page = with(&rows, stability).into_string();
        let found = |sentence: &str| assert!(page.contains(sentence), "{sentence}: {page}");
        found("pcss: with the default views the image changes no more (");
        found("the error no more (mean and 99.9th percentile 0.00 and 12.50 %, with one view");
        found("the error MORE (mean and 99.9th percentile 0.00 and 50.00 %, with one view");
        assert!(!page.contains("traced: with"), "{page}");
        assert!(with(&[], stability).into_string().contains("Not measured"));
    }

    #[test]
    fn a_scene_has_three_charts_a_technique() {
        let of = |study: &str, technique: &str, views: f64| {
            let mut row = row("256²", views, 10.0, 0.1 / views);
            (row.study, row.technique) = (study.into(), technique.into());
            row
        };
        let rows: Vec<Row> = STUDIES[..2]
            .iter()
            .flat_map(|(study, technique)| [1.0, 4.0].map(|views| of(study, technique, views)))
            .collect();
        let page = with(&rows, charts).into_string();
        assert_eq!(page.matches("<svg").count(), 6, "{page}");
        assert!(page.contains(SEEN) && page.contains("seen 5.00 %"));
    }
}
