//! What Curtis 2009 measures in chapter 4: its two scenes, its versions of ray marching, and what
//! tables 4.1 to 4.4 vary.

use crate::findings::{Finding, Verdict};
use crate::groups::{Entry, Group};
use crate::options::Scale;
use crate::scenes::{self, CUBE, DRAGON, SceneSpec, Source};
use crate::stats::range;
use crate::store::Row;
use crate::techniques::{FORWARD, value_of};

/// The study's name.
pub const STUDY: &str = "Curtis 2009";
/// The scene of tables 4.1 and 4.3, where it was not.
pub const STAND_IN: &str = "bunny in the dragon's place";
/// The light of both, as large as the objects: the paper shows wide penumbrae.
const LIGHT: &str = "large";

/// One of the versions that are compared.
pub struct Version {
    /// Its curve's name, and how the report's tables call it.
    pub name: &'static str,
    /// As on a command line.
    pub technique: &'static str,
    /// The settings, but for rays and map.
    words: &'static str,
}

/// The paper's, with its jittered cells and its hash, in its order; then what compares with the second, and
/// the node's defaults. The hierarchical search has two layers there and the linear one three (its chapter
/// 4). At fragments there is no filter.
pub const VERSIONS: [Version; 5] = [
    version("hierarchical", "ray-march", "search=hierarchical layers=2 sampling=jittered hash=md5"),
    version("hierarchical, at fragments", FORWARD, UNFILTERED),
    version("linear/binary", "ray-march", "search=linear layers=3 sampling=jittered hash=md5"),
    version("hierarchical, unfiltered", "ray-march", UNFILTERED),
    version("the node's defaults", "ray-march", ""),
];

const UNFILTERED: &str = "search=hierarchical layers=2 sampling=jittered hash=md5 filter=off";

const fn version(name: &'static str, technique: &'static str, words: &'static str) -> Version {
    Version { name, technique, words }
}

/// Rays a pixel: 2×2 and 3×3.
pub const RAYS: [u32; 2] = [4, 9];
/// Tables 4.1 and 4.2 vary the map at the second of [`SCREENS`].
pub const MAPS: [u32; 3] = [256, 512, 1024];
/// Tables 4.3 and 4.4 vary the screen with the second of [`MAPS`].
pub const SCREENS: [[u32; 2]; 3] = [[800, 600], [1024, 768], [1280, 1024]];

