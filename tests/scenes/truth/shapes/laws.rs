//! What holds under lights of every shape.

use super::*;

#[test]
fn without_blockers_all_of_a_light_of_any_shape_is_seen() {
    let nothing = Tracer::new(&Scene::default()).unwrap();
    for light in lights() {
        assert_eq!(seen(&nothing, &light, DVec3::new(0.3, 0.2, 0.1)), 1.0);
    }
}

/// A card between hides all of each light, and one aside nothing.
#[test]
fn a_card_hides_lights_of_any_shape() {
    let card = |x: f64, y: f64| {
        let corner = |sx: f64, sz: f64| DVec3::new(x + sx, y, sz);
        vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
    };
    let behind = |x, y| Tracer::new(&blockers(&[card(x, y)])).unwrap();
    let (over, aside, lid) = (behind(0.0, 2.0), behind(5.0, 2.0), behind(0.0, 6.0));
    for light in lights() {
        let (shape, is_sun) = (light.shape().name(), light.shape().name() == "sun");
        assert_eq!(seen(&over, &light, DVec3::ZERO), 0.0, "{shape}");
        assert_eq!(seen(&aside, &light, DVec3::ZERO), 1.0, "{shape}");
        // Above a light that shines down there is nothing to shadow, nor is there above a lid for a sun.
        let shines_up = !light.is_one_sided() && !is_sun;
        let above = seen(&lid, &light, DVec3::Y * 8.0);
        assert_eq!(above, if shines_up { 0.0 } else { 1.0 }, "{shape}");
        // What lies behind a light hides nothing of it, and nothing lies behind a sun.
        let below = seen(&lid, &light, DVec3::ZERO);
        assert_eq!(below, if is_sun { 0.0 } else { 1.0 }, "{shape}");
    }
}

#[test]
fn another_occluder_never_shows_more_of_any_shape() {
    for light in lights() {
        let mut random = Random(41);
        let receivers: Vec<Receiver> = (-10..10)
            .map(|i| DVec3::new(f64::from(i) * 0.1, 0.0, 0.05))
            .map(|position| Receiver { position, normal: DVec3::Y })
            .collect();
        // The first spans the whole scene, so that those after it change no receiver's offset.
        let mut polygons = vec![vec![DVec3::splat(-9.0), DVec3::splat(-9.1), DVec3::X * 9.0]];
        let mut before = vec![1.0; receivers.len()];
        for _ in 0..10 {
            let [u, v, at] = [(); 3].map(|()| random.vector(0.4));
            polygons.push([DVec3::ZERO, u, u + v, v].map(|p| at + DVec3::Y * 2.0 + p).into());
            let tracer = Tracer::new(&blockers(&polygons)).unwrap();
            let sampling = Sampling::new(512, 3).unwrap();
            let traced = tracer.visible_fractions(light, &receivers, &sampling).unwrap();
            // The same rays each time: this holds ray by ray, without noise.
            assert!(traced.visible.iter().zip(&before).all(|(now, before)| now <= before));
            before = traced.visible;
        }
        assert!(before.iter().any(|&v| v < 1.0), "{}", light.shape().name());
    }
}

/// A scene of another size, place and attitude shows the same.
#[test]
fn moved_turned_and_scaled_lights_of_any_shape_are_the_same() {
    let mut random = Random(42);
    let (scene, receivers) = set_up(&mut random);
    let shift = DVec3::new(2_000.0, -300.0, 700.0);
    let turn = DMat4::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.0);
    let change = DMat4::from_translation(shift) * turn * DMat4::from_scale(DVec3::splat(8.0));
    let mut moved = scene.clone();
    for instance in &mut moved.instances {
        instance.world_from_mesh = change * instance.world_from_mesh;
    }
    let (point, axis) = (|p| change.transform_point3(p), |v| turn.transform_vector3(v));
    let up = DVec3::Y * 3.0;
    let pairs = [
        (Light::disc(up, DVec3::NEG_Y, 0.8), Light::disc(point(up), axis(DVec3::NEG_Y), 6.4)),
        (Light::sphere(up, 0.8), Light::sphere(point(up), 6.4)),
        (
            Light::capsule(up, DVec3::X * 0.6, 0.3),
            Light::capsule(point(up), axis(DVec3::X) * 4.8, 2.4),
        ),
        (Light::point(up), Light::point(point(up))),
        (
            Light::sun(DVec3::NEG_Y, 0.3, DVec3::ZERO, 2.0),
            Light::sun(axis(DVec3::NEG_Y), 0.3, shift, 16.0),
        ),
    ];
    let there: Vec<Receiver> = receivers
        .iter()
        .map(|r| Receiver { position: point(r.position), normal: axis(r.normal) })
        .collect();
    let sampling = Sampling::new(RAYS, 1).unwrap();
    let [here, away] = [&scene, &moved].map(|scene| Tracer::new(scene).unwrap());
    for (light, other) in pairs {
        let (light, other) = (light.unwrap(), other.unwrap());
        let shape = light.shape().name();
        let a = here.visible_fractions(light, &receivers, &sampling).unwrap();
        let b = away.visible_fractions(other, &there, &sampling).unwrap();
        // A point has no penumbra that would soften how far the larger scene moves a receiver.
        let apart = a.visible.iter().zip(&b.visible).filter(|(a, b)| (*a - *b).abs() > 0.03);
        assert!(apart.count() <= usize::from(shape == "point"), "{shape}");
        let soft = a.visible.iter().filter(|v| **v < 1.0).count();
        assert!(soft > 40, "{shape}: {soft} shadowed");
    }
}

#[test]
fn lights_of_any_shape_give_the_same_bits_on_any_number_of_threads() {
    let mut random = Random(43);
    let (scene, receivers) = set_up(&mut random);
    let tracer = Tracer::new(&scene).unwrap();
    let sampling = Sampling::new(128, 8).unwrap();
    for light in lights() {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| tracer.visible_fractions(light, &receivers, &sampling)).unwrap()
        };
        let one = on(1);
        assert_eq!(one, on(3));
        let alone = tracer.visible_fraction(light, &receivers[7], &sampling, 7).unwrap();
        assert_eq!(alone.visible as f32, one.visible[7]);
        let lost = Receiver { position: DVec3::NAN, normal: DVec3::Y };
        assert!(tracer.visible_fraction(light, &lost, &sampling, 0).is_err());
    }
}
