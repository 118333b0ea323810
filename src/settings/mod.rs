//! The technique and its knobs: setting, reading and checking them.

mod knobs;

pub use knobs::{KNOBS, Knob};

use crate::Error;
use crate::stages::nbuffer;
use crate::techniques::common::Settings as Baseline;
use crate::techniques::linear_light::{Across, Settings as LinearLight, Transition};
use crate::techniques::occlusion_textures::{
    Combine, Placement, Prefilter, Settings as OcclusionTextures,
};
use crate::techniques::ray_march::{
    Hash, Layers, Projection, Sampling, Search, Settings as RayMarch,
};
use crate::techniques::soft_shadow_map::{Accumulate, Receivers, Settings as SoftShadowMap, Sides};
use std::fmt::Display;
use std::str::FromStr;

/// How the visible fraction is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Technique {
    /// A shadow map from the light's centre, 3×3 percentage-closer filtered.
    Hard,
    /// Percentage-closer soft shadows (Fernando 2005).
    Pcss,
    /// The mean of hard shadow maps from points all over the light.
    ManyLights,
    /// Occluder texels projected back onto the light, gaps filled (Guennebaud 2006).
    BackProjection,
    /// Micro-patches back-projected onto the light (Atty 2006).
    #[default]
    SoftShadowMap,
    /// Rays through depth layers (Curtis 2009).
    RayMarch,
    /// Prefiltered slices, combined (Eisemann and Décoret 2008).
    OcclusionTextures,
    /// Visibility channels from warped skins (Heidrich, Brabec and Seidel 2000).
    LinearLight,
}

impl Technique {
    /// Every technique, with the name it has on a command line.
    pub const ALL: &[(&str, Self)] = &[
        ("hard", Self::Hard),
        ("pcss", Self::Pcss),
        ("many-lights", Self::ManyLights),
        ("back-projection", Self::BackProjection),
        ("soft-shadow-map", Self::SoftShadowMap),
        ("ray-march", Self::RayMarch),
        ("occlusion-textures", Self::OcclusionTextures),
        ("linear-light", Self::LinearLight),
    ];

    /// The name it has on a command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hard => "hard",
            Self::Pcss => "pcss",
            Self::ManyLights => "many-lights",
            Self::BackProjection => "back-projection",
            Self::SoftShadowMap => "soft-shadow-map",
            Self::RayMarch => "ray-march",
            Self::OcclusionTextures => "occlusion-textures",
            Self::LinearLight => "linear-light",
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How the visible fraction is computed.
    pub technique: Technique,
    /// The side of the light-space maps, texels, 1 to 4096; 256 by default.
    pub map: u32,
    /// The other knobs of [`Technique::SoftShadowMap`].
    pub soft_shadow_map: SoftShadowMap,
    /// The other knobs of [`Technique::RayMarch`].
    pub ray_march: RayMarch,
    /// The other knobs of [`Technique::OcclusionTextures`].
    pub occlusion_textures: OcclusionTextures,
    /// The other knobs of [`Technique::LinearLight`].
    pub linear_light: LinearLight,
    /// The other knobs of what users would pick instead.
    pub baseline: Baseline,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            technique: Technique::default(),
            map: 256,
            soft_shadow_map: SoftShadowMap::default(),
            ray_march: RayMarch::default(),
            occlusion_textures: OcclusionTextures::default(),
            linear_light: LinearLight::default(),
            baseline: Baseline::default(),
        }
    }
}

