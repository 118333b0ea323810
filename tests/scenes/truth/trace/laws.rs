//! Laws of visibility that hold in every scene.

use super::*;

#[track_caller]
fn seen(tracer: &Tracer, light: &RectangleLight, receiver: Receiver) -> f64 {
    tracer.visible_fraction(light, &receiver, &sampling(512), 0).unwrap().visible
}

#[test]
fn without_blockers_all_of_the_light_is_seen() {
    let nothing = Tracer::new(&Scene::default()).unwrap();
    assert_eq!(seen(&nothing, &ceiling(), on_floor(0.1, 0.2)), 1.0);
    let collapsed = [DVec3::Y; 4];
    let scene = scene_of(&[(collapsed, Role::Both)], None);
    assert_eq!(seen(&Tracer::new(&scene).unwrap(), &ceiling(), on_floor(0.0, 0.0)), 1.0);
}

#[test]
fn receivers_block_nothing_and_occluders_block() {
    let traced = |role| {
        let scene = scene_of(&[(floor_quad(3.0, 1.0), role)], Some(ceiling()));
        seen(&Tracer::new(&scene).unwrap(), &ceiling(), on_floor(0.0, 0.0))
    };
    assert_eq!([Role::Receiver, Role::Occluder, Role::Both].map(traced), [1.0, 0.0, 0.0]);
}

#[test]
fn another_occluder_never_shows_more() {
    let mut random = Random(6);
    let mut quads = Vec::new();
    let receivers: Vec<_> = (-10..10).map(|i| on_floor(f64::from(i) * 0.1, 0.05)).collect();
    let mut before = vec![1.0; receivers.len()];
    for _ in 0..12 {
        let [u, v, at] = [(); 3].map(|()| random.vector(0.4));
        let quad = [DVec3::ZERO, u, u + v, v].map(|p| at + DVec3::Y + p);
        quads.push((quad, Role::Occluder));
        let tracer = Tracer::new(&scene_of(&quads, Some(ceiling()))).unwrap();
        let traced = tracer.visible_fractions(ceiling(), &receivers, &sampling(512)).unwrap();
        // The same rays each time: this holds ray by ray, without noise.
        assert!(traced.visible.iter().zip(&before).all(|(now, before)| now <= before));
        before = traced.visible;
    }
    assert!(before.iter().any(|&v| v > 0.0 && v < 1.0));
}

#[test]
fn a_surface_hides_what_is_under_its_horizon_only_where_it_blocks() {
    // A wall under the light's middle: half of the light is behind the wall's own plane. No
    // stratum of an even grid straddles it, so the half is exact.
    let wall =
        [[-5.0, -5.0], [2.0, -5.0], [2.0, 5.0], [-5.0, 5.0]].map(|[y, z]| DVec3::new(0.0, y, z));
    let on_wall = |normal| Receiver { position: DVec3::new(0.0, 0.3, 0.1), normal };
    let traced = |role, normal| {
        let tracer = Tracer::new(&scene_of(&[(wall, role)], Some(ceiling()))).unwrap();
        seen(&tracer, &ceiling(), on_wall(normal))
    };
    assert_eq!(traced(Role::Both, DVec3::X), 0.5);
    assert_eq!(traced(Role::Both, DVec3::NEG_X), 0.5);
    assert_eq!(traced(Role::Receiver, DVec3::X), 1.0);
    // The underside of a floor sees nothing of a light above it.
    let floor = Tracer::new(&scene_of(&[(floor_quad(3.0, 0.0), Role::Both)], None)).unwrap();
    let below = Receiver { normal: DVec3::NEG_Y, ..on_floor(0.2, 0.1) };
    assert_eq!(seen(&floor, &ceiling(), below), 0.0);
}

