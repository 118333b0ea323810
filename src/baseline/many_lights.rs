//! Many lights: the mean of hard shadow maps from points all over the light.
//!
//! ```text
//!   ●  ·   ·  ● ·    once         receivers      each pixel's place and plane in light space
//!   light's points   each point   point_depth    the occluders as the point sees them
//!        \ | /                    add_point      +1 where the pixel sees the point
//!         \|/        once         average        the share of the others
//!          ● pixel
//! ```
//! The light is cut into n cells of one area and no very different sides, whatever n is, with a point at
//! a random place in each (Cook 1986). A map is fitted to the occluders as its point sees them, and one
//! texel is compared with the pixel's plane: no filter, because the mean over the points is one.
//!
//! As n and the maps grow the result is the truth, up to what the G-buffer's depth tells of the pixel's
//! plane: a pixel's own bent surface, which the bias spares, is spared by less than a texel. Each point
//! adds a whole number, so the sum is exact and has no order.
//!
//! The two rows in the middle are the same again for each point, with another view of the meshes and
//! other push constants; a plan shows them once, with their number.
//!
//! **Limits.** Shadows band where few points are asked for. A frame draws the occluders n times.

use super::{Inputs, Settings, push};
use crate::RectangleLight;
use crate::depth_layers::{self, MapView, MeshBounds};
use crate::graph::{Access, Graph, Layer, Owner, Pass, Push, ResourceId, Use};
use crate::shaders;
use crate::visibility::grid;
use ash::vk;
use glam::{DMat4, DVec3};

/// A point on the light and how it sees the occluders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// Metres from the light's centre along its x and y.
    pub at: [f64; 2],
    /// Its map.
    pub view: MapView,
}

impl LightPoint {
    /// Light space to the map's clip space.
    pub fn clip_from_light(&self) -> DMat4 {
        let [x, y] = self.at;
        self.view.clip_from_light() * DMat4::from_translation(DVec3::new(-x, -y, 0.0))
    }
}

/// Uniform in [0, 1): the finalizer of MurmurHash3 over seed, point and axis.
fn uniform(seed: u32, point: u32, axis: u32) -> f64 {
    let mut h = (seed.wrapping_mul(0x9e37_79b9) ^ (2 * point + axis)).wrapping_mul(0xcc9e_2d51);
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    f64::from(h ^ (h >> 16)) / 2f64.powi(32)
}

/// A point in each of n cells of one area of a light with these half-extents, metres from its centre:
/// rows of cells, as many and as high as makes the cells square where they can be.
pub fn places(half: [f64; 2], n: u32, seed: u32) -> Vec<[f64; 2]> {
    let rows = (f64::from(n) * half[1] / half[0]).sqrt().round().clamp(1.0, f64::from(n)) as u32;
    let start = |row: u32| (u64::from(row) * u64::from(n) / u64::from(rows)) as u32;
    (0..rows)
        .flat_map(|row| (start(row)..start(row + 1)).map(move |point| (row, point)))
        .map(|(row, point)| {
            let (first, end) = (start(row), start(row + 1));
            let [x, y] =
                [0, 1].map(|axis| if seed == 0 { 0.5 } else { uniform(seed, point, axis) });
            let cells = f64::from(end - first);
            let across = (f64::from(point - first) + x) / cells;
            let down = (f64::from(first) + cells * y) / f64::from(n);
            [(2.0 * across - 1.0) * half[0], (2.0 * down - 1.0) * half[1]]
        })
        .collect()
}

/// The points of a frame, each with a map of `side` texels fitted to the occluders; where a point sees
/// none of them, as its maps have it that see nothing.
pub(crate) fn points(
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    settings: &Settings,
    centre: &MapView,
) -> Vec<LightPoint> {
    places(light.half_extents(), settings.samples, settings.seed)
        .into_iter()
        .map(|at| {
            let moved = light.moved(at);
            let view = depth_layers::fit_occluders(&moved, occluders, None, centre.side);
            LightPoint { at, view: view.unwrap_or(*centre) }
        })
        .collect()
}

