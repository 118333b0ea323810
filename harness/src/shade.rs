//! Compose: visibility × unshadowed irradiance, for the eye.

use antumbra::scene::AreaLight;
use antumbra::techniques::many_lights::places_within;
use glam::{DVec2, DVec3};

/// Points a side of the grid on the light that irradiance is summed over; as many together on a polygon.
const GRID: usize = 4;

/// Light from everywhere else, as a share of the brightest pixel, so that umbra is not black.
const AMBIENT: f64 = 0.06;

/// The colour of every surface.
const ALBEDO: f64 = 0.8;

/// The color of pixels that show no surface.
const BACKGROUND: [u8; 3] = [46, 50, 56];

/// A light as points in the world that each stand for as much of its area, or of a line's length.
struct Points {
    at: Vec<DVec3>,
    size: f64,
    emission: DVec3,
}

impl Points {
    fn of(light: &AreaLight) -> Self {
        let rectangle = &light.light;
        let [a, b] = rectangle.half_extents();
        let number = GRID * GRID;
        let (flat, size) = match light.outline() {
            Some(outline) => (places_within(outline, number as u32, 0), area(outline)),
            None => {
                let grid = (0..number).map(|i| {
                    let cell = DVec2::new((i % GRID) as f64, (i / GRID) as f64);
                    let at = (cell + 0.5) * (2.0 / GRID as f64) - 1.0;
                    [at.x * a, at.y * b]
                });
                (grid.collect(), if rectangle.is_line() { 2.0 * a } else { 4.0 * a * b })
            }
        };
        let frame = rectangle.world_from_light();
        let place = |[x, y]: [f64; 2]| frame.transform_point3(DVec3::new(x, y, 0.0));
        let at = flat.into_iter().map(place).collect();
        Self { at, size, emission: rectangle.emission() }
    }
}

/// The area of a polygon that runs counter-clockwise.
fn area(outline: &[[f64; 2]]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(p, q)| 0.5 * (p[0] * q[1] - p[1] * q[0])).sum()
}

/// Irradiance by the light alone, nothing in between: Σ cos θ cos θ′ / r² dA over its points.
fn irradiance(light: &Points, position: DVec3, normal: DVec3) -> f64 {
    let mut sum = 0.0;
    for point in &light.at {
        let to_light = *point - position;
        let r2 = to_light.length_squared();
        let received = normal.dot(to_light).max(0.0);
        let emitted = -light.emission.dot(to_light);
        if r2 > 0.0 && emitted > 0.0 {
            sum += received * emitted / (r2 * r2);
        }
    }
    sum * light.size / light.at.len() as f64
}

fn srgb(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let y = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (y * 255.0).round() as u8
}

/// The shaded image, three bytes a pixel, exposed so that the brightest lit pixel is not clipped.
pub fn shade(
    light: &AreaLight,
    visibility: &[f32],
    positions: &[[f32; 4]],
    normals: &[[f32; 4]],
) -> Vec<u8> {
    let vector = |v: &[f32; 4]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    let points = Points::of(light);
    let irradiances: Vec<f64> = positions
        .iter()
        .zip(normals)
        .map(|(p, n)| if p[3] > 0.0 { irradiance(&points, vector(p), vector(n)) } else { 0.0 })
        .collect();
    // The brightest hundredth may clip: a surface close to the light should not darken the rest.
    let mut sorted: Vec<f64> = irradiances.iter().copied().filter(|e| *e > 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    let bright = sorted.get(sorted.len() * 99 / 100).copied().unwrap_or(1.0);
    let peak = f64::from(light.color.iter().copied().fold(0.0, f32::max)).max(1e-6);
    let mut pixels = Vec::with_capacity(visibility.len() * 3);
    for ((v, e), p) in visibility.iter().zip(&irradiances).zip(positions) {
        if p[3] == 0.0 {
            pixels.extend(BACKGROUND);
            continue;
        }
        let direct = f64::from(*v) * e / bright;
        for channel in light.color {
            let colored = direct * f64::from(channel) / peak;
            pixels.push(srgb(ALBEDO * (colored * (1.0 - AMBIENT) + AMBIENT)));
        }
    }
    pixels
}
