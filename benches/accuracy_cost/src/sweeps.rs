//! The sweeps that reproduce the figures of Atty 2006 and Eisemann 2008's table, the kinds of levels, and
//! a technique that is wrong on purpose.

use crate::groups::{Against, Entry, Group, Stage};
use crate::options::Scale;
use crate::scenes::SceneSpec;
use crate::scenes::Source;
use antumbra::stages::nbuffer::Kind;
use glam::DVec3;

/// Error and time against N: Atty 2006 Figs. 17 and 22.
pub const SIDE: &str = "occluder map";
/// Error and time against the light: Atty 2006 Figs. 18 and 24.
pub const LIGHT: &str = "light size";
/// Error against the lateral position: Atty 2006 Fig. 19.
pub const LATERAL: &str = "lateral position";
/// Error against the vertical position: Atty 2006 Fig. 20.
pub const VERTICAL: &str = "vertical position";
/// Time against polygons: Atty 2006 Fig. 21.
pub const POLYGONS: &str = "polygons";
/// A light 10 % too big, handed to the node and not to the truth.
pub const WRONG: &str = "wrong on purpose";
/// Kinds of levels of ray marching: Curtis 2009 section 5.1.
pub const LEVELS: &str = "kinds of levels";
/// Eisemann 2008 Figure 2's table.
pub const EISEMANN: &str = "Eisemann 2008";

/// Beyond it, the light in [`WRONG`].
pub const WRONG_SCALE: f64 = 1.1;

/// One and two sides.
pub const SIDES: [(&str, &str); 2] = [("one side", "sides=one"), ("two sides", "sides=two")];

/// The height of an object's centre where [`VERTICAL`] is 0, and of the light.
const OBJECT_HEIGHT: f64 = 2.0;

fn entry(curve: &str, words: String, x: f64) -> Entry {
    Entry::new("soft-shadow-map", curve, words, x)
}

/// The objects of the sweeps: what they are called here and in `scenes::made`.
fn models(scale: &Scale) -> &'static [&'static str] {
    // The paper's third is a Buddha; a box on the ground shows what the others cannot.
    if scale.quick { &["card", "bunny"] } else { &["card", "bunny", "suzanne", "tall box"] }
}

fn group(scale: &Scale, study: &'static str, model: &'static str, light: f64) -> Group {
    Group {
        study,
        scene: model.into(),
        light: format!("{light} m"),
        stage: Stage::Moved { model, light, by: DVec3::ZERO, half: 2.6, reach: 0.0 },
        extent: [scale.grid; 2],
        against: if model == "card" { Against::Card } else { Against::Traced },
        at: None,
        entries: Vec::new(),
    }
}

/// From `from` to `to` in so many steps.
fn steps(from: f64, to: f64, count: u32) -> impl Iterator<Item = f64> {
    // Rounded, so that a value has few digits.
    let at = move |i| from + (to - from) * f64::from(i) / f64::from(count);
    (0..=count).map(move |i| (at(i) * 1000.0).round() / 1000.0)
}

/// One and two sides; N = 128 is what the paper's Figs. 18 to 20 have.
fn both_sides(map: u32, x: f64) -> Vec<Entry> {
    SIDES.iter().map(|(name, sides)| entry(name, format!("{sides} map={map}"), x)).collect()
}

/// Every sweep but [`wrong`] and [`eisemann`], in the report's order.
pub fn all(scale: &Scale) -> Vec<Group> {
    let mut groups = Vec::new();
    for model in models(scale) {
        groups.push(side(scale, model));
        groups.extend(light(scale, model));
        groups.extend(moved(scale, model));
    }
    groups.extend(polygons(scale));
    groups.extend(levels(scale));
    groups
}

/// The right light and one 10 % too big, on the card, whose truth has no noise.
pub fn wrong(scale: &Scale) -> Group {
    let right = entry("right", "map=256".into(), 1.0);
    let wrong = Entry {
        light_scale: WRONG_SCALE,
        x: WRONG_SCALE,
        curve: "light 10 % too big".into(),
        ..right.clone()
    };
    Group { entries: vec![right, wrong], ..group(scale, WRONG, "card", 0.4) }
}

fn side(scale: &Scale, model: &'static str) -> Group {
    // Sides that are no powers of two, as in the paper, and whose step is not near a whole number of
    // the texels that the card covers (0.673 N): its spikes would else be a slow wave.
    let every = if scale.quick { 20 } else { 10 };
    let sides = (40..=400).step_by(every);
    let entries = sides.flat_map(|n: u32| {
        SIDES.iter().map(move |(name, words)| entry(name, format!("{words} map={n}"), f64::from(n)))
    });
    Group { entries: entries.collect(), ..group(scale, SIDE, model, 0.4) }
}

