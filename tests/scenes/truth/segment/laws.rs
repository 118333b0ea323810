//! What visibility is, whatever the scene; with many random scenes in `tests/laws/line_truth.rs`.

use super::*;
use antumbra::scene::Scene;
use antumbra::truth::visible_fraction_of_quad;

#[test]
fn only_what_lies_between_receiver_and_light_blocks() {
    let at = |y: f64, point| seen(&card([-3.0, 3.0], y, 3.0), &tube(), point);
    assert_eq!(at(1.0, DVec3::ZERO), 0.0);
    // Behind the light, in its plane, so but for the rounding of f32, behind the receiver, through it.
    for y in [2.5, 2.0, f64::from(2.0_f32.next_down()), -1.0, 0.0] {
        assert_eq!(at(y, DVec3::ZERO), 1.0, "{y}");
    }
    // A receiver behind the light, beside it in its plane, on it, at its end, on its line, by rounding.
    for [x, y, z] in [
        [0.0, 2.5, 0.0],
        [0.1, 2.0, 0.1],
        [0.1, 2.0, 0.0],
        [1.0, 2.0, 0.0],
        [3.0, 2.0, 0.0],
        [3.0, 2.0_f64.next_down(), 0.0],
        [0.0, 2.0_f64.next_down(), 0.0],
    ] {
        assert_eq!(at(1.0, DVec3::new(x, y, z)), 1.0);
    }
    // A wall that goes on behind the light is cut at its plane: x = 0.5 hides 0.5 to 1.
    let wall = [[1.0, -1.0], [9.0, -1.0], [9.0, 1.0], [1.0, 1.0]];
    let wall = halves(wall.map(|[y, z]| DVec3::new(0.5, y, z)));
    assert_near(seen(&wall, &tube(), DVec3::ZERO), 0.75, 1e-14);
}

#[test]
fn roles_and_normals_mean_what_they_do_to_the_others() {
    let light = tube();
    let of = |scene: &Scene, normal| {
        let receiver = Receiver { position: DVec3::new(0.2, 0.0, 0.1), normal };
        ExactLine::new(scene).unwrap().visible_fraction(&light, &receiver).unwrap()
    };
    let above = |role| of(&soup(&card([-3.0, 3.0], 1.0, 3.0), role), DVec3::Y);
    assert_eq!([Role::Receiver, Role::Occluder, Role::Both].map(above), [1.0, 0.0, 0.0]);
    // The floor itself: it hides all of the light from its underside, and nothing without a normal.
    let floor = soup(&card([-3.0, 3.0], 0.0, 3.0), Role::Both);
    assert_eq!([DVec3::Y, DVec3::NEG_Y, DVec3::ZERO].map(|n| of(&floor, n)), [1.0, 0.0, 1.0]);
    // A wall under the light's middle hides the half behind its own plane.
    let wall =
        [[-5.0, -5.0], [1.9, -5.0], [1.9, 5.0], [-5.0, 5.0]].map(|[y, z]| DVec3::new(0.2, y, z));
    for normal in [DVec3::X, DVec3::NEG_X] {
        let v = of(&soup(&halves(wall), Role::Both), normal);
        let beyond = 0.5 * (1.0 - 0.2 * normal.x);
        assert_near(v, beyond, 1e-3);
    }
}

#[test]
fn triangles_that_touch_leave_no_gap_and_edge_on_ones_hide_nothing() {
    // A fan whose corner lies in the receiver's plane, in the way of a ray and on edges of others.
    let rim = |i: u32| {
        let angle = f64::from(i % 8) * std::f64::consts::FRAC_PI_4;
        DVec3::new(3.0 * angle.cos(), 1.0, 3.0 * angle.sin())
    };
    let fan: Vec<[DVec3; 3]> = (0..8).map(|i| [DVec3::Y, rim(i), rim(i + 1)]).collect();
    for point in [DVec3::ZERO, DVec3::X, DVec3::new(0.3, 0.0, 1e-17), DVec3::Z] {
        assert_eq!(seen(&fan, &tube(), point), 0.0, "{point}");
    }
    let [p, q] = [DVec3::new(-0.3, 1.0, 0.0), DVec3::new(0.3, 1.1, 0.0)];
    let in_the_plane = [p, q, DVec3::new(0.0, 0.5, 0.0)];
    let corner = DVec3::new(0.0, 1.0, 0.5);
    let [touching, end_on] =
        [[p, corner, DVec3::new(0.1, 1.0, 0.5)], [DVec3::ZERO, corner, DVec3::X]];
    for none in [[p; 3], [p, q, p], [p, q, p.lerp(q, 0.5)], in_the_plane, touching, end_on] {
        assert_eq!(seen(&[none], &tube(), DVec3::ZERO), 1.0, "{none:?}");
    }
    assert_eq!(seen(&[], &tube(), DVec3::ZERO), 1.0);
    // With one edge in the plane it hides what the edge does.
    let edge = [p, q, corner];
    let [from, to] = [-0.3 * 2.0, 0.3 * 2.0 / 1.1];
    assert_near(seen(&[edge], &tube(), DVec3::ZERO), 1.0 - 0.5 * (to - from), 1e-14);
}

