//! Lights that a technique refuses.

use super::*;
use crate::lent::*;

/// A technique that takes no lines refuses one; the others plan a whole frame.
#[test]
fn a_line_is_refused_by_what_needs_an_area() {
    let meshes = meshes();
    let light = generate::line_light(1.0, 0.3).unwrap();
    for name in Technique::NAMES {
        let d = of_technique(name);
        let planned = plan(&d, Limits::default(), &Frame { light: light.into(), ..frame(&meshes) });
        if ["hard", "many-lights", "ray-march", "linear-light", "traced"].contains(name) {
            assert!(ran(&planned.unwrap()).len() > 1, "{name}");
        } else {
            let sentence = planned.unwrap_err().to_string();
            let start = format!(
                "the light is a line, and {name} takes no lines; choose hard, many-lights, ray-march, "
            );
            assert!(sentence.starts_with(&start), "{sentence}");
        }
    }
}

/// Lights whose squared size single precision cannot hold are refused, and so are occluders as far away.
#[test]
fn lengths_that_single_precision_does_not_hold_are_refused() {
    let meshes = meshes();
    for side in [1e-100, 1e-16, 1e16, 1e100] {
        let light = generate::square_light(side).unwrap();
        let sentence = plan(
            &description(&[]),
            Limits::default(),
            &Frame { light: light.into(), ..frame(&meshes) },
        )
        .unwrap_err()
        .to_string();
        assert!(
            sentence.starts_with(&format!("the light is {side:e} by {side:e} m")),
            "{sentence}"
        );
    }
    for side in [2e-15, 5e14] {
        let light = generate::square_light(side).unwrap();
        make(&description(&[]), &Frame { light: light.into(), ..frame(&meshes) });
    }
    let huge = MeshInstance { bounds: [[-1e16; 3], [1e16; 3]], ..meshes[1] };
    let meshes = [meshes[0], huge];
    let planned = plan(&description(&[]), Limits::default(), &frame(&meshes));
    let sentence = planned.unwrap_err().to_string();
    assert!(sentence.starts_with("mesh 1 blocks up to"), "{sentence}");
}

/// Some techniques take a polygon; the others name those.
#[test]
fn an_outline_is_refused_by_what_knows_rectangles_alone() {
    let meshes = meshes();
    let corners = [[-0.25, -0.25], [0.25, -0.25], [0.0, 0.25]];
    let light = Light::with_outline(generate::square_light(0.5).unwrap(), &corners).unwrap();
    for name in Technique::NAMES {
        let d = of_technique(name);
        let planned = plan(&d, Limits::default(), &Frame { light, ..frame(&meshes) });
        if ["many-lights", "ray-march", "linear-light", "traced"].contains(name) {
            assert!(ran(&planned.unwrap()).len() > 1, "{name}");
        } else {
            let sentence = planned.unwrap_err().to_string();
            let start = format!(
                "the light is a polygon, and {name} takes no polygons; choose many-lights, ray-march, linear-light, or traced"
            );
            assert!(sentence.starts_with(&start), "{sentence}");
        }
    }
}

/// No technique takes every shape but the one that the sentence names; many-lights and ray-march take discs. A sun is refused by none.
#[test]
fn shapes_are_refused_by_what_does_not_take_them() {
    let meshes = meshes();
    let lights = [
        Light::disc(DVec3::Y * 4.0, DVec3::NEG_Y, 0.3),
        Light::sphere(DVec3::Y * 4.0, 0.3),
        Light::capsule(DVec3::Y * 4.0, DVec3::X, 0.1),
        Light::point(DVec3::Y * 4.0),
        Light::sun(DVec3::NEG_Y, 0.01, DVec3::ZERO, 5.0),
    ];
    let names = ["disc", "sphere", "capsule", "point", "sun"];
    for (light, shape) in lights.into_iter().zip(names) {
        let light = light.unwrap();
        assert_eq!(light.shape().name(), shape);
        let (said, these) = match shape {
            "point" => ("point that shines to all sides", "such points".into()),
            _ => (shape, format!("{shape}s")),
        };
        let refused = |name: &str| {
            let d = of_technique(name);
            let planned = plan(&d, Limits::default(), &Frame { light, ..frame(&meshes) });
            planned.map(|plan| assert!(ran(&plan).len() > 1, "{name}")).map_err(|e| e.to_string())
        };
        for name in Technique::NAMES {
            let takes_discs = ["many-lights", "ray-march"].contains(name);
            let taken = shape == "sun" || *name == "traced" || (shape == "disc" && takes_discs);
            let others = if shape == "disc" { "many-lights, ray-march, or " } else { "" };
            let sentence = format!(
                "the light is a {said}, and {name} takes no {these}; choose {others}traced, which takes every shape"
            );
            assert_eq!(refused(name), if taken { Ok(()) } else { Err(sentence) });
        }
        let looked = situation(&description(&[]), &Frame { light, ..frame(&meshes) });
        let start = format!("the light is a {said}, and auto takes no {these}; choose ");
        match looked {
            Ok(_) => assert!(["sun", "disc"].contains(&shape), "{shape}"),
            Err(e) => assert!(e.to_string().starts_with(&start), "{e}"),
        }
    }
}

/// Every technique takes a point that shines to one side, and shows it by a hard shadow where it knows no other way.
#[test]
fn a_point_to_one_side_is_taken_by_all() {
    let meshes = meshes();
    let light = Light::from(RectangleLight::point(DVec3::Y * 4.0, DVec3::NEG_Y).unwrap());
    for name in Technique::NAMES {
        for omit in [Omit::Nothing, Omit::Invisible] {
            let d = Description { omit, ..of_technique(name) };
            let plan = make(&d, &Frame { light, ..frame(&meshes) });
            let hard = ran(&plan).contains(&"hard.visibility");
            assert_eq!(hard, *name != "traced", "{name}: {}", plan.explain());
            assert!(*name == "hard" || !hard || plan.explain().contains("the light is a point"));
        }
    }
    assert!(situation(&description(&[]), &Frame { light, ..frame(&meshes) }).unwrap().is_some());
    // What it shines on lies before it, as before a rectangle.
    let up = Light::from(RectangleLight::point(DVec3::Y * 4.0, DVec3::Y).unwrap());
    let plan = make(&of_technique("hard"), &Frame { light: up, ..frame(&meshes) });
    assert_eq!(ran(&plan), ["visibility.lit"]);
}

/// The host cannot draw linear-light's maps, receivers included: only the device knows where their samples lie.
#[test]
fn lines_take_no_host_draws() {
    let description = of_technique("linear-light");
    let mut meshes = meshes();
    assert!(plan(&description, Limits::default(), &frame(&meshes)).is_ok());
    for (role, mesh) in [Role::Occluder, Role::Receiver].into_iter().zip(&mut meshes) {
        (mesh.role, mesh.geometry) = (role, Geometry::HostDrawn(7));
    }
    for mesh in &mut meshes {
        let error = plan(&description, Limits::default(), &frame(std::slice::from_ref(mesh)));
        let error = error.unwrap_err().to_string();
        assert!(error.contains("where linear-light puts its samples"), "{error}");
    }
}
