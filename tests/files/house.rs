//! The house: which file may know which, how many a pass takes to follow, and how long files are.

use antumbra_tests::example::root;
use antumbra_tests::headers::entry;
use antumbra_tests::permutations::modules;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Every Rust file under a folder, relative to the repository.
fn rust_files(folder: &str) -> Vec<PathBuf> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{folder:?}: {e}"));
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() && !path.ends_with("target") {
                walk(&path, found);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    walk(&root().join(folder), &mut found);
    found.sort();
    found.iter().map(|path| path.strip_prefix(root()).unwrap().into()).collect()
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path:?}: {e}"))
}

/// A file's code: no comments, and nothing from its unit tests on, which stand at the end.
fn code(path: &Path) -> String {
    let all = text(path);
    let product = all.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let no_comment = |line: &str| line.split("//").next().unwrap_or_default().to_owned();
    product.lines().map(|line| no_comment(line) + "\n").collect()
}

fn is_test(path: &Path) -> bool {
    let name = path.to_string_lossy();
    name.contains("/tests/") || name.ends_with("tests.rs")
}

/// The paths that a `use` tree names, each in full.
fn flatten(prefix: &str, tree: &str, found: &mut Vec<String>) {
    let tree = tree.trim();
    let Some(open) = tree.find('{') else {
        let path = tree.split(" as ").next().unwrap_or_default().trim();
        let path = path.strip_suffix("::self").unwrap_or(path);
        found.push(match path {
            "self" => prefix.trim_end_matches("::").to_owned(),
            path => format!("{prefix}{path}"),
        });
        return;
    };
    let inner = &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())];
    let prefix = format!("{prefix}{}", &tree[..open]);
    let (mut depth, mut start) = (0, 0);
    for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !inner[start..at].trim().is_empty() {
                    flatten(&prefix, &inner[start..at], found);
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}

/// The module of a file of the library, as path segments.
fn module_of(path: &Path) -> Vec<String> {
    let inside = path.strip_prefix("src").unwrap().with_extension("");
    let mut parts: Vec<String> =
        inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if matches!(parts.last().map(String::as_str), Some("mod" | "lib")) {
        parts.pop();
    }
    parts
}

/// The files of the library that each file imports from. What a module only passes on (`pub use`) counts as the file
/// that has it.
fn imports() -> BTreeMap<PathBuf, BTreeSet<PathBuf>> {
    let files: Vec<PathBuf> = rust_files("src").into_iter().filter(|f| !is_test(f)).collect();
    let by_module: BTreeMap<Vec<String>, PathBuf> =
        files.iter().map(|file| (module_of(file), file.clone())).collect();
    let uses: BTreeMap<&PathBuf, Vec<(bool, Vec<String>)>> =
        files.iter().map(|file| (file, uses_of(file))).collect();
    // The file that a path leads to: the deepest module on it, or where that passes the name on to.
    let resolve = |path: &[String]| -> Option<PathBuf> {
        let mut path = path.to_vec();
        for _ in 0..8 {
            let depth = (0..=path.len()).rev().find(|&n| by_module.contains_key(&path[..n]))?;
            let file = &by_module[&path[..depth]];
            let Some(name) = path.get(depth) else { return Some(file.clone()) };
            let passed_on = uses[file].iter().find(|(public, used)| {
                *public && used.last() == Some(name) && !used.starts_with(&path[..=depth])
            });
            match passed_on {
                Some((_, used)) => path.clone_from(used),
                None => return Some(file.clone()),
            }
        }
        None
    };
    files
        .iter()
        .map(|file| {
            let to = uses[file].iter().filter(|(public, _)| !public || file.ends_with("lib.rs"));
            let to = to.filter_map(|(_, path)| resolve(path)).filter(|to| to != file);
            (file.clone(), to.collect())
        })
        .collect()
}

