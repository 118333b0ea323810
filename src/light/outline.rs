//! The outlines of lights: which polygons are some, and the rectangle around one.
//!
//! ```text
//!    y
//!    ▲ ┌ ─ ─ ─ 2───────1   the rectangle: light space's axes, its origin in the middle
//!    │         │       │
//!    │ │       │       │   the outline: corners in metres, counter-clockwise as seen
//!    │ 4───────3       │   from the side that the light shines to
//!    │ │               │
//!    │ 5───────────────0
//!    └────────────────────► x
//! ```

use super::RectangleLight;
use crate::Error;
use glam::{DMat3, DVec2, DVec3};
use smallvec::SmallVec;
use std::ops::RangeInclusive;

/// The number of corners that an outline may have: a technique may visit them at every pixel.
pub(crate) const CORNERS: RangeInclusive<usize> = 3..=16;

/// The largest distance of corners from their common plane, relative to the light's size: the rounding of f32 corners
/// within a hundred times that size from the origin.
const MAX_WARP: f64 = 1e-5;

/// Parts of an outline this near to each other, relative to its size, touch: thousands of times what
/// rounding moves f64 corners by within a thousand sizes from the origin.
const TOUCHING: f64 = 1e-9;

/// The largest distance of a corner outside its rectangle, relative to the rectangle: the rounding of f32 corners.
const SLACK: f64 = 1e-6;

/// Twice the area that an outline encloses, above 0 where it runs counter-clockwise.
pub(crate) fn doubled_area(corners: &[[f64; 2]]) -> f64 {
    let Some(first) = corners.first().copied().map(DVec2::from_array) else { return 0.0 };
    let from_first = |p: [f64; 2]| DVec2::from_array(p) - first;
    corners.windows(2).map(|edge| from_first(edge[0]).perp_dot(from_first(edge[1]))).sum()
}

/// The longer side of the box around an outline.
fn size(corners: &[[f64; 2]]) -> f64 {
    let [low, high] = bounds(corners);
    (high - low).max_element()
}

/// The least and largest coordinates.
fn bounds(corners: &[[f64; 2]]) -> [DVec2; 2] {
    corners
        .iter()
        .map(|&p| DVec2::from_array(p))
        .fold([DVec2::MAX, DVec2::MIN], |[low, high], p| [low.min(p), high.max(p)])
}

/// Why an outline in a light's space is invalid, as the end of a sentence that names it; `None` for a valid one.
pub(crate) fn problem(corners: &[[f64; 2]], half_extents: [f64; 2]) -> Option<String> {
    if let Some(problem) = wrong_shape(corners) {
        return Some(problem);
    }
    let inside = |p: &[f64; 2]| (0..2).all(|i| p[i].abs() <= half_extents[i] * (1.0 + SLACK));
    if let Some(corner) = corners.iter().position(|p| !inside(p)) {
        let ([x, y], [a, b]) = (corners[corner], half_extents);
        return Some(format!(
            "its corner {corner} at ({x}, {y}) lies outside of the light's rectangle, which reaches to \
             ±{a} and ±{b} m"
        ));
    }
    if doubled_area(corners) < 0.0 {
        return Some(
            "its corners must run counter-clockwise, as seen from the side that the light shines to; \
             reverse them"
                .into(),
        );
    }
    None
}

/// Why corners make no outline, apart from their direction and their place; `None` where they make one.
fn wrong_shape(corners: &[[f64; 2]]) -> Option<String> {
    if let Some(problem) = wrong_number(corners.len()) {
        return Some(problem);
    }
    let size = size(corners);
    if !(corners.iter().flatten().all(|x| x.is_finite()) && size.is_finite()) {
        return Some(NOT_FINITE.into());
    }
    // Divided by the size so that no product overflows or vanishes.
    let unit: Vec<[f64; 2]> = corners.iter().map(|p| p.map(|x| x / size)).collect();
    let area = doubled_area(&unit).abs();
    // Not finite where all corners are one.
    if area.is_nan() || area <= TOUCHING {
        return Some(NO_AREA.into());
    }
    meets_itself(&unit).then(|| "its outline must neither touch nor cross itself".into())
}

