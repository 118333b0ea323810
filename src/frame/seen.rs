//! What a camera sees of the receivers: the parts of their boxes within slices of its frustum.

use super::camera::Camera;
use crate::stages::depth_layers::{LightBox, Polygon, cut_faces, each_face, outside_of};
use crate::stages::views::Visible;
use glam::{DMat4, DVec3, DVec4};

/// The least and largest coordinates of points, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    /// The least coordinates.
    pub min: DVec3,
    /// The largest.
    pub max: DVec3,
}

impl Bounds {
    /// The bounds of no point.
    pub const NONE: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Widens the bounds to a point.
    pub fn add(&mut self, p: DVec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    /// Widens the bounds to hold others.
    pub fn join(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// Whether they hold any point.
    pub fn is_some(&self) -> bool {
        self.min.x <= self.max.x
    }

    fn holds(&self, p: DVec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }
}

/// What a perspective camera sees of receivers in light space; `None` for an orthographic one.
pub(super) fn visible<'a>(
    light_from_ndc: &DMat4,
    receivers: &'a [LightBox],
) -> Option<Visible<'a>> {
    let frustum = Frustum::new(light_from_ndc)?;
    let mut all = Bounds::NONE;
    for b in receivers {
        all.add(b.min);
        all.add(b.max);
    }
    Some(Visible::new(frustum.corners([0.0, frustum.furthest(&all)]), receivers))
}

/// How many boxes are cut to what the frustum has of them. What lies within it in part of further ones counts by the box
/// around them all.
const MOST_CUT: usize = 32;

/// The pyramid that a perspective camera sees, in world space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    eye: DVec3,
    forward: DVec3,
    /// The rays through the image's corners: bit 0 of a corner's number selects its right side, bit 1 the lower one.
    /// Each is one metre long along `forward`.
    rays: [DVec3; 4],
}

impl Frustum {
    /// The frustum of a frame's camera; `None` for an orthographic one, or a matrix that is no camera.
    pub fn new(world_from_ndc: &DMat4) -> Option<Self> {
        let camera = Camera::of(world_from_ndc);
        let eye = camera.eye?;
        let forward = camera.direction;
        let ray = |i: usize| {
            let [x, y] = [(i & 1) as f64, (i >> 1) as f64].map(|end| 2.0 * end - 1.0);
            let p = *world_from_ndc * DVec4::new(x, y, 0.5, 1.0);
            let along = p.truncate() / p.w - eye;
            along / along.dot(forward)
        };
        let rays = [0, 1, 2, 3].map(ray);
        let sound = eye.is_finite() && rays.iter().all(|r| r.is_finite());
        sound.then_some(Self { eye, forward, rays })
    }

    /// The width of a pixel one metre before the eye, for an image of this width, metres.
    pub fn pixel(&self, width: u32) -> f64 {
        (self.rays[1] - self.rays[0]).length() / f64::from(width)
    }

    /// The least distance before the eye at which the frustum meets a box along the world's axes; `None` where it does not
    /// meet it, or where the eye is in it.
    pub fn distance(&self, of: &Bounds) -> Option<f64> {
        if of.holds(self.eye) {
            return None;
        }
        let mut least = f64::INFINITY;
        self.each_corner(of, [0.0, self.furthest(of)], |p| {
            least = least.min((p - self.eye).dot(self.forward));
        });
        least.is_finite().then_some(least)
    }

