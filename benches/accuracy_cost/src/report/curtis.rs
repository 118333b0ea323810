//! Tables 4.1 to 4.4 of Curtis 2009 as they are there, and the kinds of levels of its section 5.1.

use super::strip::image;
use super::tables::{found, head_of, row_of, unmeasured};
use super::{Report, ms, once};
use crate::curtis::{self, MAPS, RAYS, SCREENS, VERSIONS, Version};
use crate::picture::{self, Pictures};
use crate::scenes::CUBE;
use crate::store::Row;
use crate::sweeps;
use crate::techniques::{FORWARD, value_of};
use antumbra::stages::nbuffer::{Kind, Levels};
use antumbra_harness::levels::{BUILD, bytes, ms as sum_of, tightness};
use maud::{Markup, html};

/// Frames a second of tables 4.1 to 4.4: of each of the paper's versions, for 2×2 and 3×3 rays, by a table's columns.
const PUBLISHED: [[[[u32; 3]; 2]; 3]; 4] = [
    [[[46, 40, 28], [37, 34, 21]], [[30, 26, 18], [18, 16, 12]], [[25, 18, 15], [12, 11, 10]]],
    [[[70, 50, 35], [60, 45, 31]], [[66, 47, 34], [50, 44, 30]], [[36, 32, 23], [25, 22, 17]]],
    [[[45, 40, 32], [40, 34, 22]], [[33, 26, 19], [20, 16, 12]], [[27, 18, 14], [17, 11, 8]]],
    [[[74, 50, 41], [61, 45, 34]], [[70, 47, 41], [49, 44, 35]], [[41, 32, 23], [31, 22, 15]]],
];

/// A table of the paper.
struct Table {
    /// Its place among tables 4.1 to 4.4.
    index: usize,
    /// Whether its scene is the cube; the dragon otherwise.
    cube: bool,
    /// Whether its columns are sizes of the screen; of the map otherwise.
    screens: bool,
}

impl Table {
    fn new(index: usize) -> Self {
        Self { index, cube: index % 2 == 1, screens: index >= 2 }
    }

    fn title(&self) -> String {
        let scene = if self.cube { "elongated cube" } else { "dragon" };
        let (what, other) = match self.screens {
            true => ("screen", "512×512 texels"),
            false => ("map", "1024×768 pixels"),
        };
        format!("Table 4.{}: {what} resolution, {scene}, {other}", self.index + 1)
    }

    /// A column's map and screen.
    fn column(&self, i: usize) -> (u32, [u32; 2]) {
        if self.screens { (MAPS[1], SCREENS[i]) } else { (MAPS[i], SCREENS[1]) }
    }

    fn html(&self, report: &Report) -> Markup {
        let own: Vec<&Row> =
            report.study(curtis::STUDY).filter(|r| (r.scene == CUBE) == self.cube).collect();
        let found = |i: usize, version: &Version, rays: u32| {
            let (map, extent) = self.column(i);
            let wanted = |row: &&&Row| {
                row.curve == version.name
                    && row.extent == extent
                    && value_of(&row.settings, "rays") == Some(f64::from(rays))
                    && row.x == f64::from(map)
            };
            own.iter().find(wanted).copied()
        };
        let columns = [0, 1, 2].map(|i| {
            let (map, [width, height]) = self.column(i);
            if self.screens { format!("{width}×{height}") } else { format!("{map}×{map}") }
        });
        html! {
            h3 { (self.title()) }
            @if let Some(first) = own.first() {
                @if first.scene == curtis::STAND_IN {
                    p.part {
                        "The dragon was not fetched (" code { "benches/fetch_dragon.sh" } " does it): the bunny stands \
                         in for it, under another light."
                    }
                }
                p { small { (first.scene) ", " (first.triangles) " triangles." } }
                table.n {
                    (head_of(["search", "rays", "deferred"].into_iter().chain(columns.iter().map(String::as_str))))
                    @for (v, version) in VERSIONS.iter().enumerate() {
                        @for (r, rays) in RAYS.iter().enumerate() {
                            tr {
                                td { (version.name) } td { (rays.isqrt()) "×" (rays.isqrt()) }
                                td { @if version.technique == FORWARD { "no" } @else { "yes" } }
                                @for i in 0..3 {
                                    td { (cell(found(i, version, *rays), PUBLISHED[self.index].get(v).map(|fps| fps[r][i]))) }
                                }
                            }
                        }
                    }
                }
            } @else {
                p.open { "Not measured in this run." }
            }
        }
    }
}

/// Time and error here, and the paper's frames a second.
fn cell(row: Option<&Row>, then: Option<u32>) -> Markup {
    html! {
        @match row.map(|r| (r, r.measured())) {
            None => i { "not measured" },
            Some((_, Some((errors, times)))) => {
                b { (ms(times.frame_ms[1])) } " ms, " (format!("{:.2}", 100.0 * errors.summary.mean_abs_error)) " %"
            }
            Some((row, None)) => (unmeasured(row)),
        }
        @if let Some(fps) = then { " " small { "(" (fps) " fps)" } }
    }
}

