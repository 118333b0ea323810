//! The union's area against an integral over slabs, on which no edge begins, ends or crosses.

use super::*;
use crate::truth::random::Random;

/// A few thousand roundings of f64: sums over hundreds of slabs, each a few roundings off.
const ROUNDING: f64 = 1e-12;

/// The share of the light that no triangle covers.
///
/// Between abscissas where edges begin, end or cross, the length of a vertical line that is inside
/// the light and outside every triangle is linear, so the middle times the width is its integral.
fn by_slabs(light: &[DVec2], triangles: &[[DVec2; 3]]) -> f64 {
    let outlines: Vec<&[DVec2]> =
        std::iter::once(light).chain(triangles.iter().map(|t| &t[..])).collect();
    let edges: Vec<[DVec2; 2]> = outlines.iter().flat_map(|outline| loop_of(outline)).collect();
    let mut events: Vec<f64> = edges.iter().map(|edge| edge[0].x).collect();
    for (i, [a, b]) in edges.iter().enumerate() {
        for [c, d] in &edges[..i] {
            let (u, v) = (b - a, d - c);
            let t = (c - a).perp_dot(v) / u.perp_dot(v);
            if (0.0..=1.0).contains(&t) {
                events.push(a.x + u.x * t);
            }
        }
    }
    events.sort_by(f64::total_cmp);
    let (mut seen, mut whole) = (0.0, 0.0);
    for slab in events.windows(2) {
        let (x, width) = ((slab[0] + slab[1]) / 2.0, slab[1] - slab[0]);
        let mut covered: Vec<[f64; 2]> =
            triangles.iter().flat_map(|triangle| spans(triangle, x)).collect();
        covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
        for [low, high] in spans(light, x) {
            whole += (high - low) * width;
            let mut from = low;
            for [bottom, top] in &covered {
                seen += (bottom.min(high) - from).max(0.0) * width;
                from = from.max(*top);
            }
            seen += (high - from).max(0.0) * width;
        }
    }
    seen / whole
}

fn loop_of(outline: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> + '_ {
    (0..outline.len()).map(|i| [outline[i], outline[(i + 1) % outline.len()]])
}

/// Where the vertical line at x is inside the outline.
fn spans(outline: &[DVec2], x: f64) -> Vec<[f64; 2]> {
    let crossed = loop_of(outline).filter(|[a, b]| (a.x < x) != (b.x < x));
    let mut ys: Vec<f64> =
        crossed.map(|[a, b]| a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x)).collect();
    ys.sort_by(f64::total_cmp);
    ys.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

fn by_library(light: &LightOutline, triangles: &[[DVec2; 3]]) -> f64 {
    let mut union = Union::new();
    for triangle in triangles {
        union.add(&mut triangle.map(to_grid));
    }
    union.uncovered(light)
}

fn square() -> [DVec2; 4] {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(DVec2::from_array)
}

fn point(random: &mut Random, size: f64) -> DVec2 {
    random.vector(size).truncate()
}

#[test]
fn overlapping_triangles_cover_what_an_integral_over_slabs_says() {
    let mut random = Random(31);
    let (mut worst, mut partial) = (0.0_f64, 0);
    for case in 0..400 {
        // Corners in common, and in common with the light's, make edges that coincide and touch.
        let pool: Vec<DVec2> = match case % 3 {
            0 => (0..8).map(|_| point(&mut random, 1.5)).chain(square()).collect(),
            _ => (0..60).map(|_| point(&mut random, 1.5)).collect(),
        };
        let needle = if case % 3 == 2 { 1e-6 } else { 1.0 };
        let triangles: Vec<[DVec2; 3]> = (0..12)
            .map(|_| {
                let pick = [(); 3].map(|()| random.within(0.0, pool.len() as f64) as usize);
                let [a, b, c] = pick.map(|i| pool[i]);
                [a, b, a + (c - a) * needle]
            })
            .collect();
        let expected = by_slabs(&square(), &triangles);
        let seen = by_library(&LightOutline::square(), &triangles);
        worst = worst.max((seen - expected).abs());
        partial += usize::from(expected > 0.05 && expected < 0.95);
    }
    println!("worst difference from the integral over slabs: {worst:.1e}");
    assert!(worst < ROUNDING, "{worst}");
    assert!(partial > 200, "only {partial} cases cover a part");
}

#[test]
fn a_light_of_any_outline_is_covered_as_the_integral_says() {
    let mut random = Random(32);
    let mut worst = 0.0_f64;
    for _ in 0..200 {
        // Star-shaped about the centre, hence simple; mostly not convex.
        let light: Vec<DVec2> = (0..9)
            .map(|i| {
                let angle = std::f64::consts::TAU * (f64::from(i) + random.within(0.0, 0.9)) / 9.0;
                DVec2::from_angle(angle) * random.within(0.2, 1.0)
            })
            .collect();
        let outline = LightOutline::new(light.iter().map(|&p| to_grid(p)).collect());
        let outline = outline.unwrap_or_else(|| panic!("{light:?} is simple"));
        let triangles: Vec<[DVec2; 3]> =
            (0..5).map(|_| [(); 3].map(|()| point(&mut random, 1.2))).collect();
        let difference = by_library(&outline, &triangles) - by_slabs(&light, &triangles);
        worst = worst.max(difference.abs());
    }
    assert!(worst < ROUNDING, "{worst}");
}

