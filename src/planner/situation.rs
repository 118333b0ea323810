//! What boxes tell of a light, its occluders and its receivers: in microseconds, before anything is drawn.

use crate::RectangleLight;
use crate::depth_layers::{self, Eye, MapView, MeshBounds};
use crate::frame::{Geometry, MeshInstance};
use glam::{DMat4, DVec3, DVec4};

/// More occluders than this are not compared in pairs: they count as overlapping.
const MOST_COMPARED: usize = 16;

/// A light, what blocks it and what receives, by their boxes.
///
/// Distances are along the light's normal from its plane, in metres. They are bounds: the true ones lie within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Situation {
    /// The light's width and height, metres; a line has no height.
    pub light: [f64; 2],
    /// Meshes that may block light on its way to a receiver.
    pub occluders: usize,
    /// Of so many that block.
    pub given: usize,
    /// Meshes that receive.
    pub receivers: usize,
    /// Meshes that block and receive.
    pub both: usize,
    /// Meshes that the host draws.
    pub host_drawn: usize,
    /// Triangles of the occluders; those of what the host draws are not known.
    pub triangles: u64,
    /// Least and largest distance of occluders; no less than a ten-thousandth of the largest.
    pub occluder_distances: [f64; 2],
    /// Least and largest distance of receivers, where an occluder may shadow them.
    pub receiver_distances: [f64; 2],
    /// Every occluder is flat: a sheet.
    pub sheets: bool,
    /// Some occluder is open: seen from both sides, and no sheet.
    pub open: bool,
    /// Some occluder may lie before another, as the map's eye sees them.
    pub overlap: bool,
    /// Atty 2006 eq. 3 for the whole thickness of an occluder, over the light's side: the most of the light that its
    /// back hides and its front does not, or the other way round; 0 to 1, the largest of all occluders.
    pub thickness: f64,
    /// Width of the widest penumbra across the light's rays, metres.
    pub penumbra: f64,
    /// The same in pixels, by the smallest pixel there; infinite where the camera is inside what may be shadowed.
    pub penumbra_pixels: f64,
    /// The most edges that a metre across a shadow may have, by the occluders' triangles: as many as they have if
    /// together they cover their box's face once. Infinite where they are not known.
    pub edges: f64,
    /// The same over a pixel, by the largest pixel there: 0 to 1.
    pub edges_a_pixel: f64,
    /// A map's texel where shadows fall furthest, in pixels, by the smallest pixel there; infinite where the camera is
    /// inside. Every technique errs by something like it at edges.
    pub texel_pixels: f64,
    /// The smaller side of what the map shows at the occluders' mean distance, metres.
    pub size: f64,
}

/// What a situation is made from.
pub(crate) struct Seen<'a> {
    pub light: &'a RectangleLight,
    /// Those that may block, and how many there were.
    pub occluders: &'a [MeshInstance],
    pub given: usize,
    pub receivers: &'a [MeshInstance],
    /// The part of the receivers that may be shadowed, from the light's centre.
    pub shadowed: &'a MapView,
    /// How the technique's map looks at the occluders.
    pub map: &'a MapView,
    pub world_from_ndc: &'a DMat4,
    pub extent: [u32; 2],
}

impl Situation {
    /// Looks at a frame's boxes. The occluders are those that the node draws; where the host lends maps there are none,
    /// and the situation says of them what the maps' view does, at its worst.
    pub(crate) fn of(seen: &Seen) -> Self {
        let light_from_world = seen.light.light_from_world();
        let [a, b] = seen.light.half_extents();
        let (shadowed, map) = (seen.shadowed, seen.map);
        let nearest_receiver = least_distance(&light_from_world, seen.receivers);
        let behind = match map.eye {
            Eye::Behind(behind) => behind,
            Eye::Infinity => 0.0,
        };
        let near = (map.near - behind).max(1e-4 * shadowed.far);
        let mut s = Self {
            light: [2.0 * a, 2.0 * b],
            occluders: seen.occluders.len(),
            given: seen.given,
            receivers: seen.receivers.len(),
            both: seen.occluders.iter().filter(|m| m.role.receives()).count(),
            host_drawn: 0,
            triangles: 0,
            occluder_distances: [near, (map.far - behind).max(near)],
            receiver_distances: [nearest_receiver.max(near), shadowed.far.max(near)],
            sheets: !seen.occluders.is_empty(),
            open: false,
            overlap: seen.occluders.is_empty(),
            thickness: if seen.occluders.is_empty() { 1.0 } else { 0.0 },
            penumbra: 0.0,
            penumbra_pixels: 0.0,
            edges: if seen.occluders.is_empty() { f64::INFINITY } else { 0.0 },
            edges_a_pixel: 0.0,
            texel_pixels: 0.0,
            size: 0.0,
        };
        let [smallest, largest] = pixel_sizes(seen, &light_from_world);
        for mesh in seen.occluders {
            s.add(mesh, &light_from_world);
        }
        s.overlap |= overlapping(seen);
        s.penumbra = s.light[0].max(s.light[1]) * (s.receiver_distances[1] / near - 1.0).max(0.0);
        s.penumbra_pixels = if smallest > 0.0 { s.penumbra / smallest } else { f64::INFINITY };
        s.edges_a_pixel = (s.edges * largest).min(1.0);
        let middle = 0.5 * (s.occluder_distances[0] + s.occluder_distances[1]);
        let side = (0..2).map(|i| map.max[i] - map.min[i]).fold(f64::INFINITY, f64::min);
        let reach = if map.eye == Eye::Infinity { 1.0 } else { s.receiver_distances[1] + behind };
        s.texel_pixels = side * reach / f64::from(map.side) / smallest;
        s.size = side * if map.eye == Eye::Infinity { 1.0 } else { middle + behind };
        s
    }

