//! The comments of the library and its shaders are sentences with a subject, in the field's words.

use antumbra_tests::example::root;
use std::path::{Path, PathBuf};

/// The files and folders whose comments are held to these rules.
const PLACES: [&str; 3] = ["src", "harness/src", "glsl"];

/// Beginnings of a comment line that leave out what the comment is about.
const BEGINNINGS: [&str; 3] = ["Of ", "The same", "What of"];

/// Words for detected, queried, affected and copied.
const WORDS: [&str; 4] = ["told", "asked", "felt", "taken"];

/// A sentence that speaks of rows has one of these; what the graph runs is a pass.
const ROWS: [&str; 15] = [
    "row by row",
    "row after row",
    "texels",
    "texel",
    "pixels",
    "cell",
    "column",
    "blocks",
    "matrix",
    "transform",
    "last row",
    "polygon",
    "rows of",
    "row of `places`",
    "row of the image",
];

/// The comment of a line, behind its marks and spaces; none where it has none.
fn comment(line: &str) -> Option<&str> {
    let (code, text) = line.split_once("//")?;
    // A quote or a colon before it: an address or a string.
    let is_comment = !code.ends_with(':') && code.matches('"').count() % 2 == 0;
    is_comment.then(|| text.trim_start_matches(['/', '!']).trim())
}

/// The lower-case words of a text.
fn words(text: &str) -> Vec<String> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

/// What is wrong with the comments of a text, as `line: reason`.
fn problems(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    // The sentence so far, and the line it began in.
    let mut sentence = (String::new(), 1);
    for (nth, line) in text.lines().enumerate().map(|(nth, line)| (nth + 1, line)) {
        let text = comment(line).unwrap_or_default();
        let whole_line = line.trim_start().starts_with("//");
        let begins = BEGINNINGS.iter().find(|begins| text.starts_with(**begins));
        // Behind code a comment begins in lower case; elsewhere that is the middle of a sentence.
        let begins = begins.or((!whole_line && text.starts_with("of ")).then_some(&"of"));
        if let Some(begins) = begins {
            found.push(format!("{nth}: the comment begins with \"{}\"", begins.trim()));
        }
        let all = words(text);
        for word in WORDS.iter().filter(|word| all.iter().any(|w| w == **word)) {
            found.push(format!("{nth}: \"{word}\" is no word of the field"));
        }
        if !whole_line || text.is_empty() {
            found.extend(rows(&sentence));
            sentence = (String::new(), nth + 1);
        }
        for (part, piece) in text.split_inclusive(". ").enumerate() {
            if part > 0 {
                found.extend(rows(&sentence));
                sentence = (String::new(), nth);
            }
            sentence.0 += piece;
            sentence.0.push(' ');
        }
        if text.ends_with('.') || !whole_line {
            found.extend(rows(&sentence));
            sentence = (String::new(), nth + 1);
        }
    }
    found.extend(rows(&sentence));
    found
}

/// What is wrong with a sentence's rows, if it has any.
fn rows((sentence, line): &(String, usize)) -> Option<String> {
    let all = words(sentence);
    let is_row = |word: &String| word == "row" || word == "rows";
    let graph = ["pass", "passes", "graph"].iter().any(|word| all.iter().any(|w| w == word));
    let allowed = !graph && ROWS.iter().any(|use_of_it| sentence.contains(use_of_it));
    (all.iter().any(is_row) && !allowed).then(|| {
        format!("{line}: a row of what? What the graph runs is a pass: {}", sentence.trim())
    })
}

/// The Rust and GLSL files in a folder, or the file itself.
fn files(place: &Path) -> Vec<PathBuf> {
    if place.is_file() {
        let extension = place.extension().and_then(|e| e.to_str()).unwrap_or_default();
        let is_source = ["rs", "glsl", "comp", "vert", "frag"].contains(&extension);
        return if is_source { vec![place.to_owned()] } else { Vec::new() };
    }
    let entries = std::fs::read_dir(place).unwrap();
    let mut all: Vec<_> = entries.flat_map(|entry| files(&entry.unwrap().path())).collect();
    all.sort();
    all
}

#[test]
fn comments_have_a_subject_and_the_fields_words() {
    let mut found = Vec::new();
    let mut read = 0;
    for file in PLACES.iter().flat_map(|place| files(&root().join(place))) {
        let name = file.strip_prefix(root()).unwrap().display().to_string();
        read += 1;
        let text = std::fs::read_to_string(&file).unwrap();
        found.extend(problems(&text).into_iter().map(|problem| format!("{name}:{problem}")));
    }
    assert!(read > 100, "{read} files");
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn each_rule_finds_what_it_forbids_and_nothing_else() {
    for wrong in [
        "/// Of the G-buffer.",
        "    // The same for boxes.",
        "//! What of a graph depends on the camera.",
        "float x; // of the map",
        "/// Umbra is not told.",
        "// The nodes are asked once.",
        "/// Adds the row that sorts tiles.\nfn f() {}",
        "/// The rows\n/// that run.",
        "/// A row of texels. A row of the graph's passes.",
    ] {
        assert_eq!(problems(wrong).len(), 1, "{wrong}: {:?}", problems(wrong));
    }
    for right in [
        "/// A row of texels, and a mean of them.",
        "/// The rows and the columns\n/// of a matrix.",
        "let address = \"https://of.the/same\";",
        "/// Adds the pass that sorts tiles.\nlet row = 1;",
        "int row; // blocks a row",
    ] {
        assert!(problems(right).is_empty(), "{right}: {:?}", problems(right));
    }
}