/// The side of the light in metres, from next to none to as large as the object and beyond.
fn light(scale: &Scale, model: &'static str) -> Vec<Group> {
    let sides: &[f64] = if scale.quick {
        &[0.01, 0.1, 0.4, 1.0, 2.0]
    } else {
        &[0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0, 1.3, 1.6, 2.0]
    };
    let group = |&light: &f64| {
        let mut entries = both_sides(128, light);
        for n in [64, 256] {
            entries.push(entry(&format!("N = {n}"), format!("sides=two map={n}"), light));
        }
        Group { at: Some(light), entries, ..group(scale, LIGHT, model, light) }
    };
    sides.iter().map(group).collect()
}

fn moved(scale: &Scale, model: &'static str) -> Vec<Group> {
    if model == "tall box" {
        // It stands on the ground; the sweeps are of what floats.
        return Vec::new();
    }
    let count = if scale.quick { 4 } else { 12 };
    let mut groups = Vec::new();
    let mut push = |study, by: DVec3, reach, entries, at| {
        let stage = Stage::Moved { model, light: 0.4, by, half: 3.8, reach };
        groups.push(Group { stage, at: Some(at), entries, ..group(scale, study, model, 0.4) });
    };
    // One window for all places, as of a camera that stays; it is 2.6 times as wide as the others',
    // and so is the map in texels, which keeps a texel's size what it is elsewhere.
    const ASIDE: f64 = 1.2;
    for x in steps(-ASIDE, ASIDE, count) {
        push(LATERAL, DVec3::X * x, ASIDE, both_sides(336, x), x);
    }
    // From next to the ground to next to the light, which the object's half height limits.
    let low = if model == "card" { 0.05 } else { 0.5 };
    for y in steps(low, 4.0 - low, count) {
        push(VERTICAL, DVec3::Y * (y - OBJECT_HEIGHT), 0.0, both_sides(128, y), y);
    }
    groups
}

fn polygons(scale: &Scale) -> Vec<Group> {
    let rows: &[u32] =
        if scale.quick { &[22, 70, 150, 220] } else { &[22, 70, 110, 150, 220, 300, 410] };
    let group = |&rows: &u32| {
        // 2 · segments · (rings − 1) triangles.
        let triangles = f64::from(2 * (rows + 1) * (rows - 1));
        Group {
            scene: "sphere".into(),
            stage: Stage::Sphere(rows),
            at: Some(triangles),
            entries: vec![entry("two sides", "sides=two map=128".into(), triangles)],
            ..group(scale, POLYGONS, "bunny", 0.4)
        }
    };
    rows.iter().map(group).collect()
}

/// Kinds of levels at several map sizes, on a solid and on what has many edges.
fn levels(scale: &Scale) -> Vec<Group> {
    let (models, maps): (&[&str], &[u32]) = if scale.quick {
        (&["bunny"], &[256, 512])
    } else {
        (&["bunny", "foliage"], &[256, 512, 1024])
    };
    let group = |&model: &&'static str| {
        let entries = maps.iter().flat_map(|map| {
            Kind::NAMES.iter().map(move |kind| Entry {
                technique: "ray-march",
                ..entry(kind, format!("levels={kind} map={map}"), f64::from(*map))
            })
        });
        let extent = [3 * scale.grid; 2];
        Group { extent, entries: entries.collect(), ..group(scale, LEVELS, model, 0.4) }
    };
    models.iter().map(group).collect()
}

/// Three prefilters at three map sizes, of one texture of four slices.
pub fn eisemann() -> Group {
    let prefilters = ["mip", "sat", "n-buffer"].into_iter();
    let entry = |(prefilter, map): (&str, u32)| {
        let words = "slices=4 combine=product placement=uniform";
        let words = format!("{words} prefilter={prefilter} map={map}");
        Entry::new("occlusion-textures", prefilter, words, f64::from(map))
    };
    let entries = prefilters.flat_map(|p| [256, 512, 1024].map(|map| (p, map))).map(entry);
    let spec = SceneSpec { name: "foliage".into(), source: Source::Made("foliage") };
    Group::seen(EISEMANN, &spec, "medium", [512, 384], entries.collect())
}
