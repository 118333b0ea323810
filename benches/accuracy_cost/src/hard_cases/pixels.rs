//! What pixels see, by f64 alone: where they meet the floors, and what of the light they see from there.

use super::cases::HardCase;
use super::set::{Block, Floor, Place, Set};
use crate::Problem;
use antumbra::RectangleLight;
use antumbra::lent::MeshBounds;
use antumbra::stages::depth_layers::{MapView, fit_occluders, fit_receivers};
use antumbra::truth::{Exact, PolygonLight, Receiver};
use glam::{DMat4, DVec2, DVec3};
use rayon::prelude::*;

/// How steeply a receiver's own surface may rise above its plane: what the node allows it
/// (`glsl/common/light_space.glsl`).
const OWN_SLOPE: f64 = 0.3;

/// The image's side in pixels.
pub const SIDE: u32 = 32;

/// The side of the soft shadow map, texels.
pub const RECEIVER_MAP: u32 = 64;

/// Where a pixel meets a floor.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Where, m, before anything is scaled or moved.
    pub position: DVec3,
    /// The floor's normal on the viewer's side.
    pub normal: DVec3,
    pub blocks: bool,
}

/// What each pixel meets first; none is the background.
pub fn seen(set: &Set, extent: [u32; 2]) -> Vec<Option<Seen>> {
    let clip_from_world = set.view(Place::HERE, extent).clip_from_world;
    let world_from_clip = clip_from_world.inverse();
    let pixels = (0..extent[0] * extent[1])
        .map(|i| DVec2::new(f64::from(i % extent[0]), f64::from(i / extent[0])));
    let size = DVec2::new(f64::from(extent[0]), f64::from(extent[1]));
    pixels
        .map(|pixel| {
            let ndc = (pixel + 0.5) * 2.0 / size - 1.0;
            let at = |depth: f64| world_from_clip.project_point3(ndc.extend(depth));
            let (near, far) = (at(0.75), at(0.25));
            let met = set.floors.iter().filter_map(|floor| meet(floor, near, far)).map(|seen| {
                let depth = clip_from_world.project_point3(seen.position).z;
                (depth, seen)
            });
            let met = met.filter(|(depth, _)| (0.0..=1.0).contains(depth) && *depth > 0.0);
            met.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, seen)| seen)
        })
        .collect()
}

/// Where a line meets a floor.
fn meet(floor: &Floor, near: DVec3, far: DVec3) -> Option<Seen> {
    let to_floor = floor.at.inverse();
    let (a, b) = (to_floor.transform_point3(near), to_floor.transform_point3(far));
    let t = a.y / (a.y - b.y);
    let p = a + (b - a) * t;
    let within = p.x.abs() <= 0.5 * floor.size[0] && p.z.abs() <= 0.5 * floor.size[1];
    let up = floor.at.transform_vector3(DVec3::Y);
    let normal = if (near - far).dot(up) < 0.0 { -up } else { up };
    (t.is_finite() && within).then(|| Seen {
        position: floor.at.transform_point3(p),
        normal,
        blocks: floor.role.blocks(),
    })
}

/// Between which visible fractions a pixel's must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub truth: f64,
    /// The fraction with occluders as large as a technique can see them.
    pub least: f64,
    /// The fraction with occluders as small as a technique can see them.
    pub most: f64,
}

/// How the node's maps look at a case.
pub struct Maps {
    occluders: Option<MapView>,
    receivers: Option<MapView>,
}

impl Maps {
    /// Those of a case, through the window that a host gives or fitted.
    pub fn of(case: &HardCase, windowed: bool) -> Result<Self, Problem> {
        let scene = case.set.scene(Place::HERE)?;
        let boxes = |keep: fn(antumbra::Role) -> bool| -> Vec<(MeshBounds, DMat4)> {
            let placed = scene.instances.iter().filter(|i| keep(i.role));
            let placed = placed.filter(|i| !scene.meshes[i.mesh].indices.is_empty());
            placed.map(|i| (scene.meshes[i.mesh].bounds(), i.world_from_mesh)).collect()
        };
        let light = &case.set.light;
        let blocking = boxes(antumbra::Role::blocks);
        // A floor under everything is not in the maps.
        let receiving = boxes(antumbra::Role::receives);
        let aside = |mesh: &(MeshBounds, DMat4)| {
            antumbra::stages::depth_layers::is_aside(light, mesh, &receiving)
        };
        let blocking: Vec<_> = blocking.into_iter().filter(|mesh| !aside(mesh)).collect();
        let occluders = fit_occluders(light, &blocking, case.window.filter(|_| windowed), case.map);
        let receivers = occluders
            .as_ref()
            .and_then(|view| fit_receivers(light, &receiving, view, RECEIVER_MAP));
        Ok(Self { occluders, receivers })
    }

