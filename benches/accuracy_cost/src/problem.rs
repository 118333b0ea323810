//! What went wrong, in words.

use std::fmt::Display;

/// What went wrong, as a sentence for a person that names the file, scene or setting: every error of the bench.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Problem(pub String);

impl Problem {
    /// The problem of a file, an option or a case, which the sentence begins with.
    pub fn of<E: Display>(what: impl Display) -> impl Fn(E) -> Self {
        move |error| Self(format!("{what}: {error}"))
    }
}

impl From<antumbra::Error> for Problem {
    fn from(error: antumbra::Error) -> Self {
        Self(error.to_string())
    }
}

impl From<String> for Problem {
    fn from(sentence: String) -> Self {
        Self(sentence)
    }
}

impl From<&str> for Problem {
    fn from(sentence: &str) -> Self {
        Self(sentence.into())
    }
}
