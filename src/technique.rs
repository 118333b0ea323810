//! The techniques, in the one file that names all of them.

use crate::Error;
use crate::knob::{Knob, Knobs};
use crate::techniques::room::{Room, check};
use crate::techniques::{linear_light, soft_shadow_map};
use std::fmt;
use std::str::FromStr;

macro_rules! techniques {
    ($($(#[$about:meta])* $variant:ident($room:ident),)+) => {
        /// How the visible fraction is computed: a technique with its settings.
        ///
        /// The text form of a technique is its name and any settings: `"pcss taps=32"`.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Technique {
            $($(#[$about])*
            #[doc = concat!("\n\nSettings: [`settings::", stringify!($room), "`].")]
            $variant(crate::techniques::$room::Settings),)+
        }

        impl Technique {
            /// The names of all techniques, as on a command line.
            pub const NAMES: &'static [&'static str] =
                &[$(<crate::techniques::$room::Settings as Knobs>::NAME),+];

            /// Every technique with its default settings.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(Default::default()),)+]
            }

            /// The settings as the trait that answers for the technique.
            pub fn room(&self) -> &dyn Room {
                match self {
                    $(Self::$variant(settings) => settings,)+
                }
            }

            fn room_mut(&mut self) -> &mut dyn Room {
                match self {
                    $(Self::$variant(settings) => settings,)+
                }
            }
        }

        /// The settings of each technique, and their choices.
        pub mod settings {
            $(#[doc(inline)]
            pub use crate::techniques::$room::settings as $room;)+
        }

        $(impl From<crate::techniques::$room::Settings> for Technique {
            fn from(settings: crate::techniques::$room::Settings) -> Self {
                Self::$variant(settings)
            }
        })+
    };
}

techniques! {
    /// A shadow map from the light's centre with a 3×3 percentage-closer filter.
    Hard(hard),
    /// Percentage-closer soft shadows (Fernando 2005).
    Pcss(pcss),
    /// The mean of hard shadow maps from points all over the light.
    ManyLights(many_lights),
    /// Occluder texels projected back onto the light, with gaps filled (Guennebaud 2006).
    BackProjection(back_projection),
    /// Micro-patches back-projected onto the light (Atty 2006).
    SoftShadowMap(soft_shadow_map),
    /// Rays through depth layers (Curtis 2009).
    RayMarch(ray_march),
    /// Prefiltered slices, combined (Eisemann and Décoret 2008).
    OcclusionTextures(occlusion_textures),
    /// Visibility channels from warped skins (Heidrich, Brabec and Seidel 2000).
    LinearLight(linear_light),
    /// Samples of the light covered by the triangles themselves.
    Traced(traced),
}

impl Default for Technique {
    fn default() -> Self {
        Self::SoftShadowMap(soft_shadow_map::Settings::default())
    }
}

impl Technique {
    /// The name, as on a command line.
    pub fn name(&self) -> &'static str {
        self.room().name()
    }

    /// The technique's knobs.
    pub fn knobs(&self) -> Vec<Knob> {
        self.room().knobs()
    }

    /// Sets one knob from text.
    ///
    /// # Errors
    /// [`Error::Setting`] for a key that the technique does not have, which names those it has, or for a value that
    /// the knob does not take.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        self.room_mut().set(key, value)
    }

    /// The value of a knob, as [`Self::set`] takes it; none for a key that the technique does not have.
    pub fn get(&self, key: &str) -> Option<String> {
        self.room().get(key)
    }

    /// The side of the light-space maps, texels.
    pub fn map(&self) -> u32 {
        self.room().maps().side
    }

    /// The technique with maps of another side, texels; a technique without maps stays as it is.
    ///
    /// # Errors
    /// [`Error::Setting`] for a side outside 1 to 4096.
    pub fn with_map(mut self, side: u32) -> Result<Self, Error> {
        if self.get("map").is_none() {
            return Ok(self);
        }
        self.set("map", &side.to_string())?;
        Ok(self)
    }

    /// Checks every knob, and those that must agree with each other.
    ///
    /// # Errors
    /// [`Error::Setting`] for the first wrong knob.
    pub fn check(&self) -> Result<(), Error> {
        check(self.room())
    }

    /// The technique for line and polygon lights, which places its samples by itself: `error` is the visible fraction
    /// that may be missed, `samples` the most samples on a line, `lines` the most lines.
    pub(crate) fn along_lines(error: f32, samples: u32, lines: u32) -> Self {
        linear_light::Settings { error, samples, lines, ..Default::default() }.into()
    }
}

