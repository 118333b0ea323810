//! No test is left out: each file of a program's folder is a module of it, and each folder with a `main.rs` is a
//! program.

use antumbra_tests::example::root;
use std::fs;
use std::path::{Path, PathBuf};

/// Which files and folders are there, in order.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

/// A path's name without its extension.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_string_lossy().into_owned()
}

/// The modules among these files that a text does not declare.
fn left_out(text: &str, files: &[PathBuf]) -> Vec<String> {
    let modules = files.iter().filter(|file| file.extension().is_some_and(|e| e == "rs"));
    let names = modules.map(|file| stem(file)).filter(|name| name != "main");
    let declared =
        |line: &str, name: &str| line.trim_start_matches("pub ") == format!("mod {name};");
    names.filter(|name| !text.lines().any(|line| declared(line, name))).collect()
}

/// Checks that a module declares every file of its folder, and so do its own modules: theirs stand in a folder of their
/// name. Other folders hold data.
fn check_modules(folder: &Path, text: &str) {
    let entries = entries(folder);
    let left_out = left_out(text, &entries);
    assert!(left_out.is_empty(), "{}: no module declares {left_out:?}", folder.display());
    for folder in entries.iter().filter(|path| path.is_dir()) {
        if let Ok(text) = fs::read_to_string(folder.with_extension("rs")) {
            check_modules(folder, &text);
        }
    }
}

#[test]
fn every_file_is_a_module_of_its_program() {
    let folders = entries(&root().join("tests"));
    let manifest = fs::read_to_string(root().join("tests/Cargo.toml")).unwrap();
    let mut programs = Vec::new();
    for folder in folders.iter().filter(|folder| folder.join("main.rs").exists()) {
        let name = stem(folder);
        let target = format!("[[test]]\nname = \"{name}\"\npath = \"{name}/main.rs\"\n");
        assert!(manifest.contains(&target), "tests/Cargo.toml has no {target}");
        let main = fs::read_to_string(folder.join("main.rs")).unwrap();
        check_modules(folder, &main);
        programs.push(name);
    }
    assert!(programs.len() >= 6, "{programs:?}");
    let once = manifest.lines().find_map(|line| line.strip_prefix("once = ")).unwrap();
    let once: Vec<String> = serde_json::from_str(once).unwrap();
    // The packages of benches/ have programs as well.
    let benches = entries(&root().join("benches"));
    let tests = benches.iter().map(|folder| folder.join("tests")).filter(|tests| tests.is_dir());
    programs.extend(tests.flat_map(|tests| entries(&tests)).map(|file| stem(&file)));
    assert!(once.iter().all(|name| programs.contains(name)), "{once:?} of {programs:?}");
}

#[test]
fn a_file_that_no_module_declares_is_found() {
    let files = ["main.rs", "a.rs", "b.rs", "table.txt"].map(PathBuf::from);
    assert_eq!(left_out("mod a;\n", &files), ["b"]);
    assert_eq!(left_out("mod a;\nmod b;\n", &files), [""; 0]);
}