#[test]
fn edges_that_coincide_but_for_rounding_cover_what_the_integral_says() {
    // Corners on a lattice in a skewed frame: bundles of collinear edges, a few roundings apart.
    let mut random = Random(35);
    for jitter in [0.0, 1e-16, 1e-14, 1e-12, 1e-9] {
        for steps in [2.0, 4.0, 8.0, 50.0] {
            let skew = [(); 2].map(|()| point(&mut random, 0.1) + DVec2::splat(0.2));
            let mut corner = || {
                let place = point(&mut random, 1.0) * steps;
                let p = place.round() / steps;
                let skewed = DVec2::new(p.x + p.dot(skew[0]), p.y + p.dot(skew[1]));
                skewed + point(&mut random, jitter)
            };
            let all: Vec<[DVec2; 3]> = (0..50).map(|_| [(); 3].map(|()| corner())).collect();
            // A few large ones cover the light; small ones leave gaps.
            let small: Vec<[DVec2; 3]> =
                all.iter().map(|[a, b, c]| [*a, a + (b - a) * 0.15, a + (c - a) * 0.15]).collect();
            for triangles in [&all[..6], &small] {
                let seen = by_library(&LightOutline::square(), triangles);
                let expected = by_slabs(&square(), triangles);
                let difference = (seen - expected).abs();
                assert!(difference < ROUNDING, "{difference} at {jitter}, {steps} steps");
            }
        }
    }
}

#[test]
fn the_comparison_sees_a_triangle_that_is_lost_and_one_that_is_a_billionth_too_big() {
    let mut random = Random(33);
    let mut triangles: Vec<[DVec2; 3]> =
        (0..5).map(|_| [(); 3].map(|()| point(&mut random, 0.4))).collect();
    let expected = by_slabs(&square(), &triangles);
    let without = by_library(&LightOutline::square(), &triangles[1..]);
    assert!((without - expected).abs() > 1e-3);
    triangles.iter_mut().flatten().for_each(|corner| *corner *= 1.0 + 1e-9);
    let bigger = by_library(&LightOutline::square(), &triangles);
    assert!((bigger - expected).abs() > 10.0 * ROUNDING);
}

#[test]
fn a_fan_of_slivers_leaves_no_crack() {
    // Neighbours share corners to the bit, so their union is whole to the bit.
    let rim: Vec<DVec2> = (0..2000)
        .map(|i| DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / 2000.0) * 1.9)
        .collect();
    let apex = DVec2::new(0.3, -0.7);
    let fan: Vec<[DVec2; 3]> = loop_of(&rim).map(|[a, b]| [apex, a, b]).collect();
    assert_eq!(by_library(&LightOutline::square(), &fan), 0.0);
    // But for one of them, which is a narrow triangle.
    let seen = by_library(&LightOutline::square(), &fan[1..]);
    let expected = 1.0 - by_slabs(&square(), &fan[..1]);
    assert!(seen > 0.0 && (seen - expected).abs() < ROUNDING, "{seen} against {expected}");
}

#[test]
fn thousands_of_polygons_add_up_whichever_way_the_library_looks_for_crossings() {
    // It lists below 2,000 edges, keeps a tree beyond, and cuts the plane up beyond 32,000.
    let mut random = Random(34);
    let cell: Vec<[DVec2; 3]> = (0..4).map(|_| [(); 3].map(|()| point(&mut random, 1.0))).collect();
    let covered = 1.0 - by_slabs(&square(), &cell);
    for side in [1, 10, 30, 60] {
        let scale = 1.0 / f64::from(side);
        let centers = (0..side * side).map(|i| {
            let at = |i: i32| f64::from(2 * i + 1) * scale - 1.0;
            DVec2::new(at(i % side), at(i / side))
        });
        let all: Vec<[DVec2; 3]> = centers
            .flat_map(|center| cell.iter().map(move |t| t.map(|p| center + p * scale)))
            .collect();
        let seen = by_library(&LightOutline::square(), &all);
        assert!((1.0 - seen - covered).abs() < ROUNDING, "{side}: {seen} and {covered}");
    }
}

#[test]
fn what_has_no_area_covers_nothing_and_what_is_not_finite_does_not_panic() {
    let o = DVec2::ZERO;
    let nothing = [[o; 3], [o, DVec2::X, DVec2::X * 0.5], [o, DVec2::Y, o]];
    assert_eq!(by_library(&LightOutline::square(), &nothing), 1.0);
    let torn = [[DVec2::NAN, DVec2::INFINITY, DVec2::NEG_INFINITY], [DVec2::MAX, DVec2::MIN, o]];
    let seen = by_library(&LightOutline::square(), &torn);
    assert!((0.0..=1.0).contains(&seen));
}