    /// The distance of a box's nearest corner before the eye, metres; below 0 behind it.
    pub fn nearest(&self, of: &Bounds) -> f64 {
        let distances = corners(of).map(|p| (p - self.eye).dot(self.forward));
        distances.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// The distance of a box's furthest corner before the eye, metres; 0 for a box behind it.
    pub fn furthest(&self, of: &Bounds) -> f64 {
        corners(of).iter().map(|p| (*p - self.eye).dot(self.forward)).fold(0.0, f64::max)
    }

    /// The bounds, under a transform, of the part of a box that lies between two distances before the eye.
    pub fn slice(&self, of: &Bounds, between: [f64; 2], transform: &DMat4) -> Bounds {
        let mut bounds = Bounds::NONE;
        self.each_corner(of, between, |p| bounds.add(transform.transform_point3(p)));
        bounds
    }

    /// Finds the bounds, under a transform, of what of some boxes lies between each distance of `ends` and the next. The
    /// first of these is 0, and no box reaches beyond the last.
    pub fn slices(
        &self,
        boxes: impl Iterator<Item = Bounds>,
        ends: &[f64],
        transform: &DMat4,
        seen: &mut [Bounds],
    ) {
        let (sides, whole) = (self.sides(), self.corners([0.0, ends[ends.len() - 1]]));
        let mut parts = Parts { frustum: self, ends, transform, seen };
        let mut rest = Bounds::NONE;
        let mut cut = 0;
        for of in boxes {
            let corners = corners(&of);
            let [all, any] = outside_of(&sides, &corners);
            let [near, far] = [self.nearest(&of), self.furthest(&of)];
            if all != 0 || far <= 0.0 {
                continue;
            }
            if any == 0 && parts.of(near) == parts.of(far) {
                corners.iter().for_each(|p| parts.add(parts.of(near), *p));
            } else if cut < MOST_CUT {
                cut += 1;
                each_face(&corners, &sides, |face| parts.add_face(face));
                each_face(&whole, &planes_of(&of), |face| parts.add_face(face));
            } else {
                rest.join(&of);
            }
        }
        if rest.is_some() {
            for (seen, pair) in seen.iter_mut().zip(ends.windows(2)) {
                seen.join(&self.slice(&rest, [pair[0], pair[1]], transform));
            }
        }
    }

    /// The planes through the eye and the image's edges, where `plane · (p, 1)` is 0 or more within the frustum.
    fn sides(&self) -> [DVec4; 4] {
        let middle = 0.25 * (self.rays[0] + self.rays[1] + self.rays[2] + self.rays[3]);
        [[0, 2], [1, 3], [0, 1], [2, 3]].map(|[a, b]| {
            let n = self.rays[a].cross(self.rays[b]);
            let n = if n.dot(middle) < 0.0 { -n } else { n };
            n.extend(-n.dot(self.eye))
        })
    }

    /// The corners of the slice between two distances before the eye: bit 2 of a corner's number selects the further end.
    pub fn corners(&self, [near, far]: [f64; 2]) -> [DVec3; 8] {
        std::array::from_fn(|i| self.eye + self.rays[i & 3] * if i < 4 { near } else { far })
    }

    /// Calls `add` with every corner of the part of a box that lies in a slice of the frustum. Each is one of a face of
    /// the box that the slice cuts, or of a face of the slice that the box cuts.
    fn each_corner(&self, of: &Bounds, [near, far]: [f64; 2], mut add: impl FnMut(DVec3)) {
        let own = self.corners([near, far]);
        let [left, right, top, bottom] = self.sides();
        let along = self.forward.dot(self.eye);
        let of_slice = [
            left,
            right,
            top,
            bottom,
            self.forward.extend(-along - near),
            (-self.forward).extend(along + far),
        ];
        cut_faces(&corners(of), &of_slice, &mut add);
        cut_faces(&own, &planes_of(of), &mut add);
    }
}

/// The bounds of what lies between distances before the eye.
struct Parts<'a> {
    frustum: &'a Frustum,
    ends: &'a [f64],
    transform: &'a DMat4,
    seen: &'a mut [Bounds],
}

impl Parts<'_> {
    /// The part that has a distance.
    fn of(&self, distance: f64) -> usize {
        self.ends[1..self.ends.len() - 1].partition_point(|end| *end < distance)
    }

    fn add(&mut self, part: usize, p: DVec3) {
        self.seen[part].add(self.transform.transform_point3(p));
    }

    /// Adds a face's corners to the parts that they lie in, and where an edge passes from one part to the next to both.
    fn add_face(&mut self, face: &Polygon) {
        let Frustum { eye, forward, .. } = *self.frustum;
        let distance = |p: DVec3| (p - eye).dot(forward);
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            let (from, to) = (distance(a), distance(b));
            let [first, last] = [self.of(from), self.of(to)];
            self.add(first, a);
            for part in first.min(last)..first.max(last) {
                let p = a + (b - a) * ((self.ends[part + 1] - from) / (to - from));
                self.add(part, p);
                self.add(part + 1, p);
            }
        }
    }
}

/// The planes of a box's faces, where `plane · (p, 1)` is 0 or more within it.
fn planes_of(of: &Bounds) -> [DVec4; 6] {
    [
        DVec4::new(1.0, 0.0, 0.0, -of.min.x),
        DVec4::new(0.0, 1.0, 0.0, -of.min.y),
        DVec4::new(0.0, 0.0, 1.0, -of.min.z),
        DVec4::new(-1.0, 0.0, 0.0, of.max.x),
        DVec4::new(0.0, -1.0, 0.0, of.max.y),
        DVec4::new(0.0, 0.0, -1.0, of.max.z),
    ]
}

fn corners(of: &Bounds) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let end = |axis: usize| if i >> axis & 1 == 1 { of.max[axis] } else { of.min[axis] };
        DVec3::new(end(0), end(1), end(2))
    })
}

#[cfg(test)]
#[path = "seen_tests.rs"]
mod tests;
