//! Compose: visibility × unshadowed irradiance, for the eye.

use antumbra::scene::AreaLight;
use antumbra::techniques::many_lights::{places_on_disc, places_within};
use antumbra::{Light, Shape};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Points a side of the grid on the light that irradiance is summed over; as many together on other shapes.
const GRID: usize = 4;

/// Light from everywhere else, as a share of the brightest pixel, so that umbra is not black.
const AMBIENT: f64 = 0.06;

/// The colour of every surface.
const ALBEDO: f64 = 0.8;

/// The color of pixels that show no surface.
const BACKGROUND: [u8; 3] = [46, 50, 56];

/// A light as points in the world that each stand for as much of it.
struct Points {
    at: Vec<DVec3>,
    /// The area of all points together, or the length of a line, or 1 of a point.
    size: f64,
    /// The direction of a light that shines to one side.
    emission: Option<DVec3>,
}

/// A light as what it makes of a receiver without occluders.
enum Source {
    Points(Points),
    /// A sun's emission, and the solid angle of its disc.
    Sun(DVec3, f64),
}

impl Source {
    /// A sphere is its disc's area at its centre, a capsule its stadium's along its axis, for which both shine alike to
    /// all sides: exact for a sphere above the horizon.
    fn of(light: &Light) -> Self {
        let rectangle = light.rectangle();
        let [a, b] = rectangle.half_extents();
        let number = GRID * GRID;
        let grid = || {
            let cells = (0..number).map(|i| DVec2::new((i % GRID) as f64, (i / GRID) as f64));
            let points = cells.map(|cell| (cell + 0.5) * (2.0 / GRID as f64) - 1.0);
            points.map(|at| [at.x * a, at.y * b]).collect()
        };
        let (flat, size): (Vec<[f64; 2]>, f64) = match light.shape() {
            Shape::Polygon(outline) => (places_within(outline, number as u32, 0), area(outline)),
            Shape::Disc { radius } => {
                (places_on_disc(radius, number as u32, 0), PI * radius * radius)
            }
            Shape::Sphere { radius } => (vec![[0.0; 2]], PI * radius * radius),
            Shape::Capsule { half_length, radius } => {
                let share = |i: usize| (i as f64 + 0.5) * (2.0 / number as f64) - 1.0;
                let axis = (0..number).map(|i| [share(i) * half_length, 0.0]);
                (axis.collect(), radius * (4.0 * half_length + PI * radius))
            }
            Shape::Point => (vec![[0.0; 2]], 1.0),
            Shape::Sun { angular_size } => {
                let tangent = (0.5 * angular_size).tan();
                return Self::Sun(light.emission(), PI * tangent * tangent);
            }
            Shape::Line => (grid(), 2.0 * a),
            _ => (grid(), 4.0 * a * b),
        };
        let frame = rectangle.world_from_light();
        let place = |[x, y]: [f64; 2]| frame.transform_point3(DVec3::new(x, y, 0.0));
        let at = flat.into_iter().map(place).collect();
        Self::Points(Points { at, size, emission: light.is_one_sided().then(|| light.emission()) })
    }

    /// Irradiance by the light alone, nothing in between, for a radiance of 1; of a line and a point, for a radiance
    /// times width, or area, of 1.
    fn irradiance(&self, position: DVec3, normal: DVec3) -> f64 {
        match self {
            Self::Points(points) => points.irradiance(position, normal),
            Self::Sun(emission, solid_angle) => -normal.dot(*emission).min(0.0) * solid_angle,
        }
    }
}

impl Points {
    /// Σ cos θ cos θ′ / r² dA over the points; cos θ′ is 1 where the light shines to all sides.
    fn irradiance(&self, position: DVec3, normal: DVec3) -> f64 {
        let mut sum = 0.0;
        for point in &self.at {
            let to_light = *point - position;
            let r2 = to_light.length_squared();
            let received = normal.dot(to_light).max(0.0);
            let emitted = self.emission.map_or(r2.sqrt(), |emission| -emission.dot(to_light));
            if r2 > 0.0 && emitted > 0.0 {
                sum += received * emitted / (r2 * r2);
            }
        }
        sum * self.size / self.at.len() as f64
    }
}

