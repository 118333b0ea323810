//! Area lights in a node's extras.

use super::*;
use antumbra::{RectangleLight, Shape};

/// The light of a node with these members beside its extras.
pub fn light(node: Value, extras: Value) -> Result<antumbra::scene::AreaLight, String> {
    let mut lamp = node;
    lamp["name"] = json!("lamp");
    lamp["extras"] = json!({"area_light": "rectangle", "width": 2.0, "height": 1});
    let Value::Object(extras) = extras else { panic!("extras are an object") };
    for (key, value) in extras {
        lamp["extras"][key] = value;
    }
    with_nodes(&json!([{"mesh": 0}, lamp])).map(|scene| scene.light(None).unwrap().clone())
}

fn rectangle(node: Value) -> RectangleLight {
    *light(node, json!({})).unwrap().light.rectangle()
}

#[test]
fn a_light_lies_in_its_nodes_plane_and_emits_along_minus_z() {
    let lamp = light(json!({"translation": [1, 2, 3]}), json!({})).unwrap();
    assert_eq!((lamp.name.as_str(), lamp.color, lamp.intensity), ("lamp", [1.0; 3], 1.0));
    assert_eq!(lamp.light.center(), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(lamp.light.emission(), DVec3::NEG_Z);
    assert_eq!(lamp.light.shape(), Shape::Rectangle);
    assert_eq!(lamp.light.rectangle().half_extents(), [1.0, 0.5]);
    let bright = light(json!({}), json!({"color": [1, 0.5, 0], "intensity": 40})).unwrap();
    assert_eq!((bright.color, bright.intensity), ([1.0, 0.5, 0.0], 40.0));
}

/// Wherever its node stands and however it is scaled, a sun shines along its −Z on what casts shadows.
#[test]
fn a_sun_is_far_away_and_as_wide_as_its_angle() {
    let node = json!({"translation": [7, 0, 0], "scale": [2, 2, 2]});
    let sun = json!({"area_light": "sun", "angular_size": 0.02, "intensity": 3});
    let lamp = light(node, sun).unwrap();
    assert_eq!(lamp.intensity, 3.0);
    let scene = with_nodes(&json!([{"mesh": 0}])).unwrap();
    let all = scene.bounds(|_| true).unwrap();
    let away = all.center() - lamp.light.center();
    assert!((away.normalize() - DVec3::NEG_Z).length() < 1e-12);
    assert!((away.length() / all.size().length() - 500.0).abs() < 1e-6);
    assert_eq!(lamp.light.shape(), Shape::Sun { angular_size: 0.02 });
    assert!(
        (lamp.light.rectangle().half_extents()[0] / away.length() - 0.01f64.tan()).abs() < 1e-12
    );
}

#[test]
fn a_nodes_scale_stretches_its_light() {
    assert_eq!(rectangle(json!({"scale": [3, 4, 5]})).half_extents(), [3.0, 2.0]);
    // Flattened along its own normal it is the same light.
    let flat = rectangle(json!({"scale": [1, 1, 0]}));
    assert_eq!((flat.half_extents(), flat.emission()), ([1.0, 0.5], DVec3::NEG_Z));
}

/// Whatever a node mirrors, light leaves where its −Z points.
#[test]
fn mirrored_lights_emit_along_their_nodes_minus_z() {
    for (scale, z) in [
        ([-1, 1, 1], -1.0),
        ([1, -1, 1], -1.0),
        ([1, 1, -1], 1.0),
        ([-1, -1, 1], -1.0),
        ([-1, -1, -1], 1.0),
    ] {
        let light = rectangle(json!({"scale": scale}));
        assert_eq!(light.emission(), DVec3::Z * z, "{scale:?}");
        assert_eq!(light.half_extents(), [1.0, 0.5], "{scale:?}");
    }
}

/// A rectangle without height is a line along the node's X, one without width along its Y; light leaves
/// along −Z, whatever the node mirrors, turns and stretches.
#[test]
fn a_side_of_nothing_makes_a_line() {
    for (sides, along) in [([3.0, 0.0], DVec3::X), ([0.0, 3.0], DVec3::Y)] {
        let line = |mut node: Value| {
            node["translation"] = json!([1, 2, 3]);
            let lamp = light(node, json!({"width": sides[0], "height": sides[1]})).unwrap();
            assert_eq!(lamp.light.shape(), Shape::Line);
            assert_eq!(lamp.light.center(), DVec3::new(1.0, 2.0, 3.0));
            let line = lamp.light.rectangle();
            let axis = line.world_from_light().transform_vector3(DVec3::X);
            (axis, line.half_extents()[0], line.emission())
        };
        assert_eq!(line(json!({})), (along, 1.5, DVec3::NEG_Z));
        for (scale, z) in [
            ([-2, 2, 2], -1.0),
            ([2, -2, 2], -1.0),
            ([2, 2, -2], 1.0),
            ([-2, -2, -2], 1.0),
            ([2, 2, 0], -1.0),
        ] {
            let (axis, half, emission) = line(json!({"scale": scale}));
            assert!(axis.cross(along).length() < 1e-15, "{scale:?}");
            assert_eq!((half, emission), (3.0, DVec3::Z * z), "{scale:?}");
        }
        // Across the line its node may have no extent at all.
        let (_, half, emission) = line(json!({"scale": [along.x, along.y, 1.0]}));
        assert_eq!((half, emission), (1.5, DVec3::NEG_Z));
        // A quarter turn about y: −Z becomes −X, and X −Z.
        let half_root = 0.5f64.sqrt();
        let (axis, half, emission) = line(json!({"rotation": [0, half_root, 0, half_root]}));
        let turned = if along == DVec3::X { DVec3::NEG_Z } else { DVec3::Y };
        assert!((axis - turned).length() < 1e-12 && (half - 1.5).abs() < 1e-12);
        assert!((emission - DVec3::NEG_X).length() < 1e-12, "{emission}");
    }
}

/// Whatever a node mirrors, turns, stretches and skews, and whichever way its corners run, a polygon lies where
/// the node puts them and shines along its −Z.
#[test]
fn a_polygon_lies_where_its_node_puts_its_corners() {
    let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let skew = [2, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1];
    for (node, z) in [
        (json!({}), -1.0),
        (json!({"translation": [4, 5, 6], "scale": [2, 3, 4]}), -1.0),
        (json!({"scale": [-1, 1, 1]}), -1.0),
        (json!({"scale": [1, -1, 1]}), -1.0),
        (json!({"scale": [1, 1, -1]}), 1.0),
        (json!({"scale": [-2, -1, -1]}), 1.0),
        (json!({"scale": [1, 1, 0]}), -1.0),
        (json!({"matrix": skew}), -1.0),
    ] {
        let world = match node.get("matrix") {
            Some(_) => DMat4::from_cols_array(&skew.map(f64::from)),
            None => {
                let vector = |key: &str, other: f64| {
                    let part = |i| node.get(key).map_or(other, |v| v[i].as_f64().unwrap());
                    DVec3::new(part(0), part(1), part(2))
                };
                DMat4::from_translation(vector("translation", 0.0))
                    * DMat4::from_scale(vector("scale", 1.0))
            }
        };
        let placed = l.map(|[x, y]| world.transform_point3(DVec3::new(x, y, 0.0)));
        for reversed in [false, true] {
            let mut corners = l;
            if reversed {
                corners.reverse();
            }
            let lamp = light(node.clone(), json!({"area_light": "polygon", "corners": corners}));
            let lamp = lamp.unwrap();
            assert_eq!(lamp.light.emission(), DVec3::Z * z, "{node}");
            let outline = lamp.light.outline().unwrap();
            let next = outline.iter().cycle().skip(1);
            let area: f64 = outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
            let scale = world.x_axis.truncate().cross(world.y_axis.truncate()).length();
            assert!((area - 8.0 * scale).abs() < 1e-12, "{node}: {area}");
            for &[x, y] in outline {
                let frame = lamp.light.rectangle().world_from_light();
                let there = frame.transform_point3(DVec3::new(x, y, 0.0));
                assert!(placed.iter().any(|p| p.distance(there) < 1e-12), "{node}: {there}");
            }
        }
    }
    assert!(light(json!({}), json!({})).unwrap().light.outline().is_none());
}

#[test]
fn polygons_that_cannot_be_used_are_refused_by_name() {
    let square = json!([[0, 0], [1, 0], [1, 1], [0, 1]]);
    for (node, corners, sentence) in [
        (json!({}), json!(null), "its corners are null; write a list of [x, y]"),
        (json!({}), json!("round"), "its corners are \"round\"; write a list of [x, y]"),
        (json!({}), json!([[0, 0], [1, 0], 3]), "its corner 2 is not two numbers; write [x, y]"),
        (json!({}), json!([[0, 0], [1, "0"], [0, 1]]), "its corner 1 is not two numbers"),
        (json!({}), json!([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), "its corner 0 is not two numbers"),
        (
            json!({}),
            json!([[0, 0], [1, 0]]),
            "its light cannot be used: it must have 3 to 16 corners, and has 2",
        ),
        (
            json!({}),
            json!([[0, 0], [1, 1], [2, 2]]),
            "its light cannot be used: its corners must enclose an area",
        ),
        (
            json!({}),
            json!([[0, 0], [2, 0], [0.5, 1], [1, 1]]),
            "its light cannot be used: its outline must neither touch nor cross itself",
        ),
        (
            json!({"scale": [1, 0, 1]}),
            square.clone(),
            "its light cannot be used: its corners must enclose an area",
        ),
        (
            json!({"scale": [1e9, 1e9, 1]}),
            square.clone(),
            "a side of the rectangle around its corners, with the node's scale, is 1000000000 m",
        ),
        (json!({"translation": [0, 1e10, 0]}), square, "it lies further than 1e9 m"),
    ] {
        let extras = json!({"area_light": "polygon", "corners": corners});
        let found = light(node, extras).unwrap_err();
        assert!(found.starts_with(&format!("node \"lamp\": {sentence}")), "{found}");
    }
    let found = light(json!({}), json!({"area_light": "polygon"})).unwrap_err();
    assert!(found.contains("its area_light has no corners; give it 3 to 16"), "{found}");
}

#[test]
fn lights_that_cannot_be_used_are_refused_by_name() {
    for (node, extras, sentence) in [
        (
            json!({}),
            json!({"area_light": "disc"}),
            "its area_light is \"disc\"; write \"rectangle\", \"polygon\", \"disk\", \"sphere\", \"capsule\" or \"sun\"",
        ),
        (json!({}), json!({"area_light": 1}), "its area_light is 1; write \"rectangle\""),
        (json!({}), json!({"width": -2}), "its width is -2; write a number of metres from 0 up"),
        (json!({}), json!({"height": "NaN"}), "its height is \"NaN\"; write a number"),
        (
            json!({"translation": [0, 1e10, 0]}),
            json!({"width": 0, "height": 0.0}),
            "it lies further than 1e9 m",
        ),
        (
            json!({"scale": [0, 1, 1]}),
            json!({"height": 0}),
            "its width with the node's scale is 0 m",
        ),
        (
            json!({"scale": [1, 1e9, 1]}),
            json!({"width": 0}),
            "its height with the node's scale is 1000000000 m",
        ),
        (
            json!({"scale": [1, 0, 0]}),
            json!({"height": 0}),
            "its light cannot be used: a line must shine into some direction across it",
        ),
        (json!({"translation": [0, 1e10, 0]}), json!({"height": 0}), "it lies further than 1e9 m"),
        (
            json!({}),
            json!({"area_light": "sun"}),
            "its area_light has no angular_size; give it one",
        ),
        (
            json!({}),
            json!({"area_light": "sun", "angular_size": "1"}),
            "its angular_size is \"1\"; write a number of radians",
        ),
        (
            json!({}),
            json!({"area_light": "sun", "angular_size": 2}),
            "its light cannot be used: its angular size must be above 0 and at most 1 rad",
        ),
        (
            json!({"scale": [1, 1, 0]}),
            json!({"area_light": "sun", "angular_size": 0.1}),
            "its light cannot be used: its direction",
        ),
        (json!({}), json!({"color": [1, 1]}), "its color is a list; write three numbers"),
        (json!({}), json!({"color": [1, -1, 1]}), "its color holds -1; numbers from 0 up"),
        (json!({}), json!({"intensity": "1"}), "its intensity holds \"1\"; numbers from 0 up"),
        (json!({"scale": [0, 1, 1]}), json!({}), "its width with the node's scale is 0 m"),
        (
            json!({"scale": [1, 1e9, 1]}),
            json!({}),
            "its height with the node's scale is 1000000000 m",
        ),
        (json!({"translation": [0, 1e10, 0]}), json!({}), "it lies further than 1e9 m"),
        (
            json!({"matrix": [1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}),
            json!({}),
            "its light cannot be used: its two axes must be perpendicular",
        ),
    ] {
        let found = light(node, extras).unwrap_err();
        assert!(found.starts_with(&format!("node \"lamp\": {sentence}")), "{found}");
    }
    let nodes = json!([{"mesh": 0}, {"extras": {"area_light": "rectangle", "height": 1}}]);
    let found = with_nodes(&nodes).unwrap_err();
    assert!(found.starts_with("node 1: its area_light has no width"), "{found}");
}

/// A parent that stretches a turned child skews it: refused in the plane, harmless across it.
#[test]
fn shear_is_refused_where_it_skews_the_rectangle() {
    let (file, primitives) = square();
    let under_stretch = |rotation: [f64; 4]| {
        let nodes = json!([
            {"mesh": 0},
            {"scale": [2, 1, 1], "children": [2]},
            {"name": "lamp", "rotation": rotation,
             "extras": {"area_light": "rectangle", "width": 1, "height": 1}},
        ]);
        file.scene(&primitives, json!({"nodes": nodes, "scenes": [{"nodes": [0, 1]}]}))
    };
    let (sin, cos) = 0.4_f64.sin_cos();
    assert!(under_stretch([0.0, 0.0, sin, cos]).unwrap_err().contains("uneven scale"));
    let scene = under_stretch([0.0, sin, 0.0, cos]).unwrap();
    let light = scene.light(None).unwrap().light;
    // The plane leans; its normal is on the side of the node's −Z, though no longer along it.
    let minus_z = DVec3::new(-2.0 * 0.8_f64.sin(), 0.0, -0.8_f64.cos());
    assert!(light.emission().dot(minus_z) > 0.0);
}

#[test]
fn a_scene_without_a_light_is_loaded_and_says_so_when_asked_for_one() {
    let scene = with_nodes(&json!([{"mesh": 0}])).unwrap();
    assert!(scene.light(None).is_err());
}

#[test]
fn lights_stand_in_the_order_of_the_file() {
    let (file, primitives) = square();
    let extras = json!({"area_light": "rectangle", "width": 1, "height": 1});
    let nodes = json!([
        {"mesh": 0},
        {"name": "a", "extras": extras},
        {"name": "b", "extras": extras, "children": [1]},
    ]);
    let members = json!({"nodes": nodes, "scenes": [{"nodes": [2, 0]}]});
    let scene = file.scene(&primitives, members).unwrap();
    let names: Vec<_> = scene.lights.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["a", "b"]);
    assert_eq!(scene.light(Some("b")).unwrap().name, "b");
}
