//! Area lights and shadow roles, read from the extras of nodes.
//!
//! glTF 2.0 has no area light; extras are what Blender writes a node's custom properties to.
//!
//! | `area_light` | other keys, in metres of the node's space | light |
//! |---|---|---|
//! | `rectangle` | `width`, `height` | the node's XY plane, along its −Z; one side of 0: a line; both: a point |
//! | `polygon` | `corners` | as a rectangle |
//! | `disk` | `radius` | as a rectangle |
//! | `sphere` | `radius` | to all sides |
//! | `capsule` | `radius`, `length` between the centres of its caps, along the node's X | to all sides |
//! | `sun` | `angular_size`, radians | along the node's −Z, from infinitely far away |

use super::json::Root;
use super::{MAX_COORDINATE, Problem, nodes};
use crate::error::quoted;
use crate::scene::{AreaLight, Bounds, Role};
use crate::{Error, Light, RectangleLight};
use glam::{DMat4, DVec3};
use serde_json::Value;

/// The shortest and longest side of a light in the world, in metres: techniques divide by its area,
/// in f32 on the GPU, and multiply by it.
pub(super) const SIDES: [f64; 2] = [1e-6, 1e6];

/// The largest difference of a node's scales along its axes, relative to them, and the largest cosine of the angles
/// between these axes, for a light that must stay round: files write both as f32.
const UNEVEN: f64 = 1e-4;

/// The node's `shadow_role`, or [`Role::Both`].
pub(super) fn role(extras: &Value) -> Result<Role, Problem> {
    let Some(value) = extras.get("shadow_role") else { return Ok(Role::default()) };
    value.as_str().and_then(|word| word.parse().ok()).ok_or_else(|| {
        format!("its shadow_role is {}; write occluder, receiver or both", shown(value))
    })
}

/// The node's area light, if it has one: its shape carried into the world. A sun shines on `all`, the box of
/// what casts shadows.
pub(super) fn light(
    root: &Root,
    node: usize,
    extras: &Value,
    world: &DMat4,
    all: &Bounds,
) -> Result<Option<AreaLight>, Problem> {
    let Some(kind) = extras.get("area_light") else { return Ok(None) };
    let sentence = |problem: Problem| format!("{}: {problem}", nodes::label(root, node));
    let light = match kind.as_str() {
        Some("rectangle") => rectangle(extras, world),
        Some("polygon") => polygon(extras, world),
        Some("disk") => disk(extras, world),
        Some("sphere") => sphere(extras, world),
        Some("capsule") => capsule(extras, world),
        Some("sun") => sun(extras, world, all),
        _ => Err(format!(
            "its area_light is {}; write \"rectangle\", \"polygon\", \"disk\", \"sphere\", \"capsule\" or \"sun\"",
            shown(kind)
        )),
    };
    let light = light.map_err(sentence)?;
    let color = color(extras).map_err(sentence)?;
    let intensity = match extras.get("intensity") {
        Some(value) => brightness(value, "intensity").map_err(sentence)?,
        None => 1.0,
    };
    Ok(Some(AreaLight { name: nodes::name(root, node), light, color, intensity }))
}

/// Where the node stands.
pub(super) fn center(world: &DMat4) -> Result<DVec3, Problem> {
    let center = world.w_axis.truncate();
    if center.abs().max_element() <= MAX_COORDINATE {
        return Ok(center);
    }
    Err(format!("it lies further than {MAX_COORDINATE:e} m from the origin"))
}

/// What a light refuses, as the end of a sentence that names the node.
pub(super) fn unusable(error: Error) -> Problem {
    match error {
        Error::Light(problem) => format!("its light cannot be used: {problem}"),
        other => other.to_string(),
    }
}

