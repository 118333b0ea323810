//! Lights that shine to all sides: each receiver sees a figure of its own.

use super::*;

/// Just inside the cone that touches the sphere an edge leaves something of it, just outside nothing.
#[test]
fn a_spheres_disc_fills_the_cone_that_touches_it() {
    let radius = 1.0;
    let light = Light::sphere(DVec3::ZERO, radius).unwrap();
    for distance in [1.05, 1.5, 4.0, 30.0_f64] {
        let position = DVec3::X * distance;
        let cone = (radius / distance).asin();
        let edge = |angle: f64| {
            // From the receiver towards the light, and up by the angle; beyond it all is hidden.
            let along = (DVec3::NEG_X + DVec3::Y * angle.tan()) * (distance - radius) * 0.5;
            seen(&half_plane(position + along, DVec3::Y, DVec3::X), &light, position)
        };
        assert_eq!(edge(cone * 1.001), 1.0, "{distance}");
        assert_eq!(edge(-cone * 1.001), 0.0, "{distance}");
        for c in [-29.0 / 30.0, -0.6, 0.0, 0.5, 29.0 / 30.0] {
            let found = edge((c * cone.tan()).atan());
            near(found, share_of_disc(c));
            assert!(found > 0.0 && found < 1.0, "{distance} {c}");
        }
    }
}

/// The disc through the sphere's centre that faces a receiver, as a polygon.
fn facing(receiver: &Receiver, offset: f64, center: DVec3, radius: f64) -> PolygonLight {
    let away = receiver.position + receiver.normal * offset - center;
    let distance = away.length();
    let tangent = (radius / distance).asin().tan();
    let u = away.any_orthogonal_vector().normalize();
    let v = away.normalize().cross(u);
    PolygonLight::new(&circle(center, [u, v].map(|axis| axis * tangent * distance))).unwrap()
}

#[test]
fn a_sphere_is_the_exact_fraction_of_the_disc_that_each_receiver_sees() {
    let mut random = Random(31);
    let (scene, receivers) = set_up(&mut random);
    let (tracer, exact) = (Tracer::new(&scene).unwrap(), Exact::new(&scene).unwrap());
    let center = DVec3::new(0.5, 2.6, 0.2);
    let light = Light::sphere(center, 0.9).unwrap();
    let sampling = Sampling::new(RAYS, 1).unwrap();
    agrees(&tracer, &light, &receivers, |r| {
        let offset = tracer.offset(light, r.position, &sampling);
        exact.visible_fraction(&facing(r, offset, center, 0.9), r).unwrap()
    });
}

/// The stadium of a capsule along x that a receiver sees, as a polygon.
fn stadium(
    receiver: &Receiver,
    offset: f64,
    center: DVec3,
    [half, radius]: [f64; 2],
) -> PolygonLight {
    let away = (receiver.position + receiver.normal * offset - center).with_x(0.0);
    let corners =
        circle(DVec3::ZERO, [DVec3::X, away.normalize().cross(DVec3::X)].map(|v| v * radius));
    let moved = |p: DVec3| center + p + DVec3::X * half.copysign(p.x);
    PolygonLight::new(&corners.into_iter().map(moved).collect::<Vec<_>>()).unwrap()
}

#[test]
fn a_capsule_is_the_exact_fraction_of_the_stadium_that_each_receiver_sees() {
    let mut random = Random(34);
    let (scene, receivers) = set_up(&mut random);
    let (tracer, exact) = (Tracer::new(&scene).unwrap(), Exact::new(&scene).unwrap());
    let center = DVec3::new(0.5, 2.6, 0.2);
    let sampling = Sampling::new(RAYS, 1).unwrap();
    for [half, radius] in [[0.4, 0.6], [1.2, 0.1]] {
        let light = Light::capsule(center, DVec3::X * half, radius).unwrap();
        agrees(&tracer, &light, &receivers, |r| {
            let offset = tracer.offset(light, r.position, &sampling);
            exact.visible_fraction(&stadium(r, offset, center, [half, radius]), r).unwrap()
        });
    }
}

/// A disc that faces a receiver and fills the cone of a sphere shows it the same.
#[test]
fn a_sphere_and_a_disc_that_faces_the_receiver_agree() {
    let mut random = Random(32);
    let (scene, receivers) = set_up(&mut random);
    let tracer = Tracer::new(&scene).unwrap();
    let center = DVec3::Y * 3.0;
    let sphere = Light::sphere(center, 0.7).unwrap();
    let mut soft = 0;
    for receiver in &receivers {
        let away = receiver.position - center;
        let sine = 0.7 / away.length();
        let disc = Light::disc(center, away, 0.7 / (1.0 - sine * sine).sqrt()).unwrap();
        let sampling = Sampling::new(RAYS, 9).unwrap();
        let of = |light: &Light, stream| {
            tracer.visible_fraction(light, receiver, &sampling, stream).unwrap().visible
        };
        let (a, b) = (of(&sphere, 0), of(&disc, 1));
        // Loose triangles have more edges than one.
        assert!((a - b).abs() < 8.0 * NOISE, "{a} {b}");
        soft += u32::from(a > 0.0 && a < 1.0);
    }
    assert!(soft > 50, "{soft} in the penumbra");
}

