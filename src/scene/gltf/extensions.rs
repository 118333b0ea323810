//! Extensions of glTF: those that a file may require, and the parts of its JSON that they add.

use super::Problem;
use crate::error::quoted;
use serde::Deserialize;
use serde::de::IgnoredAny;
#[cfg(feature = "draco")]
use std::collections::BTreeMap;

/// The extension by which positions and normals may be integers.
pub(super) const QUANTIZATION: &str = "KHR_mesh_quantization";

/// The extensions that a file may require because they are read.
const READ: &[&str] = &[
    QUANTIZATION,
    "KHR_node_visibility",
    "EXT_lights_area",
    "KHR_lights_area",
    "EXT_mesh_gpu_instancing",
    #[cfg(feature = "draco")]
    DRACO,
    #[cfg(feature = "meshopt")]
    MESHOPT[0],
    #[cfg(feature = "meshopt")]
    MESHOPT[1],
];

/// The extension by which a primitive is a Draco stream.
const DRACO: &str = "KHR_draco_mesh_compression";

/// The extensions by which a buffer view is what meshoptimizer made of it.
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The first letters of the extensions that a file may require because they change neither triangles nor transforms.
const HARMLESS: &[&str] = &[
    "ADOBE_materials_",
    "AGI_",
    "CESIUM_primitive_outline",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_lights_",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "EXT_texture_",
    "FB_geometry_metadata",
    "KHR_animation_pointer",
    "KHR_audio",
    "KHR_interactivity",
    "KHR_lights_punctual",
    "KHR_materials_",
    "KHR_physics_",
    "KHR_technique",
    "KHR_texture_",
    "KHR_xmp",
    "MSFT_lod",
    "MSFT_packing_",
    "MSFT_texture_",
    "OMI_",
    "VRMC_",
];

/// Why a file that requires these extensions cannot be read; `None` where it can.
pub(super) fn refusal(required: &[String]) -> Option<Problem> {
    let is_known =
        |name: &str| READ.contains(&name) || HARMLESS.iter().any(|known| name.starts_with(known));
    let name = required.iter().find(|name| !is_known(name))?;
    let how = match name.as_str() {
        DRACO => "which the crate's feature draco reads; build with it, or export it without",
        name if MESHOPT.contains(&name) => {
            "which the crate's feature meshopt reads; build with it, or export it without"
        }
        _ => "which is not supported; export it without",
    };
    Some(format!("it requires the extension {}, {how}", quoted(name)))
}

/// The extensions of a node that change what stands where.
#[derive(Debug, Deserialize)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Option<Visibility>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
    #[serde(rename = "KHR_lights_punctual")]
    pub punctual: Option<LightOfNode>,
    #[serde(rename = "EXT_lights_area")]
    pub ext_area: Option<LightOfNode>,
    #[serde(rename = "KHR_lights_area")]
    pub khr_area: Option<LightOfNode>,
}

impl NodeExtensions {
    /// Whether there is a light at the node.
    pub fn shines(&self) -> bool {
        self.punctual.is_some() || self.ext_area.is_some() || self.khr_area.is_some()
    }
}

/// The light at a node.
#[derive(Debug, Deserialize)]
pub(super) struct LightOfNode {
    pub light: usize,
}

#[derive(Debug, Deserialize)]
pub(super) struct Visibility {
    #[serde(default = "yes")]
    pub visible: bool,
}

fn yes() -> bool {
    true
}

#[derive(Debug, Deserialize)]
pub(super) struct Instancing {
    #[serde(default)]
    pub attributes: InstanceAttributes,
}

/// The accessors of how instances stand within their node.
#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) struct InstanceAttributes {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}

#[cfg(feature = "draco")]
#[derive(Debug, Deserialize)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub draco: Option<Draco>,
}

/// A primitive whose elements a Draco stream holds.
#[cfg(feature = "draco")]
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Draco {
    pub buffer_view: usize,
    /// The numbers that the stream gives its attributes.
    pub attributes: BTreeMap<String, u32>,
}

#[cfg(feature = "meshopt")]
#[derive(Debug, Deserialize)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    ext: Option<Meshopt>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr: Option<Meshopt>,
}

#[cfg(feature = "meshopt")]
impl ViewExtensions {
    /// What meshoptimizer made of a buffer view: the ratified extension's where there are both.
    pub fn meshopt(&self) -> Option<&Meshopt> {
        self.khr.as_ref().or(self.ext.as_ref())
    }
}

/// A buffer view as meshoptimizer compressed it.
#[cfg(feature = "meshopt")]
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Meshopt {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: u64,
    pub count: u64,
    pub mode: String,
    pub filter: Option<String>,
}

/// What is read of a material in which something else is wrong.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct RestOfMaterial {
    #[serde(default)]
    pub double_sided: bool,
    alpha_mode: Option<String>,
    extensions: Option<RestOfExtensions>,
}

#[derive(Deserialize)]
pub(super) struct RestOfExtensions {
    #[serde(rename = "KHR_materials_transmission")]
    transmission: Option<IgnoredAny>,
}

impl RestOfMaterial {
    /// Whether it stops all light, whatever is wrong.
    pub fn is_whole(&self) -> bool {
        let transmits = self.extensions.as_ref().is_some_and(|e| e.transmission.is_some());
        !transmits && self.alpha_mode.as_deref().is_none_or(|mode| mode == "OPAQUE")
    }
}
