//! Meshes that shine, as area lights: the plane parts of a primitive with an `emissiveFactor`, along their fronts.

use super::extras::SIDES;
use super::notes::Notes;
use super::outline::{Part, Triangles, simplified};
use crate::error::quoted;
use crate::scene::{AreaLight, Instance, Mesh};
use crate::{Light, RectangleLight};
use glam::DVec3;

/// The most lights that an instance of a mesh becomes, and that all do together: what a node has.
const LIGHTS: [usize; 2] = [8, 64];

/// The triangles that are looked at for lights, all instances together.
const LOOKED_AT: usize = 1 << 16;

/// The corners that an outline may have.
const CORNERS: usize = 16;

/// The largest cosine of the angle between a rectangle's sides: positions are f32.
const SQUARE: f64 = 1e-5;

/// The radiance of a material: linear color and a factor on it, as the bits of f32 numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Emission {
    color: [u32; 3],
    strength: u32,
}

impl Emission {
    /// What shines; `None` where that is nothing, or no number.
    pub fn new(color: [f32; 3], strength: f32) -> Option<Self> {
        let sound = color.iter().chain([&strength]).all(|of| of.is_finite() && *of >= 0.0);
        let shines = strength > 0.0 && color.iter().any(|of| *of > 0.0);
        let bits = || Self { color: color.map(f32::to_bits), strength: strength.to_bits() };
        (sound && shines).then(bits)
    }
}

/// What the lights of a file's meshes have in common.
#[derive(Default)]
pub(super) struct Shining {
    pub lights: Vec<AreaLight>,
    looked_at: usize,
    /// The instances that are no lights because there are too many.
    passed_over: usize,
}

impl Shining {
    /// Adds the lights of an instance of a mesh that shines.
    pub fn add(&mut self, mesh: &Mesh, instance: &Instance, emission: Emission, notes: &mut Notes) {
        let [most, most_of_all] = LIGHTS;
        self.looked_at = self.looked_at.saturating_add(mesh.indices.len() / 3);
        if self.looked_at > LOOKED_AT || self.lights.len() >= most_of_all {
            self.passed_over += 1;
            return;
        }
        let world = |point: DVec3| instance.world_from_mesh.transform_point3(point);
        let triangles = Triangles::new(&mesh.positions, &mesh.indices, world, instance.mirrored());
        let parts = triangles.parts();
        let whole: f64 = parts.iter().map(|part| part.area).sum();
        let (mut shown, mut count) = (0.0, 0);
        for part in &parts {
            let room = count < most && self.lights.len() < most_of_all;
            let Some((light, share)) = light(part).filter(|_| room) else { continue };
            let color = emission.color.map(f32::from_bits);
            let intensity = (f64::from(f32::from_bits(emission.strength)) * share) as f32;
            self.lights.push(AreaLight { name: instance.name.clone(), light, color, intensity });
            shown += part.area;
            count += 1;
        }
        if count < parts.len() {
            notes.tell(format!(
                "of the {} plane parts of what shines at {}, {count} are lights; the others, {:.1} % of its area, are none",
                parts.len(),
                quoted(&instance.name),
                100.0 * (1.0 - shown / whole.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
            ));
        }
    }

    /// The lights, with what is left to say of them.
    pub fn lights(self, notes: &mut Notes) -> Vec<AreaLight> {
        if self.passed_over > 0 {
            let [_, most] = LIGHTS;
            notes.tell(format!(
                "{} meshes that shine are no lights: there are {most} at most, of {LOOKED_AT} triangles",
                self.passed_over
            ));
        }
        self.lights
    }
}

/// The light of a part, and how much brighter it is so that as much light leaves it as the part's.
fn light(part: &Part) -> Option<(Light, f64)> {
    if let Some(rectangle) = rectangle(&part.corners) {
        return sized(rectangle.into()).map(|light| (light, part.area / part.enclosed));
    }
    let corners = simplified(&part.corners, CORNERS)?;
    let light = sized(Light::polygon(&corners).ok()?)?;
    let outline = light.outline()?;
    let last = outline.last()?;
    let before = [last].into_iter().chain(outline);
    let doubled: f64 = before.zip(outline).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
    // Rounding alone is none.
    let share = 2.0 * part.area / doubled;
    Some((light, if (share - 1.0).abs() < SQUARE { 1.0 } else { share }))
}

/// The light, if its sides are long and short enough.
fn sized(light: Light) -> Option<Light> {
    let mut sides = light.rectangle().half_extents().into_iter().map(|half| 2.0 * half);
    sides.all(|side| (SIDES[0]..=SIDES[1]).contains(&side)).then_some(light)
}

/// The rectangle of these corners, if they are those of one.
fn rectangle(corners: &[DVec3]) -> Option<RectangleLight> {
    let [a, b, c, d] = *corners else { return None };
    let (u, v) = (0.5 * (b - a), 0.5 * (d - a));
    let skew = u.normalize_or_zero().dot(v.normalize_or_zero()).abs();
    let off = (c - (b + d - a)).length();
    if skew > SQUARE || off > SQUARE * u.length().min(v.length()) {
        return None;
    }
    // It shines to where the corners run counter-clockwise.
    RectangleLight::new(a.midpoint(c), u, -(v.reject_from(u))).ok()
}
