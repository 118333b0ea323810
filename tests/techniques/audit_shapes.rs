//! The audit under every shape of a light: does it see the light that the truth has?

use crate::audit::{audited, frame, moves_surfaces, seen, sun};
use antumbra::audit::ErrorWindow;
use antumbra::scene::{Camera, Role, generate};
use antumbra::truth::{Sampling, Tracer};
use antumbra::{Light, RectangleLight};
use antumbra_tests::device::unwatched;
use antumbra_tests::measure::{Setup, summary};
use glam::DVec3;

/// Every shape of a light as the truth has it; what `traced` makes of the shape does not matter.
#[test]
fn the_truth_of_a_shape_is_the_tracers() {
    let device = unwatched();
    if moves_surfaces(&device) {
        return;
    }
    let (above, down) = (DVec3::Y * 4.0, DVec3::NEG_Y);
    let lights: [(&str, Light); 8] = [
        ("line", generate::line_light(1.0, 0.4).unwrap().into()),
        ("disc", Light::disc(above, down, 0.4).unwrap()),
        ("polygon", generate::polygon_light(&[[-0.4, -0.4], [0.5, -0.3], [0.0, 0.5]]).unwrap()),
        ("sun", sun()),
        ("sphere", Light::sphere(above, 0.4).unwrap()),
        ("capsule", Light::capsule(above, DVec3::X * 0.5, 0.1).unwrap()),
        ("point", Light::point(above).unwrap()),
        ("point to one side", RectangleLight::point(above, down).unwrap().into()),
    ];
    for (name, light) in lights {
        let scene = generate::spheres(light).with_occluders_as(Role::Both);
        let camera = Camera::framing(&scene, 157.0 / 118.0);
        let setup = seen(&scene, &camera);
        let mut stage = audited(&device, &setup, "technique=traced", 1024);
        let mut window = ErrorWindow::new();
        (0..12).for_each(|_| window.add(&frame(&mut stage, &setup).unwrap()));
        let tracer = Tracer::new(&scene).unwrap();
        let sampling = Sampling::new(1024, 1).unwrap();
        let truth = tracer.visible_fractions(light, &Setup::receivers(&stage), &sampling).unwrap();
        let whole = summary(&truth.visible, &stage.visibility().unwrap());
        let error = window.error();
        println!("{name}: {:.3} %, measured {error:?}", 100.0 * whole.mean_abs_error);
        let (pixels, whole) = (whole.pixels, whole.mean_abs_error);
        // The noise of 512 samples, which a small polygon has 200 of, against an image with hardly any error; and a pixel at
        // a contact, where a hair's breadth decides. Another shape would be wrong by several percent.
        let most = 4e-3 + 1.0 / pixels as f64;
        assert!((error.mean - whole).abs() < most, "{name}: {whole}, {error:?}");
    }
}