    /// A texel's larger side over its distance.
    fn texel(view: Option<&MapView>) -> f64 {
        view.map_or(0.0, |view| {
            view.texels_per_uv().map(f64::recip).into_iter().fold(0.0, f64::max)
        })
    }
}

/// How far off the outlines that a technique knows may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// In texels of the occluder map.
    pub texels: f64,
    /// In texels of the soft shadow map.
    pub receiver_texels: f64,
}

/// The exact visible fraction of a light behind a case's blocks, moved in or out.
struct Truth<'a> {
    exact: Exact,
    light: &'a PolygonLight,
    /// How far above its plane a pixel looks where that blocks, over its distance from the light's.
    raised: f64,
    light_from_world: DMat4,
}

impl Truth<'_> {
    fn at(&self, seen: &Seen) -> Result<f64, antumbra::Error> {
        if !seen.blocks {
            return self.exact.visible_from(self.light, seen.position);
        }
        let distance = self.light_from_world.transform_point3(seen.position).z.max(0.0);
        let position = seen.position + seen.normal * (self.raised * distance);
        self.exact.visible_fraction(self.light, &Receiver { position, normal: seen.normal })
    }
}

/// Whether all of a light is beneath a surface, which no light then reaches: what is seen of it is for nobody to say.
fn faces_away(light: &RectangleLight, seen: &Seen) -> bool {
    let [a, b] = light.half_extents();
    let frame = light.world_from_light();
    let corners = [[a, b], [a, -b], [-a, b], [-a, -b]];
    corners.into_iter().all(|[x, y]| {
        let corner = frame.transform_point3(DVec3::new(x, y, 0.0));
        seen.normal.dot(corner - seen.position) <= 0.0
    })
}

/// The ranges of a set's pixels under a light of its own; background is lit.
pub fn ranges(
    set: &Set,
    maps: &Maps,
    light: &RectangleLight,
    pixels: &[Option<Seen>],
    reach: Reach,
) -> Result<Vec<Range>, Problem> {
    let texel = reach.texels * Maps::texel(maps.occluders.as_ref())
        + reach.receiver_texels * Maps::texel(maps.receivers.as_ref());
    let light_from_world = set.light.light_from_world();
    let furthest = |block: &Block| block.furthest(&light_from_world).max(0.0);
    let polygon = PolygonLight::from(light);
    let truth = |by: f64, raised: f64| {
        let scene = set.blockers(|block| by * texel * furthest(block));
        let exact = Exact::new(&scene)?;
        Ok::<_, Problem>(Truth { exact, light: &polygon, raised, light_from_world })
    };
    // What a texel holds counts for a surface that blocks only where its middle is above what the surface itself
    // may rise.
    let raised =
        (1.0 + OWN_SLOPE) * std::f64::consts::FRAC_1_SQRT_2 * Maps::texel(maps.occluders.as_ref());
    let of = [truth(0.0, 0.0)?, truth(1.0, 0.0)?, truth(-1.0, raised)?];
    let range = |pixel: &Option<Seen>| {
        let Some(seen) = pixel else { return Ok(Range { truth: 1.0, least: 1.0, most: 1.0 }) };
        let [truth, grown, shrunk] = [of[0].at(seen)?, of[1].at(seen)?, of[2].at(seen)?];
        if seen.blocks && faces_away(&set.light, seen) {
            return Ok(Range { truth, least: 0.0, most: 1.0 });
        }
        Ok(Range { truth, least: grown.min(truth), most: shrunk.max(truth) })
    };
    pixels.par_iter().map(range).collect()
}
