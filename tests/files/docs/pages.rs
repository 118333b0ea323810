//! README and docs: short enough, no dead link, no command that there is not, tables as the code has them.

use super::{metadata, root};
use antumbra::Technique;
use antumbra::scene::from_gltf_bytes;
use base64::{Engine, prelude::BASE64_STANDARD};
use glam::DVec3;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// README and the pages of docs/, by their paths from the root, with their texts.
fn pages() -> Vec<(PathBuf, String)> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> =
        docs.filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    paths.push(root().join("README.md"));
    assert!(paths.len() > 8, "{paths:?}");
    paths.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

fn page(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap()
}

#[test]
fn the_readme_is_one_page() {
    let readme = page("README.md");
    let lines = readme.lines().count();
    assert!(lines <= 150, "{lines} lines");
    for (number, line) in (1..).zip(readme.lines()) {
        let columns = line.chars().count();
        assert!(columns <= 120, "line {number} has {columns} columns");
    }
}

/// The targets of a page's links.
fn links(text: &str) -> Vec<&str> {
    text.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect()
}

/// The name by which a heading is linked to.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    let kept = kept.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Whether a page has a heading of that name.
fn has_heading(text: &str, name: &str) -> bool {
    text.lines().filter_map(|l| l.strip_prefix('#')).any(|l| anchor(l.trim_matches('#')) == name)
}

#[test]
fn links_lead_somewhere() {
    let mut found = 0;
    for (path, text) in pages() {
        let folder = path.parent().unwrap();
        for link in links(&text).into_iter().filter(|link| !link.contains("://")) {
            found += 1;
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { path.clone() } else { folder.join(file) };
            assert!(target.exists(), "{} links to {link}", path.display());
            if !heading.is_empty() {
                let there = fs::read_to_string(&target).unwrap();
                assert!(has_heading(&there, heading), "{} links to {link}", path.display());
            }
        }
    }
    assert!(found > 30, "{found} links");
    assert_eq!(links("a [b](c.md) and [d](e.md#f)"), ["c.md", "e.md#f"]);
    assert!(has_heading("# A\n## What a `b` is\n", "what-a-b-is") && !has_heading("# A\n", "b"));
}

/// What of the text behind a word is a name, such as that of a target.
fn names<'a>(text: &'a str, word: &str) -> Vec<&'a str> {
    let name =
        |rest: &'a str| rest.split(|c: char| !c.is_alphanumeric() && !"_-".contains(c)).next();
    let names = text.split(word).skip(1).filter_map(name);
    // In capitals stands what the reader fills in.
    names.filter(|name| name.chars().any(|c| c.is_lowercase())).collect()
}

#[test]
fn commands_are_there() {
    let makefile = page("Makefile");
    let has_rule = |name: &str| {
        let rule = |l: &str| l.split(':').next().unwrap_or("").split(' ').any(|word| word == name);
        makefile.lines().any(|l| !l.starts_with(['\t', '#']) && l.contains(':') && rule(l))
    };
    let metadata = metadata();
    let members = metadata["workspace_members"].as_array().unwrap();
    let has_target = |kind: &str, name: &str| {
        let packages = metadata["packages"].as_array().unwrap();
        let own = packages.iter().filter(|package| members.contains(&package["id"]));
        let mut targets = own.flat_map(|package| package["targets"].as_array().unwrap());
        targets.any(|t| t["name"] == name && t["kind"].as_array().unwrap().contains(&json!(kind)))
    };
    assert!(has_rule("demo") && !has_rule("demonstration") && !has_rule("CARGO"));
    assert!(has_target("bench", "accuracy_cost") && !has_target("test", "accuracy_cost"));
    let mut found = 0;
    for (path, text) in pages() {
        // In code a command begins a line or a pair of backquotes.
        let commands = [names(&text, "`make "), names(&text, "\nmake ")].concat();
        for name in commands {
            found += 1;
            assert!(has_rule(name), "{} says make {name}", path.display());
        }
        for (kind, option) in
            [("bench", "--bench "), ("test", "--test "), ("example", "--example ")]
        {
            for name in names(&text, option) {
                found += 1;
                assert!(has_target(kind, name), "{} says {option}{name}", path.display());
            }
        }
    }
    assert!(found > 30, "{found} commands");
    assert_eq!(names("run `make demo` or `make F`", "`make "), ["demo"]);
}

/// The rows of the table whose head begins so, as they are written.
fn rows(page: &str, head: &str) -> Vec<String> {
    let lines = page.lines().skip_while(|l| !l.starts_with(head)).skip(2);
    lines.take_while(|l| l.starts_with('|')).map(str::to_owned).collect()
}