    fn add(&mut self, mesh: &MeshInstance, light_from_world: &DMat4) {
        let to_light = *light_from_world * mesh.world_from_mesh;
        let triangles = match mesh.geometry {
            Geometry::Buffers(buffers) => u64::from(buffers.count / 3),
            Geometry::HostDrawn(_) => {
                self.host_drawn += 1;
                self.edges = f64::INFINITY;
                0
            }
        };
        self.triangles += triangles;
        let (center, half) = box_of(&mesh.bounds, &to_light);
        let mut sides = mesh_sides(&mesh.bounds, &to_light);
        sides.sort_by(f64::total_cmp);
        let face = (sides[2] * sides[1]).sqrt().max(f64::MIN_POSITIVE);
        self.edges = self.edges.max(4.0 * (triangles as f64).sqrt() / face);
        if depth_layers::thin_axis(&mesh.bounds).is_some() {
            return;
        }
        self.sheets = false;
        self.open |= mesh.double_sided;
        let front = (center.z - half.z).max(self.occluder_distances[0]);
        let back = center.z + half.z;
        let receiver = self.receiver_distances[0];
        let thickness = if receiver <= back {
            1.0
        } else {
            0.5 * receiver * (back - front) / (front * (receiver - back))
        };
        self.thickness = self.thickness.max(thickness.clamp(0.0, 1.0));
    }
}

/// A box's middle and half-diagonal along the axes of light space.
fn box_of(bounds: &MeshBounds, light_from_mesh: &DMat4) -> (DVec3, DVec3) {
    let [low, high] = bounds.map(|p| DVec3::from_array(p.map(f64::from)));
    let half = 0.5 * (high - low);
    let axis = |i: usize| light_from_mesh.col(i).truncate().abs();
    let reach = axis(0) * half.x + axis(1) * half.y + axis(2) * half.z;
    (light_from_mesh.transform_point3(0.5 * (low + high)), reach)
}

/// The lengths of a box's three sides, metres.
fn mesh_sides(bounds: &MeshBounds, light_from_mesh: &DMat4) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let side = f64::from(bounds[1][i]) - f64::from(bounds[0][i]);
        light_from_mesh.col(i).truncate().length() * side
    })
}

/// The least distance of some meshes' boxes.
fn least_distance(light_from_world: &DMat4, meshes: &[MeshInstance]) -> f64 {
    let least = |m: &MeshInstance| {
        let (center, half) = box_of(&m.bounds, &(*light_from_world * m.world_from_mesh));
        center.z - half.z
    };
    meshes.iter().map(least).fold(f64::INFINITY, f64::min)
}

/// Whether any two occluders may cover the same texel of the map.
fn overlapping(seen: &Seen) -> bool {
    if seen.occluders.len() > MOST_COMPARED {
        return true;
    }
    let texel = [0, 1].map(|i| (seen.map.max[i] - seen.map.min[i]) / f64::from(seen.map.side));
    let mut windows = [None; MOST_COMPARED];
    for (window, mesh) in windows.iter_mut().zip(seen.occluders) {
        let placed = (mesh.bounds, mesh.world_from_mesh);
        *window = depth_layers::window_of(seen.map.eye, seen.light, &placed, seen.map.near);
    }
    let apart = |a: &([f64; 2], [f64; 2]), b: &([f64; 2], [f64; 2])| {
        (0..2).any(|i| a.1[i] + texel[i] < b.0[i] || b.1[i] + texel[i] < a.0[i])
    };
    windows.iter().enumerate().any(|(i, a)| {
        windows[..i].iter().any(|b| matches!((a, b), (Some(a), Some(b)) if !apart(a, b)))
    })
}

/// The smallest and the largest pixel where shadows may fall, metres across the view.
///
/// A pixel at a point is 2w/(W |g|) wide, with w the point's clip coordinate and g the part of x's gradient across the
/// view; w is linear, so that its extremes over the frustum of what may be shadowed are at its corners.
fn pixel_sizes(seen: &Seen, light_from_world: &DMat4) -> [f64; 2] {
    let clip_from_world = seen.world_from_ndc.inverse();
    let clip_from_light = clip_from_world * light_from_world.inverse();
    let row = |i: usize| clip_from_light.row(i);
    let center = *seen.world_from_ndc * DVec4::new(0.0, 0.0, 0.5, 1.0);
    // Which sign w has in front of the camera.
    let sign = (clip_from_world * (center / center.w)).w.signum();
    let across = |r: DVec4| {
        let view = row(3).truncate();
        let along = view.normalize_or_zero();
        let r = r.truncate();
        (r - along * r.dot(along)).length()
    };
    let per_w = (0..2)
        .map(|i| 2.0 / (f64::from(seen.extent[i]) * across(row(i)).max(f64::MIN_POSITIVE)))
        .fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], x| [least.min(x), most.max(x)]);
    let v = seen.shadowed;
    let mut w = [f64::INFINITY, 0.0f64];
    for i in 0..8 {
        let d = if i & 4 == 0 { v.near } else { v.far };
        let u = if i & 1 == 0 { v.min[0] } else { v.max[0] };
        let t = if i & 2 == 0 { v.min[1] } else { v.max[1] };
        let at = sign * row(3).dot(DVec4::new(u * d, t * d, d, 1.0));
        w = [w[0].min(at), w[1].max(at)];
    }
    // Behind the camera, or not to be told.
    if !(w[0] > 0.0 && w[0] <= w[1] && w[1].is_finite()) {
        return [0.0, f64::INFINITY];
    }
    [w[0] * per_w[0], w[1] * per_w[1]]
}
