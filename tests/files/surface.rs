//! The public surface: `surface.txt` lists what hosts can name, so that a change of it is seen.
//!
//! `ANTUMBRA_WRITE_SURFACE=1 cargo test --workspace --test files surface` writes the list anew.

use antumbra_tests::example::root;
use std::path::{Path, PathBuf};

/// The list, beside this file.
fn list_path() -> PathBuf {
    root().join("tests/files/surface.txt")
}

/// The lines of a file with its comments gone, and each item of several lines in one.
fn statements(text: &str) -> Vec<String> {
    let product = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let mut found: Vec<String> = Vec::new();
    let mut open = false;
    for line in product.lines() {
        let comment = line.trim_start().starts_with("//");
        if comment || line.trim().is_empty() {
            continue;
        }
        match found.last_mut() {
            Some(last) if open => {
                last.push(' ');
                last.push_str(line.trim());
            }
            _ => found.push(line.to_owned()),
        }
        let whole = found.last().map_or("", String::as_str);
        // A signature ends at its body, a declaration at its semicolon, a member at its comma.
        let begins = whole.trim_start().starts_with("pub ") || whole.starts_with("impl");
        let balanced = whole.matches(['(', '<']).count() <= whole.matches([')', '>']).count();
        open =
            begins && !(whole.ends_with(['{', ';']) || (whole.ends_with([',', '}']) && balanced));
    }
    found
}

/// A signature without its body, its spaces as one line has them.
fn tidy(statement: &str) -> String {
    let head = statement.trim().trim_end_matches(['{', ',', ';']).trim_end();
    let words: Vec<&str> = head.split_whitespace().collect();
    words.join(" ").replace("( ", "(").replace(", )", ")").replace(" )", ")")
}

/// What a file adds to the surface of its module.
fn list(module: &str, text: &str, found: &mut Vec<String>) {
    // The type whose members or methods come, and whether they are public without saying so.
    let (mut inside, mut members) = (String::new(), false);
    for statement in statements(text) {
        let depth = statement.len() - statement.trim_start().len();
        let item = statement.trim();
        if depth == 0 {
            let named = |prefix: &str| {
                let rest = item.strip_prefix(prefix)?;
                Some(rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()?.to_owned())
            };
            let of_type = item.strip_prefix("impl").map(|rest| {
                let rest = rest.trim_start().split(" where ").next().unwrap_or_default();
                // Generics of the block, if any.
                let rest = if rest.starts_with('<') {
                    rest.split_once("> ").map_or(rest, |r| r.1)
                } else {
                    rest
                };
                rest.trim_end_matches('{').trim().to_owned()
            });
            members = item.starts_with("pub enum") || item.starts_with("pub trait");
            inside = match of_type {
                Some(name) if !name.contains(" for ") => name,
                Some(_) => String::new(),
                None => named("pub struct ")
                    .or_else(|| named("pub enum "))
                    .or_else(|| named("pub trait "))
                    .unwrap_or_default(),
            };
            if item.starts_with("pub ") && !item.starts_with("pub mod ") {
                found.push(format!("{module} {}", tidy(item)));
            }
        } else if depth == 4 && !inside.is_empty() && !item.starts_with(['#', '}', ')']) {
            let own = item.starts_with("pub ") || (members && !item.starts_with("pub("));
            if own {
                found.push(format!("{module} {inside}: {}", tidy(item)));
            }
        }
    }
}

/// Follows the public modules of a file that are not hidden.
fn follow(module: &str, file: &Path, found: &mut Vec<String>) {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    list(module, &text, found);
    let stem = file.file_stem().unwrap().to_string_lossy().into_owned();
    let folder = match stem.as_str() {
        "mod" | "lib" => file.parent().unwrap().to_owned(),
        stem => file.with_file_name(stem),
    };
    let lines: Vec<&str> = text.lines().collect();
    for (nth, line) in lines.iter().enumerate() {
        let Some(name) = line.strip_prefix("pub mod ").and_then(|rest| rest.strip_suffix(';'))
        else {
            continue;
        };
        if nth > 0 && lines[nth - 1] == "#[doc(hidden)]" {
            continue;
        }
        let paths = [folder.join(format!("{name}.rs")), folder.join(name).join("mod.rs")];
        let path = paths.iter().find(|path| path.exists()).unwrap_or_else(|| panic!("{name}"));
        follow(&format!("{module}::{name}"), path, found);
    }
}

