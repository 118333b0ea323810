//! Lines against sums worked out by hand, against rays, and against rectangles that are all but lines.

use crate::truth::exact::{halves, soup};
use crate::truth::random::Random;
use antumbra::RectangleLight;
use antumbra::scene::Role;
use antumbra::truth::{Exact, ExactLine, PolygonLight, Receiver};
use glam::DVec3;

mod bunny;
mod laws;

/// The error bound of the truth where distances are of one order and no edge lies in the receiver's plane.
const PROMISED: f64 = 1e-9;

/// A line light over x in −1..1 at y = 2, shining down.
fn tube() -> RectangleLight {
    RectangleLight::line(DVec3::Y * 2.0, DVec3::X, DVec3::NEG_Y).unwrap()
}

/// A card over x in `from..to` and |z| ≤ `half`.
fn card([from, to]: [f64; 2], y: f64, half: f64) -> [[DVec3; 3]; 2] {
    halves([[from, -half], [from, half], [to, half], [to, -half]].map(|[x, z]| DVec3::new(x, y, z)))
}

fn seen(triangles: &[[DVec3; 3]], light: &RectangleLight, point: DVec3) -> f64 {
    ExactLine::new(&soup(triangles, Role::Both)).unwrap().visible_from(light, point).unwrap()
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected}");
}

/// Random triangles before a random line, seen from a random point: loose ones of many sizes, some of
/// which reach through the light's plane, some behind the receiver.
struct Case {
    light: RectangleLight,
    point: DVec3,
    triangles: Vec<[DVec3; 3]>,
}

fn random_case(random: &mut Random, triangles: usize) -> Case {
    let [x, _, z] = random.frame();
    let center = random.vector(2.0);
    let half = x * random.within(0.05, 1.0);
    let light = RectangleLight::line(center, half, z + random.vector(0.5)).unwrap();
    let point = center + light.emission() * random.within(0.5, 3.0) + random.vector(1.0);
    let triangles = (0..triangles)
        .map(|i| {
            let at = center + half * random.within(-1.5, 1.5);
            let at = at + (point - at) * random.within(-0.1, 1.1);
            let size = [0.1, 0.3, 3.0][i % 3];
            [(); 3].map(|()| at + random.vector(size))
        })
        .collect();
    Case { light, point, triangles }
}

#[test]
fn a_card_hides_what_is_worked_out_by_hand() {
    // From (px, 0, pz) the card at y = 1 is seen twice as wide: x is carried to 2x − px on the light.
    for (edges, [px, pz], hidden) in [
        ([-0.2, 0.3], [0.0, 0.0], [-0.4, 0.6]),
        ([-0.2, 0.3], [0.1, 0.7], [-0.5, 0.5]),
        ([-0.2, 0.3], [0.5, -1.9], [-0.9, 0.1]),
        // Past an end of the light, and past both.
        ([0.2, 0.9], [0.0, 0.0], [0.4, 1.0]),
        ([-0.7, 0.9], [0.1, 0.3], [-1.0, 1.0]),
        // Beside the light, and beside the card: the plane meets y = 1 at pz / 2.
        ([0.2, 0.9], [-2.0, 0.0], [1.0, 1.0]),
        ([-0.2, 0.3], [0.0, 2.1], [0.0, 0.0]),
    ] {
        let v = seen(&card(edges, 1.0, 1.0), &tube(), DVec3::new(px, 0.0, pz));
        assert_near(v, 1.0 - 0.5 * (hidden[1] - hidden[0]), 1e-14);
    }
    // A wall across the light, from y = 0.5 to 1.5 at x = 0.2: 0.2 · 2 / 1.5 to 0.2 · 2 / 0.5.
    let wall = [[0.5, -1.0], [1.5, -1.0], [1.5, 1.0], [0.5, 1.0]];
    let wall = halves(wall.map(|[y, z]| DVec3::new(0.2, y, z)));
    assert_near(seen(&wall, &tube(), DVec3::ZERO), 1.0 - 0.5 * (0.8 - 0.8 / 3.0), 1e-14);
    // A triangle with its corner in the middle, cut where it is half as wide: |x| ≤ 0.2 at z = ½.
    let corner = [[0.0, 0.0], [-0.4, 1.0], [0.4, 1.0]].map(|[x, z]| DVec3::new(x, 1.0, z));
    assert_near(seen(&[corner], &tube(), DVec3::Z), 1.0 - 0.4, 1e-14);
}

