//! Tables 4.1 to 4.4 of Curtis 2009 as they are there, and the kinds of levels of its section 5.1.

use super::tables::{found, row_of};
use super::{Report, ms, once};
use crate::curtis::{self, MAPS, RAYS, SCREENS, VERSIONS, Version};
use crate::levels::{BUILD, bytes, ms as sum_of, tightness};
use crate::picture::{self, Pictures};
use crate::plot::escape;
use crate::scenes::CUBE;
use crate::store::{Outcome, Row};
use crate::sweeps;
use crate::techniques::{FORWARD, value_of};
use antumbra::stages::nbuffer::{Kind, Levels};

/// A table of the paper.
struct Table {
    number: &'static str,
    title: &'static str,
    /// The cube's or the dragon's.
    cube: bool,
    /// Over the screen's sizes instead of the map's.
    screens: bool,
    /// Frames a second of each of the paper's versions, for 2×2 and 3×3 rays.
    published: [[[u32; 3]; 2]; 3],
}

const TABLES: [Table; 4] = [
    Table {
        number: "4.1",
        title: "map resolution, dragon, 1024×768 pixels",
        cube: false,
        screens: false,
        published: [
            [[46, 40, 28], [37, 34, 21]],
            [[30, 26, 18], [18, 16, 12]],
            [[25, 18, 15], [12, 11, 10]],
        ],
    },
    Table {
        number: "4.2",
        title: "map resolution, elongated cube, 1024×768 pixels",
        cube: true,
        screens: false,
        published: [
            [[70, 50, 35], [60, 45, 31]],
            [[66, 47, 34], [50, 44, 30]],
            [[36, 32, 23], [25, 22, 17]],
        ],
    },
    Table {
        number: "4.3",
        title: "screen resolution, dragon, 512×512 texels",
        cube: false,
        screens: true,
        published: [
            [[45, 40, 32], [40, 34, 22]],
            [[33, 26, 19], [20, 16, 12]],
            [[27, 18, 14], [17, 11, 8]],
        ],
    },
    Table {
        number: "4.4",
        title: "screen resolution, elongated cube, 512×512 texels",
        cube: true,
        screens: true,
        published: [
            [[74, 50, 41], [61, 45, 34]],
            [[70, 47, 41], [49, 44, 35]],
            [[41, 32, 23], [31, 22, 15]],
        ],
    },
];

impl Table {
    /// A column's map and screen.
    fn column(&self, i: usize) -> (u32, [u32; 2]) {
        if self.screens { (MAPS[1], SCREENS[i]) } else { (MAPS[i], SCREENS[1]) }
    }

    fn html(&self, report: &Report) -> String {
        let own: Vec<&Row> =
            report.study(curtis::STUDY).filter(|r| (r.scene == CUBE) == self.cube).collect();
        let mut out = format!("<h3>Table {}: {}</h3>\n", self.number, self.title);
        let Some(first) = own.first() else {
            return out + "<p class=\"open\">Not measured in this run.</p>\n";
        };
        if first.scene == curtis::STAND_IN {
            out += "<p class=\"part\">The dragon was not fetched \
                    (<code>benches/fetch_dragon.sh</code> does it): the bunny stands in \
                    for it, under another light.</p>\n";
        }
        let triangles = first.triangles;
        out += &format!("<p><small>{}, {triangles} triangles.</small></p>\n", escape(&first.scene));
        out += "<table class=\"n\">";
        let columns = (0..3).map(|i| {
            let (map, [width, height]) = self.column(i);
            if self.screens { format!("{width}×{height}") } else { format!("{map}×{map}") }
        });
        let head = ["search", "rays", "deferred"].map(String::from).into_iter();
        out += &row_of(head.chain(columns), "th");
        for (v, version) in VERSIONS.iter().enumerate() {
            for (r, rays) in RAYS.iter().enumerate() {
                let cells = (0..3).map(|i| {
                    let (map, extent) = self.column(i);
                    let wanted = |row: &&&Row| {
                        row.curve == version.name
                            && row.extent == extent
                            && value_of(&row.settings, "rays") == Some(f64::from(*rays))
                            && row.x == f64::from(map)
                    };
                    let then = self.published.get(v).map(|fps| fps[r][i]);
                    cell(own.iter().find(wanted).copied(), then)
                });
                let side = rays.isqrt();
                let deferred = if version.technique == FORWARD { "no" } else { "yes" };
                let first = [version.name.into(), format!("{side}×{side}"), deferred.into()];
                out += &row_of(first.into_iter().chain(cells), "td");
            }
        }
        out + "</table>\n"
    }
}

/// Time and error here, and the paper's frames a second.
fn cell(row: Option<&Row>, then: Option<u32>) -> String {
    let here = match row.map(|r| &r.outcome) {
        None => "<i>not measured</i>".into(),
        Some(Outcome::Measured { errors, times }) => {
            format!("<b>{}</b> ms, {:.2} %", ms(times.frame_ms[1]), 100.0 * errors.mean_abs_error)
        }
        Some(Outcome::NotThere) => "<i>not there yet</i>".into(),
        Some(Outcome::Failed(why)) => format!("failed: {}", escape(why)),
    };
    then.map_or(here.clone(), |fps| format!("{here} <small>({fps} fps)</small>"))
}

