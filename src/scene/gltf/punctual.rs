//! Lights of KHR_lights_punctual, with the size that they lack.
//!
//! A point of I candela is a sphere of the radiance I/(π r²), a spot a disc of that, which is what they come to far away.
//! A directional light of E lux is a sun of the radiance E over its solid angle.

use super::document::{Document, item};
use super::extras::{center, emission, sun_of, unusable};
use super::json::{Root, at};
use super::nodes::{self, Placed};
use super::{Bounds, Problem};
use crate::scene::AreaLight;
use crate::{Light, RectangleLight};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Punctual, Type};
use gltf::json::validation::Checked;
use serde_json::Value;
use std::f64::consts::PI;

/// The angular size of the sun as the earth sees it, radians.
const SUN: f64 = 0.0093;

/// The list of lights.
const LIGHTS: &str = "extensions.KHR_lights_punctual.lights";

/// The least and the largest radius, metres, beside 0.
const RADII: [f64; 2] = [5e-7, 5e5];

/// The node's light; `None` where it has none. Its radius, or angular size, is what the node's extras say, or the light's own,
/// or `radius`. A light without one is a point.
pub(super) fn light(
    (root, document): (&Root, &Document),
    placed: &Placed,
    all: &Bounds,
    radius: f64,
) -> Result<Option<AreaLight>, Problem> {
    let label = || nodes::label(root, placed.node);
    let node = at(&root.nodes, placed.node, "nodes", label)?;
    let Some(of) = node.extensions.as_ref().and_then(|e| e.punctual.as_ref()) else {
        return Ok(None);
    };
    let lights = &document.extensions.punctual.lights;
    let punctual: Punctual = item(lights, of.light, LIGHTS, label)?;
    let of_light = punctual.extras.as_ref();
    let of_light: Value =
        of_light.and_then(|text| serde_json::from_str(text.get()).ok()).unwrap_or_default();
    let sentence = |problem: Problem| format!("{}: {problem}", label());
    let number = |key: &str, otherwise: f64| {
        let value = node.extras.get(key).or_else(|| of_light.get(key));
        let number = value.map_or(Some(otherwise), Value::as_f64);
        number
            .filter(|number| number.is_finite() && *number >= 0.0)
            .ok_or_else(|| sentence(format!("its {key} is no number from 0 up")))
    };
    let (world, brightness) = (&placed.world, f64::from(punctual.intensity));
    let (light, size) = if let Checked::Valid(Type::Directional) = punctual.type_ {
        let angle = number("angular_size", SUN)?;
        let tangent = (0.5 * angle).tan();
        (sun_of(angle, world, all), PI * tangent * tangent)
    } else {
        let radius = number("radius", radius)?;
        if radius > 0.0 && !(RADII[0]..=RADII[1]).contains(&radius) {
            let [least, most] = RADII;
            return Err(sentence(format!(
                "its radius is {radius} m; it must be 0, or from {least:e} to {most:e} m"
            )));
        }
        let (center, size) = (center(world).map_err(sentence)?, PI * radius * radius);
        let light = match (punctual.type_, radius > 0.0) {
            (Checked::Valid(Type::Point), true) => Light::sphere(center, radius),
            (Checked::Valid(Type::Point), false) => Light::point(center),
            (Checked::Valid(Type::Spot), true) => Light::disc(center, emission(world), radius),
            (Checked::Valid(Type::Spot), false) => {
                RectangleLight::point(center, emission(world)).map(Light::from)
            }
            (Checked::Valid(Type::Directional) | Checked::Invalid, _) => {
                return Err(sentence(format!(
                    "{LIGHTS}[{}] is of no type that there is: directional, point and spot",
                    of.light
                )));
            }
        };
        (light.map_err(unusable), if radius > 0.0 { size } else { 1.0 })
    };
    let light = light.map_err(sentence)?;
    let intensity = (brightness / size) as f32;
    let color = punctual.color;
    if !(intensity.is_finite()
        && intensity >= 0.0
        && color.iter().all(|c| c.is_finite() && *c >= 0.0))
    {
        return Err(sentence(
            "its light's color and intensity must be finite numbers from 0 up".into(),
        ));
    }
    Ok(Some(AreaLight { name: nodes::name(root, placed.node), light, color, intensity }))
}
