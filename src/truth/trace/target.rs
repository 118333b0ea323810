//! The points of a light that rays are sent to, by its shape (the table in [`crate::truth`]).
//!
//! ```text
//!   t ┌─┬─┬─┐  strata of the unit square    map that keeps areas       light
//!     ├─┼─┼─┤  with a random point in each  ────────────────────►   ◯ ▭ △ ⬭ ─
//!     └─┴─┴─┘ s                             so each has as much of it
//! ```

use super::sampling::Stream;
use crate::{Light, Shape};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_4, PI};

/// A light relative to an origin: f64 dot products, no matrix that holds a far translation.
pub(super) struct LightFrame {
    center: DVec3,
    /// The unit vectors of light space.
    axes: [DVec3; 3],
    kind: Kind,
}

/// How the points of a light follow from its receiver.
enum Kind {
    /// A figure in the light's plane: a corner or the centre, the two axes of the figure, and what it is.
    Flat(DVec3, [DVec3; 2], Flat),
    Sphere {
        radius: f64,
    },
    Capsule {
        half_length: f64,
        radius: f64,
    },
    Point,
    /// The sun's radius in the tangent plane at unit distance, and the extent of what may block it.
    Sun {
        tangent: f64,
        extent: f64,
    },
}

enum Flat {
    Rectangle,
    Line,
    Disc,
    Polygon(Vec<Piece>),
    Point,
}

/// A triangle of a polygon, and the shares of the polygon's area before it and in it.
struct Piece {
    before: f64,
    share: f64,
    corners: [DVec2; 3],
}

/// The figure that a receiver's rays are sent to.
pub(super) struct Target<'a> {
    base: DVec3,
    sides: [DVec3; 2],
    figure: Figure<'a>,
    /// The share of the way from the receiver to the figure at which rays end.
    pub(super) end: f64,
}

#[derive(Clone, Copy)]
enum Figure<'a> {
    Square,
    Line,
    Disc,
    Triangles(&'a [Piece]),
    Stadium { half_length: f64, radius: f64 },
    Point,
}

impl LightFrame {
    /// The light about `origin`; `extent` bounds the coordinates of what may block it, relative to that.
    pub(super) fn of(light: &Light, origin: DVec3, extent: f64) -> Self {
        let frame = light.rectangle().world_from_light();
        let axis = |axis: DVec3| frame.transform_vector3(axis);
        let axes = [axis(DVec3::X), axis(DVec3::Y), axis(DVec3::Z)];
        let center = light.center() - origin;
        let kind = match light.shape() {
            Shape::Rectangle => {
                let (sides, corner) = rectangle(light, origin);
                Kind::Flat(corner, sides, Flat::Rectangle)
            }
            Shape::Line => {
                let (sides, corner) = rectangle(light, origin);
                Kind::Flat(corner, sides, Flat::Line)
            }
            Shape::Disc { radius } => {
                Kind::Flat(center, [axes[0] * radius, axes[1] * radius], Flat::Disc)
            }
            Shape::Polygon(corners) => {
                Kind::Flat(center, [axes[0], axes[1]], Flat::Polygon(pieces(corners)))
            }
            Shape::Sphere { radius } => Kind::Sphere { radius },
            Shape::Capsule { half_length, radius } => Kind::Capsule { half_length, radius },
            Shape::Point if light.is_one_sided() => {
                Kind::Flat(center, [DVec3::ZERO; 2], Flat::Point)
            }
            Shape::Point => Kind::Point,
            Shape::Sun { angular_size } => {
                Kind::Sun { tangent: (0.5 * angular_size).tan(), extent }
            }
        };
        Self { center, axes, kind }
    }

