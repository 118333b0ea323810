//! The picture strip: scene by technique, and where each is wrong.

use super::{Report, ms, once};
use crate::groups::MATRIX;
use crate::picture::{self, ERROR_SCALE, Pictures};
use crate::store::Row;
use crate::techniques::CURVES;
use maud::{Markup, html};

/// The rows that stand for their technique, of one scene, in the order of the curves.
fn shown<'a>(report: &'a Report, scene: &str) -> Vec<&'a Row> {
    let of = |curve: &crate::techniques::Curve| {
        let words = curve.steps().find(|step| step.shown)?.words;
        report.study(MATRIX).find(|r| {
            let light = r.light != "small" && r.light != "large";
            let same = r.curve == curve.label && r.settings == words;
            light && same && r.scene == scene && r.mean().is_some()
        })
    };
    CURVES.iter().filter_map(of).collect()
}

/// A kept picture, where there is one.
pub(super) fn image(pictures: &Pictures, scene: &str, name: &str) -> Option<Markup> {
    let url = pictures.url(scene, name)?;
    Some(html! { img src=(url) alt={ (scene) ", " (name) }; })
}

/// The strip as a table: a column a scene, and for each technique its pictures over their errors, so
/// that one look along a row judges a technique and one down a column a scene.
pub fn strip(report: &Report) -> Markup {
    let pictures = Pictures::new(report.cache);
    let scenes = once(report.study(MATRIX).map(|r| r.scene.as_str()));
    let strips: Vec<(&str, Markup, Vec<&Row>)> = scenes
        .into_iter()
        .filter_map(|s| Some((s, image(&pictures, s, picture::TRUTH)?, shown(report, s))))
        .collect();
    let rows: Vec<&Row> = strips.iter().flat_map(|s| s.2.iter().copied()).collect();
    html! {
        div.wide {
            table.strip {
                tr { th {} @for (scene, ..) in &strips { th { (scene) } } }
                tr { th { "truth" } @for (_, truth, _) in &strips { td { (truth) } } }
                @for label in once(rows.iter().map(|r| r.curve.as_str())) {
                    @let settings = rows.iter().find(|r| r.curve == label).map_or("", |r| &r.settings);
                    tr {
                        th { (label) br; small { (settings) } }
                        @for (scene, _, shown) in &strips {
                            td {
                                @if let Some(row) = shown.iter().find(|r| r.curve == label) {
                                    @for name in [label, &picture::error_of(label)] {
                                        @if let Some(image) = image(&pictures, scene, name) { (image) }
                                        br;
                                    }
                                    small {
                                        (format!("{:.1}", 100.0 * row.mean().unwrap_or_default())) " %, "
                                        @if let Some(seen) = row.seen() { (format!("seen {:.1} %, ", 100.0 * seen)) }
                                        (ms(row.ms().unwrap_or_default())) " ms"
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
        (scale())
    }
}

/// The color bar of the errors.
fn scale() -> Markup {
    const STEPS: u16 = 80;
    const WIDTH: f64 = 320.0;
    let step = WIDTH / f64::from(STEPS);
    let color = |i: u16| {
        let error = (f32::from(i) + 0.5) / f32::from(STEPS) * 2.0 - 1.0;
        let [r, g, b] = picture::color(error * ERROR_SCALE);
        format!("#{r:02x}{g:02x}{b:02x}")
    };
    html! {
        p {
            svg width=(WIDTH + 160.0) height="34" font-size="11.5" role="img" {
                title { "colors of the error" }
                @for i in 0..STEPS {
                    rect x=(format!("{:.2}", 80.0 + f64::from(i) * step)) y="2" width=(format!("{:.2}", step + 0.3))
                        height="12" fill=(color(i)) {}
                }
                text x="74" y="12" class="e" { "too dark" }
                text x=(WIDTH + 86.0) y="12" { "too bright" }
                @for share in [-1.0, -0.5, -0.1, 0.1, 0.5, 1.0] {
                    text x=(format!("{:.1}", 80.0 + 0.5 * WIDTH * (1.0 + share))) y="28" class="m" {
                        (format!("{:+.0} %", share * 100.0 * f64::from(ERROR_SCALE)))
                    }
                }
            }
        }
    }
}
