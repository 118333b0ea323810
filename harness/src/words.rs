//! Techniques in words, as tests and benches write them.

// Words in a test or a bench that are wrong end it.
#![allow(clippy::panic)]

use antumbra::{Error, Technique};

/// A technique from `key=value` words. `technique=NAME` as the first of them names the technique, which is the default
/// one without it: `"technique=pcss taps=8"`, `"map=128"`.
///
/// # Errors
/// [`Error::Setting`] for a technique, a key or a value that is not known.
pub fn technique_of(words: &str) -> Result<Technique, Error> {
    let words = words.trim();
    match words.strip_prefix("technique=") {
        Some(rest) => rest.parse(),
        None => format!("{} {words}", Technique::default().name()).parse(),
    }
}

/// A technique by its name and settings, as in `"pcss taps=8"`.
///
/// # Panics
/// Panics where the words are no technique: they are written in a test or a bench.
#[expect(clippy::panic, reason = "the words stand in a test or a bench")]
pub fn technique(words: &str) -> Technique {
    words.parse().unwrap_or_else(|e| panic!("{words}: {e}"))
}