/// Both scenes under their lights, the cube first: a quick run has room for one.
fn both() -> [(SceneSpec, &'static str); 2] {
    let spec = |name: &str, source| SceneSpec { name: name.into(), source };
    let dragon = if scenes::dragon_path().exists() {
        (spec(DRAGON, Source::Made(DRAGON)), LIGHT)
    } else {
        (spec(STAND_IN, Source::Committed("bunny")), "medium")
    };
    [(spec(CUBE, Source::Made(CUBE)), LIGHT), dragon]
}

/// The rows of a screen: all maps or one. With `shown` pictures are kept of the most rays.
fn entries(maps: &[u32], shown: bool) -> Vec<Entry> {
    let mut all = Vec::new();
    for version in &VERSIONS {
        for rays in RAYS {
            all.extend(maps.iter().map(|map| {
                let words = format!("{} rays={rays} map={map}", version.words);
                let words = words.trim_start().into();
                let entry = Entry::new(version.technique, version.name, words, f64::from(*map));
                Entry { shown: shown && rays == RAYS[1], ..entry }
            }));
        }
    }
    all
}

/// A group a scene and screen.
pub fn groups(scale: &Scale) -> Vec<Group> {
    let mut groups = Vec::new();
    for (spec, light) in both() {
        for extent in SCREENS {
            let maps = if extent == SCREENS[1] { &MAPS[..] } else { &MAPS[1..2] };
            let entries = entries(maps, extent == SCREENS[0]);
            let group = Group::seen(STUDY, &spec, light, extent, entries);
            groups.push(Group { at: Some(f64::from(extent[0])), ..group });
        }
    }
    groups.truncate(if scale.quick { 1 } else { groups.len() });
    groups
}

/// Times of one version over those of another, for all that both have and `keep` accepts: least and largest.
fn ratios(
    rows: &[Row],
    [over, under]: [&str; 2],
    keep: impl Fn(&Row) -> bool,
    pair: impl Fn(&Row, &Row) -> bool,
) -> Option<[f64; 2]> {
    let of = |curve: &str| -> Vec<&Row> {
        let mine = |r: &&Row| r.study == STUDY && r.curve == curve && keep(r);
        rows.iter().filter(mine).collect()
    };
    let (over, under) = (of(over), of(under));
    let all = over.iter().flat_map(|a| {
        let others = under.iter().filter(|b| a.scene == b.scene && pair(a, b));
        others.filter_map(|b| Some(a.ms()? / b.ms()?)).collect::<Vec<f64>>()
    });
    range(all)
}

/// Whether two rows have the same pixels, rays and map.
fn alike(a: &Row, b: &Row) -> bool {
    a.extent == b.extent && a.x == b.x && same_rays(a, b)
}

fn same_rays(a: &Row, b: &Row) -> bool {
    value_of(&a.settings, "rays") == value_of(&b.settings, "rays")
}

/// What section 4.2 says of its tables, and whether it holds here.
pub fn findings(rows: &[Row]) -> Vec<Finding> {
    let [hierarchical, forward, linear, unfiltered, _] = VERSIONS.map(|v| v.name);
    let cube = |r: &Row| r.scene == CUBE;
    let finding = |figure, claim, measured: Option<(bool, String)>| {
        let (verdict, sentence) = match measured {
            None => (Verdict::Unmeasured, "not measured".into()),
            Some((true, sentence)) => (Verdict::Holds, sentence),
            Some((false, sentence)) => (Verdict::Refuted, sentence),
        };
        Finding { figure, claim, verdict, sentence }
    };
    let searches = ratios(rows, [linear, hierarchical], |_| true, alike).map(|[least, most]| {
        (
            least > 1.0,
            format!("linear takes {least:.1} to {most:.1} times as long; 1.5 to 3.1 there"),
        )
    });
    let of = |keep: fn(&Row, bool) -> bool, is_cube| {
        ratios(rows, [forward, unfiltered], |r| keep(r, is_cube), alike)
    };
    let kept: fn(&Row, bool) -> bool = |r, is_cube| (r.scene == CUBE) == is_cube;
    let forward = of(kept, false).zip(of(kept, true)).map(|([d0, d1], [c0, c1])| {
        let sentence = format!(
            "at fragments the dragon takes {d0:.2} to {d1:.2} times as long, the cube {c0:.2} to {c1:.2} \
             times; 1.4 to 2.1 and 1.0 to 1.2 there"
        );
        (d0 + d1 > c0 + c1, sentence)
    });
    let grown = |a: &Row, b: &Row| same_rays(a, b) && a.extent == b.extent && a.x == 4.0 * b.x;
    let growth = |version| ratios(rows, [version; 2], cube, grown);
    let sensitive = growth(hierarchical).zip(growth(linear)).map(|([h0, h1], [l0, l1])| {
        let sentence = format!(
            "from 256² to 1024² the cube takes {h0:.1} to {h1:.1} times as long by it, {l0:.1} to {l1:.1} by \
             the linear search; 1.9 to 2.0 and 1.5 to 1.6 there"
        );
        (h0 + h1 > l0 + l1, sentence)
    });
    vec![
        finding("4.1–4.4", "The hierarchical search is the faster one throughout.", searches),
        finding("4.1–4.4", "Deferred shading gains more in complex scenes.", forward),
        finding("4.2", "Hierarchical search is more sensitive to the map's resolution.", sensitive),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_compare_what_is_alike() {
        let row = |curve: &str, scene: &str, map: f64, ms| {
            let mut row = crate::store::tests::row(curve, map, ms, 0.01);
            (row.study, row.scene) = (STUDY.into(), scene.into());
            row.settings = format!("rays=4 map={map}");
            row
        };
        let [hierarchical, forward, linear, unfiltered, _] = VERSIONS.map(|v| v.name);
        let rows = [
            row(hierarchical, CUBE, 256.0, 10.0),
            row(hierarchical, CUBE, 1024.0, 30.0),
            row(linear, CUBE, 256.0, 20.0),
            row(linear, CUBE, 1024.0, 40.0),
            row(forward, CUBE, 256.0, 10.0),
            row(unfiltered, CUBE, 256.0, 10.0),
            row(forward, DRAGON, 256.0, 30.0),
            row(unfiltered, DRAGON, 256.0, 10.0),
        ];
        let all = findings(&rows);
        assert!(all.iter().all(|f| f.verdict == Verdict::Holds), "{all:?}");
        assert!(all[0].sentence.contains("1.3 to 2.0"), "{}", all[0].sentence);
        assert!(
            all[1].sentence.contains("3.00 to 3.00") && all[1].sentence.contains("1.00 to 1.00")
        );
        assert!(findings(&rows[..1]).iter().all(|f| f.verdict == Verdict::Unmeasured));
        let slow = [row(hierarchical, CUBE, 256.0, 30.0), row(linear, CUBE, 256.0, 20.0)];
        assert_eq!(findings(&slow)[0].verdict, Verdict::Refuted);
    }

    #[test]
    fn the_tables_are_complete() {
        let groups = groups(&crate::options::FULL);
        assert_eq!(groups.len(), 6);
        let count =
            |extent: [u32; 2]| groups.iter().find(|g| g.extent == extent).unwrap().entries.len();
        assert_eq!(count(SCREENS[1]), 3 * count(SCREENS[0]));
    }
}