/// The files of each walk are there, and few.
#[test]
fn the_walks_of_architecture_are_short() {
    let rows = rows(&page("docs/architecture.md"), "| pass | files |");
    assert_eq!(rows.len(), Technique::NAMES.len(), "one a technique");
    for row in rows {
        let mut words = row.split('`').skip(1).step_by(2);
        let (pass, files) = (words.next().unwrap(), words.collect::<Vec<_>>());
        assert!((5..=9).contains(&files.len()), "{pass}: {} files", files.len());
        let mut named = false;
        for file in files {
            let text = fs::read_to_string(root().join(file));
            let text = text.unwrap_or_else(|e| panic!("{pass}: {file}: {e}"));
            named |= text.contains(&format!("\"{pass}\""));
        }
        assert!(named, "no file of its walk names {pass}");
    }
}

/// The light of README's scene shines down, from where it says.
#[test]
fn the_readmes_light_is_one() {
    let readme = page("README.md");
    let (_, rest) = readme.split_once("```json\n").unwrap();
    let node: Value = serde_json::from_str(rest.split("```").next().unwrap()).unwrap();
    // Beside a triangle, without which nothing is a scene.
    let corners = [[0.0f32; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let bytes = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes));
    let scene = json!({
        "asset": { "version": "2.0" },
        "nodes": [node, { "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "byteLength": 36, "uri": bytes }],
    });
    let scene = scene.to_string();
    let scene = from_gltf_bytes(scene.as_bytes(), Path::new("README.md")).unwrap();
    let light = *scene.light(Some("lamp")).unwrap().light.rectangle();
    assert!(light.emission().abs_diff_eq(DVec3::NEG_Y, 1e-6), "{}", light.emission());
    assert!(light.center().abs_diff_eq(DVec3::Y * 3.0, 1e-6), "{}", light.center());
    let [a, b] = light.half_extents();
    assert!((a - 0.4).abs() < 1e-6 && (b - 0.2).abs() < 1e-6, "{a} {b}");
}

/// What `auto` knows of one choice of settings in one view, from its table.
struct Measured {
    view: String,
    technique: String,
    settings: String,
    /// In percent.
    error: f64,
    ms: f64,
}

fn measured() -> Vec<Measured> {
    let table = page("src/auto/table.csv");
    let of = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |at: usize| cells[at].parse::<f64>().unwrap();
        Measured {
            view: format!("{} | {}", cells[0], cells[1]),
            technique: cells[10].into(),
            settings: cells[11].into(),
            error: 100.0 * number(12),
            ms: number(14) + number(15),
        }
    };
    // Behind the names of the columns and the probe.
    table.lines().skip(2).map(of).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

fn ms(ms: f64) -> String {
    if ms >= 100.0 { format!("{ms:.0}") } else { format!("{ms:.1}") }
}

/// The values in the order in which they first come.
fn once<'a>(values: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut once = Vec::new();
    for value in values {
        if !once.contains(&value) {
            once.push(value);
        }
    }
    once
}

#[test]
fn the_tables_of_accuracy_are_autos() {
    let (accuracy, readme) = (page("docs/accuracy.md"), page("README.md"));
    let all = measured();
    let views = once(all.iter().map(|m| m.view.as_str()));
    assert_eq!(views.len(), 36);
    let techniques = once(all.iter().map(|m| m.technique.as_str()));
    for name in &techniques {
        let own = || all.iter().filter(|m| m.technique == **name);
        for settings in once(own().map(|m| m.settings.as_str())) {
            let these = || own().filter(|m| m.settings == settings);
            let errors: Vec<f64> = these().map(|m| m.error).collect();
            let times: Vec<f64> = these().map(|m| m.ms).collect();
            let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
            let (worst, slowest) = (most(&errors), most(&times));
            let (error, time) = (median(errors), median(times));
            let row = format!(
                "| `{name}` | {settings} | {error:.1} | {worst:.1} | {} | {} |",
                ms(time),
                ms(slowest)
            );
            assert!(accuracy.contains(&row), "docs/accuracy.md lacks this row:\n{row}");
            let plain: Technique = name.parse().unwrap();
            if format!("{name} {settings}").parse::<Technique>().unwrap() == plain {
                let cells = format!(" | {error:.1}, {worst:.1} | {time:.0} | ");
                let row = readme.lines().find(|l| l.starts_with(&format!("| `{name}` |")));
                assert!(row.unwrap().contains(&cells), "README's {name} lacks{cells}");
            }
        }
    }
    for view in views {
        let cell = |name: &&str| {
            let here = || all.iter().filter(|m| m.view == view && m.technique == **name);
            let fastest = |goal: f64| {
                let good = here().filter(|m| m.error <= goal).map(|m| m.ms);
                good.min_by(f64::total_cmp)
            };
            let times = [5.0, 3.0, 2.0].map(fastest);
            if times == [None; 3] {
                return "never".to_owned();
            }
            times.map(|t| t.map_or_else(|| "never".into(), ms)).join(" / ")
        };
        let cells: Vec<String> = techniques.iter().map(cell).collect();
        let row = format!("| {view} | {} |", cells.join(" | "));
        assert!(accuracy.contains(&row), "docs/accuracy.md lacks this row:\n{row}");
    }
}
