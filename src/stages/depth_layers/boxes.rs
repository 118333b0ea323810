//! Bounding boxes in a light's space.

use crate::RectangleLight;
use crate::lent::{Geometry, MeshBounds, MeshInstance, from_origin, origin_of};
use glam::{DMat4, DVec3, DVec4};
use smallvec::SmallVec;

/// A box is flat where its smallest extent is no more than this share of its largest.
const FLAT: f64 = 1e-6;

/// A convex polygon.
pub(crate) type Polygon = SmallVec<[DVec3; 12]>;

/// The corners of a box's faces, which are numbered by a bit an axis.
const FACES: [[usize; 4]; 6] =
    [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];

/// The part of a convex polygon on the inner side of a plane: where `plane · (p, 1)` is 0 or more.
pub(crate) fn cut(polygon: &Polygon, plane: &DVec4) -> Polygon {
    let height = |p: DVec3| plane.dot(p.extend(1.0));
    let mut kept = Polygon::new();
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (from, to) = (height(a), height(b));
        if from >= 0.0 {
            kept.push(a);
        }
        if (from >= 0.0) != (to >= 0.0) {
            kept.push(a + (b - a) * (from / (from - to)));
        }
    }
    kept
}

/// The planes that a point lies outside of, where `plane · (p, 1)` is below 0, a bit each.
fn outside(planes: &[DVec4], p: DVec3) -> u32 {
    let beyond = |(i, plane): (usize, &DVec4)| u32::from(plane.dot(p.extend(1.0)) < 0.0) << i;
    planes.iter().enumerate().map(beyond).sum()
}

/// The planes that all of some points lie outside of, and those that any does, a bit each.
pub(crate) fn outside_of(planes: &[DVec4], points: &[DVec3]) -> [u32; 2] {
    let outside = points.iter().map(|p| outside(planes, *p));
    outside.fold([u32::MAX, 0], |[all, any], bits| [all & bits, any | bits])
}

/// Calls `add` with every corner of the parts of a box's faces that lie within some planes, on the side where
/// `plane · (p, 1)` is 0 or more.
pub(crate) fn cut_faces(corners: &[DVec3; 8], planes: &[DVec4], mut add: impl FnMut(DVec3)) {
    each_face(corners, planes, |face| face.iter().for_each(|p| add(*p)));
}

/// Calls `add` with the parts of a box's faces that lie within some planes, on the side where `plane · (p, 1)` is 0 or
/// more.
pub(crate) fn each_face(corners: &[DVec3; 8], planes: &[DVec4], mut add: impl FnMut(&Polygon)) {
    let outside = corners.map(|p| outside(planes, p));
    for face in &FACES {
        let [all, any] =
            face.iter().fold([u32::MAX, 0], |[all, any], &i| [all & outside[i], any | outside[i]]);
        if all != 0 {
            continue;
        }
        let mut polygon: Polygon = face.iter().map(|&i| corners[i]).collect();
        for (i, plane) in planes.iter().enumerate() {
            if any >> i & 1 == 1 {
                polygon = cut(&polygon, plane);
            }
        }
        add(&polygon);
    }
}

/// The planes of the faces of a convex solid with the corners of a box, where `plane · (p, 1)` is 0 or more within it. The
/// plane of a face without area is 0.
pub(crate) fn planes_around(corners: &[DVec3; 8]) -> [DVec4; 6] {
    let middle = 0.125 * corners.iter().sum::<DVec3>();
    FACES.map(|[a, b, c, d]| {
        let across = (corners[c] - corners[a]).cross(corners[d] - corners[b]);
        let normal = across.normalize_or_zero();
        let normal = if normal.dot(middle - corners[a]) < 0.0 { -normal } else { normal };
        normal.extend(-normal.dot(corners[a]))
    })
}

/// A mesh's box in light space, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightBox {
    /// The corners; bit i of a corner's number selects the end of the mesh's axis i.
    pub corners: [DVec3; 8],
    /// The corners' least coordinates.
    pub min: DVec3,
    /// The corners' largest coordinates.
    pub max: DVec3,
    /// The largest sum whose rounding a corner's distance carries, metres.
    pub summed: f64,
    /// The axis along which a flat box has no extent; none where the box is thick.
    pub thin_axis: Option<usize>,
}

/// The largest sum whose rounding a corner's distance carries, where positions count from `origin`.
fn summed([low, high]: &MeshBounds, light_from_mesh: &DMat4, origin: [f32; 3]) -> f64 {
    let furthest = [0, 1, 2].map(|i| {
        let [low, high] = [low[i], high[i]].map(|x| f64::from(x) - f64::from(origin[i]));
        low.abs().max(high.abs())
    });
    let row = from_origin(light_from_mesh, origin).row(2).abs();
    row.dot(DVec3::from_array(furthest).extend(1.0))
}

