//! Many lights: the mean of hard shadow maps from points all over the light.
//!
//! ```text
//!   ●  ·   ·  ● ·    once         receivers      each pixel's place and plane in light space
//!   light's points   each point   point_depth    the occluders as the point sees them
//!        \ | /                    add_point      +1 where the pixel sees the point
//!         \|/        once         average        the share of the others
//!          ● pixel
//! ```
//! The light is cut into n cells of equal area whose sides differ little, whatever n is, with a point at a random
//! place in each (Cook 1986); a light with another outline than a rectangle is cut by the same rule. Each point's map
//! is fitted to the occluders that it sees, and one texel is compared with the pixel's plane: no filter, because the
//! mean over the points is one.
//!
//! As n and the maps grow, the result converges to the exact visible fraction, up to the error of the pixel's plane
//! from the G-buffer's depth: the bias for a pixel's own bent surface shrinks with the texel. Each point adds a whole
//! number, so the sum is exact and independent of order.
//!
//! A sun's points are the directions to the points of its disc. Its light is parallel, and each direction has an
//! orthographic map, or one for each of up to `views` parts of what the camera sees.
//!
//! The two passes in the middle are repeated for each point, with another view of the meshes and other push constants;
//! a plan shows them once, with their number.
//!
//! **Limits.** Shadows band with few points. A frame draws the occluders n times.

mod places;
pub mod settings;

pub use places::{places, places_on_disc, places_within};
pub use settings::Settings;

use super::room::{Maps, PassInputs, Room, Seen, Shapes, Shows, Takes};
use crate::Error;
use crate::graph::{Access, Graph, Layer, Owner, Pass, Push, ResourceId, Use, Uses};
use crate::light::Shape;
use crate::shaders::module;
use crate::stages::depth_layers::{self, Eye, MapView};
use crate::stages::views::{LightPoint, Served, Views};
use crate::stages::visibility::grid;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

impl Room for Settings {
    fn takes(&self) -> Takes {
        Takes {
            shapes: Shapes::LINES.and(Shapes::POLYGONS).and(Shapes::DISCS),
            lent_maps: Err(
                "sees the occluders from points all over the light, and occluder maps from its centre alone",
            ),
            ..Takes::RECTANGLES
        }
    }

    fn shows(&self) -> Shows {
        Shows { back_side: true, fusion: true, ..Shows::SOFT }
    }

    fn maps(&self) -> Maps {
        Maps::own_views(self.map)
    }

    fn views(&self, seen: &Seen) -> Result<Views, Error> {
        Ok(Views::Points(points(self, seen)))
    }

    fn most_views(&self, view: MapView) -> Views {
        let most = self.samples * self.views;
        Views::Points(vec![LightPoint { at: [0.0; 2], view }; most as usize])
    }

    fn most_served(&self) -> u32 {
        self.views
    }

    fn nests(&self) -> bool {
        false
    }

    fn takes_parallel(&self) -> bool {
        true
    }

    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId> {
        declare(graph, self.samples as usize, inputs);
        None
    }
}

/// The push constants of `add_point.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct AddPoint {
    /// The point's place on the light, m from its centre; of parallel light how x and y go on for each metre towards it.
    pub point: [f32; 2],
    /// Map texels a unit of u and v, in the point's map.
    pub texels_per_uv: [f32; 2],
    /// The texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// 1 over the map's near plane, 1/m, or its height where light is parallel, m.
    pub inv_near: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
    /// The map's side in texels.
    pub map: i32,
    /// 1 where light is parallel.
    pub parallel: i32,
}

/// The push constants of `average.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Average {
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// The number of points.
    pub points: f32,
}

