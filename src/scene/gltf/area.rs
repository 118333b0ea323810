//! Lights of the drafts EXT_lights_area and KHR_lights_area.
//!
//! Both list lights in the file's extensions, and a node has one by its number. The first has rectangles and disks of a
//! `size` that the largest of the node's scales makes larger; the second the shapes of this project's extras. Their
//! intensities are in nits, the unit of an area light's radiance.

use super::Problem;
use super::document::{Document, item};
use super::extras::{self, center, emission, unusable};
use super::json::{Root, at};
use super::nodes::{self, Placed};
use crate::error::quoted;
use crate::scene::AreaLight;
use crate::{Light, RectangleLight};
use glam::DMat4;
use serde::Deserialize;
use serde_json::json;

/// A light of either draft.
#[derive(Deserialize)]
struct Area {
    /// The name of what it is: the one draft calls it `type`, the other `shape`.
    #[serde(alias = "type")]
    shape: String,
    #[serde(default = "white")]
    color: [f32; 3],
    intensity: Option<f32>,
    /// The length along y, or the diameter.
    size: Option<f64>,
    #[serde(default)]
    rect: Rect,
    width: Option<f64>,
    height: Option<f64>,
    radius: Option<f64>,
}

#[derive(Default, Deserialize)]
struct Rect {
    /// The width as a multiple of the height.
    aspect: Option<f64>,
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

/// The luminance of a light that does not say it, in nits, by EXT_lights_area and by KHR_lights_area.
const NITS: [f32; 2] = [1000.0, 1.0];

/// The node's light; `None` where it has none.
pub(super) fn light(
    (root, document): (&Root, &Document),
    placed: &Placed,
) -> Result<Option<AreaLight>, Problem> {
    let label = || nodes::label(root, placed.node);
    let node = at(&root.nodes, placed.node, "nodes", label)?;
    let Some(extensions) = node.extensions.as_ref() else { return Ok(None) };
    let lists = &document.extensions;
    let (lights, index, what, nits) = match (&extensions.ext_area, &extensions.khr_area) {
        (Some(of), _) => (&lists.ext_area.lights, of.light, "EXT_lights_area", NITS[0]),
        (None, Some(of)) => (&lists.khr_area.lights, of.light, "KHR_lights_area", NITS[1]),
        (None, None) => return Ok(None),
    };
    let of: Area = item(lights, index, &format!("extensions.{what}.lights"), label)?;
    let light = if extensions.ext_area.is_some() {
        sized(&of, &placed.world)
    } else {
        shaped(&of, &placed.world)
    };
    let light = light.map_err(|problem| format!("{}: {problem}", label()))?;
    let intensity = of.intensity.unwrap_or(nits);
    if !of.color.iter().chain([&intensity]).all(|of| of.is_finite() && *of >= 0.0) {
        return Err(format!(
            "{}: its light's color and intensity must be finite numbers from 0 up",
            label()
        ));
    }
    Ok(Some(AreaLight { name: nodes::name(root, placed.node), light, color: of.color, intensity }))
}

/// A rectangle or a disk by EXT_lights_area: the node turns it, and its largest scale makes it larger.
fn sized(of: &Area, world: &DMat4) -> Result<Light, Problem> {
    let axes = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate());
    let scale = axes.into_iter().map(|axis| axis.length()).fold(0.0, f64::max);
    let size = of.size.unwrap_or(1.0) * scale;
    let [least, most] = extras::SIDES;
    let sides = [size * of.rect.aspect.unwrap_or(1.0), size];
    if let Some(side) = sides.into_iter().find(|side| !(least..=most).contains(side)) {
        return Err(format!(
            "a side of its light, with the node's scale, is {side} m; it must be from {least:e} to {most:e} m"
        ));
    }
    let center = center(world)?;
    let light = match of.shape.as_str() {
        "rect" => RectangleLight::facing(center, emission(world), axes[1], sides).map(Light::from),
        "disk" => Light::disc(center, emission(world), 0.5 * size),
        other => return Err(format!("its light is a {}; there are rect and disk", quoted(other))),
    };
    light.map_err(unusable)
}

/// A rectangle, disk or sphere by KHR_lights_area, which goes with the node's transform as one of its extras does.
fn shaped(of: &Area, world: &DMat4) -> Result<Light, Problem> {
    let or_one = |length: Option<f64>| length.unwrap_or(1.0);
    let members = json!({
        "width": or_one(of.width), "height": or_one(of.height), "radius": or_one(of.radius)
    });
    match of.shape.as_str() {
        "rect" => extras::rectangle(&members, world),
        "disk" => extras::disk(&members, world),
        "sphere" => extras::sphere(&members, world),
        other => Err(format!("its light is a {}; there are rect, disk and sphere", quoted(other))),
    }
}