#[test]
fn two_cards_hide_their_union() {
    let of = |a, b| {
        let both = [card(a, 1.0, 1.0), card(b, 0.5, 1.0)].concat();
        1.0 - seen(&both, &tube(), DVec3::new(0.0, 0.0, 0.2))
    };
    // Seen twice and four times as wide: −0.8..−0.2 with 0.2..0.6, −0.4..0.6, −0.6..−0.4, −0.8..−0.2.
    let a = [-0.4, -0.1];
    assert_near(of(a, [0.05, 0.15]), 0.5 * (0.6 + 0.4), 1e-14);
    assert_near(of(a, [-0.1, 0.15]), 0.5 * 1.4, 1e-14);
    assert_near(of(a, [-0.15, -0.1]), 0.5 * 0.6, 1e-14);
    assert_near(of(a, [-0.2, -0.05]), 0.5 * 0.6, 1e-14);
}

/// Whether a triangle crosses the segment, by the volumes that it makes with its ends.
fn crosses([a, b, c]: [DVec3; 3], from: DVec3, to: DVec3) -> bool {
    let volume = |p: DVec3, q: DVec3, r: DVec3| (p - from).dot((q - from).cross(r - from));
    let turns = [volume(a, b, to), volume(b, c, to), volume(c, a, to)];
    let normal = (b - a).cross(c - a);
    let between = normal.dot(from - a) * normal.dot(to - a) < 0.0;
    between && (turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0))
}

#[test]
fn rays_to_a_thousand_points_of_the_light_agree() {
    const RAYS: u32 = 1000;
    let mut random = Random(71);
    let mut partial = 0;
    for count in 0..600 {
        let Case { light, point, triangles } = random_case(&mut random, 1 + count % 12);
        let half = light.world_from_light().transform_vector3(DVec3::X * light.half_extents()[0]);
        let free = (0..RAYS)
            .map(|i| light.center() + half * ((2.0 * f64::from(i) + 1.0) / f64::from(RAYS) - 1.0))
            .filter(|&to| !triangles.iter().any(|&t| crosses(t, point, to)))
            .count();
        let lit = (point - light.center()).dot(light.emission()) > 0.0;
        let expected = if lit { free as f64 / f64::from(RAYS) } else { 1.0 };
        let v = seen(&triangles, &light, point);
        // Half a ray for each end of an interval.
        let allowed = triangles.len() as f64 / f64::from(RAYS);
        assert_near(v, expected, allowed);
        partial += usize::from(v > 0.0 && v < 1.0);
    }
    assert!(partial > 250, "only {partial} cases were in the penumbra");
}

#[test]
fn a_line_is_what_ever_thinner_rectangles_come_to() {
    let mut random = Random(72);
    for _ in 0..100 {
        let Case { light, point, triangles } = random_case(&mut random, 6);
        let frame = light.world_from_light();
        let half = frame.transform_vector3(DVec3::X * light.half_extents()[0]);
        let exact = Exact::new(&soup(&triangles, Role::Both)).unwrap();
        let v = seen(&triangles, &light, point);
        let thin = |height: f64| {
            // Emission is −(u × v).
            let up = frame.transform_vector3(DVec3::NEG_Y * height);
            let thin = RectangleLight::new(light.center(), half, up).unwrap();
            (exact.visible_from(&PolygonLight::from(&thin), point).unwrap() - v).abs()
        };
        // Its height moves an interval's ends, both ways alike, by as much times the cotangent of the
        // edge's angle with the receiver's plane.
        assert!(thin(1e-3) < 0.02 && thin(1e-7) < 1e-5, "{} {}", thin(1e-3), thin(1e-7));
    }
}

#[test]
fn an_occluder_a_micrometre_away_is_placed_as_exactly_as_a_far_one() {
    let point = DVec3::new(0.123_456, 0.0, -0.2);
    let far = [[-0.3, 1.0, -0.2], [0.2, 0.9, 0.1], [0.0, 1.1, -0.35]].map(DVec3::from_array);
    let expected = seen(&[far], &tube(), point);
    assert!(expected > 0.1 && expected < 0.9, "{expected}");
    for scale in [1e-2, 1e-4, 1e-6] {
        // Positions next to the point are rounded to 2⁻⁵⁶ m, which the scale magnifies.
        let rounding = 1e-16 / scale;
        let near = far.map(|corner| point + (corner - point) * scale);
        assert_near(seen(&[near], &tube(), point), expected, PROMISED.min(20.0 * rounding));
    }
}