/// The points of a frame, each with a map of `side` texels fitted to the occluders; of a sun those of each view. A point
/// that sees none of the occluders gets a view in which nothing is visible.
fn points(settings: &Settings, seen: &Seen) -> Vec<LightPoint> {
    let Seen { light, shape, occluders, centre, parallel, .. } = *seen;
    let Settings { samples, seed, .. } = *settings;
    let places = match shape {
        Shape::Polygon(corners) => places_within(corners, samples, seed),
        Shape::Disc { radius } => places_on_disc(radius, samples, seed),
        Shape::Sun { angular_size } if !parallel.is_empty() => {
            let places = places_on_disc((0.5 * angular_size).tan(), samples, seed);
            let through = |view: &Served| {
                let map = view.map;
                places.iter().map(move |&at| towards(at, &map))
            };
            return parallel.iter().flat_map(through).collect();
        }
        _ => places(light.half_extents(), samples, seed),
    };
    places
        .into_iter()
        .map(|at| {
            let moved = light.moved(at);
            let view = depth_layers::fit_occluders(&moved, occluders, None, centre.side);
            LightPoint { at, view: view.unwrap_or(*centre) }
        })
        .collect()
}

/// A point of a sun with a map of all that a view shows, which the direction to the point slants.
fn towards(at: [f64; 2], view: &MapView) -> LightPoint {
    let slanted = |i: usize| at[i] * view.near;
    let (mut min, mut max) = (view.min, view.max);
    for i in 0..2 {
        min[i] += slanted(i).min(0.0);
        max[i] += slanted(i).max(0.0);
    }
    LightPoint { at, view: MapView { min, max, ..*view } }
}

/// Adds the passes that turn the meshes, as the points see them, of which each view has as many as there are `samples`, into
/// the visible fraction.
fn declare(graph: &mut Graph, samples: usize, inputs: &PassInputs) {
    let PassInputs { gbuffer, visibility, need, .. } = *inputs;
    let extent = gbuffer.extent.map(|e| e as i32);
    let image = |graph: &mut Graph, name, format| {
        graph.image(name, format, gbuffer.extent, Owner::Transient)
    };
    let positions = image(graph, "many_lights.positions", vk::Format::R32G32B32A32_SFLOAT);
    let normals = image(graph, "many_lights.normals", vk::Format::R32G32B32A32_SFLOAT);
    let hidden = image(graph, "many_lights.hidden_points", vk::Format::R32_SFLOAT);
    let sides = [inputs.occluders.side; 2];
    let depth = graph.image("many_lights.point_map", depth_layers::FORMAT, sides, Owner::Transient);
    let mut uses = Uses::from_slice(&gbuffer.all_bound());
    uses.extend([
        Use::bound(2, positions, Access::ImageWrite),
        Use::bound(3, normals, Access::ImageWrite),
        Use::bound(4, hidden, Access::ImageWrite),
    ]);
    graph.push(Pass::compute(
        "many_lights.receivers",
        module!("many_lights/receivers.comp"),
        grid(gbuffer.extent),
        Push::NONE,
        uses,
        need,
    ));
    // A frame without shadows has no points; it declares its passes once, for the plan to name them.
    let none = [LightPoint { at: [0.0; 2], view: *inputs.occluders }];
    let first = samples * inputs.view as usize;
    let points = inputs.views.points().get(first..first + samples).unwrap_or(&none);
    for (nth, point) in (first..).zip(points) {
        depth_layers::draw(graph, "many_lights.point_depth", depth, Layer::Front, nth as u32, need);
        graph.push(Pass::compute(
            "many_lights.add_point",
            module!("many_lights/add_point.comp"),
            grid(gbuffer.extent),
            Push::new(&AddPoint {
                point: point.at.map(|x| x as f32),
                texels_per_uv: point.view.texels_per_uv().map(|x| x as f32),
                first: point.view.first().map(|x| x as f32),
                extent,
                inv_near: point.view.top() as f32,
                snap: inputs.snap,
                map: point.view.side as i32,
                parallel: i32::from(point.view.eye == Eye::Infinity),
            }),
            smallvec![
                Use::bound(0, positions, Access::SampledCompute),
                Use::bound(1, normals, Access::SampledCompute),
                Use::bound(2, depth, Access::SampledCompute),
                Use::bound(3, hidden, Access::ImageUpdate),
            ],
            need,
        ));
    }
    graph.push(Pass::compute(
        "many_lights.average",
        module!("many_lights/average.comp"),
        grid(gbuffer.extent),
        Push::new(&Average { extent, points: points.len() as f32 }),
        smallvec![
            Use::bound(0, hidden, Access::SampledCompute),
            Use::bound(1, visibility, Access::ImageWrite),
            Use::bound(2, positions, Access::SampledCompute),
        ],
        need,
    ));
}