/// Figures 4.1 and 4.2: the truth and each version, 3×3 rays, with what is wrong below.
fn figures(report: &Report) -> Markup {
    let pictures = Pictures::new(report.cache);
    let image = |scene: &str, name: &str| image(&pictures, scene, name);
    let truth = |scene: &'_ str| Some((scene.to_string(), image(scene, picture::TRUTH)?));
    let scenes = once(report.study(curtis::STUDY).map(|r| r.scene.as_str()));
    let scenes: Vec<_> = scenes.into_iter().filter_map(truth).collect();
    html! {
        @if !scenes.is_empty() {
            div.wide {
                table.strip.figure {
                    (head_of(std::iter::once("truth").chain(VERSIONS.iter().map(|v| v.name))))
                    @for (scene, truth) in &scenes {
                        tr {
                            td { (truth) br; (scene) }
                            @for Version { name, .. } in &VERSIONS {
                                td {
                                    @if let Some(seen) = image(scene, name) { (seen) }
                                    br;
                                    @if let Some(wrong) = image(scene, &picture::error_of(name)) { (wrong) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The four tables, and the pictures that belong to them.
pub fn tables(report: &Report) -> Markup {
    html! {
        p {
            "Time of a frame and mean error here; in brackets the paper's frames a second, on a GPU of 2009. Its \
             versions have two layers (hierarchical) and three (linear), jittered rays and a hash of MD5; the last two \
             rows are what the node does unasked, and those above them what compares with “no”. Where deferred is \
             “no”, every fragment that passes the depth test when it is drawn sends rays, whatever is drawn over it \
             later; there is no filter then, and drawing the scene is in the time, where the others' G-buffer is not. \
             Models and lights are as near as the text tells."
        }
        @for finding in &curtis::findings(report.rows) { (found(finding)) }
        (figures(report))
        @for index in 0..PUBLISHED.len() { (Table::new(index).html(report)) }
    }
}

/// Memory, time and tightness of the kinds of levels.
pub fn levels(report: &Report) -> Markup {
    let tight: Vec<f64> = Kind::ALL.iter().map(|kind| tightness(*kind)).collect();
    let cells = |row: &Row| {
        let nth = Kind::ALL.iter().position(|kind| kind.name() == row.curve)?;
        let (kind, (errors, times)) = (&Kind::ALL[nth], row.measured()?);
        let name = kind.name();
        let passes = || times.passes.iter().map(|(name, ms)| (name.as_str(), *ms));
        let [build, classify, trace] =
            [&BUILD[..], &["classify"], &["trace"]].map(|names| sum_of(passes(), names));
        let levels = Levels { map: row.x as u32, kind: *kind };
        let (mb, sum) = (bytes(levels) as f64 / 1e6, build + classify + trace);
        let first = [row.scene.clone(), levels.map.to_string(), name.into(), format!("{mb:.1}")];
        let last = [tight[nth], 100.0 * errors.summary.mean_abs_error].map(|v| format!("{v:.2}"));
        Some(first.into_iter().chain([build, classify, trace, sum].map(ms)).chain(last))
    };
    html! {
        p {
            "The windows of the hierarchical search: memory, ms to make them, ms of classification and rays, and how \
             many texels they hold for each that is asked for (windows of 1 to 24 texels). The rays are the same, and \
             stopped alike; how high, from which the filter's width follows, is told by the window that stopped them, \
             so that errors differ a little. N-buffers have shaders of their own, without the branches of the others: \
             what compares without that is classification."
        }
        table.n {
            (head_of(["scene", "N", "levels", "MB", "build", "classify", "trace", "sum", "held", "mean %"]))
            @for row in report.study(sweeps::LEVELS) {
                @if let Some(cells) = cells(row) { (row_of(cells)) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::with;
    use super::*;
    use crate::store::Outcome;
    use crate::store::tests::row;

    #[test]
    fn a_row_stands_in_each_table_that_has_it() {
        let mut middle = row("hierarchical", 512.0, 123.0, 0.0321);
        middle.study = curtis::STUDY.into();
        middle.scene = CUBE.into();
        middle.extent = SCREENS[1];
        middle.settings = "rays=9 map=512".into();
        let page = with(&[middle.clone()], tables).into_string();
        // 512² at 1024×768 stands in tables 4.2 and 4.4.
        assert_eq!(page.matches("<b>123</b> ms, 3.21 % <small>(45 fps)</small>").count(), 2);
        assert!(page.contains("Not measured in this run"));
        middle.scene = curtis::STAND_IN.into();
        let page = with(&[middle], tables).into_string();
        assert_eq!(page.matches("was not fetched").count(), 2);
    }

    #[test]
    fn levels_are_told_with_their_memory() {
        let mut one = row("mip", 256.0, 5.0, 0.01);
        one.study = sweeps::LEVELS.into();
        let Outcome::Measured { times, .. } = &mut one.outcome else { unreachable!() };
        let pass = |name: &str, ms| (format!("ray_march.{name}"), ms);
        times.passes = vec![pass("level", 3.0), pass("trace", 4.0)];
        let page = with(&[one], levels).into_string();
        assert!(page.contains("<td>3.00</td><td>0.00</td><td>4.00</td><td>7.00</td>"), "{page}");
        // A mip's windows hold more than a search wants; 1.00 are the others'.
        assert!(tightness(Kind::NBuffer) == 1.0 && tightness(Kind::Thirds) == 1.0);
        assert!((2.0..9.0).contains(&tightness(Kind::Mip)), "{}", tightness(Kind::Mip));
    }
}
