//! The items of a glTF file that the `gltf` crate reads: materials, textures, samplers, images, skins, animations and lights.
//!
//! Each is text until something that is shown uses it, and is then read alone, with every index followed by
//! [`at`]: what is wrong with an item stops nothing that does not need it, and three bytes of a file,
//! `{},`, are 16 of the memory and not the crate's 968 of a material.

use super::Problem;
use super::json::{at, shortened};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

/// A list's items, each as text.
type Items<'a> = Vec<&'a RawValue>;

#[derive(Default, Deserialize)]
pub(super) struct Document<'a> {
    #[serde(borrow, default, deserialize_with = "lenient")]
    pub materials: Items<'a>,
    #[serde(borrow, default, deserialize_with = "lenient")]
    pub textures: Items<'a>,
    #[serde(borrow, default, deserialize_with = "lenient")]
    pub samplers: Items<'a>,
    #[serde(borrow, default, deserialize_with = "lenient")]
    pub images: Items<'a>,
    #[serde(borrow, default, deserialize_with = "lenient")]
    pub skins: Items<'a>,
    #[serde(borrow, default, deserialize_with = "lenient")]
    pub animations: Items<'a>,
    #[serde(borrow, default, deserialize_with = "lenient")]
    pub extensions: Extensions<'a>,
}

/// The extensions of the whole file.
#[derive(Default, Deserialize)]
pub(super) struct Extensions<'a> {
    #[serde(borrow, default, rename = "KHR_lights_punctual", deserialize_with = "lenient")]
    pub punctual: Lights<'a>,
    #[serde(borrow, default, rename = "EXT_lights_area", deserialize_with = "lenient")]
    pub ext_area: Lights<'a>,
    #[serde(borrow, default, rename = "KHR_lights_area", deserialize_with = "lenient")]
    pub khr_area: Lights<'a>,
}

#[derive(Default, Deserialize)]
pub(super) struct Lights<'a> {
    #[serde(borrow, default, deserialize_with = "lenient")]
    pub lights: Items<'a>,
}

/// A member, empty where it is something else than it should be.
fn lenient<'de, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: Default + Deserialize<'de>,
{
    let text: &'de RawValue = Deserialize::deserialize(deserializer)?;
    Ok(serde_json::from_str(text.get()).unwrap_or_default())
}

/// Item `index` of the list called `what`, which `owner` refers to.
pub(super) fn item<T: DeserializeOwned>(
    items: &[&RawValue],
    index: usize,
    what: &str,
    owner: impl FnOnce() -> String,
) -> Result<T, Problem> {
    let text = at(items, index, what, owner)?.get();
    serde_json::from_str(text)
        .map_err(|e| format!("{what}[{index}] is wrong: {}", shortened(&e.to_string())))
}
