//! Laws of visibility that hold in every scene.

use super::*;

#[test]
fn only_what_lies_between_receiver_and_light_blocks() {
    let light = PolygonLight::from(&ceiling());
    let blocked = |y: f64, point| seen(&card(3.0, y), &light, point);
    assert_eq!(blocked(1.0, DVec3::ZERO), 0.0);
    let behind_light = blocked(2.5, DVec3::ZERO);
    let in_its_plane = blocked(2.0, DVec3::ZERO);
    // As a panel is whose corners an f32 transform rounded.
    let rounded_panel = blocked(f64::from(2.0_f32.next_down()), DVec3::ZERO);
    let behind_receiver = blocked(-1.0, DVec3::ZERO);
    let through_receiver = blocked(0.0, DVec3::ZERO);
    let unlit = blocked(1.0, DVec3::new(0.0, 2.5, 0.0));
    let on_the_light = blocked(1.0, DVec3::new(0.1, 2.0, 0.1));
    let all = [behind_light, in_its_plane, rounded_panel, behind_receiver, through_receiver];
    assert_eq!(all, [1.0; 5]);
    assert_eq!([unlit, on_the_light], [1.0; 2]);
}

#[test]
fn receivers_block_nothing_and_occluders_block() {
    let light = PolygonLight::from(&ceiling());
    let of =
        |role| Exact::new(&soup(&card(3.0, 1.0), role)).unwrap().visible_from(&light, DVec3::ZERO);
    let roles = [Role::Receiver, Role::Occluder, Role::Both];
    assert_eq!(roles.map(|role| of(role).unwrap()), [1.0, 0.0, 0.0]);
}

#[test]
fn another_occluder_never_shows_more() {
    let mut random = Random(51);
    let light = PolygonLight::from(&ceiling());
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    let mut before = 1.0;
    for _ in 0..40 {
        let at = DVec3::Y + random.vector(0.4);
        triangles.push([(); 3].map(|()| at + random.vector(0.2)));
        let now = seen(&triangles, &light, DVec3::ZERO);
        // Crossings are rounded anew with each triangle.
        assert!(now <= before + 1e-14, "{before} to {now}");
        before = now;
    }
    assert!(before > 0.0 && before < 0.9);
}

#[test]
fn a_surface_hides_what_is_under_its_horizon_and_nothing_else() {
    // A wall under the light's middle: half of the light is behind the wall's own plane.
    let wall =
        [[-5.0, -5.0], [2.0, -5.0], [2.0, 5.0], [-5.0, 5.0]].map(|[y, z]| DVec3::new(0.0, y, z));
    let light = PolygonLight::from(&ceiling());
    let position = DVec3::new(0.0, 0.3, 0.1);
    let of = |role, normal| {
        let exact = Exact::new(&soup(&halves(wall), role)).unwrap();
        let v = exact.visible_fraction(&light, &Receiver { position, normal }).unwrap();
        // The wall is seen from `offset` beside it, 1.7 m under the light, and ends in its plane.
        assert_near(
            v.fract().min(0.5),
            if v == 1.0 { 0.0 } else { 0.5 },
            exact.offset(&light, position),
        );
        v
    };
    assert!(of(Role::Both, DVec3::X) < 0.6 && of(Role::Both, DVec3::NEG_X) < 0.6);
    assert_eq!(of(Role::Receiver, DVec3::X), 1.0);
    let floor = Exact::new(&soup(&card(3.0, 0.0), Role::Both)).unwrap();
    let on_floor = |normal| Receiver { position: DVec3::new(0.2, 0.0, 0.1), normal };
    let of = |normal| floor.visible_fraction(&light, &on_floor(normal)).unwrap();
    assert_eq!([DVec3::Y, DVec3::NEG_Y, DVec3::ZERO].map(of), [1.0, 0.0, 1.0]);
}

#[test]
fn a_floor_does_not_shadow_itself() {
    // Needles 20 m long and 2 mm wide, out of every axis, their receivers rounded to f32.
    let turn = DMat4::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, -0.4);
    let far = DVec3::new(80.0, 30.0, -50.0);
    let world = |p: DVec3| turn.transform_vector3(p) + far;
    let needles: Vec<[DVec3; 3]> = (-40..40)
        .flat_map(|i| {
            let z = f64::from(i) * 2e-3;
            let corners = [(-10.0, z), (-10.0, z + 2e-3), (10.0, z + 2e-3), (10.0, z)];
            halves(corners.map(|(x, z)| world(DVec3::new(x, 0.0, z))))
        })
        .collect();
    let axis = |v: DVec3| turn.transform_vector3(v);
    let light = RectangleLight::new(world(DVec3::Y * 3.0), axis(DVec3::X), axis(DVec3::NEG_Z));
    let light = PolygonLight::from(&light.unwrap());
    let exact = Exact::new(&soup(&needles, Role::Both)).unwrap();
    let mut random = Random(52);
    let receivers: Vec<Receiver> = (0..300)
        .map(|_| {
            let on = DVec3::new(random.within(-9.0, 9.0), 0.0, random.within(-0.07, 0.07));
            Receiver { position: world(on).as_vec3().as_dvec3(), normal: axis(DVec3::Y) }
        })
        .collect();
    let seen = exact.visible_fractions(&light, &receivers).unwrap();
    assert!(seen.iter().all(|&v| v == 1.0));
    // Without the offset about half of them are below their surface.
    let bare = receivers.iter().map(|r| exact.visible_from(&light, r.position).unwrap());
    assert!(bare.filter(|&v| v < 1.0).count() > 50);
    // Receivers further off are safe with the error they are said to have.
    let low: Vec<Receiver> = receivers
        .iter()
        .map(|r| Receiver { position: r.position - axis(DVec3::Y) * 1e-3, ..*r })
        .collect();
    assert!(exact.visible_fractions(&light, &low).unwrap().iter().any(|&v| v < 1.0));
    let exact = exact.with_position_error(1e-3).unwrap();
    assert!(exact.visible_fractions(&light, &low).unwrap().iter().all(|&v| v == 1.0));
}

