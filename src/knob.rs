//! Knobs: the settings of a technique that a user can change, each stated once.
//!
//! A room lists its knobs as [`Field`]s of its settings: key, unit, legal values, a text that says what the knob does,
//! and the functions that get and set it. Ranges, defaults, help texts, errors and `docs/settings.md` follow from
//! that. This file names no technique.

use crate::Error;
use std::fmt;

/// What the knob for the side of maps says, where a map has 256 texels a side by itself.
pub(crate) const MAP_OF_256: &str = "side of the occluder maps; any whole number, and 0 for 256 where one view serves a \
                                     light, 512 where several do";

/// What it says where a map has 128 by itself.
pub(crate) const MAP_OF_128: &str = "side of the occluder maps; any whole number, and 0 for 128 where one view serves a \
                                     light, 512 where several do";

/// The most views of a light that share its receivers.
pub(crate) const MOST_VIEWS: u32 = 8;

/// The values that a knob may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values {
    /// A whole number from the first to the second, both included.
    Whole(u32, u32),
    /// A real number from the first to the second, both included.
    Real(f32, f32),
    /// One of these names.
    Choice(&'static [&'static str]),
    /// The names `on` and `off`.
    Switch,
}

/// Prints the range or the names as part of a sentence.
impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(least, most) => write!(f, "{least} to {most}"),
            Self::Real(least, most) => write!(f, "{least} to {most}"),
            Self::Choice(names) => f.write_str(&names.join(", ")),
            Self::Switch => f.write_str("on, off"),
        }
    }
}

/// A knob in a technique's list, without its technique's type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// The key, as in `--set key=value`.
    pub key: &'static str,
    /// The unit of the value, or `choice` or `switch`.
    pub unit: &'static str,
    /// The values that are legal.
    pub values: Values,
    /// A text that says what the knob does, and what 0 means where 0 is legal.
    pub about: &'static str,
}

/// One knob of the settings `S`, with the functions that read and write it.
#[derive(Debug)]
pub struct Field<S> {
    knob: Knob,
    access: Access<S>,
}

#[derive(Debug)]
enum Access<S> {
    Whole(fn(&S) -> u32, fn(&mut S, u32)),
    Real(fn(&S) -> f32, fn(&mut S, f32)),
    /// Reads the choice's name; writing returns whether the name is one of the choices.
    Choice(fn(&S) -> &'static str, fn(&mut S, &str) -> bool),
    Switch(fn(&S) -> bool, fn(&mut S, bool)),
}

impl<S> Field<S> {
    /// A knob with whole numbers in a range, both ends included.
    pub const fn whole(
        key: &'static str,
        unit: &'static str,
        [least, most]: [u32; 2],
        about: &'static str,
        get: fn(&S) -> u32,
        set: fn(&mut S, u32),
    ) -> Self {
        let knob = Knob { key, unit, values: Values::Whole(least, most), about };
        Self { knob, access: Access::Whole(get, set) }
    }

    /// A knob with real numbers in a range, both ends included.
    pub const fn real(
        key: &'static str,
        unit: &'static str,
        [least, most]: [f32; 2],
        about: &'static str,
        get: fn(&S) -> f32,
        set: fn(&mut S, f32),
    ) -> Self {
        let knob = Knob { key, unit, values: Values::Real(least, most), about };
        Self { knob, access: Access::Real(get, set) }
    }

    /// A knob with one of a few names; `set` returns whether a name is one of them.
    pub const fn choice(
        key: &'static str,
        names: &'static [&'static str],
        about: &'static str,
        get: fn(&S) -> &'static str,
        set: fn(&mut S, &str) -> bool,
    ) -> Self {
        let knob = Knob { key, unit: "choice", values: Values::Choice(names), about };
        Self { knob, access: Access::Choice(get, set) }
    }

    /// A knob that is on or off.
    pub const fn switch(
        key: &'static str,
        about: &'static str,
        get: fn(&S) -> bool,
        set: fn(&mut S, bool),
    ) -> Self {
        let knob = Knob { key, unit: "switch", values: Values::Switch, about };
        Self { knob, access: Access::Switch(get, set) }
    }

    /// The knob for the side of the light-space maps, which every technique has.
    pub const fn map(get: fn(&S) -> u32, set: fn(&mut S, u32)) -> Self {
        const ABOUT: &str = "side of the occluder map, or of each of several; any whole number";
        Self::whole("map", "texels", [1, 4096], ABOUT, get, set)
    }

    /// The knob for the side of the light-space maps of techniques with several views; `about` says what 0 means.
    pub const fn map_of_views(
        about: &'static str,
        get: fn(&S) -> u32,
        set: fn(&mut S, u32),
    ) -> Self {
        Self::whole("map", "texels", [0, 4096], about, get, set)
    }

    /// The knob for the most views that a light is seen through.
    pub const fn views(get: fn(&S) -> u32, set: fn(&mut S, u32)) -> Self {
        const ABOUT: &str = "most views of a light, each with a map for a part of what the light reaches; a light that \
                             one serves gets one. Any whole number";
        Self::whole("views", "views", [1, MOST_VIEWS], ABOUT, get, set)
    }

    /// The switch of techniques that skip tiles of pixels.
    pub const fn classify(get: fn(&S) -> bool, set: fn(&mut S, bool)) -> Self {
        const ABOUT: &str = "skip 8×8-pixel tiles that no occluder can shadow, where visibility is computed at the \
                             pixels; the image is the same, and off is for measuring what that saves";
        Self::switch("classify", ABOUT, get, set)
    }