/// Adds the rows that turn the meshes, as `points` see them, into `visibility`.
pub fn declare(graph: &mut Graph, visibility: ResourceId, points: &[LightPoint], inputs: &Inputs) {
    let Inputs { gbuffer, need, .. } = *inputs;
    let extent = gbuffer.extent.map(|e| e as i32);
    let image = |graph: &mut Graph, name, format| {
        graph.image(name, format, gbuffer.extent, Owner::Transient)
    };
    let positions = image(graph, "baseline.positions", vk::Format::R32G32B32A32_SFLOAT);
    let normals = image(graph, "baseline.normals", vk::Format::R32G32B32A32_SFLOAT);
    let hidden = image(graph, "baseline.hidden_points", vk::Format::R32_SFLOAT);
    let sides = [inputs.occluders.side; 2];
    let depth = graph.image("baseline.point_map", depth_layers::FORMAT, sides, Owner::Transient);
    graph.push(Pass::compute(
        "baseline.receivers",
        shaders::RECEIVERS,
        grid(gbuffer.extent),
        Push::new(&push::Receivers {
            light_from_ndc: gbuffer.light_from_ndc,
            extent,
            background: gbuffer.background,
            masked: i32::from(gbuffer.mask.is_some()),
        }),
        vec![
            Use::bound(0, gbuffer.depth, Access::SampledCompute),
            Use::bound(1, gbuffer.mask.unwrap_or(gbuffer.depth), Access::SampledCompute),
            Use::bound(2, positions, Access::ImageWrite),
            Use::bound(3, normals, Access::ImageWrite),
            Use::bound(4, hidden, Access::ImageWrite),
        ],
        need,
    ));
    // A frame without shadows has no points; its rows say so once.
    let none = [LightPoint { at: [0.0; 2], view: *inputs.occluders }];
    let points = if points.is_empty() { &none } else { points };
    for (nth, point) in points.iter().enumerate() {
        depth_layers::draw(graph, "baseline.point_depth", depth, Layer::Front, nth as u32, need);
        graph.push(Pass::compute(
            "baseline.add_point",
            shaders::ADD_POINT,
            grid(gbuffer.extent),
            Push::new(&push::AddPoint {
                point: point.at.map(|x| x as f32),
                texels_per_uv: point.view.texels_per_uv().map(|x| x as f32),
                first: point.view.first().map(|x| x as f32),
                extent,
                inv_near: (1.0 / point.view.near) as f32,
                snap: inputs.snap,
                map: point.view.side as i32,
            }),
            vec![
                Use::bound(0, positions, Access::SampledCompute),
                Use::bound(1, normals, Access::SampledCompute),
                Use::bound(2, depth, Access::SampledCompute),
                Use::bound(3, hidden, Access::ImageUpdate),
            ],
            need,
        ));
    }
    graph.push(Pass::compute(
        "baseline.average",
        shaders::AVERAGE,
        grid(gbuffer.extent),
        Push::new(&push::Average { extent, points: points.len() as f32 }),
        vec![
            Use::bound(0, hidden, Access::SampledCompute),
            Use::bound(1, visibility, Access::ImageWrite),
        ],
        need,
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every cell has one area, so the mean of the points' places is the light's centre, and no strip
    /// of the light has more points than its area says, but for the cells that the strip cuts.
    #[test]
    fn points_are_spread_evenly_for_any_number_and_shape() {
        for half in [[0.5, 0.5], [2.0, 0.25], [0.1, 0.4]] {
            for n in [1_u32, 2, 3, 7, 16, 61, 256, 1000, 4096] {
                let points = places(half, n, 3);
                assert_eq!(points.len(), n as usize);
                for axis in 0..2 {
                    assert!(points.iter().all(|p| p[axis].abs() <= half[axis]));
                    let below = points.iter().filter(|p| p[axis] < 0.3 * half[axis]).count();
                    let share = below as f64 / f64::from(n);
                    // The cut crosses a row or a column of cells: at most about √(n · aspect) of them.
                    let cells = (f64::from(n) * half[1 - axis] / half[axis]).sqrt() + 2.0;
                    let allowed = cells / f64::from(n);
                    assert!((share - 0.65).abs() <= allowed, "{half:?} {n} {axis}: {share}");
                }
            }
        }
        // On a line they are one row, evenly.
        for (i, [x, y]) in places([2.0, 0.0], 256, 3).into_iter().enumerate() {
            let cell = (x / 2.0 + 1.0) * 128.0;
            assert!(y == 0.0 && (i as f64..=i as f64 + 1.0).contains(&cell), "{i}: {x} {y}");
        }
        assert_eq!(places([0.5, 0.2], 1, 0), [[0.0, 0.0]], "without a seed the centre");
        assert_ne!(places([0.5, 0.2], 9, 1), places([0.5, 0.2], 9, 2));
    }
}
