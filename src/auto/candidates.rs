//! The techniques and settings that [`super::Auto`] chooses among.

use crate::technique::Technique;
use std::sync::OnceLock;

/// A technique with its settings in text form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidate {
    /// The technique's name.
    pub technique: &'static str,
    /// The settings as `key=value` words; those not named have their defaults.
    pub words: &'static str,
}

const fn of(technique: &'static str, words: &'static str) -> Candidate {
    Candidate { technique, words }
}

/// Every candidate for a light with an area: those that are the fastest at some error in some scene of the report, and
/// settings between them. `linear-light` places its samples by the allowed error itself, and is not among them.
pub const CANDIDATES: &[Candidate] = &[
    of("hard", "map=256"),
    of("hard", "map=512"),
    of("hard", "map=1024"),
    of("pcss", "taps=16"),
    of("pcss", "taps=32"),
    of("pcss", "taps=64"),
    of("soft-shadow-map", "sides=one map=128"),
    of("soft-shadow-map", "sides=one map=256"),
    of("soft-shadow-map", "map=64"),
    of("soft-shadow-map", "map=128"),
    of("soft-shadow-map", "map=256"),
    of("soft-shadow-map", "map=512"),
    of("occlusion-textures", "slices=4 map=128"),
    of("occlusion-textures", "slices=4"),
    of("occlusion-textures", "slices=8"),
    of("occlusion-textures", "slices=16"),
    of("occlusion-textures", "slices=16 map=512"),
    of("ray-march", "rays=4 map=128"),
    of("ray-march", "rays=4"),
    of("ray-march", "rays=16 map=128"),
    of("ray-march", "rays=16"),
    of("ray-march", "rays=64"),
    of("ray-march", "rays=16 map=512"),
    of("ray-march", "rays=64 map=512"),
    of("many-lights", "samples=16"),
    of("many-lights", "samples=64"),
    of("many-lights", "samples=256"),
    of("traced", "samples=64"),
    of("traced", "samples=256"),
];

/// The candidates' techniques, in the order of [`CANDIDATES`].
pub(super) fn techniques() -> &'static [Technique] {
    static ALL: OnceLock<Vec<Technique>> = OnceLock::new();
    ALL.get_or_init(|| CANDIDATES.iter().map(Candidate::settings).collect())
}

impl Candidate {
    /// The candidate's technique. A test holds that every candidate's words are valid.
    pub fn settings(&self) -> Technique {
        format!("{} {}", self.technique, self.words).parse().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_candidate_is_what_its_words_say_and_another_one() {
        for (i, c) in CANDIDATES.iter().enumerate() {
            let settings = c.settings();
            settings.check().unwrap();
            assert_eq!(settings.name(), c.technique);
            for word in c.words.split_whitespace() {
                let (key, value) = word.split_once('=').unwrap();
                assert_eq!(settings.get(key).as_deref(), Some(value), "{c:?}");
            }
            assert!(CANDIDATES[..i].iter().all(|o| o.settings() != settings), "{c:?}");
        }
    }
}