/// The triangles that a valid outline is cut into, as the numbers of their corners, counter-clockwise: one ear after the
/// other is cut off (Meisters 1975). Triangles without an area are left out.
pub(crate) fn triangles(corners: &[[f64; 2]]) -> SmallVec<[[u8; 3]; 14]> {
    let at = |i: u8| DVec2::from_array(corners[usize::from(i)]);
    let doubled = |[a, b, c]: [u8; 3]| (at(b) - at(a)).perp_dot(at(c) - at(a));
    let holds = |[a, b, c]: [u8; 3], p: u8| {
        ![a, b, c].contains(&p)
            && [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(|t| doubled(t) >= 0.0)
    };
    let mut rest: SmallVec<[u8; 16]> = (0..corners.len() as u8).collect();
    let mut cut = SmallVec::new();
    while rest.len() >= 3 {
        let n = rest.len();
        let corner = |i: usize| [rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]];
        let is_ear = |&i: &usize| {
            let ear = corner(i);
            doubled(ear) >= 0.0 && !rest.iter().any(|&p| holds(ear, p))
        };
        // Rounding may leave no ear; the largest triangle is then cut off.
        let largest = || (0..n).max_by(|&i, &j| doubled(corner(i)).total_cmp(&doubled(corner(j))));
        let ear = (0..n).find(is_ear).or_else(largest).unwrap_or(0);
        if doubled(corner(ear)) > 0.0 {
            cut.push(corner(ear));
        }
        rest.remove(ear);
    }
    cut
}

const NOT_FINITE: &str = "its corners must be finite numbers";
const NO_AREA: &str = "its corners must enclose an area";

fn wrong_number(corners: usize) -> Option<String> {
    let (least, most) = CORNERS.into_inner();
    (!CORNERS.contains(&corners))
        .then(|| format!("it must have {least} to {most} corners, and has {corners}"))
}

/// Whether an outline of size 1 touches or crosses itself.
fn meets_itself(corners: &[[f64; 2]]) -> bool {
    let n = corners.len();
    let edge = |i: usize| [i, (i + 1) % n].map(|i| DVec2::from_array(corners[i]));
    (0..n).any(|i| {
        let [a, b] = edge(i);
        let [_, c] = edge((i + 1) % n);
        // Neighbours share a corner; the rest of either stays away from the other.
        to_segment(c, a, b) <= TOUCHING
            || to_segment(a, b, c) <= TOUCHING
            || (i + 2..n).filter(|j| (j + 1) % n != i).any(|j| apart([a, b], edge(j)) <= TOUCHING)
    })
}

fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(a + along * t)
}