/// A rectangle in the node's X and Y, or of a side of 0 a line along the other, or of two a point.
pub(super) fn rectangle(extras: &Value, world: &DMat4) -> Result<Light, Problem> {
    let (width, height) = (side(extras, "width")?, side(extras, "height")?);
    let center = center(world)?;
    let half_u = world.x_axis.truncate() * (0.5 * width);
    let half_v = world.y_axis.truncate() * (0.5 * height);
    let light = match (width == 0.0, height == 0.0) {
        (true, true) => {
            return RectangleLight::point(center, emission(world))
                .map(Light::from)
                .map_err(unusable);
        }
        (false, true) => line(center, in_range("width", half_u)?, world),
        (true, false) => line(center, in_range("height", half_v)?, world),
        (false, false) => {
            let (half_u, half_v) = (in_range("width", half_u)?, in_range("height", half_v)?);
            // Light leaves along half_v × half_u. Where the node mirrors, that is its +Z: turn one axis.
            let turned = half_v.cross(half_u).dot(-world.z_axis.truncate()) < 0.0;
            RectangleLight::new(center, half_u, if turned { -half_v } else { half_v })
        }
    };
    let skewed = "a node above it with a rotation and an uneven scale may skew it";
    light.map(Light::from).map_err(|e| format!("{}; {skewed}", unusable(e)))
}

/// A disk about the node's origin in its X and Y.
pub(super) fn disk(extras: &Value, world: &DMat4) -> Result<Light, Problem> {
    let (center, radius) = (center(world)?, radius(extras, world)?);
    Light::disc(center, emission(world), radius).map_err(unusable)
}

/// A sphere about the node's origin.
pub(super) fn sphere(extras: &Value, world: &DMat4) -> Result<Light, Problem> {
    Light::sphere(center(world)?, radius(extras, world)?).map_err(unusable)
}

/// A capsule about the node's origin, along its X.
fn capsule(extras: &Value, world: &DMat4) -> Result<Light, Problem> {
    let (center, radius) = (center(world)?, radius(extras, world)?);
    let half_axis = world.x_axis.truncate() * (0.5 * side(extras, "length")?);
    let whole = 2.0 * (half_axis.length() + radius);
    if whole > SIDES[1] {
        return Err(format!(
            "its length with its caps and the node's scale is {whole} m; it must be at most {:e} m",
            SIDES[1]
        ));
    }
    Light::capsule(center, half_axis, radius).map_err(unusable)
}

/// The radius in the world, if the node scales all axes alike and the diameter there is a light's side.
fn radius(extras: &Value, world: &DMat4) -> Result<f64, Problem> {
    let radius = side(extras, "radius")?;
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate());
    let scale = x.length();
    let differs = |axis: DVec3| (axis.length() - scale).abs() > UNEVEN * scale;
    let leans = |a: DVec3, b: DVec3| a.dot(b).abs() > UNEVEN * scale * scale;
    if differs(y) || differs(z) || leans(x, y) || leans(y, z) || leans(z, x) {
        return Err(format!(
            "its light is round, and the node's scale is {}, {} and {} along its axes, or skews them; scale all alike",
            scale,
            y.length(),
            z.length()
        ));
    }
    let diameter = 2.0 * radius * scale;
    if (SIDES[0]..=SIDES[1]).contains(&diameter) {
        return Ok(radius * scale);
    }
    Err(format!(
        "twice its radius with the node's scale is {diameter} m; it must be from {:e} to {:e} m",
        SIDES[0], SIDES[1]
    ))
}

/// Along the node's −Z, as a rectangle, whatever the node mirrors.
fn line(center: DVec3, half: DVec3, world: &DMat4) -> Result<RectangleLight, Error> {
    RectangleLight::line(center, half, emission(world))
}

/// The direction in which a light in the node's XY plane shines.
pub(super) fn emission(world: &DMat4) -> DVec3 {
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate());
    // Flattened along its own normal it is the same light.
    if z == DVec3::ZERO { y.cross(x) } else { -z }
}

/// A polygon in the node's X and Y, whichever way its corners run.
fn polygon(extras: &Value, world: &DMat4) -> Result<Light, Problem> {
    let mut corners = corners(extras)?
        .into_iter()
        .map(|[x, y]| world.transform_point3(DVec3::new(x, y, 0.0)))
        .collect::<Vec<_>>();
    if !corners.iter().all(|corner| corner.abs().max_element() <= MAX_COORDINATE) {
        return Err(format!("it lies further than {MAX_COORDINATE:e} m from the origin"));
    }
    let mut light = Light::polygon(&corners).map_err(unusable)?;
    // The side from which they run counter-clockwise is the one that shines.
    if light.emission().dot(emission(world)) < 0.0 {
        corners.reverse();
        light = Light::polygon(&corners).map_err(unusable)?;
    }
    let sides = light.rectangle().half_extents().map(|half| 2.0 * half);
    if let Some(side) = sides.into_iter().find(|side| !(SIDES[0]..=SIDES[1]).contains(side)) {
        return Err(format!(
            "a side of the rectangle around its corners, with the node's scale, is {side} m; it must be \
             from {:e} to {:e} m",
            SIDES[0], SIDES[1]
        ));
    }
    Ok(light)
}

