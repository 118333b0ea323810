//! What each of the light's samples counts for.
//!
//! The samples lie on the rectangle around the light's shape, a cell each. A sample counts for the share of its cell that
//! the shape covers, so that any shape is the rectangle with other weights.

use crate::Shape;
use std::f64::consts::TAU;

/// The most cells along a side of the light that have weights of their own.
pub(super) const MOST: usize = 16;

/// The corners of the polygon that stands for a circle: its area is 99.98 % of the circle's.
const CIRCLE: usize = 180;

/// The weights of the samples, row by row: 65,535 for a cell within the shape, 0 for one outside.
pub type Weights = [u16; MOST * MOST];

/// The weights of a shape's `side` × `side` samples, at most [`MOST`] a side; `None` where all are the same.
pub fn weights(shape: Shape, half: [f64; 2], side: usize) -> Option<Weights> {
    let outline: Vec<[f64; 2]> = match shape {
        Shape::Polygon(corners) => corners.to_vec(),
        Shape::Disc { .. } | Shape::Sphere { .. } | Shape::Sun { .. } => stadium(0.0, half[1]),
        Shape::Capsule { half_length, radius } => stadium(half_length, radius),
        _ => return None,
    };
    let step = half.map(|h| 2.0 * h / side as f64);
    let cell = |nth: usize| {
        let at = [nth % side, nth / side];
        if at[1] >= side {
            return 0;
        }
        let low = [0, 1].map(|i| -half[i] + step[i] * at[i] as f64);
        let share = covered(&outline, low, step) / (step[0] * step[1]);
        (share.clamp(0.0, 1.0) * f64::from(u16::MAX)).round() as u16
    };
    Some(std::array::from_fn(cell))
}

/// The outline of all points within `radius` of a segment along x: a circle where it has no length.
fn stadium(half_length: f64, radius: f64) -> Vec<[f64; 2]> {
    let corner = |nth: usize| {
        let (sin, cos) = (TAU * (nth as f64 + 0.5) / CIRCLE as f64).sin_cos();
        [radius * cos + half_length.copysign(cos), radius * sin]
    };
    (0..CIRCLE).map(corner).collect()
}

/// The area of a polygon within a cell (Sutherland and Hodgman 1974).
fn covered(outline: &[[f64; 2]], low: [f64; 2], size: [f64; 2]) -> f64 {
    let mut within = outline.to_vec();
    for axis in 0..2 {
        for (sign, limit) in [(1.0, low[axis]), (-1.0, -low[axis] - size[axis])] {
            within = cut(&within, |p| sign * p[axis] - limit);
        }
    }
    let edges = within.iter().zip(within.iter().cycle().skip(1));
    edges.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs() / 2.0
}

/// The part of a polygon where `inside` is at least 0, for a linear `inside`.
fn cut(polygon: &[[f64; 2]], inside: impl Fn(&[f64; 2]) -> f64) -> Vec<[f64; 2]> {
    let mut kept = Vec::with_capacity(polygon.len() + 4);
    for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (from, to) = (inside(a), inside(b));
        if from >= 0.0 {
            kept.push(*a);
        }
        if (from >= 0.0) != (to >= 0.0) {
            let t = from / (from - to);
            kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn area(shape: Shape, half: [f64; 2]) -> f64 {
        let of = |side: usize| {
            let sum: f64 = weights(shape, half, side).unwrap().iter().map(|&w| f64::from(w)).sum();
            sum / f64::from(u16::MAX) / (side * side) as f64 * 4.0 * half[0] * half[1]
        };
        assert!((of(8) / of(16) - 1.0).abs() < 1e-3);
        of(8)
    }

    #[test]
    fn weights_add_up_to_the_shapes_area() {
        assert_eq!(weights(Shape::Rectangle, [1.0, 2.0], 8), None);
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-3;
        assert!(near(area(Shape::Disc { radius: 2.0 }, [2.0, 2.0]), 4.0 * PI));
        let capsule = Shape::Capsule { half_length: 1.0, radius: 0.5 };
        assert!(near(area(capsule, [1.5, 0.5]), 2.0 + PI / 4.0));
        // An L, which is not convex.
        let l = [[-1.0, -1.0], [1.0, -1.0], [1.0, -0.4], [-0.3, -0.4], [-0.3, 1.0], [-1.0, 1.0]];
        let polygon = Shape::Polygon(&l);
        assert!(near(area(polygon, [1.0, 1.0]), 2.0 * 0.6 + 0.7 * 1.4));
        let weights = weights(polygon, [1.0, 1.0], 8).unwrap();
        assert_eq!((weights[0], weights[63]), (u16::MAX, 0));
    }
}
