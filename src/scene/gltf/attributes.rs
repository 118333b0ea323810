//! The attributes of a primitive, by the accessors of their elements.

use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, Visitor};
use std::fmt;

/// What a triangle's corners have.
#[derive(Debug, Default)]
pub(super) struct Attributes {
    pub position: Option<usize>,
    pub normal: Option<usize>,
    pub color: Option<usize>,
    pub joints_0: Option<usize>,
    pub weights_0: Option<usize>,
    pub joints_1: Option<usize>,
    pub weights_1: Option<usize>,
    /// The sets of texture coordinates, each with its number: `TEXCOORD_0` and so on.
    pub coordinates: Vec<(u32, usize)>,
}

/// The first letters of a set of texture coordinates.
const COORDINATES: &str = "TEXCOORD_";

impl Attributes {
    /// The accessor of the texture coordinates of this number.
    pub fn coordinates(&self, set: u32) -> Option<usize> {
        self.coordinates.iter().find(|(number, _)| *number == set).map(|(_, accessor)| *accessor)
    }

    /// Those that there are, each by its name.
    #[cfg(feature = "draco")]
    pub fn all(&self) -> impl Iterator<Item = (String, usize)> {
        let named = [
            ("POSITION", self.position),
            ("NORMAL", self.normal),
            ("JOINTS_0", self.joints_0),
            ("WEIGHTS_0", self.weights_0),
            ("JOINTS_1", self.joints_1),
            ("WEIGHTS_1", self.weights_1),
        ];
        let named = named.into_iter().filter_map(|(name, of)| Some((name.to_owned(), of?)));
        let sets = self.coordinates.iter().map(|(set, of)| (format!("{COORDINATES}{set}"), *of));
        named.chain(sets)
    }
}

impl<'de> Deserialize<'de> for Attributes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Names)
    }
}

struct Names;

impl<'de> Visitor<'de> for Names {
    type Value = Attributes;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the attributes of a primitive")
    }

    fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Attributes, M::Error> {
        let mut of = Attributes::default();
        while let Some(name) = map.next_key::<String>()? {
            let place = match name.as_str() {
                "POSITION" => &mut of.position,
                "NORMAL" => &mut of.normal,
                "COLOR_0" => &mut of.color,
                "JOINTS_0" => &mut of.joints_0,
                "WEIGHTS_0" => &mut of.weights_0,
                "JOINTS_1" => &mut of.joints_1,
                "WEIGHTS_1" => &mut of.weights_1,
                other => {
                    match other.strip_prefix(COORDINATES).and_then(|set| set.parse().ok()) {
                        Some(set) => {
                            let accessor: Option<usize> = map.next_value()?;
                            of.coordinates.extend(accessor.map(|accessor| (set, accessor)));
                        }
                        None => drop(map.next_value::<IgnoredAny>()?),
                    }
                    continue;
                }
            };
            *place = map.next_value()?;
        }
        Ok(of)
    }
}