/// The corners in the node's space; the light checks their number.
fn corners(extras: &Value) -> Result<Vec<[f64; 2]>, Problem> {
    let value = extras.get("corners").ok_or(
        "its area_light has no corners; give it 3 to 16 in metres, as in \"corners\": [[0, 0], [1, 0], [0, 1]]",
    )?;
    let corner = |value: &Value| match value.as_array().map(Vec::as_slice) {
        Some([x, y]) => Some([x.as_f64()?, y.as_f64()?]),
        _ => None,
    };
    let list = value.as_array().ok_or_else(|| {
        format!("its corners are {}; write a list of [x, y], in metres", shown(value))
    })?;
    list.iter()
        .enumerate()
        .map(|(i, value)| {
            corner(value).ok_or_else(|| {
                format!("its corner {i} is not two numbers; write [x, y], in metres")
            })
        })
        .collect()
}

/// Half a side in the world, if the side's length there is one.
fn in_range(what: &str, half: DVec3) -> Result<DVec3, Problem> {
    let side = 2.0 * half.length();
    if (SIDES[0]..=SIDES[1]).contains(&side) {
        return Ok(half);
    }
    Err(format!(
        "its {what} with the node's scale is {side} m; it must be from {:e} to {:e} m",
        SIDES[0], SIDES[1]
    ))
}

fn sun(extras: &Value, world: &DMat4, all: &Bounds) -> Result<Light, Problem> {
    let lacking = "its area_light has no angular_size; give it one in radians, as in \"angular_size\": 0.0093";
    let value = extras.get("angular_size").ok_or(lacking)?;
    let size = value.as_f64().ok_or_else(|| {
        format!("its angular_size is {}; write a number of radians", shown(value))
    })?;
    sun_of(size, world, all)
}

/// A sun of an angular size in radians that shines along a node's −Z on `all`.
pub(super) fn sun_of(size: f64, world: &DMat4, all: &Bounds) -> Result<Light, Problem> {
    // Only the direction of the transform counts for a sun, not its scale.
    let emission = -world.z_axis.truncate();
    let radius = (0.5 * all.size().length()).max(SIDES[0]);
    Light::sun(emission, size, all.center(), radius).map_err(unusable)
}

fn side(extras: &Value, key: &str) -> Result<f64, Problem> {
    let value = extras.get(key).ok_or_else(|| {
        format!("its area_light has no {key}; give it one in metres, as in \"{key}\": 1.0")
    })?;
    value
        .as_f64()
        .filter(|side| side.is_finite() && *side >= 0.0)
        .ok_or_else(|| format!("its {key} is {}; write a number of metres from 0 up", shown(value)))
}

fn color(extras: &Value) -> Result<[f32; 3], Problem> {
    let Some(value) = extras.get("color") else { return Ok([1.0; 3]) };
    let channels = value.as_array().filter(|channels| channels.len() == 3).ok_or_else(|| {
        format!("its color is {}; write three numbers, [red, green, blue]", shown(value))
    })?;
    let mut color = [0.0; 3];
    for (channel, value) in color.iter_mut().zip(channels) {
        *channel = brightness(value, "color")?;
    }
    Ok(color)
}

fn brightness(value: &Value, key: &str) -> Result<f32, Problem> {
    let number = value.as_f64().map(|v| v as f32);
    number
        .filter(|v| v.is_finite() && *v >= 0.0)
        .ok_or_else(|| format!("its {key} holds {}; numbers from 0 up are meant", shown(value)))
}

/// A value as a sentence shows it: on one line, not endless.
fn shown(value: &Value) -> String {
    match value {
        Value::String(word) => quoted(word),
        Value::Array(_) => "a list".into(),
        Value::Object(_) => "an object".into(),
        other => other.to_string(),
    }
}