    fn text(&self, settings: &S) -> String {
        match self.access {
            Access::Whole(get, _) => get(settings).to_string(),
            Access::Real(get, _) => get(settings).to_string(),
            Access::Choice(get, _) => get(settings).into(),
            Access::Switch(get, _) => if get(settings) { "on" } else { "off" }.into(),
        }
    }

    fn set(&self, settings: &mut S, text: &str) -> Result<(), Error> {
        let refuse = |problem: String| Err(self.refusal(&problem));
        match (&self.access, text.trim()) {
            (Access::Whole(_, set), text) => match text.parse() {
                Ok(number) => set(settings, number),
                Err(e) => return refuse(format!("\"{text}\" is no whole number ({e})")),
            },
            (Access::Real(_, set), text) => match text.parse() {
                Ok(number) => set(settings, number),
                Err(e) => return refuse(format!("\"{text}\" is no number ({e})")),
            },
            (Access::Choice(_, set), text) => {
                if !set(settings, text) {
                    return refuse(format!("\"{text}\" is not one of its choices"));
                }
            }
            (Access::Switch(_, set), "on") => set(settings, true),
            (Access::Switch(_, set), "off") => set(settings, false),
            (Access::Switch(..), text) => {
                return refuse(format!("\"{text}\" is neither on nor off"));
            }
        }
        self.check(settings)
    }

    /// Checks that the value lies within the range; choices and switches always do.
    fn check(&self, settings: &S) -> Result<(), Error> {
        let good = match (&self.access, self.knob.values) {
            (Access::Whole(get, _), Values::Whole(least, most)) => {
                (least..=most).contains(&get(settings))
            }
            (Access::Real(get, _), Values::Real(least, most)) => {
                (least..=most).contains(&get(settings))
            }
            _ => true,
        };
        if good {
            return Ok(());
        }
        Err(self.refusal(&format!("{} is outside its range", self.text(settings))))
    }

    fn refusal(&self, problem: &str) -> Error {
        let Knob { key, unit, values, .. } = &self.knob;
        let legal = match values {
            Values::Choice(_) | Values::Switch => values.to_string(),
            _ => format!("{values} ({unit})"),
        };
        Error::Setting { key: (*key).into(), problem: format!("{problem}; give {legal}") }
    }
}

/// A room's settings with all of their knobs.
pub trait Knobs: Default + 'static {
    /// The technique's name, as on a command line.
    const NAME: &'static str;
    /// The knobs, in the order in which a reader wants them.
    const FIELDS: &'static [Field<Self>];
}

/// The methods of settings with [`Knobs`], for settings whose type is not known.
pub trait Tune {
    /// The technique's name, as on a command line.
    fn name(&self) -> &'static str;

    /// The technique's knobs.
    fn knobs(&self) -> Vec<Knob>;

    /// The value of a knob as text; none for a key that the technique does not have.
    fn get(&self, key: &str) -> Option<String>;

    /// The value that a knob has by default, as text; none for a key that the technique does not have.
    fn default_of(&self, key: &str) -> Option<String>;

    /// Sets a knob from text.
    ///
    /// # Errors
    /// [`Error::Setting`] for a key that the technique does not have, which names those it has, or for a value that
    /// the knob does not take, which says those it takes.
    fn set(&mut self, key: &str, value: &str) -> Result<(), Error>;

    /// Checks every knob against its range.
    ///
    /// # Errors
    /// [`Error::Setting`] for the first knob whose value is outside its range.
    fn check_ranges(&self) -> Result<(), Error>;
}

fn field<S: Knobs>(key: &str) -> Option<&'static Field<S>> {
    S::FIELDS.iter().find(|field| field.knob.key == key)
}

impl<S: Knobs> Tune for S {
    fn name(&self) -> &'static str {
        S::NAME
    }

    fn knobs(&self) -> Vec<Knob> {
        S::FIELDS.iter().map(|field| field.knob).collect()
    }

    fn get(&self, key: &str) -> Option<String> {
        field::<S>(key).map(|field| field.text(self))
    }

    fn default_of(&self, key: &str) -> Option<String> {
        S::default().get(key)
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        let Some(field) = field::<S>(key) else {
            let known: Vec<_> = S::FIELDS.iter().map(|field| field.knob.key).collect();
            let problem = format!("{} has no such setting; it has {}", S::NAME, known.join(", "));
            return Err(Error::Setting { key: key.into(), problem });
        };
        field.set(self, value)
    }

    fn check_ranges(&self) -> Result<(), Error> {
        S::FIELDS.iter().try_for_each(|field| field.check(self))
    }
}

/// Declares the names of an enum's variants, and the conversions between both.
macro_rules! choices {
    ($type:ty: $($name:literal => $variant:ident),+ $(,)?) => {
        impl $type {
            /// The variants, in the order of [`Self::NAMES`].
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];
            /// The variants' names, in order.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// The variant's name.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }

            /// The variant with a name; none where there is no such variant.
            pub fn named(name: &str) -> Option<Self> {
                match name {
                    $($name => Some(Self::$variant),)+
                    _ => None,
                }
            }
        }
    };
}

/// Declares the field of a choice: its key, its type, its text, and the member of the settings that holds it.
macro_rules! choice {
    ($key:literal, $type:ty, $about:expr, $($member:ident).+) => {
        $crate::knob::Field::choice(
            $key,
            <$type>::NAMES,
            $about,
            |settings| settings.$($member).+.name(),
            |settings, name| <$type>::named(name).map(|choice| settings.$($member).+ = choice).is_some(),
        )
    };
}

pub(crate) use {choice, choices};