#[test]
fn a_scene_20_km_away_looks_as_it_does_here() {
    let mut random = Random(54);
    let shift = DVec3::new(20_000.0, -300.0, 7_000.0);
    let mut partial = 0;
    for _ in 0..100 {
        let triangles: Vec<[DVec3; 3]> =
            (0..5).map(|_| [(); 3].map(|()| DVec3::Y + random.vector(0.5))).collect();
        let away: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(|p| p + shift)).collect();
        let point = DVec3::new(random.within(-0.5, 0.5), 0.0, random.within(-0.5, 0.5));
        let here = ceiling();
        let there = RectangleLight::new(here.center() + shift, DVec3::X / 2.0, DVec3::NEG_Z / 2.0);
        let v = seen(&triangles, &PolygonLight::from(&here), point);
        // Positions there are rounded to 2⁻³⁸ m, magnified where a triangle is near the point.
        let far = seen(&away, &PolygonLight::from(&there.unwrap()), point + shift);
        assert_near(far, v, 1e-9);
        partial += usize::from(v > 0.0 && v < 1.0);
    }
    assert!(partial > 50, "only {partial} cases were in the penumbra");
}

#[test]
fn the_same_inputs_give_the_same_bits_on_any_number_of_threads() {
    let mut random = Random(55);
    let triangles: Vec<[DVec3; 3]> =
        (0..40).map(|_| [(); 3].map(|()| DVec3::Y + random.vector(0.5))).collect();
    let exact = Exact::new(&soup(&triangles, Role::Both)).unwrap();
    let light = PolygonLight::from(&ceiling());
    let receivers: Vec<Receiver> = (0..200)
        .map(|_| Receiver { position: random.vector(1.0) - DVec3::Y, normal: DVec3::Y })
        .collect();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| exact.visible_fractions(&light, &receivers)).unwrap()
    };
    let one = on(1);
    assert_eq!(one, on(3));
    // Earlier calls change nothing.
    let alone = exact.visible_fraction(&light, &receivers[7]).unwrap();
    assert_eq!(alone, one[7]);
    assert!(one.iter().any(|&v| v > 0.0 && v < 1.0));
}

#[test]
fn unusable_input_is_refused_with_a_sentence() {
    let light = PolygonLight::from(&ceiling());
    let exact = Exact::new(&soup(&card(1.0, 1.0), Role::Both)).unwrap();
    let refused = |position, normal| {
        let receivers =
            [Receiver { position: DVec3::ZERO, normal: DVec3::Y }, Receiver { position, normal }];
        exact.visible_fractions(&light, &receivers).unwrap_err().to_string()
    };
    assert!(refused(DVec3::NAN, DVec3::Y).contains("receiver 1 must have a finite position"));
    assert!(
        refused(DVec3::ZERO, DVec3::INFINITY).contains("receiver 1 must have a finite position")
    );
    assert!(refused(DVec3::splat(1e120), DVec3::Y).contains("light sizes"));
    assert!(
        refused(DVec3::new(0.0, f64::NAN, 0.0), DVec3::Y)
            .contains("receiver 1 must have a finite position")
    );
    let torn = exact.visible_from(&light, DVec3::new(f64::NAN, 0.0, 0.0));
    assert!(torn.unwrap_err().to_string().contains("finite"));
    assert!(exact.visible_from(&light, DVec3::NAN).unwrap_err().to_string().contains("finite"));
    for error in [-1.0, f64::NAN, f64::INFINITY] {
        let exact = Exact::new(&Scene::default()).unwrap();
        let refusal = exact.with_position_error(error).err().unwrap().to_string();
        assert!(refusal.contains("position_error"));
    }
    let lost = [DVec3::ZERO, DVec3::X, DVec3::NAN];
    let refusal = Exact::new(&soup(&[lost], Role::Both)).err().unwrap().to_string();
    assert!(refusal.contains("triangle 0"));
}

#[test]
fn extreme_sizes_neither_panic_nor_leave_zero_to_one() {
    let mut random = Random(56);
    let sizes = [1e-300, 1e-100, 1e-12, 1.0, 1e12, 1e17];
    for light_size in sizes {
        for scene_size in &sizes[1..] {
            let half = light_size / 2.0;
            let light = RectangleLight::new(DVec3::Y, DVec3::X * half, DVec3::NEG_Z * half);
            let Ok(light) = light else { continue };
            let triangles: Vec<[DVec3; 3]> =
                (0..8).map(|_| [(); 3].map(|()| random.vector(*scene_size))).collect();
            let exact = Exact::new(&soup(&triangles, Role::Both)).unwrap();
            for distance in sizes {
                let seen = exact.visible_from(&PolygonLight::from(&light), random.vector(distance));
                assert!(seen.is_err() || seen.is_ok_and(|v| (0.0..=1.0).contains(&v)));
            }
        }
    }
}
