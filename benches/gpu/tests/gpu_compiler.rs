//! No shader spills, has too few waves or too much code on a GPU, no pass of a default frame is one lane's long work, and
//! docs/gpu.md has the figures of today's shaders.

#![allow(missing_docs, clippy::unwrap_used, reason = "a test says what went wrong by panicking")]

use antumbra_gpu::compiled::{Compiled, compile_for};
use antumbra_gpu::families::{FAMILIES, Family};
use antumbra_gpu::gate::{self, Exceptions};
use antumbra_gpu::page;
use std::path::Path;
use std::sync::OnceLock;

/// What is compiled for all families that there are; a sentence is printed for each other one.
fn compiled() -> &'static [(Family, Compiled)] {
    static ALL: OnceLock<Vec<(Family, Compiled)>> = OnceLock::new();
    ALL.get_or_init(|| {
        let (compiled, said) = page::everything(Path::new(env!("CARGO_BIN_EXE_gpu")));
        said.iter().for_each(|sentence| eprintln!("left out: {sentence}"));
        let strict = std::env::var("ANTUMBRA_NO_SKIPS").is_ok_and(|value| value == "1");
        assert!(!strict || !compiled.is_empty(), "nothing was compiled: {said:?}");
        compiled
    })
}

fn exceptions() -> Exceptions {
    let path = page::root().join("benches/gpu/exceptions.txt");
    gate::exceptions(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn no_shader_breaks_a_rule() {
    let exceptions = exceptions();
    let broken = compiled().iter().flat_map(|(f, all)| gate::broken(f, all, &exceptions));
    let broken: Vec<_> = broken.collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn no_pass_is_long_work_of_one_workgroup() {
    let exceptions = exceptions();
    let frames = page::frames().unwrap();
    assert_eq!(frames.len(), 9);
    let found: Vec<_> =
        frames.iter().flat_map(|(_, passes)| gate::serial(passes, &exceptions)).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Each name of an exception is a shader's or a pass's.
#[test]
fn exceptions_are_of_what_there_is() {
    let frames = page::frames().unwrap();
    let passes: Vec<&str> = frames.iter().flat_map(|(_, p)| p.iter().map(|p| p.name)).collect();
    for (rule, name) in exceptions().into_keys() {
        let is = match rule.as_str() {
            "words" => passes.contains(&name.as_str()),
            _ => page::root().join(format!("spirv/{name}.spv")).is_file(),
        };
        assert!(is, "there is no {name}");
    }
}

#[test]
fn the_page_has_the_figures_of_these_shaders() {
    let page = std::fs::read_to_string(page::root().join(page::PAGE)).unwrap();
    let old = page::between(&page).unwrap();
    let driver = |text: &str| text.lines().next().unwrap_or_default().to_owned();
    let new = page::tables(compiled(), &page::frames().unwrap());
    if compiled().len() < FAMILIES.len() || driver(&new) != driver(old) {
        eprintln!("left out: the page's figures are of another compiler: {}", driver(old));
        return;
    }
    assert!(new == old, "docs/gpu.md: cargo run --release -p antumbra-gpu -- --write-docs");
}

/// The gate notices what it looks for.
#[test]
fn bad_shaders_are_noticed() {
    let (family, all) = match compiled().first() {
        Some(first) => first,
        None => return eprintln!("left out: nothing was compiled"),
    };
    let mut bad = all.clone();
    let shader = bad.shaders.iter_mut().find(|s| s.module() == "hard/hard.comp").unwrap();
    for (name, number) in [("Spilled VGPRs", 1), ("Subgroups per SIMD", 7), ("Code size", 40_000)] {
        shader.figures.insert(name.into(), number);
    }
    let broken = |all| gate::broken(family, all, &exceptions()).len();
    assert_eq!(broken(&bad), broken(all) + 3);
    let mut frames = page::frames().unwrap();
    frames[0].1[0].serial_words = Some(1000);
    assert_eq!(gate::serial(&frames[0].1, &Exceptions::new()).len(), 1);
    for wrong in ["waves traced/rays.comp", "waves traced/rays.comp 3", "vawes a.comp 1 because"] {
        assert!(gate::exceptions(wrong).is_err(), "{wrong}");
    }
}

/// What cannot be compiled is a sentence.
#[test]
fn a_family_that_the_driver_does_not_know_is_a_sentence() {
    let unknown = Family { name: "gfx0", ..FAMILIES[0] };
    let said = compile_for(Path::new(env!("CARGO_BIN_EXE_gpu")), &unknown).unwrap_err();
    println!("{said}");
    assert!(said.contains("gfx0") || said.contains("not installed"), "{said}");
    assert_eq!(said.lines().count(), 1);
}
