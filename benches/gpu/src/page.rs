//! `docs/gpu.md`, whose tables this program writes.

use crate::compiled::{Compiled, compile_for};
use crate::families::{FAMILIES, Family};
use crate::frame::{FramePass, TECHNIQUES, frame_of};
use crate::table;
use antumbra::scene::from_gltf;
use std::path::{Path, PathBuf};

/// The project's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The path of the page in the project's folder.
pub const PAGE: &str = "docs/gpu.md";

const BEGIN: &str = "<!-- gpu: written by cargo run --release -p antumbra-gpu -- --write-docs -->";
const END: &str = "<!-- /gpu -->";

/// What is compiled for all families that RADV knows, and a sentence for each other one.
pub fn everything(program: &Path) -> (Vec<(Family, Compiled)>, Vec<String>) {
    let (mut compiled, mut said) = (Vec::new(), Vec::<String>::new());
    for family in FAMILIES {
        match compile_for(program, &family) {
            Ok(all) => compiled.push((family, all)),
            Err(problem) if said.contains(&problem) => {}
            Err(problem) => said.push(problem),
        }
    }
    (compiled, said)
}

/// The passes of each technique's default frame over the bunny.
///
/// # Errors
/// What loading or planning refuses.
pub fn frames() -> Result<Vec<(&'static str, Vec<FramePass>)>, antumbra::Error> {
    let scene = from_gltf(&root().join("scenes/bunny.glb"))?;
    TECHNIQUES.into_iter().map(|name| Ok((name, frame_of(name, &scene)?))).collect()
}

/// All tables, as they stand between the page's marks.
pub fn tables(compiled: &[(Family, Compiled)], frames: &[(&str, Vec<FramePass>)]) -> String {
    let Some((first, all)) = compiled.first() else { return String::new() };
    let mut text = format!("Compiled by {}.\n\n## Shaders\n\n", all.driver);
    text.push_str(&table::shaders(compiled));
    text.push_str("\n## Default frames at 1920×1080\n");
    for (technique, passes) in frames {
        text.push('\n');
        text.push_str(&table::frame(technique, passes, first, all));
    }
    text
}

/// The page's tables; `None` for a page without its marks.
pub fn between(page: &str) -> Option<&str> {
    let (_, rest) = page.split_once(BEGIN)?;
    Some(rest.split_once(END)?.0.trim_start_matches('\n'))
}

/// Replaces the page's tables.
///
/// # Errors
/// A sentence where the page cannot be read or written, or has no marks.
pub fn write(tables: &str) -> Result<(), String> {
    let path = root().join(PAGE);
    let page = std::fs::read_to_string(&path).map_err(|e| format!("{PAGE}: {e}"))?;
    let halves = page.split_once(BEGIN).zip(page.split_once(END));
    let ((before, _), (_, after)) =
        halves.ok_or_else(|| format!("{PAGE} has no tables to replace"))?;
    let page = format!("{before}{BEGIN}\n{tables}{END}{after}");
    std::fs::write(&path, page).map_err(|e| format!("{PAGE}: {e}"))
}