/// What is re-exported stands in files whose modules are private: each `pub use` names it, and its file is listed too.
fn surface() -> Vec<String> {
    let mut found = Vec::new();
    follow("antumbra", &root().join("src/lib.rs"), &mut found);
    for (module, files) in [
        ("antumbra::frame", "accesses draws doubts make passes plan plans"),
        ("antumbra::gpu", "host layouts memory record retired"),
        ("antumbra::graph", "access barrier pass plan resource show sync2 why"),
        ("antumbra::auto", "budget candidates choice choose costs features table"),
        ("antumbra::effects", "omit rules situation verdicts"),
    ] {
        for name in files.split(' ') {
            let path = root().join(format!("src/{}/{name}.rs", &module["antumbra::".len()..]));
            let text = std::fs::read_to_string(&path)
                .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            list(module, &text, &mut found);
        }
    }
    for path in ["src/node/shown.rs", "src/light/shape.rs", "src/plain.rs"] {
        let text =
            std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"));
        list("antumbra", &text, &mut found);
    }
    for entry in std::fs::read_dir(root().join("src/techniques")).unwrap().map(Result::unwrap) {
        let path = entry.path().join("settings.rs");
        if path.exists() {
            let room = entry.file_name().to_string_lossy().into_owned();
            let text = std::fs::read_to_string(&path).unwrap();
            list(&format!("antumbra::settings::{room}"), &text, &mut found);
        }
    }
    found.sort();
    found.dedup();
    found
}

#[test]
fn the_surface_is_the_one_that_is_listed() {
    let now = surface();
    assert!(now.len() > 300, "{} items", now.len());
    if std::env::var("ANTUMBRA_WRITE_SURFACE").is_ok_and(|value| value == "1") {
        std::fs::write(list_path(), now.join("\n") + "\n").unwrap();
    }
    let listed = std::fs::read_to_string(list_path()).unwrap_or_default();
    let listed: Vec<&str> = listed.lines().collect();
    let gone: Vec<String> =
        listed.iter().filter(|l| !now.iter().any(|n| n == *l)).map(|l| format!("- {l}")).collect();
    let new: Vec<String> =
        now.iter().filter(|n| !listed.contains(&n.as_str())).map(|n| format!("+ {n}")).collect();
    assert!(
        gone.is_empty() && new.is_empty(),
        "the public surface is not the one in tests/files/surface.txt:\n{}\nif that is meant, run\n\
         ANTUMBRA_WRITE_SURFACE=1 cargo test --workspace --test files surface, and tell hosts in CHANGELOG.md",
        [gone, new].concat().join("\n")
    );
}

#[test]
fn items_members_and_methods_are_listed_and_private_ones_are_not() {
    let text = "/// A doc.\npub struct A {\n    /// Seen.\n    pub b: u32,\n    c: u32,\n}\n\nimpl A {\n    \
                pub fn long(\n        &self,\n        x: u32,\n    ) -> u32 {\n        x\n    }\n\n    fn hidden(&self) {}\n}\n\n\
                pub enum E {\n    F,\n    G { h: u32 },\n}\n\npub(crate) fn inner() {}\n";
    let mut found = Vec::new();
    list("m", text, &mut found);
    assert_eq!(
        found,
        [
            "m pub struct A",
            "m A: pub b: u32",
            "m A: pub fn long(&self, x: u32) -> u32",
            "m pub enum E",
            "m E: F",
            "m E: G { h: u32 }"
        ]
    );
}
