//! Points are spread evenly, over rectangles, lines, discs and outlines.

// A test may panic: that is how it fails.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::light::outline::doubled_area;

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
    // On a line they are one row of cells, evenly spaced.
    for (i, [x, y]) in places([2.0, 0.0], 256, 3).into_iter().enumerate() {
        let cell = (x / 2.0 + 1.0) * 128.0;
        assert!(y == 0.0 && (i as f64..=i as f64 + 1.0).contains(&cell), "{i}: {x} {y}");
    }
    assert_eq!(places([0.5, 0.2], 1, 0), [[0.0, 0.0]], "without a seed the centre");
    assert_ne!(places([0.5, 0.2], 9, 1), places([0.5, 0.2], 9, 2));
}

/// A disc has as many points in any half plane, but for the cells along its edge, as it has area there.
#[test]
fn points_are_spread_evenly_over_a_disc() {
    for n in [1_u32, 7, 64, 1000, 4096] {
        let points = places_on_disc(2.0, n, 3);
        assert_eq!(points.len(), n as usize);
        assert!(points.iter().all(|[x, y]| x.hypot(*y) <= 2.0));
        let root = f64::from(n).sqrt();
        for turn in [0.0_f64, 0.6, 1.9, 4.0] {
            let (sin, cos) = turn.sin_cos();
            for c in [-0.8_f64, -0.3, 0.0, 0.5] {
                let within = points.iter().filter(|[x, y]| x * cos + y * sin <= 2.0 * c).count();
                let share = 1.0 - (c.acos() - c * (1.0 - c * c).sqrt()) / std::f64::consts::PI;
                // A bent edge crosses up to twice as many cells as a straight one.
                let allowed = (2.0 * root + 2.0) / f64::from(n);
                let found = within as f64 / f64::from(n);
                assert!((found - share).abs() <= allowed, "{n} {turn} {c}: {found}, not {share}");
            }
        }
        // Rings of one area have as many points.
        let inner = points.iter().filter(|[x, y]| x.hypot(*y) <= 2.0 * 0.5_f64.sqrt()).count();
        let share = inner as f64 / f64::from(n);
        assert!((share - 0.5).abs() <= (4.0 * root + 4.0) / f64::from(n), "{n}: {share}");
    }
    assert_eq!(places_on_disc(2.0, 1, 0), [[0.0, 0.0]], "without a seed the centre");
}

/// An L, a triangle with its point to the side, a comb with three teeth, and a slanted sliver.
fn outlines() -> Vec<Vec<[f64; 2]>> {
    let comb = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [0.6, 1.0],
        [0.5, -0.5],
        [0.2, 0.9],
        [-0.2, 0.8],
        [-0.4, -0.6],
        [-0.5, 1.0],
        [-1.0, 1.0],
    ];
    vec![
        vec![[-1.0, -1.5], [1.0, -1.5], [1.0, -0.5], [0.0, -0.5], [0.0, 1.5], [-1.0, 1.5]],
        vec![[-0.5, -0.3], [0.5, 0.1], [-0.4, 0.3]],
        comb.to_vec(),
        vec![[-1.0, -0.1], [1.0, 0.08], [1.0, 0.1], [-0.9, -0.05]],
    ]
}

/// Whether a point is in a polygon, by how often a ray to the right leaves it.
fn is_in(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let n = polygon.len();
    let crossed = |&i: &usize| {
        let ([ax, ay], [bx, by]) = (polygon[i], polygon[(i + 1) % n]);
        (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)
    };
    (0..n).filter(crossed).count() % 2 == 1
}

/// Area and centroid, by triangles from the origin.
fn centroid(polygon: &[[f64; 2]]) -> (f64, [f64; 2]) {
    let mut sums = [0.0; 3];
    for [a, b] in edges(polygon) {
        let cross = a[0] * b[1] - a[1] * b[0];
        let moments = [0, 1].map(|i| (a[i] + b[i]) * cross / 6.0);
        sums = [sums[0] + cross / 2.0, sums[1] + moments[0], sums[2] + moments[1]];
    }
    (sums[0], [sums[1] / sums[0], sums[2] / sums[0]])
}

/// Points lie inside, and their mean is the centroid: each is off by no more than its cell, and the mean of n by √n
/// times less than one of them, since they are drawn one by one.
#[test]
fn points_of_an_outline_lie_in_it_and_round_its_centroid() {
    for outline in outlines() {
        let (area, middle) = centroid(&outline);
        assert!((doubled_area(&outline) - 2.0 * area).abs() < 1e-12);
        for n in [1_u32, 2, 3, 7, 16, 61, 256, 1000, 4096] {
            for seed in [0, 1, 5] {
                let points = places_within(&outline, n, seed);
                assert_eq!(points.len(), n as usize);
                let outside = points.iter().filter(|p| !is_in(&outline, **p)).count();
                assert_eq!(outside, 0, "{outline:?}, {n} points, seed {seed}");
                for axis in 0..2 {
                    let mean = points.iter().map(|p| p[axis]).sum::<f64>() / f64::from(n);
                    let reach = outline.iter().map(|p| p[axis]);
                    let (low, high) = reach
                        .fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
                    // A row is as high as it is where the polygon is narrow, and a cell as wide as it may be in
                    // two parts.
                    let cell = (high - low) / f64::from(n).sqrt();
                    let allowed = 2.0 * cell / f64::from(n).sqrt();
                    assert!(
                        (mean - middle[axis]).abs() <= allowed,
                        "{n} {seed} {axis}: {mean}, {middle:?}"
                    );
                }
            }
        }
    }
}

/// Left of any line there are as many points as the area there says, but for the cells that it cuts.
#[test]
fn points_of_an_outline_are_spread_evenly() {
    for outline in outlines() {
        let area = doubled_area(&outline);
        let points = places_within(&outline, 1024, 7);
        for axis in 0..2 {
            let swapped: Vec<_> = outline.iter().rev().map(|&[x, y]| [y, x]).collect();
            let polygon = if axis == 0 { &outline } else { &swapped };
            let [low, high] = Profile::new(polygon).reach();
            for step in 1..10 {
                let limit = low + (high - low) * f64::from(step) / 10.0;
                let expected = doubled_area(&below(polygon, limit, 1.0)) / area;
                let found = points.iter().filter(|p| p[axis] < limit).count() as f64 / 1024.0;
                assert!(
                    (expected - found).abs() < 1.5 / 32.0,
                    "{axis} {limit}: {expected} {found}"
                );
            }
        }
    }
}

/// A rectangle's outline is cut into the rectangle's own cells.
#[test]
fn an_outline_that_is_the_rectangle_has_its_points() {
    for [a, b] in [[0.5, 0.5], [2.0, 0.25], [0.1, 0.4]] {
        let outline = [[-a, -b], [a, -b], [a, b], [-a, b]];
        for n in [1_u32, 2, 3, 7, 61, 256, 1000] {
            let pairs = places([a, b], n, 3).into_iter().zip(places_within(&outline, n, 3));
            for (p, q) in pairs {
                assert!((0..2).all(|i| (p[i] - q[i]).abs() < 1e-12), "{a} {b} {n}: {p:?} {q:?}");
            }
        }
    }
    assert_ne!(places_within(&outlines()[0], 9, 1), places_within(&outlines()[0], 9, 2));
}
