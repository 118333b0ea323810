//! Exact against the closed form, and against sums worked out by hand.

use crate::truth::random::Random;
use antumbra::RectangleLight;
use antumbra::scene::{Mesh, Role, Scene};
use antumbra::truth::{
    Exact, PolygonLight, Receiver, visible_fraction_of_polygon, visible_fraction_of_quad,
};
use glam::{DMat4, DVec3};

pub mod bunny;
mod laws;

/// The error bound of the truth where distances are of one order (the module's derivation gives a
/// hundredth of it).
const PROMISED: f64 = 1e-9;

/// Triangles in f64: each is an f32 mesh, the unit triangle, under a transform of its own.
pub fn soup(triangles: &[[DVec3; 3]], role: Role) -> Scene {
    let mut scene = Scene::default();
    for (i, &[a, b, c]) in triangles.iter().enumerate() {
        let unit = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            indices: vec![0, 1, 2],
            ..Mesh::default()
        };
        let columns = [(b - a).extend(0.0), (c - a).extend(0.0), DVec3::Z.extend(0.0)];
        let place = DMat4::from_cols(columns[0], columns[1], columns[2], a.extend(1.0));
        scene.add(&format!("triangle {i}"), unit, place, role);
    }
    scene
}

pub fn halves([a, b, c, d]: [DVec3; 4]) -> [[DVec3; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

fn seen(triangles: &[[DVec3; 3]], light: &PolygonLight, point: DVec3) -> f64 {
    Exact::new(&soup(triangles, Role::Both)).unwrap().visible_from(light, point).unwrap()
}

/// A unit light at y = 2, shining down.
fn ceiling() -> RectangleLight {
    let up = DVec3::new(0.0, 2.0, 0.0);
    RectangleLight::new(up, DVec3::X / 2.0, DVec3::NEG_Z / 2.0).unwrap()
}

/// A card over x and z in −half..half.
fn card(half: f64, y: f64) -> [[DVec3; 3]; 2] {
    halves(
        [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]]
            .map(|[x, z]| DVec3::new(x * half, y, z * half)),
    )
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected}");
}

#[test]
fn agrees_with_the_closed_form() {
    let mut random = Random(41);
    let (mut worst, mut partial) = (0.0_f64, 0);
    for case in 0..6000 {
        let [x, y, z] = random.frame();
        let center = random.vector(2.0);
        let sides = [random.within(0.05, 1.0), random.within(0.05, 1.0)];
        let light = RectangleLight::new(center, x * sides[0], y * sides[1]).unwrap();
        let receiver = center - z * random.within(0.5, 3.0) + random.vector(1.0);
        // Some reach through the light's plane, some behind the receiver, some through both.
        let size = [0.3, 1.0, 30.0][case % 3];
        let at = center + (receiver - center) * random.within(0.0, 1.1);
        let [u, v] = [(); 2].map(|()| random.vector(size));
        let corner = at - u * random.within(0.0, 1.0) - v * random.within(0.0, 1.0);
        let (triangles, expected) = if case % 2 == 0 {
            let triangle = [corner, corner + u, corner + v];
            (vec![triangle], visible_fraction_of_polygon(&light, &triangle, receiver))
        } else {
            let quad = [corner, corner + u, corner + u + v, corner + v];
            (halves(quad).to_vec(), visible_fraction_of_quad(&light, quad, receiver))
        };
        worst =
            worst.max((seen(&triangles, &PolygonLight::from(&light), receiver) - expected).abs());
        partial += usize::from(expected > 0.0 && expected < 1.0);
    }
    println!("worst difference from the closed form: {worst:.1e}");
    assert!(worst < PROMISED, "{worst}");
    assert!(partial > 2000, "only {partial} cases were in the penumbra");
}

