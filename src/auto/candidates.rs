//! What `auto` chooses among.

use crate::settings::{Settings, Technique};

/// A technique with its settings, as words of a command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidate {
    /// The technique.
    pub technique: Technique,
    /// Its settings, as `key=value` words; the rest are the defaults.
    pub words: &'static str,
}

const fn of(technique: Technique, words: &'static str) -> Candidate {
    Candidate { technique, words }
}

/// Every choice for a light with an area: those that are the fastest at some error in some scene of the
/// report, and what lies between them. A line's own technique places its samples by the error itself, so that
/// it is no row here.
pub const CANDIDATES: &[Candidate] = {
    use Technique::{Hard, ManyLights, OcclusionTextures, Pcss, RayMarch, SoftShadowMap};
    &[
        of(Hard, "map=256"),
        of(Hard, "map=512"),
        of(Hard, "map=1024"),
        of(Pcss, "taps=16"),
        of(Pcss, "taps=32"),
        of(Pcss, "taps=64"),
        of(SoftShadowMap, "sides=one map=128"),
        of(SoftShadowMap, "sides=one map=256"),
        of(SoftShadowMap, "map=64"),
        of(SoftShadowMap, "map=128"),
        of(SoftShadowMap, "map=256"),
        of(SoftShadowMap, "map=512"),
        of(OcclusionTextures, "slices=4 map=128"),
        of(OcclusionTextures, "slices=4"),
        of(OcclusionTextures, "slices=8"),
        of(OcclusionTextures, "slices=16"),
        of(OcclusionTextures, "slices=16 map=512"),
        of(RayMarch, "rays=4 map=128"),
        of(RayMarch, "rays=4"),
        of(RayMarch, "rays=16 map=128"),
        of(RayMarch, "rays=16"),
        of(RayMarch, "rays=64"),
        of(RayMarch, "rays=16 map=512"),
        of(RayMarch, "rays=64 map=512"),
        of(ManyLights, "samples=16"),
        of(ManyLights, "samples=64"),
        of(ManyLights, "samples=256"),
    ]
};

impl Candidate {
    /// The settings; words that no knob takes are left out, which a test holds there are none of.
    pub fn settings(&self) -> Settings {
        let mut settings = Settings { technique: self.technique, ..Settings::default() };
        for word in self.words.split_whitespace() {
            if let Some((key, value)) = word.split_once('=') {
                let _ = settings.set(key, value);
            }
        }
        settings
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
            for word in c.words.split_whitespace() {
                let (key, value) = word.split_once('=').unwrap();
                assert_eq!(settings.get(key).as_deref(), Some(value), "{c:?}");
            }
            assert!(CANDIDATES[..i].iter().all(|o| o.settings() != settings), "{c:?}");
        }
    }
}
