//! Area lights and shadow roles, read from the extras of nodes.
//!
//! glTF 2.0 has no area light; extras are what Blender writes a node's custom properties to.

use super::json::Root;
use super::{MAX_COORDINATE, Problem, nodes};
use crate::error::quoted;
use crate::scene::{AreaLight, Bounds, Role};
use crate::{Error, RectangleLight};
use glam::{DMat4, DVec3};
use serde_json::Value;

/// The shortest and longest side of a light in the world, in metres: techniques divide by its area,
/// in f32 on the GPU, and multiply by it.
const SIDES: [f64; 2] = [1e-6, 1e6];

/// The node's `shadow_role`, or [`Role::Both`].
pub(super) fn role(extras: &Value) -> Result<Role, Problem> {
    let Some(value) = extras.get("shadow_role") else { return Ok(Role::default()) };
    value.as_str().and_then(|word| word.parse().ok()).ok_or_else(|| {
        format!("its shadow_role is {}; write occluder, receiver or both", shown(value))
    })
}

/// The node's area light, if it has one: its rectangle carried into the world. A sun is as far from `all`, the
/// box of what casts shadows, as it has to be.
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
        Some("rectangle") => rectangle(extras, world).map(|light| (light, Vec::new())),
        Some("polygon") => polygon(extras, world),
        Some("sun") => sun(extras, world, all).map(|light| (light, Vec::new())),
        _ => Err(format!(
            "its area_light is {}; write \"rectangle\", \"polygon\" or \"sun\"",
            shown(kind)
        )),
    };
    let (light, outline) = light.map_err(sentence)?;
    let color = color(extras).map_err(sentence)?;
    let intensity = match extras.get("intensity") {
        Some(value) => brightness(value, "intensity").map_err(sentence)?,
        None => 1.0,
    };
    Ok(Some(AreaLight { name: nodes::name(root, node), light, outline, color, intensity }))
}

/// A rectangle in the node's X and Y, or of a side of 0 a line along the other.
fn rectangle(extras: &Value, world: &DMat4) -> Result<RectangleLight, Problem> {
    let (width, height) = (side(extras, "width")?, side(extras, "height")?);
    let center = world.w_axis.truncate();
    if center.abs().max_element() > MAX_COORDINATE {
        return Err(format!("it lies further than {MAX_COORDINATE:e} m from the origin"));
    }
    let half_u = world.x_axis.truncate() * (0.5 * width);
    let half_v = world.y_axis.truncate() * (0.5 * height);
    let light = match (width == 0.0, height == 0.0) {
        (true, true) => {
            return Err(
                "its width 0 and height 0 are a point, which has no soft shadow; give it a \
                        width"
                    .into(),
            );
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
    light.map_err(|e| match e {
        Error::Light(problem) => format!(
            "its light cannot be used: {problem}; a node above it with a rotation and an uneven \
             scale may skew it"
        ),
        other => other.to_string(),
    })
}

/// Along the node's −Z, as a rectangle, whatever the node mirrors.
fn line(center: DVec3, half: DVec3, world: &DMat4) -> Result<RectangleLight, Error> {
    RectangleLight::line(center, half, emission(world))
}

/// The direction in which a light in the node's XY plane shines.
fn emission(world: &DMat4) -> DVec3 {
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate());
    // Flattened along its own normal it is the same light.
    if z == DVec3::ZERO { y.cross(x) } else { -z }
}

/// A polygon in the node's X and Y, whichever way its corners run, and its corners in light space.
fn polygon(extras: &Value, world: &DMat4) -> Result<(RectangleLight, Vec<[f64; 2]>), Problem> {
    let mut corners = corners(extras)?
        .into_iter()
        .map(|[x, y]| world.transform_point3(DVec3::new(x, y, 0.0)))
        .collect::<Vec<_>>();
    if !corners.iter().all(|corner| corner.abs().max_element() <= MAX_COORDINATE) {
        return Err(format!("it lies further than {MAX_COORDINATE:e} m from the origin"));
    }
    let around = |corners: &[DVec3]| match RectangleLight::around(corners) {
        Ok(light) => Ok(light),
        Err(Error::Light(problem)) => Err(format!("its light cannot be used: {problem}")),
        Err(other) => Err(other.to_string()),
    };
    let mut found = around(&corners)?;
    // The side from which they run counter-clockwise is the one that shines.
    if found.0.emission().dot(emission(world)) < 0.0 {
        corners.reverse();
        found = around(&corners)?;
    }
    let sides = found.0.half_extents().map(|half| 2.0 * half);
    if let Some(side) = sides.into_iter().find(|side| !(SIDES[0]..=SIDES[1]).contains(side)) {
        return Err(format!(
            "a side of the rectangle around its corners, with the node's scale, is {side} m; it must be \
             from {:e} to {:e} m",
            SIDES[0], SIDES[1]
        ));
    }
    Ok(found)
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

fn sun(extras: &Value, world: &DMat4, all: &Bounds) -> Result<RectangleLight, Problem> {
    let lacking = "its area_light has no angular_size; give it one in radians, as in \"angular_size\": 0.0093";
    let value = extras.get("angular_size").ok_or(lacking)?;
    let size = value.as_f64().ok_or_else(|| {
        format!("its angular_size is {}; write a number of radians", shown(value))
    })?;
    // Only the direction of the transform counts for a sun, not its scale.
    let emission = -world.z_axis.truncate();
    let radius = (0.5 * all.size().length()).max(SIDES[0]);
    RectangleLight::sun(emission, size, all.center(), radius).map_err(|e| match e {
        Error::Light(problem) => format!("its light cannot be used: {problem}"),
        other => other.to_string(),
    })
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