#[test]
fn a_floor_does_not_shadow_itself() {
    // Needles 20 m long and 2 mm wide, turned out of every axis, 100 m from the world's origin,
    // their receivers rounded to f32: what an f32 renderer would ask about.
    let turn = DMat4::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, -0.4);
    let world = |p: DVec3| turn.transform_vector3(p) + DVec3::new(80.0, 30.0, -50.0);
    let needles: Vec<([DVec3; 4], Role)> = (-40..40)
        .map(|i| {
            let z = f64::from(i) * 2e-3;
            let edge = |x: f64, z: f64| world(DVec3::new(x, 0.0, z));
            let quad = [edge(-10.0, z), edge(-10.0, z + 2e-3), edge(10.0, z + 2e-3), edge(10.0, z)];
            (quad, Role::Both)
        })
        .collect();
    let axis = |v: DVec3| turn.transform_vector3(v);
    let light = RectangleLight::new(world(DVec3::Y * 3.0), axis(DVec3::X), axis(DVec3::NEG_Z));
    let light = light.unwrap();
    let tracer = Tracer::new(&scene_of(&needles, Some(light))).unwrap();
    let mut random = Random(8);
    let receivers: Vec<Receiver> = (0..2000)
        .map(|_| {
            let on = DVec3::new(random.within(-9.0, 9.0), 0.0, random.within(-0.07, 0.07));
            let relative = (world(on) - light.center()).as_vec3().as_dvec3();
            Receiver { position: light.center() + relative, normal: axis(DVec3::Y) }
        })
        .collect();
    let traced = tracer.visible_fractions(light, &receivers, &sampling(32)).unwrap();
    assert!(traced.visible.iter().all(|&v| v == 1.0));

    // World positions in f32 are off by more here, and the caller who says so is safe as well.
    let far = DVec3::new(20_000.0, 0.0, 0.0);
    let up = light.center() + far;
    let far_light = RectangleLight::new(up, axis(DVec3::X), axis(DVec3::NEG_Z)).unwrap();
    let far_needles: Vec<_> = needles.iter().map(|(q, r)| (q.map(|p| p + far), *r)).collect();
    let tracer = Tracer::new(&scene_of(&far_needles, Some(far_light))).unwrap();
    let rounded = receivers.map_positions(|p| (p + far).as_vec3().as_dvec3());
    let darkest = |sampling: &Sampling| {
        let traced = tracer.visible_fractions(far_light, &rounded, sampling).unwrap();
        traced.visible.into_iter().fold(1.0_f32, f32::min)
    };
    assert!(darkest(&sampling(32)) < 1.0);
    assert_eq!(darkest(&sampling(32).with_position_error(1e-3).unwrap()), 1.0);
}

trait MapPositions {
    fn map_positions(&self, change: impl Fn(DVec3) -> DVec3) -> Self;
}

impl MapPositions for Vec<Receiver> {
    fn map_positions(&self, change: impl Fn(DVec3) -> DVec3) -> Self {
        self.iter().map(|r| Receiver { position: change(r.position), ..*r }).collect()
    }
}

#[test]
fn a_scene_20_km_away_looks_as_it_does_here() {
    let mut random = Random(9);
    let shift = DVec3::new(20_000.0, -300.0, 7_000.0);
    for _ in 0..20 {
        let here = random_case(&mut random, 100);
        let corner = here.light.world_from_light();
        let [width, height] = here.light.half_extents();
        let away = Case {
            // +y of light space is −half_v of a right-handed frame, hence the sign.
            light: RectangleLight::new(
                here.light.center() + shift,
                corner.transform_vector3(DVec3::X * width),
                corner.transform_vector3(DVec3::NEG_Y * height),
            )
            .unwrap(),
            quad: here.quad.map(|p| p + shift),
            receivers: here.receivers.map_positions(|p| p + shift),
        };
        assert!((away.light.emission() - here.light.emission()).length() < 1e-12);
        let (_, near) = compare(&here, 512);
        let (_, far) = compare(&away, 512);
        // Positions there are rounded to 2⁻³⁸ m, which turns one ray in 10⁹; the quad's corners
        // are rounded to f32 about its first, the same in both.
        let one_ray = 1.0 / 512.0;
        assert!(near.visible.iter().zip(&far.visible).all(|(a, b)| (a - b).abs() <= one_ray));
        let moved = near.visible.iter().zip(&far.visible).filter(|(a, b)| a != b).count();
        assert!(moved <= 1, "{moved} of 100 receivers changed");
    }
}