/// Without a length a capsule is the disc of its radius that faces the receiver; a sphere's is wider by the tangent of
/// its cone. From fifty radii away they differ by 2 · 10⁻⁴ of the radius.
#[test]
fn a_capsule_without_a_length_is_a_sphere_far_enough_away() {
    let capsule = Light::capsule(DVec3::ZERO, DVec3::ZERO, 0.1).unwrap();
    let sphere = Light::sphere(DVec3::ZERO, 0.1).unwrap();
    let mut random = Random(33);
    for _ in 0..40 {
        let [x, y, z] = random.frame();
        let (position, beyond) = (z * 5.0, x * 0.6 + y * 0.8);
        for c in [-0.5, 0.0, 0.7] {
            let tracer = half_plane(z * 2.5 + beyond * 0.05 * c, beyond, z);
            for light in [&capsule, &sphere] {
                near(seen_with(&tracer, light, position, beyond), share_of_disc(c));
            }
        }
    }
}

/// The share of a stadium with an x, along its axis, of at most `x`, by its halves' heights added up.
fn share_of_stadium(half_length: f64, radius: f64, x: f64) -> f64 {
    let whole = radius * (4.0 * half_length + PI * radius);
    let height = |x: f64| {
        let past = (x.abs() - half_length).max(0.0);
        2.0 * (radius * radius - past * past).max(0.0).sqrt()
    };
    let (steps, from) = (100_000, -half_length - radius);
    let step = (x - from) / f64::from(steps);
    (0..steps).map(|i| height(from + (f64::from(i) + 0.5) * step) * step).sum::<f64>() / whole
}

#[test]
fn an_edge_hides_the_share_of_a_capsule_that_is_worked_out_by_hand() {
    let (half_length, radius) = (0.7, 0.3);
    let axis = DVec3::new(0.6, 0.0, 0.8);
    let light = Light::capsule(DVec3::Y * 4.0, axis * half_length, radius).unwrap();
    // From straight below, and from aside, at four metres from the axis.
    for away in [DVec3::NEG_Y, axis.cross(DVec3::Y)] {
        let position = DVec3::Y * 4.0 + away * 4.0;
        let middle = DVec3::Y * 4.0 + away * 2.0;
        let up = axis.cross(away);
        for x in [-0.9, -0.5, 0.0, 0.4, 0.85] {
            // Across the axis.
            let tracer = half_plane(middle + axis * 0.5 * x, axis, away);
            let found = seen_with(&tracer, &light, position, up);
            near(found, share_of_stadium(half_length, radius, x));
        }
        for c in [-0.8, 0.0, 0.5] {
            // Along it: a disc and a rectangle are cut by one line.
            let tracer = half_plane(middle + up * 0.5 * radius * c, up, away);
            let disc = PI * radius / (4.0 * half_length + PI * radius);
            let share = share_of_disc(c) * disc + (1.0 - disc) * 0.5 * (1.0 + c);
            near(seen_with(&tracer, &light, position, axis), share);
        }
        // From beyond an end the plane leans with the receiver, and what hides half of the light still does.
        let tracer = half_plane(middle + axis * 1.5, up, away);
        near(seen_with(&tracer, &light, position + axis * 3.0, axis), 0.5);
    }
}

#[test]
fn from_inside_a_light_all_of_it_is_seen() {
    let wall = vec![DVec3::ZERO, DVec3::X * 0.3, DVec3::new(0.3, 0.3, 0.0), DVec3::Y * 0.3];
    let tracer = Tracer::new(&blockers(&[wall])).unwrap();
    // Behind the wall, from which a point there is hidden.
    let center = DVec3::new(0.1, 0.1, -0.2);
    let capsule = Light::capsule(center, DVec3::X * 2.0, 0.5).unwrap();
    for (light, inside) in [
        (Light::sphere(center, 1.0).unwrap(), 1.0),
        (capsule, 1.0),
        (Light::point(center).unwrap(), 0.0),
    ] {
        assert_eq!(seen(&tracer, &light, center + DVec3::Z * 0.45), inside);
    }
    // In a cap, which is further from the centre than the radius.
    let card = |x: f64| {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[y, z]| DVec3::new(x, y, z))
    };
    let tracer = Tracer::new(&blockers(&[card(2.2).into()])).unwrap();
    let capsule = Light::capsule(DVec3::ZERO, DVec3::X * 2.0, 0.5).unwrap();
    assert_eq!(seen(&tracer, &capsule, DVec3::X * 2.45), 1.0);
    assert!(seen(&tracer, &capsule, DVec3::new(2.8, 0.0, 0.1)) < 0.5);
}