#[test]
fn parallel_cards_at_many_heights_cover_what_a_grid_of_their_edges_says() {
    let mut random = Random(42);
    for _ in 0..100 {
        let point = DVec3::new(random.within(-1.0, 1.0), 0.0, random.within(-1.0, 1.0));
        let (mut triangles, mut shadows) = (Vec::new(), Vec::new());
        for _ in 0..8 {
            let y = random.within(0.1, 1.9);
            let k = 2.0 / y;
            // Where it is on the light, then where that puts it at height y.
            let [low, size] = [random.vector(0.6), random.vector(0.5).abs()];
            let high = low + size;
            shadows.push([low.x, high.x, low.z, high.z]);
            let place = |x: f64, z: f64| {
                DVec3::new(point.x + (x - point.x) / k, y, point.z + (z - point.z) / k)
            };
            triangles.extend(halves([
                place(low.x, low.z),
                place(low.x, high.z),
                place(high.x, high.z),
                place(high.x, low.z),
            ]));
        }
        // Every cell between neighbouring edges is covered whole or not at all.
        let cuts = |from: usize| {
            let edges = shadows.iter().flat_map(|s| [s[from], s[from + 1]]).chain([-0.5, 0.5]);
            let mut cuts: Vec<f64> = edges.filter(|e| e.abs() <= 0.5).collect();
            cuts.sort_by(f64::total_cmp);
            cuts
        };
        let mut open = 0.0;
        for x in cuts(0).windows(2) {
            for z in cuts(2).windows(2) {
                let (mx, mz) = ((x[0] + x[1]) / 2.0, (z[0] + z[1]) / 2.0);
                let covers = |s: &[f64; 4]| s[0] < mx && mx < s[1] && s[2] < mz && mz < s[3];
                if !shadows.iter().any(covers) {
                    open += (x[1] - x[0]) * (z[1] - z[0]);
                }
            }
        }
        assert_near(seen(&triangles, &PolygonLight::from(&ceiling()), point), open, 1e-12);
    }
}

#[test]
fn the_error_is_within_what_is_derived_for_lights_of_any_size() {
    // A light 2 m away, turned out of every axis; a card half way whose shadow is the light moved.
    let mut random = Random(45);
    for half in [1.0, 1e-2, 1e-4, 1e-6] {
        // The module's η.
        let placement = 16.0 * 2.0_f64.powi(-53) * 2.0 / half;
        let mut worst = 0.0_f64;
        for _ in 0..300 {
            let [x, y, z] = random.frame();
            let light = RectangleLight::new(z, x * half, y * half).unwrap();
            let moved = [random.within(-0.9, 0.9), random.within(-0.9, 0.9)];
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[s, t]| (x * (s + moved[0] * 2.0) + y * (t + moved[1] * 2.0)) * (half / 2.0));
            let expected = 1.0 - moved.iter().map(|m| 1.0 - m.abs()).product::<f64>();
            let v = seen(&halves(corners), &PolygonLight::from(&light), -z);
            worst = worst.max((v - expected).abs());
        }
        println!("half-extent {half:e}: worst error {worst:.1e}, {placement:.1e} a corner");
        // An outline of at most 8 half-extents, of 4; as much again for the inputs' own rounding.
        assert!(worst < 2.0 * 2.0 * placement, "{worst} for half-extents of {half}");
    }
}

#[test]
fn disjoint_triangles_add_and_copies_or_turned_ones_change_nothing() {
    let light = PolygonLight::from(&ceiling());
    let left = [[-0.2, 0.9, 0.0], [-0.05, 1.0, 0.1], [-0.1, 1.1, -0.15]].map(DVec3::from_array);
    let right = left.map(|p| DVec3::new(-p.x * 0.8, p.y, p.z));
    let of = |triangles: &[[DVec3; 3]]| seen(triangles, &light, DVec3::new(0.01, 0.0, 0.02));
    let [a, b] = [1.0 - of(&[left]), 1.0 - of(&[right])];
    assert!(a > 0.01 && b > 0.01 && a != b);
    assert_near(1.0 - of(&[left, right]), a + b, 1e-14);
    assert_eq!(of(&[left, left, left]), of(&[left]));
    let [p, q, r] = left;
    for turned in [[q, r, p], [r, q, p], [p, r, q]] {
        assert_near(of(&[turned]), 1.0 - a, 1e-14);
        assert_near(of(&[left, turned]), 1.0 - a, 1e-14);
    }
    // Seen from the point, one hides the other whole.
    let behind = left.map(|corner| corner * 1.2 - DVec3::new(0.002, 0.0, 0.004));
    assert_near(of(&[left, behind]), 1.0 - a, 1e-14);
}