#[test]
fn the_same_inputs_give_the_same_bits_on_any_number_of_threads() {
    let mut random = Random(10);
    let case = random_case(&mut random, 300);
    let tracer = Tracer::new(&scene_of(&[(case.quad, Role::Both)], Some(case.light))).unwrap();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| tracer.visible_fractions(case.light, &case.receivers, &sampling(128)))
    };
    let one = on(1).unwrap();
    assert_eq!(one, on(3).unwrap());
    assert_eq!(one.rays, 300 * 128);
    let other = Sampling::new(128, 8).unwrap();
    let other = tracer.visible_fractions(case.light, &case.receivers, &other).unwrap();
    assert_ne!(one.visible, other.visible);
    let alone = tracer.visible_fraction(case.light, &case.receivers[7], &sampling(128), 7);
    assert_eq!(alone.unwrap().visible as f32, one.visible[7]);
}

#[test]
fn what_cannot_be_lit_or_is_no_receiver_is_not_shadowed() {
    let scene = scene_of(
        &[(floor_quad(3.0, 1.0), Role::Both), (floor_quad(0.5, 2.0), Role::Occluder)],
        Some(ceiling()),
    );
    let tracer = Tracer::new(&scene).unwrap();
    let above = Receiver { position: DVec3::new(0.0, 2.5, 0.0), normal: DVec3::Y };
    let in_plane = Receiver { position: DVec3::new(3.0, 2.0, 0.0), normal: DVec3::Y };
    let background = Receiver { normal: DVec3::ZERO, ..on_floor(0.0, 0.0) };
    // The panel in the light's plane does not block; the floor at y = 1 does not reach up here.
    let under_panel = Receiver { position: DVec3::new(0.0, 1.5, 0.0), normal: DVec3::Y };
    for receiver in [above, in_plane, background, under_panel] {
        assert_eq!(seen(&tracer, &ceiling(), receiver), 1.0);
    }
}

#[test]
fn unusable_input_is_refused_with_a_sentence() {
    let mut scene = scene_of(&[(floor_quad(1.0, 0.0), Role::Both)], None);
    let tracer = Tracer::new(&scene).unwrap();
    let lost = Receiver { position: DVec3::NAN, normal: DVec3::Y };
    let image = [on_floor(0.0, 0.0), lost];
    let refusal = tracer.visible_fractions(ceiling(), &image, &sampling(2)).unwrap_err();
    assert!(refusal.to_string().contains("receiver 1"));

    for rays in [0, 1, u32::MAX] {
        assert!(Sampling::new(rays, 0).unwrap_err().to_string().contains("rays"));
    }
    assert!(sampling(2).with_position_error(-1.0).is_err());
    let rounded_up = [2, 3, 256, 512, 1 << 20].map(|rays| sampling(rays).rays());
    assert_eq!(rounded_up, [2, 8, 288, 512, 2 * 725 * 725]);

    let refuse = |change: &dyn Fn(&mut Scene)| {
        let mut broken = scene.clone();
        change(&mut broken);
        Tracer::new(&broken).err().map(|e| e.to_string()).unwrap_or_default()
    };
    assert!(refuse(&|s| s.meshes[0].indices[0] = 9).contains("quad 0: index 9"));
    assert!(refuse(&|s| s.meshes[0].positions[0] = [f32::NAN; 3]).contains("quad 0: vertex 0"));
    assert!(refuse(&|s| s.meshes[0].positions[0][1] = f32::NAN).contains("quad 0: vertex 0"));
    assert!(refuse(&|s| s.instances[0].mesh = 5).contains("quad 0: mesh 5"));
    scene.meshes.clear();
    assert!(Tracer::new(&scene).is_err());
}