    /// The target of the rays of a receiver at `from`, which end `offset` before it; `None` where the receiver is at
    /// or behind the plane of a one-sided light, or inside one that shines to all sides.
    pub(super) fn target(&self, from: DVec3, offset: f64) -> Option<Target<'_>> {
        let [x, y, z] = self.axes;
        match &self.kind {
            Kind::Flat(base, sides, flat) => {
                let distance = (from - *base).dot(z);
                let figure = match flat {
                    Flat::Rectangle => Figure::Square,
                    Flat::Line => Figure::Line,
                    Flat::Disc => Figure::Disc,
                    Flat::Polygon(pieces) => Figure::Triangles(pieces),
                    Flat::Point => Figure::Point,
                };
                let target = Target { base: *base, sides: *sides, figure, end: 0.0 };
                target.ending(offset, distance)
            }
            &Kind::Sphere { radius } => {
                let away = from - self.center;
                let distance = away.length();
                if distance <= radius {
                    return None;
                }
                let [u, v] = across(away / distance);
                // Tangents of the sphere from the receiver pass through the rim of this disc.
                let scale = radius * distance / ((distance - radius) * (distance + radius)).sqrt();
                let sides = [u * scale, v * scale];
                let target = Target { base: self.center, sides, figure: Figure::Disc, end: 0.0 };
                target.ending(offset, distance)
            }
            &Kind::Capsule { half_length, radius } => {
                let away = from - self.center;
                let along = away.dot(x);
                let distance = (away - x * along.clamp(-half_length, half_length)).length();
                if distance <= radius {
                    return None;
                }
                let sides = match half_length > 0.0 {
                    true => {
                        let facing = (away - x * along).normalize_or(z);
                        [x, facing.cross(x)]
                    }
                    // A capsule without a length has no axis that its plane must contain.
                    false => across(away / distance),
                };
                let figure = Figure::Stadium { half_length, radius };
                Target { base: self.center, sides, figure, end: 0.0 }.ending(offset, distance)
            }
            Kind::Point => {
                let distance = from.distance(self.center);
                let (base, sides) = (self.center, [DVec3::ZERO; 2]);
                Target { base, sides, figure: Figure::Point, end: 0.0 }.ending(offset, distance)
            }
            &Kind::Sun { tangent, extent } => {
                // Past everything: what may block lies within √3 extents of the origin.
                let reach = from.length() + 2.0 * extent;
                let sides = [x * (tangent * reach), y * (tangent * reach)];
                let figure = Figure::Disc;
                Some(Target { base: from - z * reach, sides, figure, end: 1.0 })
            }
        }
    }
}

impl Target<'_> {
    /// The target with rays that end `offset` before a light at `distance`; `None` where that leaves nothing of them.
    fn ending(self, offset: f64, distance: f64) -> Option<Self> {
        (distance > offset).then(|| Self { end: 1.0 - offset / distance, ..self })
    }

    /// The number of rays of one grid of side × side strata: a point needs one.
    pub(super) fn rays(&self, side: u32) -> u32 {
        if matches!(self.figure, Figure::Point) { 1 } else { side * side }
    }

    /// A random point in each of side × side strata; of a line in each of as many parts of its length.
    pub(super) fn strata<'a>(
        &'a self,
        side: u32,
        random: &'a mut Stream,
    ) -> impl Iterator<Item = DVec3> + 'a {
        let width = 1.0 / f64::from(side);
        let cells = (0..side).flat_map(move |row| (0..side).map(move |column| (column, row)));
        cells.take(self.rays(side) as usize).map(move |(column, row)| {
            let [s, t] = random.next_pair();
            let [s, t] = [(f64::from(column) + s) * width, (f64::from(row) + t) * width];
            let [x, y] = match self.figure {
                Figure::Square => [s, t],
                // A row's columns are the parts of one of its length's `side` parts.
                Figure::Line => [(f64::from(row) + s) * width, 0.0],
                Figure::Disc => onto_disc(2.0 * s - 1.0, 2.0 * t - 1.0).into(),
                Figure::Triangles(pieces) => onto_pieces(pieces, s, t).into(),
                Figure::Stadium { half_length, radius } => onto_stadium(half_length, radius, s, t),
                Figure::Point => [0.0; 2],
            };
            self.base + self.sides[0] * x + self.sides[1] * y
        })
    }
}

/// The sides of a light's rectangle, as vectors from corner to corner, and its first corner.
fn rectangle(light: &Light, origin: DVec3) -> ([DVec3; 2], DVec3) {
    let light = light.rectangle();
    let axes = light.world_from_light();
    let [width, height] = light.half_extents();
    let sides = [
        axes.transform_vector3(DVec3::new(2.0 * width, 0.0, 0.0)),
        axes.transform_vector3(DVec3::new(0.0, 2.0 * height, 0.0)),
    ];
    (sides, light.center() - origin - (sides[0] + sides[1]) / 2.0)
}