/// Figures 4.1 and 4.2: the truth and each version, 3×3 rays, with what is wrong below.
fn figures(report: &Report) -> String {
    let pictures = Pictures::new(report.cache);
    let image = |scene: &str, name: &str| {
        let url = pictures.url(scene, name)?;
        Some(format!("<img src=\"{url}\" alt=\"{}\">", escape(&format!("{scene}, {name}"))))
    };
    let mut out = String::from("<div class=\"wide\"><table class=\"strip figure\">\n");
    let names = VERSIONS.iter().map(|v| v.name);
    out += &row_of(std::iter::once("truth").chain(names).map(String::from), "th");
    let mut any = false;
    for scene in once(report.study(curtis::STUDY).map(|r| r.scene.as_str())) {
        let Some(truth) = image(scene, picture::TRUTH) else { continue };
        any = true;
        let of = |v: &Version| {
            let [seen, wrong] = [v.name.to_string(), picture::error_of(v.name)]
                .map(|name| image(scene, &name).unwrap_or_default());
            format!("{seen}<br>{wrong}")
        };
        let first = format!("{truth}<br>{}", escape(scene));
        out += &row_of(std::iter::once(first).chain(VERSIONS.iter().map(of)), "td");
    }
    if any { out + "</table></div>\n" } else { String::new() }
}

/// The four tables, and the pictures that belong to them.
pub fn tables(report: &Report) -> String {
    let intro = "<p>Time of a frame and mean error here; in brackets the paper's frames a second, on a \
                 GPU of 2009. Its versions have two layers (hierarchical) and three (linear), jittered \
                 rays and a hash of MD5; the last two rows are what the node does unasked, and those above them what compares with \u{201c}no\u{201d}. Where deferred \
                 is \u{201c}no\u{201d}, every fragment that passes the depth test when it is drawn sends rays, \
                 whatever is drawn over it later; there is no filter then, and drawing the scene is in the \
                 time, where the others' G-buffer is not. Models and lights are as near as the text \
                 tells.</p>\n";
    let found: String = curtis::findings(report.rows).iter().map(found).collect();
    let start = intro.to_string() + &found + &figures(report);
    TABLES.iter().fold(start, |out, table| out + &table.html(report))
}

/// Memory, time and tightness of the kinds of levels.
pub fn levels(report: &Report) -> String {
    let mut out = String::from(
        "<p>The windows of the hierarchical search: memory, ms to make them, ms of classification and \
         rays, and how many texels they hold for each that is asked for (windows of 1 to 24 texels). The \
         rays are the same, and stopped alike; how high, from which the filter's width follows, is told \
         by the window that stopped them, so that errors differ a little. N-buffers have shaders of \
         their own, without the branches of the others: what compares without that is \
         classification.</p>\n<table class=\"n\">",
    );
    let head =
        ["scene", "N", "levels", "MB", "build", "classify", "trace", "sum", "held", "mean %"];
    out += &row_of(head.map(String::from), "th");
    let tight: Vec<f64> = Kind::ALL.iter().map(|(_, kind)| tightness(*kind)).collect();
    for row in report.study(sweeps::LEVELS) {
        let Some(nth) = Kind::ALL.iter().position(|(name, _)| *name == row.curve) else { continue };
        let Some((errors, times)) = row.measured() else { continue };
        let passes = || times.passes.iter().map(|(name, ms)| (name.as_str(), *ms));
        let [build, classify, trace] =
            [&BUILD[..], &["classify"], &["trace"]].map(|names| sum_of(passes(), names));
        let levels = Levels { map: row.x as u32, kind: Kind::ALL[nth].1 };
        out += &row_of(
            [
                escape(&row.scene),
                levels.map.to_string(),
                row.curve.clone(),
                format!("{:.1}", bytes(levels) as f64 / 1e6),
                ms(build),
                ms(classify),
                ms(trace),
                ms(build + classify + trace),
                format!("{:.2}", tight[nth]),
                format!("{:.2}", 100.0 * errors.mean_abs_error),
            ],
            "td",
        );
    }
    out + "</table>\n"
}

#[cfg(test)]
mod tests {
    use super::super::tests::with;
    use super::*;
    use crate::store::tests::row;

    #[test]
    fn a_row_stands_in_each_table_that_has_it() {
        let mut middle = row("hierarchical", 512.0, 123.0, 0.0321);
        middle.study = curtis::STUDY.into();
        middle.scene = CUBE.into();
        middle.extent = SCREENS[1];
        middle.settings = "rays=9 map=512".into();
        let page = with(&[middle.clone()], tables);
        // 512² at 1024×768 stands in tables 4.2 and 4.4.
        assert_eq!(page.matches("<b>123</b> ms, 3.21 % <small>(45 fps)</small>").count(), 2);
        assert!(page.contains("Not measured in this run"));
        middle.scene = curtis::STAND_IN.into();
        let page = with(&[middle], tables);
        assert_eq!(page.matches("was not fetched").count(), 2);
    }

    #[test]
    fn levels_are_told_with_their_memory() {
        let mut one = row("mip", 256.0, 5.0, 0.01);
        one.study = sweeps::LEVELS.into();
        let Outcome::Measured { times, .. } = &mut one.outcome else { unreachable!() };
        let pass = |name: &str, ms| (format!("ray_march.{name}"), ms);
        times.passes = vec![pass("level", 3.0), pass("trace", 4.0)];
        let page = with(&[one], levels);
        assert!(page.contains("<td>3.00</td><td>0.00</td><td>4.00</td><td>7.00</td>"), "{page}");
        // A mip's windows hold more than was asked for; 1.00 are the others'.
        assert!(tightness(Kind::NBuffer) == 1.0 && tightness(Kind::Thirds) == 1.0);
        assert!((2.0..9.0).contains(&tightness(Kind::Mip)), "{}", tightness(Kind::Mip));
    }
}