/// The area of a polygon that runs counter-clockwise.
fn area(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(p, q)| 0.5 * (p[0] * q[1] - p[1] * q[0])).sum()
}

/// The irradiance of each pixel by a light of radiance 1, nothing in between; 0 where `positions` has a w of 0, which
/// shows no surface. Positions and unit normals are in world space, in metres.
pub fn irradiances(light: &Light, positions: &[[f32; 4]], normals: &[[f32; 4]]) -> Vec<f64> {
    let vector = |v: &[f32; 4]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    let source = Source::of(light);
    let of = |(p, n): (&[f32; 4], &[f32; 4])| match p[3] > 0.0 {
        true => source.irradiance(vector(p), vector(n)),
        false => 0.0,
    };
    positions.iter().zip(normals).map(of).collect()
}

fn srgb(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let y = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (y * 255.0).round() as u8
}

/// The image shaded by one light, as [`shade_all`] has it.
pub fn shade(
    light: &AreaLight,
    visibility: &[f32],
    positions: &[[f32; 4]],
    normals: &[[f32; 4]],
) -> Vec<u8> {
    shade_all(&[(light, visibility)], positions, normals)
}

/// The image shaded by the sum of some lights, each with the visible fraction of every pixel: three bytes a pixel, exposed
/// so that the brightest hundredth of what all lights together would light may be clipped, and no more. A light's color
/// times its intensity is its radiance, that of a sun its irradiance, as directional lights of glTF have it.
pub fn shade_all(
    lights: &[(&AreaLight, &[f32])],
    positions: &[[f32; 4]],
    normals: &[[f32; 4]],
) -> Vec<u8> {
    // The color of each pixel with shadows, and its brightest part without.
    let mut lit = vec![[0.0; 3]; positions.len()];
    let mut open = vec![0.0; positions.len()];
    for (light, visibility) in lights {
        let unit = match light.light.shape() {
            Shape::Sun { angular_size } => 1.0 / (PI * (0.5 * angular_size).tan().powi(2)),
            _ => 1.0,
        };
        let color = light.color.map(|c| f64::from(c) * f64::from(light.intensity) * unit);
        let most = color.into_iter().fold(0.0, f64::max);
        let irradiances = irradiances(&light.light, positions, normals);
        for (((lit, open), v), e) in lit.iter_mut().zip(&mut open).zip(*visibility).zip(irradiances)
        {
            *open += e * most;
            for (sum, channel) in lit.iter_mut().zip(color) {
                *sum += f64::from(*v) * e * channel;
            }
        }
    }
    // A surface close to a light should not darken the rest.
    open.retain(|e| *e > 0.0);
    open.sort_by(f64::total_cmp);
    let bright = open.get(open.len() * 99 / 100).copied().unwrap_or(1.0);
    let shade = |(lit, p): (&[f64; 3], &[f32; 4])| match p[3] > 0.0 {
        true => lit.map(|c| srgb(ALBEDO * (c / bright * (1.0 - AMBIENT) + AMBIENT))),
        false => BACKGROUND,
    };
    lit.iter().zip(positions).flat_map(shade).collect()
}

#[cfg(test)]
mod tests {
    // A test says what went wrong by panicking.
    #![allow(clippy::unwrap_used, clippy::panic)]

    use super::*;
    use antumbra::RectangleLight;

    /// The irradiance of a receiver at the origin.
    fn on(light: impl Into<Light>, normal: DVec3) -> f64 {
        let normal = normal.as_vec3().extend(0.0).to_array();
        irradiances(&light.into(), &[[0.0, 0.0, 0.0, 1.0]], &[normal])[0]
    }

    fn near(found: f64, expected: f64, share: f64) {
        assert!((found - expected).abs() < share * expected, "{found}, not {expected}");
    }

