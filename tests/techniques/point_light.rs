//! Points that shine to one side: every technique shows them, without a penumbra.

use antumbra::scene::{AreaLight, Role, Scene, generate};
use antumbra::truth::{Sampling, Tracer};
use antumbra::{Light, RectangleLight, Technique};
use antumbra_harness::View;
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent};
use antumbra_tests::room;
use glam::DVec3;

fn point(at: DVec3, emission: DVec3) -> Light {
    RectangleLight::point(at, emission).unwrap().into()
}

fn under(light: Light) -> Scene {
    generate::spheres(light).with_occluders_as(Role::Both)
}

/// The mean error in percent is that of shadows' edges, about which a map's texels are 2 cm: a tenth of a shadow of two
/// spheres lies within a texel of its edge, and half of that is wrong at most. The filter of `hard` is as wide as three.
const MOST: f64 = 7.5;

#[test]
fn every_technique_shows_a_point() {
    let device = device();
    let at = DVec3::new(0.2, 4.0, 0.1);
    let scene = under(point(at, DVec3::NEG_Y));
    let setup = Setup { occluders_seen: true, ..Setup::ground(&scene, 2.5, 128) };
    let aside = under(point(at + DVec3::X * 0.3, DVec3::NEG_Y));
    for technique in Technique::NAMES {
        let mut stage = setup.stage(&device, &format!("technique={technique}"));
        let image = setup.visibility(&mut stage);
        assert!(image.iter().all(|v| (0.0..=1.0).contains(v)), "{technique}: no share of a light");
        let (truth, noise) = setup.traced(&stage, 2);
        assert_eq!(noise, 0.0, "a point is seen or not");
        let error = percent(&truth, &image);
        let other = Tracer::new(&aside).unwrap();
        let sampling = Sampling::new(2, 1).unwrap();
        let receivers = Setup::receivers(&stage);
        let moved = aside.light(None).unwrap().light;
        let moved = other.visible_fractions(moved, &receivers, &sampling).unwrap();
        let wrong = percent(&moved.visible, &image);
        println!("{technique}: {error:.2} %, of a point 0.3 m aside {wrong:.2} %");
        assert!(error < MOST && wrong > 2.0 * MOST, "{technique}: {error} {wrong}");
    }
}

/// Behind a point's plane there is nothing to hide, as behind a rectangle's.
#[test]
fn a_point_shines_to_one_side() {
    let device = device();
    let up = under(point(DVec3::Y * 4.0, DVec3::Y));
    let level = under(point(DVec3::new(-3.0, 1.5, 0.0), DVec3::X));
    for technique in Technique::NAMES {
        let setup = Setup { occluders_seen: true, ..Setup::ground(&up, 2.5, 64) };
        let image = setup.visibility(&mut setup.stage(&device, &format!("technique={technique}")));
        assert!(image.iter().all(|v| *v == 1.0), "{technique}");
        // The ground reaches behind the plane of a light that shines along it.
        let setup = Setup { occluders_seen: true, ..Setup::ground(&level, 4.0, 64) };
        let mut stage = setup.stage(&device, &format!("technique={technique}"));
        let image = setup.visibility(&mut stage);
        for (v, receiver) in image.iter().zip(Setup::receivers(&stage)) {
            assert!(*v == 1.0 || receiver.position.x > -3.0, "{technique}: {}", receiver.position);
        }
        assert!(image.contains(&0.0), "{technique}");
    }
}

/// A point among walls that reach up to it is seen through several views.
#[test]
fn a_point_in_a_room_has_views() {
    let device = device();
    let mut scene = room::room();
    scene.lights = vec![AreaLight {
        name: "bulb".into(),
        light: point(DVec3::new(0.4, 2.55, 0.2), DVec3::NEG_Y),
        color: [1.0; 3],
        intensity: 1.0,
    }];
    let view = View::of(&room::camera(), [320, 240]);
    let setup =
        Setup { scene: &scene, view, extent: [320, 240], window: None, occluders_seen: true };
    for technique in ["hard", "pcss", "ray-march", "occlusion-textures", "soft-shadow-map map=256"]
    {
        let errors = [1, 4].map(|views| {
            let words = format!("technique={technique} views={views}");
            let mut stage = setup.stage(&device, &words);
            let image = setup.visibility(&mut stage);
            percent(&setup.traced(&stage, 2).0, &image)
        });
        println!("{technique}: {:.2} % with one view, {:.2} % with four", errors[0], errors[1]);
        assert!(errors[1] < 0.8 * errors[0], "{technique}: {errors:?}");
    }
}