/// The name, and the settings that are not the defaults, as [`Technique::from_str`] takes them.
impl fmt::Display for Technique {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let room = self.room();
        f.write_str(room.name())?;
        for knob in room.knobs() {
            let value = room.get(knob.key);
            if value != room.default_of(knob.key) {
                write!(f, " {}={}", knob.key, value.unwrap_or_default())?;
            }
        }
        Ok(())
    }
}

impl FromStr for Technique {
    type Err = Error;

    /// Reads a name and any settings, as in `"ray-march rays=4 map=128"`.
    fn from_str(text: &str) -> Result<Self, Error> {
        let mut words = text.split_whitespace();
        let name = words.next().unwrap_or_default();
        let Some(mut technique) = Self::all().into_iter().find(|t| t.name() == name) else {
            let problem = format!("\"{name}\" is not one of {}", Self::NAMES.join(", "));
            return Err(Error::Setting { key: "technique".into(), problem });
        };
        for word in words {
            let Some((key, value)) = word.split_once('=') else {
                let problem = format!("\"{word}\" is not KEY=VALUE");
                return Err(Error::Setting { key: word.into(), problem });
            };
            technique.set(key, value)?;
        }
        Ok(technique)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::knob::Values;
    use crate::techniques::many_lights;

    fn named(words: &str) -> Technique {
        words.parse().unwrap_or_else(|e| panic!("{words}: {e}"))
    }

    /// A value just below the range, its ends, and one just above it, as text.
    fn around(values: Values) -> [Option<String>; 4] {
        match values {
            Values::Whole(least, most) => [
                Some(least.checked_sub(1).map_or("-1".into(), |x| x.to_string())),
                Some(least.to_string()),
                Some(most.to_string()),
                Some((u64::from(most) + 1).to_string()),
            ],
            Values::Real(least, most) => {
                [least.next_down(), least, most, most.next_up()].map(|x| Some(x.to_string()))
            }
            Values::Choice(names) => [
                Some("no such name".into()),
                names.first().map(|n| (*n).into()),
                names.last().map(|n| (*n).into()),
                Some(String::new()),
            ],
            Values::Switch => ["ON", "on", "off", "1"].map(|text| Some(text.into())),
        }
    }

    /// Both ends of every range are accepted, values just beyond are refused with the legal range, and no knob writes
    /// where another one reads.
    #[test]
    fn every_knob_takes_its_range_and_nothing_else() {
        for plain in Technique::all() {
            let name = plain.name();
            for knob in plain.knobs() {
                let [below, least, most, above] = around(knob.values).map(Option::unwrap);
                for good in [least, most] {
                    let mut technique = plain;
                    technique.set(knob.key, &good).unwrap_or_else(|e| panic!("{name}: {e}"));
                    assert_eq!(technique.get(knob.key), Some(good), "{name} {}", knob.key);
                    for other in plain.knobs().iter().filter(|other| other.key != knob.key) {
                        let (now, before) = (technique.get(other.key), plain.get(other.key));
                        assert_eq!(now, before, "{name}: {} writes {}", knob.key, other.key);
                    }
                }
                for bad in [below, above] {
                    let sentence = { plain }.set(knob.key, &bad).unwrap_err().to_string();
                    assert!(
                        sentence.contains(&knob.values.to_string()),
                        "{name} {}={bad}: {sentence}",
                        knob.key
                    );
                }
            }
        }
    }

    #[test]
    fn defaults_work_and_are_not_written_out() {
        for plain in Technique::all() {
            plain.check().unwrap();
            assert_eq!(plain.to_string(), plain.name());
            assert_eq!(named(plain.name()), plain);
            for knob in plain.knobs() {
                let default = plain.get(knob.key).unwrap();
                assert_eq!(plain.room().default_of(knob.key), Some(default.clone()));
                let mut technique = plain;
                technique.set(knob.key, &default).unwrap();
                assert_eq!(technique, plain);
            }
            assert_eq!(plain.get("no such key"), None);
        }
    }

    #[test]
    fn text_comes_back_as_it_was() {
        for words in
            ["pcss taps=8", "ray-march map=128 rays=4", "linear-light error=0.05 across=edges"]
        {
            let mut sorted: Vec<_> = words.split(' ').collect();
            let shown = named(words).to_string();
            let mut again: Vec<_> = shown.split(' ').collect();
            sorted.sort_unstable();
            again.sort_unstable();
            assert_eq!(sorted, again);
            assert_eq!(named(&shown), named(words));
        }
    }

    #[test]
    fn wrong_words_are_refused_with_what_would_be_right() {
        let refuse = |words: &str| words.parse::<Technique>().unwrap_err().to_string();
        assert!(refuse("psss").contains("hard, pcss, many-lights"));
        assert!(refuse("").contains("hard, pcss, many-lights"));
        assert!(refuse("pcss taps").contains("KEY=VALUE"));
        assert!(
            refuse("pcss rays=4").contains("pcss has no such setting; it has map, views, taps")
        );
        assert!(refuse("soft-shadow-map sides=three").contains("one, bottom, two, mean"));
        assert!(refuse("soft-shadow-map tolerance=NaN").contains("0 to 0.1 (visible fraction)"));
        assert!(refuse("many-lights seed=-1").contains("0 to 4294967295"));
    }

    /// Knobs that are fine alone may be too much together.
    #[test]
    fn knobs_that_do_not_agree_are_refused() {
        let refuse = |words: &str| named(words).check().unwrap_err().to_string();
        assert!(refuse("ray-march map=2048").contains("levels=mip"));
        assert!(refuse("soft-shadow-map accumulate=blend").contains("receivers=map"));
        assert!(refuse("occlusion-textures map=4096").contains("map="));
        assert!(refuse("linear-light map=4096").contains("fewer lines"));
    }

    /// A value that was never set through text is checked as well, and by the technique's own range: many-lights is
    /// not refused for what linear-light does not take.
    #[test]
    fn members_are_checked_against_their_own_technique() {
        let one = many_lights::Settings { samples: 1, ..Default::default() };
        Technique::from(one).check().unwrap();
        let one = linear_light::Settings { samples: 1, ..Default::default() };
        let sentence = Technique::from(one).check().unwrap_err().to_string();
        assert!(sentence.contains("samples") && sentence.contains("2 to 16"), "{sentence}");
    }

    /// `docs/settings.md` agrees with the knobs; `ANTUMBRA_WRITE_DOCS=1 cargo test --workspace --lib` writes it.
    #[test]
    fn the_page_of_settings_is_what_the_knobs_say() {
        let page = page();
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/settings.md");
        if std::env::var("ANTUMBRA_WRITE_DOCS").is_ok_and(|value| value == "1") {
            std::fs::write(path, &page).unwrap();
        }
        let written = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            written == page,
            "docs/settings.md is not what the knobs say; run\n\
             ANTUMBRA_WRITE_DOCS=1 cargo test --workspace --lib the_page_of_settings"
        );
    }

    fn page() -> String {
        let mut page = String::from(
            "# Settings\n\n\
             A technique is written as its name and any settings, `KEY=VALUE` each: `pcss taps=32 map=512`. On the \
             command line of `render` the settings are `--set KEY=VALUE`; in code they are the members of the \
             technique's `Settings`, or `Technique::set`. This page is made from the code by a test.\n",
        );
        for technique in Technique::all() {
            let default = if technique == Technique::default() { ", the default" } else { "" };
            page += &format!(
                "\n## {}{default}\n\n| key | unit | values | default | what it does |\n|---|---|---|---|---|\n",
                technique.name()
            );
            for knob in technique.knobs() {
                let default = technique.get(knob.key).unwrap_or_default();
                let Knob { key, unit, values, about } = knob;
                page += &format!("| `{key}` | {unit} | {values} | {default} | {about} |\n");
            }
        }
        page
    }
}