#[test]
fn the_same_inputs_give_the_same_bits_on_any_number_of_threads() {
    let mut random = Random(74);
    let Case { light, point, triangles } = random_case(&mut random, 40);
    let exact = ExactLine::new(&soup(&triangles, Role::Both)).unwrap();
    let receivers: Vec<Receiver> = (0..200)
        .map(|_| Receiver { position: point + random.vector(1.0), normal: DVec3::Y })
        .collect();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| exact.visible_fractions(&light, &receivers)).unwrap()
    };
    let one = on(1);
    assert_eq!(one, on(3));
    // Whatever was asked before.
    assert_eq!(exact.visible_fraction(&light, &receivers[7]).unwrap(), one[7]);
    assert!(one.iter().any(|&v| v > 0.0 && v < 1.0));
}

#[test]
fn unusable_input_is_refused_with_a_sentence() {
    let triangles = card([-1.0, 1.0], 1.0, 1.0);
    let exact = ExactLine::new(&soup(&triangles, Role::Both)).unwrap();
    let of = |light: &RectangleLight, position, normal| {
        let receiver = Receiver { position, normal };
        exact.visible_fractions(light, &[receiver]).unwrap_err().to_string()
    };
    assert!(of(&tube(), DVec3::NAN, DVec3::Y).contains("receiver 0 must have a finite position"));
    assert!(of(&tube(), DVec3::ZERO, DVec3::INFINITY).contains("receiver 0"));
    assert!(of(&tube(), DVec3::splat(1e120), DVec3::Y).contains("lengths of the light"));
    assert!(exact.visible_from(&tube(), DVec3::NAN).is_err());
    let square = RectangleLight::new(DVec3::Y * 2.0, DVec3::X, DVec3::NEG_Z).unwrap();
    assert!(of(&square, DVec3::ZERO, DVec3::Y).contains("has an area; ask truth::Exact"));
    for error in [-1.0, f64::NAN, f64::INFINITY] {
        let exact = ExactLine::new(&Scene::default()).unwrap();
        assert!(exact.with_position_error(error).is_err());
    }
    assert!(ExactLine::new(&soup(&[[DVec3::NAN; 3]], Role::Both)).is_err());
    // Those that need an area say so of a line.
    let area = Exact::new(&soup(&triangles, Role::Both)).unwrap();
    let refusal = area.visible_from(&PolygonLight::from(&tube()), DVec3::ZERO).unwrap_err();
    assert!(refusal.to_string().contains("ask truth::ExactLine about a line"));
    let [[a, b, c], [_, _, d]] = triangles;
    assert!(visible_fraction_of_quad(&tube(), [a, b, c, d], DVec3::ZERO).is_nan());
}

#[test]
fn extreme_sizes_neither_panic_nor_leave_zero_to_one() {
    let mut random = Random(75);
    let sizes = [1e-300, 1e-100, 1e-12, 1.0, 1e12, 1e17, 1e100, 1e200];
    for light_size in sizes {
        for scene_size in &sizes[1..6] {
            let light = RectangleLight::line(DVec3::Y, DVec3::X * light_size, DVec3::NEG_Y);
            let Ok(light) = light else { continue };
            let triangles: Vec<[DVec3; 3]> =
                (0..8).map(|_| [(); 3].map(|()| random.vector(*scene_size))).collect();
            let exact = ExactLine::new(&soup(&triangles, Role::Both)).unwrap();
            for distance in sizes {
                let seen = exact.visible_from(&light, random.vector(distance));
                assert!(seen.is_err() || seen.is_ok_and(|v| (0.0..=1.0).contains(&v)));
            }
        }
    }
}
