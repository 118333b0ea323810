//! The techniques, and the one place that knows all of them.

use crate::Error;
use crate::knob::{Knob, Knobs};
use crate::techniques::room::{Room, check};
use crate::techniques::{
    back_projection, hard, linear_light, many_lights, occlusion_textures, pcss, ray_march,
    soft_shadow_map,
};
use std::fmt;
use std::str::FromStr;

macro_rules! techniques {
    ($($(#[$about:meta])+ $variant:ident($room:ident),)+) => {
        /// How the visible fraction is computed: a technique with its settings.
        ///
        /// As text it is the technique's name and any settings: `"pcss taps=32"`.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Technique {
            $($(#[$about])+ $variant($room::Settings),)+
        }

        impl Technique {
            /// The names of all techniques, as on a command line.
            pub const NAMES: &'static [&'static str] =
                &[$(<$room::Settings as Knobs>::NAME),+];

            /// Every technique with its default settings.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant($room::Settings::default()),)+]
            }

            /// The settings, as what answers for the technique.
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

        $(impl From<$room::Settings> for Technique {
            fn from(settings: $room::Settings) -> Self {
                Self::$variant(settings)
            }
        })+
    };
}

techniques! {
    /// A shadow map from the light's centre, 3×3 percentage-closer filtered.
    Hard(hard),
    /// Percentage-closer soft shadows (Fernando 2005).
    Pcss(pcss),
    /// The mean of hard shadow maps from points all over the light.
    ManyLights(many_lights),
    /// Occluder texels projected back onto the light, gaps filled (Guennebaud 2006).
    BackProjection(back_projection),
    /// Micro-patches back-projected onto the light (Atty 2006).
    SoftShadowMap(soft_shadow_map),
    /// Rays through depth layers (Curtis 2009).
    RayMarch(ray_march),
    /// Prefiltered slices, combined (Eisemann and Décoret 2008).
    OcclusionTextures(occlusion_textures),
    /// Visibility channels from warped skins (Heidrich, Brabec and Seidel 2000).
    LinearLight(linear_light),
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

    /// The technique with maps of another side, texels.
    ///
    /// # Errors
    /// [`Error::Setting`] for a side outside 1 to 4096.
    pub fn with_map(mut self, side: u32) -> Result<Self, Error> {
        self.set("map", &side.to_string())?;
        Ok(self)
    }

    /// Checks every knob, and those that must agree with each other.
    ///
    /// # Errors
    /// [`Error::Setting`] for the first that is wrong.
    pub fn check(&self) -> Result<(), Error> {
        check(self.room())
    }

    /// The technique for lines and polygons, which places its samples by an error itself: a visible fraction that may be
    /// missed, the most samples on a line, and the most lines.
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
