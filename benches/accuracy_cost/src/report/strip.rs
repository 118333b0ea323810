//! The picture strip: scene by technique, and where each is wrong.

use super::{Report, ms, once};
use crate::groups::MATRIX;
use crate::picture::{self, ERROR_SCALE, Pictures};
use crate::plot::escape;
use crate::store::Row;
use crate::techniques::CURVES;

/// The rows that stand for their technique, of one scene, in the order of the curves.
fn shown<'a>(report: &'a Report, scene: &str) -> Vec<&'a Row> {
    let of = |curve: &crate::techniques::Curve| {
        let (words, _) = curve.steps.get(curve.shown?)?;
        report.study(MATRIX).find(|r| {
            let light = r.light != "small" && r.light != "large";
            let same = r.curve == curve.label && r.settings == *words;
            light && same && r.scene == scene && r.mean().is_some()
        })
    };
    CURVES.iter().filter_map(of).collect()
}

/// The strip as a table.
pub fn strip(report: &Report) -> String {
    let pictures = Pictures::new(report.cache);
    let scenes = once(report.study(MATRIX).map(|r| r.scene.as_str()));
    let strips: Vec<_> = scenes.iter().map(|s| (*s, shown(report, s))).collect();
    let labels = once(strips.iter().flat_map(|s| &s.1).map(|r| r.curve.as_str()));
    let settings = |label: &str| {
        let row = strips.iter().flat_map(|s| &s.1).find(|r| r.curve == label);
        row.map_or("", |r| r.settings.as_str())
    };
    let mut out =
        String::from("<div class=\"wide\"><table class=\"strip\"><tr><th></th><th>truth</th>");
    for label in &labels {
        let words = escape(settings(label));
        out.push_str(&format!("<th>{}<br><small>{words}</small></th>", escape(label)));
    }
    out.push_str("</tr>\n");
    let image = |scene: &str, name: &str| {
        let alt = escape(&format!("{scene}, {name}"));
        let url = pictures.url(scene, name);
        url.map_or_else(String::new, |url| format!("<img src=\"{url}\" alt=\"{alt}\">"))
    };
    for (scene, rows) in &strips {
        let truth = image(scene, picture::TRUTH);
        if truth.is_empty() {
            continue;
        }
        out.push_str(&format!("<tr><th class=\"scene\">{}</th><td>{truth}</td>", escape(scene)));
        for label in &labels {
            let Some(row) = rows.iter().find(|r| r.curve == *label) else {
                out.push_str("<td></td>");
                continue;
            };
            out.push_str(&format!(
                "<td>{}<br>{}<br><small>{:.1} %, {} ms</small></td>",
                image(scene, label),
                image(scene, &picture::error_of(label)),
                100.0 * row.mean().unwrap_or_default(),
                ms(row.ms().unwrap_or_default())
            ));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</table></div>\n");
    out + &scale()
}

/// The color bar of the errors.
fn scale() -> String {
    const STEPS: u16 = 80;
    const WIDTH: f64 = 320.0;
    let mut out = format!(
        "<p><svg width=\"{0}\" height=\"34\" font-size=\"11.5\" role=\"img\"><title>colors of the \
         error</title>",
        WIDTH + 160.0
    );
    let step = WIDTH / f64::from(STEPS);
    for i in 0..STEPS {
        let error = (f32::from(i) + 0.5) / f32::from(STEPS) * 2.0 - 1.0;
        let [r, g, b] = picture::color(error * ERROR_SCALE);
        let x = 80.0 + f64::from(i) * step;
        out.push_str(&format!(
            "<rect x=\"{x:.2}\" y=\"2\" width=\"{:.2}\" height=\"12\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>",
            step + 0.3
        ));
    }
    out.push_str("<text x=\"74\" y=\"12\" class=\"e\">too dark</text>");
    out.push_str(&format!("<text x=\"{}\" y=\"12\">too bright</text>", WIDTH + 86.0));
    for share in [-1.0, -0.5, -0.1, 0.1, 0.5, 1.0] {
        let x = 80.0 + 0.5 * WIDTH * (1.0 + share);
        let percent = share * 100.0 * f64::from(ERROR_SCALE);
        out.push_str(&format!("<text x=\"{x:.1}\" y=\"28\" class=\"m\">{percent:+.0} %</text>"));
    }
    out + "</svg></p>\n"
}
