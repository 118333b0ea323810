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

/// The strip as a table: a column a scene, and for each technique its pictures over their errors, so
/// that one look along a row judges a technique and one down a column a scene.
pub fn strip(report: &Report) -> String {
    let pictures = Pictures::new(report.cache);
    let image = |scene: &str, name: &str| {
        let alt = escape(&format!("{scene}, {name}"));
        Some(format!("<img src=\"{}\" alt=\"{alt}\">", pictures.url(scene, name)?))
    };
    let scenes = once(report.study(MATRIX).map(|r| r.scene.as_str()));
    let strips: Vec<(&str, String, Vec<&Row>)> = scenes
        .into_iter()
        .filter_map(|s| Some((s, image(s, picture::TRUTH)?, shown(report, s))))
        .collect();
    let mut out = String::from("<div class=\"wide\"><table class=\"strip\">\n<tr><th></th>");
    for (scene, ..) in &strips {
        out += &format!("<th>{}</th>", escape(scene));
    }
    out += "</tr>\n<tr><th>truth</th>";
    for (_, truth, _) in &strips {
        out += &format!("<td>{truth}</td>");
    }
    out += "</tr>\n";
    let rows: Vec<&Row> = strips.iter().flat_map(|s| s.2.iter().copied()).collect();
    for label in once(rows.iter().map(|r| r.curve.as_str())) {
        let settings = rows.iter().find(|r| r.curve == label).map_or("", |r| &r.settings);
        out += &format!("<tr><th>{}<br><small>{}</small></th>", escape(label), escape(settings));
        for (scene, _, shown) in &strips {
            let Some(row) = shown.iter().find(|r| r.curve == label) else {
                out += "<td></td>";
                continue;
            };
            out += &format!(
                "<td>{}<br>{}<br><small>{:.1} %, {} ms</small></td>",
                image(scene, label).unwrap_or_default(),
                image(scene, &picture::error_of(label)).unwrap_or_default(),
                100.0 * row.mean().unwrap_or_default(),
                ms(row.ms().unwrap_or_default())
            );
        }
        out += "</tr>\n";
    }
    out += "</table></div>\n";
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