impl Settings {
    /// Sets one knob of the technique by its key.
    ///
    /// # Errors
    /// [`Error::Setting`] for a key that the technique does not have (names those it has) or a value
    /// outside its range.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        let s = &mut self.soft_shadow_map;
        let r = &mut self.ray_march;
        let o = &mut self.occlusion_textures;
        let technique = self.technique;
        match key {
            _ if !KNOBS.iter().any(|k| k.key == key && k.serves(technique)) => {
                let known = KNOBS.iter().filter(|k| k.serves(technique));
                let known: Vec<_> = known.map(|k| k.key).collect();
                let name = technique.name();
                let problem = format!("{name} has no such setting; it has {}", known.join(", "));
                return Err(Error::Setting { key: key.into(), problem });
            }
            "map" => self.map = number(key, value)?,
            "receiver_map" => s.receiver_map = number(key, value)?,
            "receivers" => s.receivers = choose(key, value, Receivers::ALL)?,
            "sides" => s.sides = choose(key, value, Sides::ALL)?,
            "accumulate" => s.accumulate = choose(key, value, Accumulate::ALL)?,
            "tolerance" => s.tolerance = number(key, value)?,
            "taps" => self.baseline.taps = number(key, value)?,
            "samples" if technique == Technique::LinearLight => {
                self.linear_light.samples = number(key, value)?;
            }
            "samples" => self.baseline.samples = number(key, value)?,
            "lines" => self.linear_light.lines = number(key, value)?,
            "across" => self.linear_light.across = choose(key, value, Across::ALL)?,
            "error" => self.linear_light.error = number(key, value)?,
            "transition" => self.linear_light.transition = choose(key, value, Transition::ALL)?,
            "rays" => r.rays = number(key, value)?,
            "layers" => r.layers = choose(key, value, Layers::ALL)?,
            "search" => r.search = choose(key, value, Search::ALL)?,
            "sampling" => r.sampling = choose(key, value, Sampling::ALL)?,
            "hash" => r.hash = choose(key, value, Hash::ALL)?,
            "levels" => r.levels = choose(key, value, nbuffer::Kind::ALL)?,
            "projection" => r.projection = choose(key, value, Projection::ALL)?,
            "classify" if technique == Technique::RayMarch => {
                r.classify = choose(key, value, RayMarch::SWITCH)?;
            }
            "classify" if technique == Technique::Pcss => {
                self.baseline.classify = choose(key, value, RayMarch::SWITCH)?;
            }
            "classify" if technique == Technique::OcclusionTextures => {
                o.classify = choose(key, value, OcclusionTextures::SWITCH)?;
            }
            "classify" => s.classify = choose(key, value, RayMarch::SWITCH)?,
            "filter" => r.filter = choose(key, value, RayMarch::SWITCH)?,
            "slices" => o.slices = number(key, value)?,
            "placement" => o.placement = choose(key, value, Placement::ALL)?,
            "prefilter" => o.prefilter = choose(key, value, Prefilter::ALL)?,
            "combine" => o.combine = choose(key, value, Combine::ALL)?,
            "fill" => o.fill = choose(key, value, OcclusionTextures::SWITCH)?,
            _ if technique == Technique::RayMarch => r.seed = number(key, value)?,
            _ => self.baseline.seed = number(key, value)?,
        }
        self.check_range(key)
    }

    /// The value of one knob of the technique, as [`Self::set`] takes it; none for other keys.
    pub fn get(&self, key: &str) -> Option<String> {
        KNOBS.iter().find(|k| k.key == key && k.serves(self.technique))?;
        self.value(key)
    }

    fn value(&self, key: &str) -> Option<String> {
        let s = &self.soft_shadow_map;
        let r = &self.ray_march;
        let o = &self.occlusion_textures;
        Some(match key {
            "map" => self.map.to_string(),
            "receiver_map" => s.receiver_map.to_string(),
            "receivers" => name_of(Receivers::ALL, s.receivers),
            "sides" => name_of(Sides::ALL, s.sides),
            "accumulate" => name_of(Accumulate::ALL, s.accumulate),
            "tolerance" => s.tolerance.to_string(),
            "taps" => self.baseline.taps.to_string(),
            "samples" if self.technique == Technique::LinearLight => {
                self.linear_light.samples.to_string()
            }
            "samples" => self.baseline.samples.to_string(),
            "lines" => self.linear_light.lines.to_string(),
            "across" => name_of(Across::ALL, self.linear_light.across),
            "error" => self.linear_light.error.to_string(),
            "transition" => name_of(Transition::ALL, self.linear_light.transition),
            "seed" if self.technique == Technique::RayMarch => r.seed.to_string(),
            "seed" => self.baseline.seed.to_string(),
            "rays" => r.rays.to_string(),
            "layers" => name_of(Layers::ALL, r.layers),
            "search" => name_of(Search::ALL, r.search),
            "sampling" => name_of(Sampling::ALL, r.sampling),
            "hash" => name_of(Hash::ALL, r.hash),
            "levels" => name_of(nbuffer::Kind::ALL, r.levels),
            "projection" => name_of(Projection::ALL, r.projection),
            "classify" if self.technique == Technique::RayMarch => {
                name_of(RayMarch::SWITCH, r.classify)
            }
            "classify" if self.technique == Technique::Pcss => {
                name_of(RayMarch::SWITCH, self.baseline.classify)
            }
            "classify" if self.technique == Technique::OcclusionTextures => {
                name_of(OcclusionTextures::SWITCH, o.classify)
            }
            "classify" => name_of(RayMarch::SWITCH, s.classify),
            "filter" => name_of(RayMarch::SWITCH, r.filter),
            "slices" => o.slices.to_string(),
            "placement" => name_of(Placement::ALL, o.placement),
            "prefilter" => name_of(Prefilter::ALL, o.prefilter),
            "combine" => name_of(Combine::ALL, o.combine),
            "fill" => name_of(OcclusionTextures::SWITCH, o.fill),
            _ => return None,
        })
    }

    /// Checks every knob, and those that must agree with each other.
    ///
    /// # Errors
    /// [`Error::Setting`] for the first that is wrong.
    pub fn check(&self) -> Result<(), Error> {
        let mut knobs = KNOBS.iter().filter(|k| k.serves(self.technique));
        knobs.try_for_each(|k| self.check_range(k.key))?;
        match self.technique {
            Technique::SoftShadowMap => self.soft_shadow_map.check_agreement(),
            Technique::RayMarch => self.ray_march.check_agreement(self.map),
            Technique::OcclusionTextures => self.occlusion_textures.check_agreement(self.map),
            Technique::LinearLight => self.linear_light.check_agreement(self.map),
            _ => Ok(()),
        }
    }

    /// Checks the knob with this key against its range.
    fn check_range(&self, key: &str) -> Result<(), Error> {
        let good = match key {
            "map" => (1..=4096).contains(&self.map),
            _ => {
                self.soft_shadow_map.in_range(key)
                    && self.baseline.in_range(key)
                    && self.ray_march.in_range(key)
                    && self.occlusion_textures.in_range(key)
                    && self.linear_light.in_range(key)
            }
        };
        if good {
            return Ok(());
        }
        let value = self.value(key).unwrap_or_default();
        let problem = format!("{value} is outside its range; {}", legal(key));
        Err(Error::Setting { key: key.into(), problem })
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
fn legal(key: &str) -> String {
    let knobs: Vec<_> = KNOBS.iter().filter(|k| k.key == key).collect();
    if let [k] = knobs[..] {
        return format!("give {} ({})", k.range, k.unit);
    }
    let of = |k: &&Knob| format!("{} ({}) with {}", k.range, k.unit, k.techniques());
    format!("give {}", knobs.iter().map(of).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_knob_takes_its_default_and_has_it() {
        for knob in KNOBS {
            for &(name, technique) in Technique::ALL {
                let plain = Settings { technique, ..Settings::default() };
                let mut settings = plain;
                if knob.serves(technique) {
                    settings.set(knob.key, knob.default).unwrap();
                    assert_eq!(settings, plain, "{name}: {}", knob.key);
                    assert_eq!(settings.get(knob.key).as_deref(), Some(knob.default));
                } else if !KNOBS.iter().any(|k| k.key == knob.key && k.serves(technique)) {
                    assert!(settings.set(knob.key, knob.default).is_err());
                    assert_eq!(settings.get(knob.key), None);
                }
                plain.check().unwrap();
            }
        }
    }

    #[test]
    fn the_page_of_settings_lists_every_knob() {
        let page = include_str!("../../docs/settings.md");
        for k in KNOBS {
            let techniques = k.techniques();
            let row = format!(
                "| `{}` | {techniques} | {} | {} | {} | {} |",
                k.key, k.unit, k.range, k.default, k.about
            );
            assert!(page.contains(&row), "docs/settings.md lacks this row:\n{row}");
        }
    }

    #[test]
    fn wrong_values_are_refused_with_what_would_be_right() {
        let refuse =
            |key: &str, value: &str| Settings::default().set(key, value).unwrap_err().to_string();
        assert!(refuse("map", "0").contains("1 to 4096"));
        assert!(refuse("map", "4097").contains("1 to 4096"));
        assert!(refuse("map", "-1").contains("1 to 4096"));
        assert!(refuse("tolerance", "NaN").contains("0 to 0.1"));
        assert!(refuse("sides", "three").contains("one, bottom, two, mean"));
        assert!(refuse("rays", "4").contains("it has map"));
        assert!(refuse("taps", "8").contains("it has map"));
        let refuse = |technique, key: &str, value: &str| {
            let mut settings = Settings { technique, ..Settings::default() };
            settings.set(key, value).unwrap_err().to_string()
        };
        assert!(refuse(Technique::Pcss, "taps", "65").contains("1 to 64"));
        assert!(refuse(Technique::ManyLights, "samples", "0").contains("1 to 4096"));
        assert!(refuse(Technique::ManyLights, "seed", "-1").contains("4294967295"));
        assert!(refuse(Technique::RayMarch, "rays", "0").contains("1 to 256"));
        assert!(refuse(Technique::RayMarch, "rays", "257").contains("1 to 256"));
        assert!(refuse(Technique::RayMarch, "map", "0").contains("1 to 4096"));
        assert!(refuse(Technique::RayMarch, "layers", "1").contains("2, 3, 4"));
        let mut large = Settings { technique: Technique::RayMarch, ..Settings::default() };
        large.set("map", "2048").unwrap();
        assert!(large.check().unwrap_err().to_string().contains("levels=mip"));
        let mut both = Settings::default();
        both.set("accumulate", "blend").unwrap();
        assert!(both.check().unwrap_err().to_string().contains("receivers=map"));
    }
}