impl LightBox {
    /// The box of a mesh in the space of `light_from_world`.
    pub fn of(mesh: &MeshInstance, light_from_world: &DMat4) -> Self {
        let light_from_mesh = *light_from_world * mesh.world_from_mesh;
        let placed = Self::new(&mesh.bounds, &light_from_mesh);
        match mesh.geometry {
            Geometry::Buffers(_) => placed,
            // The host's matrix is for positions as they are.
            Geometry::HostDrawn(_) => {
                let summed = summed(&mesh.bounds, &light_from_mesh, [0.0; 3]);
                Self { summed, ..placed }
            }
        }
    }

    /// The box of a mesh's bounds under a transform to light space.
    pub fn new(bounds: &MeshBounds, light_from_mesh: &DMat4) -> Self {
        let [low, high] = bounds.map(|p| DVec3::from_array(p.map(f64::from)));
        let size = high - low;
        let column = |i: usize| light_from_mesh.col(i).truncate();
        let edges = [column(0) * size.x, column(1) * size.y, column(2) * size.z];
        let first = light_from_mesh.transform_point3(low);
        let below = edges.iter().fold(DVec3::ZERO, |sum, e| sum + e.min(DVec3::ZERO));
        let above = edges.iter().fold(DVec3::ZERO, |sum, e| sum + e.max(DVec3::ZERO));
        let with =
            |from: [DVec3; 2], edge: DVec3| [from[0], from[1], from[0] + edge, from[1] + edge];
        let low_face = with([first, first + edges[0]], edges[1]);
        let high_face = low_face.map(|p| p + edges[2]);
        let [a, b, c, d] = low_face;
        let [e, f, g, h] = high_face;
        let flat = FLAT * size.max_element();
        Self {
            corners: [a, b, c, d, e, f, g, h],
            min: first + below,
            max: first + above,
            summed: summed(bounds, light_from_mesh, origin_of(bounds)),
            thin_axis: size.to_array().iter().position(|&extent| extent <= flat),
        }
    }

    /// The boxes of some meshes.
    pub fn of_all(light: &RectangleLight, meshes: &[(MeshBounds, DMat4)]) -> Vec<Self> {
        let light_from_world = light.light_from_world();
        meshes.iter().map(|(bounds, m)| Self::new(bounds, &(light_from_world * *m))).collect()
    }

    /// The box moved along light space's z, by metres.
    pub fn moved(&self, z: f64) -> Self {
        let up = DVec3::new(0.0, 0.0, z);
        let corners = self.corners.map(|p| p + up);
        Self { corners, min: self.min + up, max: self.max + up, ..*self }
    }

    /// The least and largest z of the part of the box within four planes, where each `plane · (p, 1)` is 0 or more; the
    /// first is the larger one where there is none.
    pub fn z_within(&self, planes: &[DVec4; 4]) -> [f64; 2] {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        cut_faces(&self.corners, planes, |p| range = [range[0].min(p.z), range[1].max(p.z)]);
        range
    }

    /// Whether the box around the corners lies outside one of some planes, on the side where `plane · (p, 1)` is below 0.
    pub fn is_outside(&self, planes: &[DVec4]) -> bool {
        planes.iter().any(|plane| {
            let inmost = DVec3::select(plane.truncate().cmpge(DVec3::ZERO), self.max, self.min);
            plane.dot(inmost.extend(1.0)) < 0.0
        })
    }

    /// The box's edge along one of the mesh's axes.
    pub fn edge(&self, axis: usize) -> DVec3 {
        self.corners[1 << axis] - self.corners[0]
    }

    /// Whether the box is flat and both a light of these half-extents and every receiver lie on one side of its plane.
    pub fn is_aside<R: Iterator<Item = Self>>(
        &self,
        [a, b]: [f64; 2],
        receivers: impl FnOnce() -> R,
    ) -> bool {
        let Some(thin) = self.thin_axis else { return false };
        let (one, other) = (self.edge((thin + 1) % 3), self.edge((thin + 2) % 3));
        let normal = one.cross(other).normalize_or_zero();
        if normal == DVec3::ZERO {
            return false;
        }
        let slack = FLAT * (self.max - self.min).length();
        let (mut above, mut below) = (true, true);
        let mut add = |p: DVec3| {
            let height = normal.dot(p - self.corners[0]);
            above &= height >= -slack;
            below &= height <= slack;
            above || below
        };
        let lamp = [(a, b), (a, -b), (-a, b), (-a, -b)];
        lamp.into_iter().all(|(x, y)| add(DVec3::new(x, y, 0.0)))
            && receivers().flat_map(|r| r.corners).all(add)
    }
}