    /// From ten metres each is about its area as seen, times the cosine, over the distance squared.
    #[test]
    fn a_light_far_away_shines_by_the_area_that_is_seen() {
        let up = DVec3::Y * 10.0;
        let slanted = DVec3::new(0.0, 0.8, 0.6);
        for (normal, cosine) in [(DVec3::Y, 1.0), (slanted, 0.8)] {
            let square = RectangleLight::facing(up, DVec3::NEG_Y, DVec3::X, [0.4, 0.2]).unwrap();
            let line = RectangleLight::line(up, DVec3::X * 0.2, DVec3::NEG_Y).unwrap();
            let capsule = Light::capsule(up, DVec3::X * 0.5, 0.2).unwrap();
            near(on(square, normal), cosine * 0.08 / 100.0, 0.01);
            near(on(line, normal), cosine * 0.4 / 100.0, 0.01);
            near(on(Light::disc(up, DVec3::NEG_Y, 0.3).unwrap(), normal), cosine * PI * 9e-4, 0.01);
            near(on(Light::sphere(up, 0.3).unwrap(), normal), cosine * PI * 9e-4, 1e-6);
            near(on(capsule, normal), cosine * (0.4 + PI * 0.04) / 100.0, 0.01);
            near(on(Light::point(up).unwrap(), normal), cosine / 100.0, 1e-6);
            let sun = Light::sun(DVec3::NEG_Y, 0.2, DVec3::ZERO, 3.0).unwrap();
            near(on(sun, normal), cosine * PI * 0.1_f64.tan().powi(2), 1e-6);
        }
    }

    /// Near by a disc is its closed form on the axis, R² / (R² + D²) times π; sixteen points know it to a thirtieth.
    #[test]
    fn a_disc_near_by_is_its_closed_form() {
        let disc = Light::disc(DVec3::Y, DVec3::NEG_Y, 0.5).unwrap();
        near(on(disc, DVec3::Y), PI * 0.25 / 1.25, 1.0 / 30.0);
    }

    /// Two lights add up, each in its color, and an image does not change with the brightness of all lights.
    #[test]
    fn lights_add_up() {
        let place = DVec3::Y * 2.0;
        let light = |color: [f32; 3], intensity: f32| AreaLight {
            name: "lamp".into(),
            light: Light::disc(place, DVec3::NEG_Y, 0.3).unwrap(),
            color,
            intensity,
        };
        let positions = [[0.0, 0.0, 0.0, 1.0], [0.3, 0.0, 0.0, 1.0], [0.0; 4]];
        let normals = [[0.0, 1.0, 0.0, 0.0]; 3];
        let shade = |lights: &[(&AreaLight, &[f32])]| shade_all(lights, &positions, &normals);
        let (red, blue) = (light([1.0, 0.0, 0.0], 2.0), light([0.0, 0.0, 1.0], 2.0));
        let purple = light([1.0, 0.0, 1.0], 1.0);
        let half = [0.5, 1.0, 0.0];
        // As bright as both, where the brightest part of each counts for the exposure.
        let both = shade(&[(&red, &half), (&blue, &half)]);
        let one = shade(&[(&purple, &half)]);
        assert!(both[0] == both[2] && both[1] < both[0] && one[0] > both[0], "{both:?} {one:?}");
        let brighter = light([1.0, 0.0, 1.0], 7.0);
        assert_eq!(one, shade(&[(&brighter, &half)]));
        assert_eq!(one[6..], BACKGROUND);
    }

    #[test]
    fn what_faces_away_or_is_behind_a_plane_gets_no_light() {
        let up = DVec3::Y * 10.0;
        let sun = |emission| Light::sun(emission, 0.2, DVec3::ZERO, 3.0).unwrap();
        let sphere = Light::sphere(up, 0.3).unwrap();
        for light in [Light::disc(up, DVec3::NEG_Y, 0.3).unwrap(), sphere, sun(DVec3::NEG_Y)] {
            assert_eq!(on(light, DVec3::NEG_Y), 0.0);
            assert!(on(light, DVec3::Y) > 0.0);
        }
        assert_eq!(on(Light::disc(up, DVec3::Y, 0.3).unwrap(), DVec3::Y), 0.0);
        assert_eq!(on(sun(DVec3::Y), DVec3::Y), 0.0);
        assert_eq!(irradiances(&sphere, &[[0.0; 4]], &[[0.0, 1.0, 0.0, 0.0]]), [0.0]);
    }
}
