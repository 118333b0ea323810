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
//! a random place in each (Cook 1986); a light of another outline than its rectangle's is cut in the same
//! way. A map is fitted to the occluders as its point sees them, and one
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

mod places;
pub use places::{places, places_within};

use crate::RectangleLight;
use crate::graph::{Access, Graph, Layer, Owner, Pass, Push, ResourceId, Use};
use crate::lent::MeshBounds;
use crate::shaders;
use crate::stages::depth_layers::{self, MapView};
use crate::stages::visibility::grid;
use crate::techniques::common::{Inputs, Settings, push};
use ash::vk;
use glam::{DMat4, DVec3};
use smallvec::smallvec;

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

/// The points of a frame, each with a map of `side` texels fitted to the occluders; where a point sees
/// none of them, as its maps have it that see nothing.
pub(crate) fn points(
    light: &RectangleLight,
    outline: Option<&[[f64; 2]]>,
    occluders: &[(MeshBounds, DMat4)],
    settings: &Settings,
    centre: &MapView,
) -> Vec<LightPoint> {
    let Settings { samples, seed, .. } = *settings;
    let places = match outline {
        Some(corners) => places_within(corners, samples, seed),
        None => places(light.half_extents(), samples, seed),
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
        smallvec![
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
        "baseline.average",
        shaders::AVERAGE,
        grid(gbuffer.extent),
        Push::new(&push::Average { extent, points: points.len() as f32 }),
        smallvec![
            Use::bound(0, hidden, Access::SampledCompute),
            Use::bound(1, visibility, Access::ImageWrite),
        ],
        need,
    ));
}
