//! Every knob: unit, range, default, and what 0 means.

use crate::Error;
use crate::soft_shadow_map::{Accumulate, Receivers, Settings as SoftShadowMap, Sides};
use std::fmt::Display;
use std::str::FromStr;

/// How the visible fraction is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Technique {
    /// Micro-patches back-projected onto the light (Atty 2006).
    #[default]
    SoftShadowMap,
}

impl Technique {
    /// Every technique, with the name it has on a command line.
    pub const ALL: &[(&str, Self)] = &[("soft-shadow-map", Self::SoftShadowMap)];

    /// The name it has on a command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::SoftShadowMap => "soft-shadow-map",
        }
    }
}

impl FromStr for Technique {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        choose("technique", name, Self::ALL)
    }
}

/// The technique and its knobs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// How the visible fraction is computed.
    pub technique: Technique,
    /// The knobs of [`Technique::SoftShadowMap`].
    pub soft_shadow_map: SoftShadowMap,
}

/// One knob, as data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Knob {
    /// The key, as in `--set key=value`.
    pub key: &'static str,
    /// The unit of the value.
    pub unit: &'static str,
    /// The values that are legal.
    pub range: &'static str,
    /// The value that stands where none is given.
    pub default: &'static str,
    /// What it does, and what 0 means where 0 is legal.
    pub about: &'static str,
}

/// The knobs of every technique.
pub const KNOBS: &[Knob] = &[
    Knob {
        key: "map",
        unit: "texels",
        range: "16 to 4096",
        default: "256",
        about: "side of the occluder map; any whole number",
    },
    Knob {
        key: "receiver_map",
        unit: "texels",
        range: "16 to 4096",
        default: "256",
        about: "side of the soft shadow map, with receivers=map",
    },
    Knob {
        key: "receivers",
        unit: "choice",
        range: "pixels, map",
        default: "pixels",
        about: "where visibility is computed: at the G-buffer's pixels, with self-shadowing, or on a \
                soft shadow map that is projected onto them, without",
    },
    Knob {
        key: "sides",
        unit: "choice",
        range: "one, bottom, two, mean",
        default: "mean",
        about: "occluders seen as their nearest faces, as those at the distance of the furthest back \
                faces, as the larger shadow of both layers, or as the mean of both, which is nearer the \
                truth (blending takes the larger)",
    },
    Knob {
        key: "accumulate",
        unit: "choice",
        range: "gather, blend, blend-fp16",
        default: "gather",
        about: "how micro-patches are added up; the blends need receivers=map, and blend-fp16 is for \
                studying what goes wrong with it",
    },
    Knob {
        key: "tolerance",
        unit: "visible fraction",
        range: "0 to 0.1",
        default: "0.0001",
        about: "most that the gather's shortcut for far texels may add to the error; 0 uses it \
                only where it is exact",
    },
];

impl Settings {
    /// Sets one knob by its key.
    ///
    /// # Errors
    /// [`Error::Setting`] for an unknown key (names the known ones) or a value outside its range.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        let s = &mut self.soft_shadow_map;
        match key {
            "map" => s.map = number(key, value)?,
            "receiver_map" => s.receiver_map = number(key, value)?,
            "receivers" => s.receivers = choose(key, value, Receivers::ALL)?,
            "sides" => s.sides = choose(key, value, Sides::ALL)?,
            "accumulate" => s.accumulate = choose(key, value, Accumulate::ALL)?,
            "tolerance" => s.tolerance = number(key, value)?,
            _ => {
                let known: Vec<_> = KNOBS.iter().map(|k| k.key).collect();
                let name = self.technique.name();
                let problem = format!("{name} has no such setting; it has {}", known.join(", "));
                return Err(Error::Setting { key: key.into(), problem });
            }
        }
        s.check_range(key)
    }

    /// The value of one knob, as [`Self::set`] takes it; none for an unknown key.
    pub fn get(&self, key: &str) -> Option<String> {
        let s = &self.soft_shadow_map;
        Some(match key {
            "map" => s.map.to_string(),
            "receiver_map" => s.receiver_map.to_string(),
            "receivers" => name_of(Receivers::ALL, s.receivers),
            "sides" => name_of(Sides::ALL, s.sides),
            "accumulate" => name_of(Accumulate::ALL, s.accumulate),
            "tolerance" => s.tolerance.to_string(),
            _ => return None,
        })
    }

    /// Checks every knob, and those that must agree with each other.
    ///
    /// # Errors
    /// [`Error::Setting`] for the first that is wrong.
    pub fn check(&self) -> Result<(), Error> {
        KNOBS.iter().try_for_each(|k| self.soft_shadow_map.check_range(k.key))?;
        self.soft_shadow_map.check_agreement()
    }
}

/// The name of a choice.
fn name_of<T: PartialEq + Copy>(all: &[(&str, T)], choice: T) -> String {
    all.iter().find(|(_, t)| *t == choice).map_or_else(String::new, |(name, _)| (*name).into())
}

/// A whole or real number from text.
fn number<T: FromStr<Err: Display>>(key: &str, value: &str) -> Result<T, Error> {
    value.trim().parse().map_err(|e| Error::Setting {
        key: key.into(),
        problem: format!("\"{value}\" is not a number it can take ({e}); {}", legal(key)),
    })
}

/// One of a few names.
fn choose<T: Copy>(key: &str, value: &str, all: &[(&str, T)]) -> Result<T, Error> {
    all.iter().find(|(name, _)| *name == value).map(|&(_, t)| t).ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|(name, _)| *name).collect();
        let problem = format!("\"{value}\" is not one of {}", names.join(", "));
        Error::Setting { key: key.into(), problem }
    })
}

/// The legal values of a knob, as part of a sentence.
pub(crate) fn legal(key: &str) -> String {
    KNOBS
        .iter()
        .find(|k| k.key == key)
        .map_or_else(String::new, |k| format!("give {} ({})", k.range, k.unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_knob_takes_its_default_and_has_it() {
        for knob in KNOBS {
            let mut settings = Settings::default();
            settings.set(knob.key, knob.default).unwrap();
            assert_eq!(settings, Settings::default(), "{}", knob.key);
            assert_eq!(settings.get(knob.key).as_deref(), Some(knob.default));
        }
        Settings::default().check().unwrap();
    }

    #[test]
    fn the_readme_lists_every_knob() {
        let readme = include_str!("../README.md");
        for k in KNOBS {
            let row =
                format!("| `{}` | {} | {} | {} | {} |", k.key, k.unit, k.range, k.default, k.about);
            assert!(readme.contains(&row), "README.md's table of settings lacks this row:\n{row}");
        }
    }

    #[test]
    fn wrong_values_are_refused_with_what_would_be_right() {
        let refuse =
            |key: &str, value: &str| Settings::default().set(key, value).unwrap_err().to_string();
        assert!(refuse("map", "15").contains("16 to 4096"));
        assert!(refuse("map", "4097").contains("16 to 4096"));
        assert!(refuse("map", "-1").contains("16 to 4096"));
        assert!(refuse("tolerance", "NaN").contains("0 to 0.1"));
        assert!(refuse("sides", "three").contains("one, bottom, two, mean"));
        assert!(refuse("rays", "4").contains("it has map"));
        let mut both = Settings::default();
        both.set("accumulate", "blend").unwrap();
        assert!(both.check().unwrap_err().to_string().contains("receivers=map"));
    }
}
