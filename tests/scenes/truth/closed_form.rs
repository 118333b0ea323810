//! Values derived by hand, and laws.

use crate::truth::random::Random;
use antumbra::RectangleLight;
use antumbra::truth::closed_form::*;
use glam::DVec3;

/// A few hundred roundings of f64: every case below has coordinates of the order 1.
const ROUNDING: f64 = 1e-13;

/// `width` × `height`, at y = 2 above the origin, shining down; light space x is world x.
fn ceiling(width: f64, height: f64) -> RectangleLight {
    let up = DVec3::new(0.0, 2.0, 0.0);
    RectangleLight::new(up, DVec3::X * (width / 2.0), DVec3::NEG_Z * (height / 2.0)).unwrap()
}

/// Parallel to the ceiling, from corner to corner, at height `y`.
fn card(low: [f64; 2], high: [f64; 2], y: f64) -> [DVec3; 4] {
    [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
        .map(|[x, z]| DVec3::new(x, y, z))
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected}");
}

#[test]
fn a_centred_card_half_way_casts_the_umbra_and_penumbra_of_the_textbook() {
    // A unit card half way to a unit light: from x on the floor its back-projection is twice its
    // size and shifted by −x, so it covers the light up to |x| = ½ and leaves it at |x| = 3/2.
    let card = card([-0.5; 2], [0.5; 2], 1.0);
    let seen = |x, z| visible_fraction_of_quad(&ceiling(1.0, 1.0), card, DVec3::new(x, 0.0, z));
    for x in [0.0, 0.3, 0.5] {
        assert_near(seen(x, 0.0), 0.0, ROUNDING);
    }
    for x in [0.5, 0.625, 1.0, 1.4, 1.5] {
        assert_near(seen(x, 0.0), x - 0.5, ROUNDING);
        assert_near(seen(0.0, -x), x - 0.5, ROUNDING);
    }
    // Half covered both ways at the corner.
    assert_near(seen(1.0, 1.0), 0.75, ROUNDING);
    assert_near(seen(2.0, 0.0), 1.0, 0.0);
}

#[test]
fn parallel_rectangles_are_a_product_of_interval_overlaps() {
    let mut random = Random(1);
    let mut partial = 0;
    for _ in 0..2000 {
        let size = [random.within(0.1, 2.0), random.within(0.1, 2.0)];
        let y = random.within(0.2, 1.8);
        let low = [random.within(-1.0, 0.5), random.within(-1.0, 0.5)];
        let high = low.map(|low| low + random.within(0.05, 1.5));
        let [x, z] = [random.within(-2.0, 2.0), random.within(-2.0, 2.0)];
        // The magnification from the card's plane to the light's, seen from the floor.
        let k = 2.0 / y;
        let covered = |i: usize, at: f64| {
            let project = |edge: f64| at + (edge - at) * k;
            let half = size[i] / 2.0;
            (project(high[i]).min(half) - project(low[i]).max(-half)).max(0.0) / size[i]
        };
        let expected = 1.0 - covered(0, x) * covered(1, z);
        let receiver = DVec3::new(x, 0.0, z);
        let light = ceiling(size[0], size[1]);
        let v = visible_fraction_of_quad(&light, card(low, high, y), receiver);
        // Coordinates of 40 light widths occur (k = 10, a light of 0.1).
        assert_near(v, expected, 40.0 * ROUNDING);
        partial += usize::from(expected > 0.0 && expected < 1.0);
    }
    assert!(partial > 300, "only {partial} cases were in the penumbra");
}

#[test]
fn a_wall_that_passes_behind_receiver_and_light_hides_what_is_past_its_plane() {
    // The plane x = w, far past both: a segment from x = 0 crosses it where it ends at x > w.
    for w in [-0.4, -0.1, 0.2, 0.45] {
        let [low, high] = [-50.0, 50.0];
        let wall =
            [[low, low], [high, low], [high, high], [low, high]].map(|[y, z]| DVec3::new(w, y, z));
        let v = visible_fraction_of_quad(&ceiling(1.0, 1.0), wall, DVec3::ZERO);
        assert_near(v, 0.5 + w.abs(), 50.0 * ROUNDING);
    }
}

#[test]
fn only_what_lies_between_receiver_and_light_blocks() {
    let light = ceiling(1.0, 1.0);
    let seen =
        |y, receiver| visible_fraction_of_quad(&light, card([-3.0; 2], [3.0; 2], y), receiver);
    assert_near(seen(1.0, DVec3::ZERO), 0.0, ROUNDING);
    let behind_light = seen(2.5, DVec3::ZERO);
    let in_its_plane = seen(2.0, DVec3::ZERO);
    let behind_receiver = seen(-1.0, DVec3::ZERO);
    let through_receiver = seen(0.0, DVec3::ZERO);
    let unlit = seen(1.0, DVec3::new(0.0, 2.5, 0.0));
    let all = [behind_light, in_its_plane, behind_receiver, through_receiver, unlit];
    assert_eq!(all, [1.0; 5]);
    assert!(seen(1.0, DVec3::NAN).is_nan());
    let torn = [DVec3::ZERO, DVec3::X, DVec3::INFINITY];
    assert!(visible_fraction_of_polygon(&light, &torn, DVec3::ZERO).is_nan());
}

#[test]
fn winding_scale_and_place_change_nothing_and_parts_add_up() {
    let mut random = Random(2);
    for _ in 0..300 {
        let [x, y, z] = random.frame();
        let center = random.vector(1.0);
        let light = |scale: f64, shift: DVec3| {
            RectangleLight::new(center * scale + shift, x * 0.6 * scale, y * 0.3 * scale).unwrap()
        };
        let receiver = center - z * random.within(1.0, 3.0) + random.vector(0.5);
        let at = (center + receiver) / 2.0 + random.vector(0.3);
        let [u, v, _] = random.frame();
        let quad = [-u - v, u - v, u + v, v - u].map(|corner| at + corner * 0.4);
        let here = light(1.0, DVec3::ZERO);
        let seen = visible_fraction_of_quad(&here, quad, receiver);
        assert!((0.0..=1.0).contains(&seen));

        let [a, b, c, d] = quad;
        assert_near(visible_fraction_of_quad(&here, [d, c, b, a], receiver), seen, ROUNDING);

        let moved = |p: DVec3| p * 7.0;
        let v =
            visible_fraction_of_quad(&light(7.0, DVec3::ZERO), quad.map(moved), moved(receiver));
        assert_near(v, seen, 10.0 * ROUNDING);

        // 20 km away positions are rounded to 2⁻³⁸ m.
        let shift = DVec3::new(20_000.0, -300.0, 7_000.0);
        let away = quad.map(|p| p + shift);
        let v = visible_fraction_of_quad(&light(1.0, shift), away, receiver + shift);
        assert_near(v, seen, 1e-9);

        let [ab, cd] = [a.lerp(b, 0.3), c.lerp(d, 0.6)];
        let hidden = |part| 1.0 - visible_fraction_of_quad(&here, part, receiver);
        assert_near(hidden([a, ab, cd, d]) + hidden([ab, b, c, cd]), 1.0 - seen, 10.0 * ROUNDING);
    }
}