/// The paths that a file imports, from the crate's root on, and whether it only passes them on.
fn uses_of(file: &Path) -> Vec<(bool, Vec<String>)> {
    let own = module_of(file);
    let code = code(file);
    let mut found = Vec::new();
    // Paths in code that no `use` brings.
    for (at, _) in code.match_indices("crate::") {
        if !code[..at].trim_end().ends_with("use") {
            let path = code[at..].split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':');
            let path = path.map(|p| p.trim_end_matches(':')).next().unwrap_or_default();
            found.push((false, path.split("::").skip(1).map(str::to_owned).collect()));
        }
    }
    let statements = code.split(';').filter_map(|s| {
        let at = s.rfind("use ")?;
        let before = s[..at].lines().last().unwrap_or_default().trim();
        let is_use = before.is_empty() || before.starts_with("pub");
        is_use.then(|| (before.starts_with("pub"), s[at + 4..].to_owned()))
    });
    for (public, tree) in statements {
        let mut paths = Vec::new();
        flatten("", &tree.replace(char::is_whitespace, " "), &mut paths);
        for path in paths {
            let path = path.replace(' ', "");
            let mut parts: Vec<String> = path.split("::").map(str::to_owned).collect();
            let first = parts.remove(0);
            let base = match first.as_str() {
                "crate" => Vec::new(),
                "self" => own.clone(),
                "super" => own[..own.len().saturating_sub(1)].to_vec(),
                // A module of this one.
                name if root().join(file).with_file_name(format!("{name}.rs")).exists()
                    || root().join(file).with_file_name(name).is_dir() =>
                {
                    [own.clone(), vec![name.to_owned()]].concat()
                }
                _ => continue,
            };
            let mut base = base;
            while parts.first().is_some_and(|p| p == "super") {
                base.pop();
                parts.remove(0);
            }
            found.push((public, [base, parts].concat()));
        }
    }
    found
}