#[test]
fn a_quad_cut_with_t_junctions_is_the_quad() {
    let mut random = Random(43);
    let mut partial = 0;
    for _ in 0..300 {
        let [u, v] = [(); 2].map(|()| random.vector(0.6));
        let corner = DVec3::Y - (u + v) / 2.0 + random.vector(0.2);
        let at = |s: f64, t: f64| corner + u * s + v * t;
        // Left in one piece, right in three that meet the middle where the left has no corner.
        let s = random.within(0.2, 0.8);
        let mut cuts = [random.within(0.0, 1.0), random.within(0.0, 1.0)];
        cuts.sort_by(f64::total_cmp);
        let mut pieces = halves([at(0.0, 0.0), at(s, 0.0), at(s, 1.0), at(0.0, 1.0)]).to_vec();
        for t in [0.0, cuts[0], cuts[1], 1.0].windows(2) {
            pieces.extend(halves([at(s, t[0]), at(1.0, t[0]), at(1.0, t[1]), at(s, t[1])]));
        }
        let point = DVec3::new(random.within(-0.5, 0.5), 0.0, random.within(-0.5, 0.5));
        let whole = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        let expected = visible_fraction_of_quad(&ceiling(), whole, point);
        assert_near(seen(&pieces, &PolygonLight::from(&ceiling()), point), expected, 1e-12);
        partial += usize::from(expected > 0.0 && expected < 1.0);
    }
    assert!(partial > 100, "only {partial} cases were in the penumbra");
}

#[test]
fn triangles_without_an_area_block_nothing() {
    let light = PolygonLight::from(&ceiling());
    let [p, q] = [DVec3::new(-0.3, 1.0, 0.0), DVec3::new(0.3, 1.1, 0.1)];
    let point = DVec3::new(0.1, 0.0, 0.0);
    let edge_on = [point, point + DVec3::Y, point + DVec3::new(0.1, 1.0, 0.0)];
    let none = [[p; 3], [p, q, p], [p, q, p.lerp(q, 0.5)], edge_on];
    assert_eq!(seen(&none, &light, point), 1.0);
    assert_eq!(seen(&[], &light, point), 1.0);
}

#[test]
fn parts_of_a_light_average_to_the_whole_by_area() {
    let mut random = Random(44);
    for _ in 0..100 {
        let triangles: Vec<[DVec3; 3]> = (0..6)
            .map(|_| {
                let at = DVec3::Y + random.vector(0.3);
                [(); 3].map(|()| at + random.vector(0.4))
            })
            .collect();
        let exact = Exact::new(&soup(&triangles, Role::Both)).unwrap();
        let point = DVec3::new(random.within(-0.5, 0.5), 0.0, random.within(-0.5, 0.5));
        // The ceiling, its corners counter-clockwise seen from below.
        let s = random.within(-0.4, 0.4);
        let t = random.within(-0.4, 0.4);
        let light = |corners: &[[f64; 2]]| {
            let world = corners.iter().map(|&[x, z]| DVec3::new(x, 2.0, z)).collect::<Vec<_>>();
            exact.visible_from(&PolygonLight::new(&world).unwrap(), point).unwrap()
        };
        let whole = exact.visible_from(&PolygonLight::from(&ceiling()), point).unwrap();
        assert_near(light(&[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]), whole, 1e-12);
        let left = light(&[[-0.5, -0.5], [s, -0.5], [t, 0.5], [-0.5, 0.5]]);
        let right = light(&[[s, -0.5], [0.5, -0.5], [0.5, 0.5], [t, 0.5]]);
        let share = (s + t) / 2.0 + 0.5;
        assert_near(left * share + right * (1.0 - share), whole, 1e-12);
        // An L and the rectangle that it lacks.
        let l = [[-0.5, -0.5], [0.5, -0.5], [0.5, t], [s, t], [s, 0.5], [-0.5, 0.5]];
        let lack = (0.5 - s) * (0.5 - t);
        let rest = light(&[[s, t], [0.5, t], [0.5, 0.5], [s, 0.5]]);
        assert_near(light(&l) * (1.0 - lack) + rest * lack, whole, 1e-12);
    }
}

#[test]
fn an_occluder_a_micrometre_away_is_placed_as_exactly_as_a_far_one() {
    // The same shadow from ever nearer: the card shrinks towards the point.
    let point = DVec3::new(0.123_456, 0.0, -0.2);
    let light = PolygonLight::from(&ceiling());
    let far = [[-0.3, 1.0, -0.2], [0.2, 0.9, 0.1], [0.0, 1.1, 0.35]].map(DVec3::from_array);
    let expected = seen(&[far], &light, point);
    assert!(expected > 0.1 && expected < 0.9);
    for scale in [1e-2, 1e-4, 1e-6] {
        // Positions next to the point are rounded to 2⁻⁵⁶ m, which the scale magnifies.
        let rounding = 1e-16 / scale;
        let near = far.map(|corner| point + (corner - point) * scale);
        assert_near(seen(&[near], &light, point), expected, PROMISED.min(20.0 * rounding));
    }
}