/// The distance between two segments; 0 where they cross.
fn apart([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> f64 {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    let crossed = side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
    if crossed {
        return 0.0;
    }
    let ends = [to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

impl RectangleLight {
    /// The smallest rectangle around a polygon, and the polygon's corners in its light space: a light of any outline,
    /// for [`Light::with_outline`](super::Light::with_outline) (Heidrich, Brabec and Seidel 2000 section 4 has polygons
    /// as their edges).
    ///
    /// `corners` are 3 to 16 points of one plane in world space, in metres, in order; the polygon need not be
    /// convex. It shines to the side from which they run counter-clockwise, as a glTF triangle faces. The
    /// rectangle's x lies along its longer side. The corners come back as x and y in metres from the rectangle's
    /// centre, in the order they were given: counter-clockwise as seen from the side that the light shines to.
    ///
    /// # Errors
    /// [`Error::Light`] for fewer than 3 corners or more than 16, for corners that are not finite, do not lie in
    /// one plane (within 10⁻⁵ of the light's size) or enclose no area (10⁻⁹ of its size squared), and for an
    /// outline that touches or crosses itself.
    pub fn around(corners: &[DVec3]) -> Result<(Self, Vec<[f64; 2]>), Error> {
        let refuse = |problem: String| Err(Error::Light(problem));
        if let Some(problem) = wrong_number(corners.len()) {
            return refuse(problem);
        }
        let from_first: Vec<DVec3> = corners.iter().map(|&corner| corner - corners[0]).collect();
        let size = from_first.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
        // `max` passes NaN over.
        if !(corners.iter().all(|corner| corner.is_finite()) && size.is_finite()) {
            return refuse(NOT_FINITE.into());
        }
        let unit: Vec<DVec3> = from_first.iter().map(|&v| v / size).collect();
        let doubled: DVec3 = unit.windows(2).map(|edge| edge[0].cross(edge[1])).sum();
        if doubled.is_nan() || doubled.length() <= TOUCHING {
            return refuse(NO_AREA.into());
        }
        let z = doubled.normalize();
        let warp = unit.iter().map(|v| v.dot(z).abs()).fold(0.0, f64::max);
        if warp > MAX_WARP {
            return refuse(format!(
                "its corners must lie in one plane (they are {warp:.1e} of its size off)"
            ));
        }
        let rectangle = smallest_rectangle(&unit, z);
        let flat: Vec<[f64; 2]> = unit.iter().map(|v| rectangle.flat(*v).into()).collect();
        let [low, high] = bounds(&flat);
        let middle = low.midpoint(high);
        let outline: Vec<[f64; 2]> =
            flat.iter().map(|&p| ((DVec2::from_array(p) - middle) * size).into()).collect();
        if let Some(problem) = wrong_shape(&outline) {
            return refuse(problem);
        }
        let center = corners[0] + rectangle.axes * middle.extend(0.0) * size;
        let half_extents = (0.5 * size * (high - low)).to_array();
        Ok((Self { center, axes: rectangle.axes, half_extents }, outline))
    }
}

/// A rectangle's axes, z along its normal and x along its longer side, with its area.
struct Around {
    axes: DMat3,
    area: f64,
}

impl Around {
    /// The rectangle around the corners with its x axis along a direction of their plane.
    fn new(corners: &[DVec3], z: DVec3, x: DVec3) -> Self {
        let axes = DMat3::from_cols(x, z.cross(x), z);
        let mut around = Self { axes, area: 0.0 };
        let flat: Vec<[f64; 2]> = corners.iter().map(|v| around.flat(*v).into()).collect();
        let [low, high] = bounds(&flat);
        let sides = high - low;
        around.area = sides.x * sides.y;
        if sides.y > sides.x * (1.0 + TOUCHING) {
            around.axes = DMat3::from_cols(axes.y_axis, -axes.x_axis, z);
        }
        around
    }

    fn flat(&self, v: DVec3) -> DVec2 {
        DVec2::new(self.axes.x_axis.dot(v), self.axes.y_axis.dot(v))
    }
}

/// The smallest rectangle has a side along one of the convex hull's (Freeman and Shapira 1975), and so along
/// the way between two of the corners. Of those as small as each other it is the first.
fn smallest_rectangle(corners: &[DVec3], z: DVec3) -> Around {
    let n = corners.len();
    // The edges first: a rectangle's own sides rather than others that are as good.
    let pairs = (1..n).flat_map(|step| (0..n).map(move |i| (i, (i + step) % n)));
    let across = z.any_orthonormal_vector();
    pairs
        .filter_map(|(i, j)| (corners[j] - corners[i]).reject_from_normalized(z).try_normalize())
        .map(|x| Around::new(corners, z, x))
        .reduce(|best, next| if next.area < best.area * (1.0 - TOUCHING) { next } else { best })
        .unwrap_or_else(|| Around::new(corners, z, across))
}

#[cfg(test)]
#[path = "outline_tests.rs"]
mod tests;