/// The files on a circle of imports, each group once.
fn circles(imports: &BTreeMap<PathBuf, BTreeSet<PathBuf>>) -> Vec<BTreeSet<PathBuf>> {
    let reach = |from: &PathBuf| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(file) = next.pop() {
            for to in imports.get(file).into_iter().flatten() {
                if seen.insert(to.clone()) {
                    next.push(to);
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&PathBuf, BTreeSet<PathBuf>> =
        imports.keys().map(|file| (file, reach(file))).collect();
    let mut found: Vec<BTreeSet<PathBuf>> = Vec::new();
    for (file, all) in &reached {
        if all.contains(*file) && !found.iter().any(|circle| circle.contains(*file)) {
            let back = |to: &&PathBuf| reached.get(*to).is_some_and(|a| a.contains(*file));
            found.push(all.iter().filter(back).cloned().collect());
        }
    }
    found
}

#[test]
fn no_file_of_the_library_imports_itself_through_others() {
    let imports = imports();
    assert!(imports.values().map(BTreeSet::len).sum::<usize>() > 300, "imports are found");
    let circles = circles(&imports);
    assert!(circles.is_empty(), "{circles:#?}");
}

#[test]
fn a_circle_is_found_and_a_line_is_none() {
    let file = |name: &str| PathBuf::from(name);
    let arrows = |pairs: &[(&str, &str)]| {
        let mut imports: BTreeMap<PathBuf, BTreeSet<PathBuf>> = BTreeMap::new();
        for (from, to) in pairs {
            imports.entry(file(from)).or_default().insert(file(to));
            imports.entry(file(to)).or_default();
        }
        imports
    };
    assert!(circles(&arrows(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
    let found = circles(&arrows(&[("a", "b"), ("b", "c"), ("c", "b")]));
    assert_eq!(found, [BTreeSet::from([file("b"), file("c")])]);
    let mut paths = Vec::new();
    flatten("", "crate::{a, b::{self, C}, d as e}", &mut paths);
    assert_eq!(paths, ["crate::a", "crate::b", "crate::b::C", "crate::d"]);
}

fn rooms() -> Vec<String> {
    let folder = root().join("src/techniques");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let names = entries.filter(|path| path.is_dir());
    let names = names.map(|path| path.file_name().unwrap().to_string_lossy().into_owned());
    names.filter(|name| name != "common").collect()
}

/// `Technique::Pcss` and the like stand where techniques are listed and in their rooms: everything else queries the
/// value.
#[test]
fn no_technique_is_named_outside_its_room() {
    let named = |line: &str| {
        line.match_indices("Technique::").any(|(at, found)| {
            line[at + found.len()..].starts_with(|c: char| c.is_uppercase())
                && !line[at + found.len()..].starts_with("NAMES")
        })
    };
    assert!(named("a == Technique::Pcss") && !named("Technique::NAMES, Technique::all()"));
    let mut found = Vec::new();
    for file in rust_files("src") {
        let is_home = file == Path::new("src/technique.rs") || file.starts_with("src/techniques");
        for (nth, line) in text(&file).lines().enumerate().filter(|_| !is_home) {
            if named(line) {
                found.push(format!("{}:{}: {}", file.display(), nth + 1, line.trim()));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn no_room_names_another() {
    let rooms = rooms();
    assert!(rooms.len() >= 8, "{rooms:?}");
    let mut found = Vec::new();
    for room in &rooms {
        for file in rust_files(&format!("src/techniques/{room}")) {
            for (nth, line) in code(&file).lines().enumerate() {
                let other = rooms.iter().filter(|other| *other != room).find(|other| {
                    line.contains(&format!("techniques::{other}"))
                        || line.contains(&format!("super::super::{other}"))
                        || (line.starts_with("use super::")
                            && line.contains(&format!("super::{other}::")))
                });
                found.extend(other.map(|other| format!("{}:{}: {other}", file.display(), nth + 1)));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// More lines than this are too many to read at once.
const LONGEST: usize = 400;

#[test]
fn no_file_is_long() {
    let mut found = Vec::new();
    for folder in ["src", "tests", "benches", "examples", "harness"] {
        for file in rust_files(folder) {
            let lines = text(&file).lines().count();
            if lines > LONGEST {
                found.push(format!("{}: {lines} lines", file.display()));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn unsafe_code_stands_where_vulkan_is_called() {
    let mut found = Vec::new();
    for file in rust_files("src").iter().filter(|file| !file.starts_with("src/gpu")) {
        for (nth, line) in code(file).lines().enumerate() {
            if line.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe") {
                found.push(format!("{}:{}: {}", file.display(), nth + 1, line.trim()));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// A pass is followed in at most so many files: its shaders with all that they include, the Rust file that declares it
/// with its push struct and bindings, and what that imports from its own room.
const FILES_A_PASS: usize = 9;

/// The Rust files of its own room that a file imports, and those that they import.
fn of_its_room(file: &Path, imports: &BTreeMap<PathBuf, BTreeSet<PathBuf>>) -> BTreeSet<PathBuf> {
    let room = file.parent().unwrap();
    let (mut found, mut next) = (BTreeSet::from([file.to_owned()]), vec![file.to_owned()]);
    while let Some(file) = next.pop() {
        for to in imports.get(&file).into_iter().flatten().filter(|to| to.starts_with(room)) {
            if found.insert(to.clone()) {
                next.push(to.clone());
            }
        }
    }
    found
}

#[test]
fn a_pass_is_followed_in_few_files() {
    let imports = imports();
    // A raster's vertices and fragments are one pass; of a compute pass each permutation is followed by itself.
    let mut passes: BTreeMap<(String, String), BTreeSet<PathBuf>> = BTreeMap::new();
    for module in modules().into_iter().filter(|m| !m.name.starts_with("headless/")) {
        let entry = entry(&module.file).unwrap();
        let shared = !module.file.ends_with(".comp");
        let which = if shared { String::new() } else { module.name.clone() };
        let glsl = module.compile().included.into_iter().chain([module.file.clone()]);
        let mut files: BTreeSet<PathBuf> = glsl.map(|name| Path::new("glsl").join(name)).collect();
        let declared_in = Path::new(&entry.declared_in);
        assert!(imports.contains_key(declared_in), "glsl/{} names {declared_in:?}", module.file);
        files.extend(of_its_room(declared_in, &imports));
        for pass in entry.passes {
            passes.entry((pass, which.clone())).or_default().extend(files.clone());
        }
    }
    assert!(passes.len() > 50, "{} passes", passes.len());
    // What looks opacity textures up is the same in every pass, and followed once.
    let is_once = |file: &&PathBuf| {
        file.starts_with("glsl/cut_outs") || file.ends_with("glsl/hierarchy/cut.glsl")
    };
    let count = |files: &BTreeSet<PathBuf>| files.iter().filter(|file| !is_once(file)).count();
    let many: Vec<_> = passes.iter().filter(|(_, files)| count(files) > FILES_A_PASS).collect();
    assert!(many.is_empty(), "more than {FILES_A_PASS} files:\n{many:#?}");
}