fn across(z: DVec3) -> [DVec3; 2] {
    let (u, v) = z.any_orthonormal_pair();
    [u, v]
}

/// The square −1..1 onto the unit disc: areas keep their ratios, squares about the centre become circles, and what lies
/// on one side of x = 0 stays there (Shirley and Chiu 1997).
fn onto_disc(a: f64, b: f64) -> DVec2 {
    let quarter = |radius: f64, other: f64| {
        let angle = if radius == 0.0 { 0.0 } else { FRAC_PI_4 * other / radius };
        radius * DVec2::from_angle(angle)
    };
    if a.abs() > b.abs() {
        return quarter(a, b);
    }
    let turned = quarter(b, a);
    DVec2::new(turned.y, turned.x)
}

/// The unit square onto a stadium, uniformly: a half disc, a rectangle of 2 half-lengths by 2 radii, a half disc.
fn onto_stadium(half_length: f64, radius: f64, s: f64, t: f64) -> [f64; 2] {
    let (middle, caps) = (4.0 * half_length, PI * radius);
    let cap = 0.5 * caps / (middle + caps);
    let b = 2.0 * t - 1.0;
    let on_cap = |a: f64| onto_disc(a, b) * radius;
    if s < cap {
        let p = on_cap(s / cap - 1.0);
        return [p.x - half_length, p.y];
    }
    if s > 1.0 - cap {
        let p = on_cap(1.0 - (1.0 - s) / cap);
        return [p.x + half_length, p.y];
    }
    let share = (s - cap) / (1.0 - 2.0 * cap);
    let x = if half_length > 0.0 { (2.0 * share - 1.0) * half_length } else { 0.0 };
    [x, b * radius]
}

/// The unit square onto a polygon, uniformly: its triangles beside each other, each as wide as its share of the area,
/// and the triangle's points by their share of the area between a corner and a parallel to the side across (Turk 1990).
fn onto_pieces(pieces: &[Piece], s: f64, t: f64) -> DVec2 {
    let after = pieces.partition_point(|piece| piece.before <= s);
    let Some(piece) = pieces.get(after.saturating_sub(1)) else { return DVec2::ZERO };
    let [a, b, c] = piece.corners;
    let share = ((s - piece.before) / piece.share).clamp(0.0, 1.0);
    a + share.sqrt() * ((b - a) + t * (c - b))
}

/// A simple polygon, counter-clockwise, as triangles: one ear after the other is cut off (Meisters 1975).
fn pieces(corners: &[[f64; 2]]) -> Vec<Piece> {
    let mut rest: Vec<DVec2> = corners.iter().map(|&corner| corner.into()).collect();
    let mut triangles = Vec::with_capacity(rest.len());
    while rest.len() > 3 {
        let n = rest.len();
        let at = |i: usize| [rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]];
        // Rounding may leave no ear by this test, and then what is most like one is cut off.
        let ear = (0..n).find(|&i| is_ear(&at(i), &rest)).or_else(|| {
            (0..n).max_by(|&i, &j| doubled_area(&at(i)).total_cmp(&doubled_area(&at(j))))
        });
        let ear = ear.unwrap_or(0);
        triangles.push(at(ear));
        rest.remove(ear);
    }
    triangles.extend(<[DVec2; 3]>::try_from(rest));
    triangles.retain(|triangle| doubled_area(triangle) > 0.0);
    let whole: f64 = triangles.iter().map(doubled_area).sum();
    let mut before = 0.0;
    let piece = |corners: [DVec2; 3]| {
        let share = doubled_area(&corners) / whole;
        before += share;
        Piece { before: before - share, share, corners }
    };
    triangles.into_iter().map(piece).collect()
}

/// Twice the area of a triangle, above 0 where it runs counter-clockwise.
fn doubled_area([a, b, c]: &[DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether a polygon's corner and its neighbours are a triangle of the polygon that no other corner touches.
fn is_ear(triangle: &[DVec2; 3], polygon: &[DVec2]) -> bool {
    let [a, b, c] = *triangle;
    let within =
        |&p: &DVec2| [[a, b, p], [b, c, p], [c, a, p]].iter().all(|side| doubled_area(side) >= 0.0);
    let others = polygon.iter().filter(|p| !triangle.contains(p));
    doubled_area(triangle) >= 0.0 && !others.clone().any(within)
}
