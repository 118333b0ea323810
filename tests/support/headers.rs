//! The first line of each file under `glsl/`: where a reader enters it.
//!
//! A whole shader names the passes that run it and the Rust file that declares them, other files those that include
//! them. Behind a `;` the line says what a first reading may skip:
//!
//! ```glsl
//! // Entry of the pass ray_march.trace (src/techniques/ray_march/passes.rs); at first skip noise.glsl.
//! // Entered from classify.comp, trace.comp and others.
//! ```

use crate::compile::{glsl_root, is_shader};
use crate::permutations::{closure, read};
use std::collections::BTreeSet;

/// What a whole shader's header says.
#[derive(Debug, PartialEq, Eq)]
pub struct Entry {
    /// The names of the passes.
    pub passes: BTreeSet<String>,
    /// Whether there are more, which the header calls `and others`.
    pub and_others: bool,
    /// The Rust file that declares them.
    pub declared_in: String,
}

/// Reads a whole shader's header.
///
/// # Errors
/// The header, where it is none.
pub fn entry(file: &str) -> Result<Entry, String> {
    parse_entry(&header(file)).ok_or_else(|| {
        format!(
            "glsl/{file} begins with no `// Entry of the pass x.y (src/z.rs).`: {}",
            header(file)
        )
    })
}

fn parse_entry(header: &str) -> Option<Entry> {
    let rest = header.strip_prefix("// Entry of the pass")?;
    let (names, rest) = rest.strip_prefix("es").unwrap_or(rest).split_once(" (")?;
    let (declared_in, end) = rest.split_once(')')?;
    let (names, and_others) = match names.strip_suffix(" and others") {
        Some(names) => (names, true),
        None => (names, false),
    };
    let passes = list(names);
    let whole = !passes.is_empty() && end.starts_with(['.', ';']);
    whole.then(|| Entry { passes, and_others, declared_in: declared_in.to_owned() })
}

/// What is wrong with the header of a file, but for the passes that it names: a file that it names and that does not
/// include it, a file to skip that is not read at all.
pub fn problems(file: &str) -> Vec<String> {
    let includes = |from: &str, to: &str| {
        glsl_root().join(from).is_file() && closure(from).iter().skip(1).any(|name| name == to)
    };
    problems_of(file, &header(file), includes)
}

/// As [`problems`], of a header; `includes` says whether a file includes another, directly or not.
pub fn problems_of(file: &str, header: &str, includes: impl Fn(&str, &str) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    if is_shader(file) {
        if parse_entry(header).is_none() {
            found.push(format!("glsl/{file} does not begin with `// Entry of the pass`"));
        }
    } else if let Some(rest) = header.strip_prefix("// Entered from") {
        let sentence = rest.split(';').next().unwrap_or_default();
        let names = files_in(sentence, file);
        if names.is_empty() {
            found.push(format!("glsl/{file} does not say which file it is entered from"));
        }
        for name in names.iter().filter(|name| !includes(name, file)) {
            found.push(format!("glsl/{file} says that it is entered from glsl/{name}; it is not"));
        }
    } else {
        found.push(format!("glsl/{file} does not begin with `// Entered from`"));
    }
    let skipped = header.split_once("skip ").map_or("", |(_, rest)| rest);
    for name in files_in(skipped, file).iter().filter(|name| !includes(file, name)) {
        found.push(format!("glsl/{file} says to skip glsl/{name}, which it does not include"));
    }
    found
}

/// A file's first line.
fn header(file: &str) -> String {
    read(file).lines().next().unwrap_or_default().to_owned()
}

/// The words of a list such as `a, b and c`.
fn list(text: &str) -> BTreeSet<String> {
    let words = text.split([',', ' ']).filter(|word| !word.is_empty() && *word != "and");
    words.map(str::to_owned).collect()
}

/// The GLSL files that a text names; one without a folder is in the folder of `beside`.
fn files_in(text: &str, beside: &str) -> Vec<String> {
    let folder = beside.rsplit_once('/').map_or("", |(folder, _)| folder);
    let words = text.split([',', ' ', ';']).map(|word| word.trim_end_matches('.'));
    let files = words.filter(|word| is_shader(word) || word.ends_with(".glsl"));
    files
        .map(|word| if word.contains('/') { word.to_owned() } else { format!("{folder}/{word}") })
        .collect()
}
