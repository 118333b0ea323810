//! What a fifth technique takes: one folder and two lines. A copy of the library gets a sketch of one, is built, and
//! renders by it.
//!
//! A program of its own, because it builds another library; it runs once, on the best device.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra_tests::compile::{to_bytes, try_compile};
use antumbra_tests::example::{folder, root};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is copied of the project.
const COPIED: [&str; 6] = ["src", "spirv", "docs", "harness", "README.md", "Cargo.lock"];

/// The two lines: where, behind which line, and what.
const LINES: [(&str, &str, &str); 2] = [
    ("src/techniques/mod.rs", "pub mod common;", "pub mod half;"),
    ("src/technique.rs", "    LinearLight(linear_light),", "    Half(half),"),
];

fn copy(from: &Path, to: &Path) {
    if from.is_dir() {
        fs::create_dir_all(to).unwrap();
        for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
            copy(&entry.path(), &to.join(entry.file_name()));
        }
    } else {
        fs::copy(from, to).unwrap_or_else(|e| panic!("{}: {e}", from.display()));
    }
}

/// Every file under a folder with its lines.
fn lines(folder: &Path) -> BTreeMap<PathBuf, Vec<String>> {
    let mut found = BTreeMap::new();
    let mut next = vec![folder.to_owned()];
    while let Some(at) = next.pop() {
        for path in fs::read_dir(&at).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                next.push(path);
            } else if let Ok(text) = fs::read_to_string(&path) {
                let name = path.strip_prefix(folder).unwrap().to_owned();
                found.insert(name, text.lines().map(str::to_owned).collect());
            }
        }
    }
    found
}

/// The workspace of the copy: library and harness, built as the project builds them.
fn manifest() -> String {
    let text = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let (head, tail) = text.split_once("[workspace]").unwrap();
    let (_, tail) = tail.split_once("resolver = ").unwrap();
    let members = "[workspace]\nmembers = [\".\", \"harness\"]\nresolver = ";
    let (before, rest) = tail.split_once("[dev-dependencies]").unwrap();
    // Examples and benches stay behind, and so does what they alone depend on.
    let (_, lints) = rest.split_once("[lints]").unwrap();
    // One small image needs no optimized library.
    let lints =
        lints.replace("package.antumbra]\nopt-level = 2", "package.antumbra]\nopt-level = 0");
    format!("{head}{members}{before}[lints]{lints}")
}

#[test]
fn a_fifth_technique_is_a_folder_and_two_lines() {
    let copied = folder("fifth");
    for name in COPIED {
        copy(&root().join(name), &copied.join(name));
    }
    fs::write(copied.join("Cargo.toml"), manifest()).unwrap();
    let sketch = root().join("tests/fifth");
    let before = lines(&copied.join("src"));

    // One folder, of Rust and of GLSL with what it compiles to.
    for file in ["mod.rs", "settings.rs"] {
        let room = copied.join("src/techniques/half");
        fs::create_dir_all(&room).unwrap();
        copy(&sketch.join("half").join(file), &room.join(file));
    }
    let source = fs::read_to_string(sketch.join("half/half.comp")).unwrap();
    fs::create_dir_all(copied.join("spirv/half")).unwrap();
    let module = to_bytes(&try_compile("half.comp", &source).unwrap());
    fs::write(copied.join("spirv/half/half.comp.spv"), module).unwrap();
    // And two lines.
    for (file, behind, line) in LINES {
        let path = copied.join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(text.matches(&format!("{behind}\n")).count(), 1, "{file}: {behind}");
        fs::write(&path, text.replace(behind, &format!("{behind}\n{line}"))).unwrap();
    }

    let after = lines(&copied.join("src"));
    let mut added = 0;
    for (file, now) in &after {
        match before.get(file) {
            None => assert!(file.starts_with("techniques/half"), "{}", file.display()),
            Some(was) => {
                added += now.len() - was.len();
                assert!(was.iter().all(|line| now.contains(line)), "{}", file.display());
            }
        }
    }
    assert_eq!(added, 2);

    fs::create_dir_all(copied.join("harness/examples")).unwrap();
    copy(&sketch.join("host/half.rs"), &copied.join("harness/examples/half.rs"));
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let output = Command::new(cargo)
        .args(["run", "--quiet", "-p", "antumbra-harness", "--example", "half"])
        .current_dir(&copied)
        // Dependencies are those that the project has built.
        .env("CARGO_TARGET_DIR", root().join("target"))
        .env_remove("ANTUMBRA_DRIVER")
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(told.contains("half.visibility"), "{told}");
    let _ = fs::remove_dir_all(copied);
}
