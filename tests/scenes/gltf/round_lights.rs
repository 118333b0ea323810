//! Disks, spheres, capsules and points in a node's extras.

use super::lights::light;
use super::*;
use antumbra::Shape;

#[test]
fn round_lights_lie_where_their_node_puts_them() {
    let half_root = 0.5f64.sqrt();
    // A quarter turn about z: X becomes Y; a quarter turn about x: −Z becomes Y.
    for (rotation, x, minus_z) in [
        ([0.0, 0.0, 0.0, 1.0], DVec3::X, DVec3::NEG_Z),
        ([0.0, 0.0, half_root, half_root], DVec3::Y, DVec3::NEG_Z),
        ([half_root, 0.0, 0.0, half_root], DVec3::X, DVec3::Y),
    ] {
        // A mirror turns neither what shines to all sides nor where −Z points.
        for scale in [[1.0, 1.0, 1.0], [2.0, 2.0, 2.0], [-2.0, 2.0, 2.0]] {
            let node = json!({"translation": [1, 2, 3], "rotation": rotation, "scale": scale});
            let by = f64::abs(scale[0]);
            let of = |extras: Value| {
                let lamp = light(node.clone(), extras).unwrap();
                assert_eq!(lamp.light.center(), DVec3::new(1.0, 2.0, 3.0));
                assert_eq!(lamp.intensity, 3.0);
                lamp.light
            };
            let near = |found: f64, expected: f64| (found - expected * by).abs() < 1e-12;
            let disk = of(json!({"area_light": "disk", "radius": 0.25, "intensity": 3}));
            assert!(matches!(disk.shape(), Shape::Disc { radius } if near(radius, 0.25)));
            assert!((disk.emission() - minus_z).length() < 1e-12, "{}", disk.emission());

            let sphere = of(json!({"area_light": "sphere", "radius": 0.25, "intensity": 3}));
            assert!(matches!(sphere.shape(), Shape::Sphere { radius } if near(radius, 0.25)));

            let extras =
                json!({"area_light": "capsule", "radius": 0.25, "length": 3, "intensity": 3});
            let capsule = of(extras);
            let Shape::Capsule { half_length, radius } = capsule.shape() else { panic!() };
            assert!(near(half_length, 1.5) && near(radius, 0.25), "{half_length} {radius}");
            let axis = capsule.rectangle().world_from_light().transform_vector3(DVec3::X);
            assert!(axis.cross(x).length() < 1e-12, "{axis}");
        }
    }
    let ball = light(json!({}), json!({"area_light": "capsule", "radius": 1, "length": 0}));
    let shape = Shape::Capsule { half_length: 0.0, radius: 1.0 };
    assert_eq!(ball.unwrap().light.shape(), shape);
}

/// Like the rectangle that shrinks to it, it shines along the node's −Z; the scale does not matter to it.
#[test]
fn a_rectangle_without_sides_is_a_point() {
    let half_root = 0.5f64.sqrt();
    for (rotation, minus_z) in
        [([0.0, 0.0, 0.0, 1.0], DVec3::NEG_Z), ([half_root, 0.0, 0.0, half_root], DVec3::Y)]
    {
        let node = json!({"translation": [1, 2, 3], "rotation": rotation, "scale": [0, 2, 1e9]});
        let point = light(node, json!({"width": 0, "height": 0})).unwrap().light;
        assert_eq!((point.shape(), point.center()), (Shape::Point, DVec3::new(1.0, 2.0, 3.0)));
        assert!(point.is_one_sided() && (point.emission() - minus_z).length() < 1e-12);
    }
    let nowhere = light(json!({"scale": [0, 0, 0]}), json!({"width": 0, "height": 0}));
    let sentence = nowhere.unwrap_err();
    assert!(sentence.contains("it must shine into some direction"), "{sentence}");
}

#[test]
fn round_lights_that_cannot_be_used_are_refused_by_name() {
    let skew = [1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    let far = "it lies further than 1e9 m";
    for kind in ["disk", "sphere", "capsule"] {
        for (node, radius, sentence) in [
            (json!({}), json!(null), "its radius is null; write a number of metres"),
            (json!({}), json!(-1), "its radius is -1; write a number of metres"),
            (json!({}), json!(0), "twice its radius with the node's scale is 0 m; it must be from"),
            (json!({}), json!(1e6), "twice its radius with the node's scale is 2000000 m"),
            (
                json!({"scale": [0, 0, 0]}),
                json!(1),
                "twice its radius with the node's scale is 0 m",
            ),
            (
                json!({"scale": [1, 2, 1]}),
                json!(1),
                "its light is round, and the node's scale is 1, 2 and 1 along its axes",
            ),
            (
                json!({"scale": [1, 1, 3]}),
                json!(1),
                "its light is round, and the node's scale is 1, 1 and 3 along its axes",
            ),
            (json!({"matrix": skew}), json!(1), "its light is round"),
            (json!({"translation": [0, 1e10, 0]}), json!(1), far),
        ] {
            let extras = json!({"area_light": kind, "radius": radius, "length": 1});
            let found = light(node, extras).unwrap_err();
            assert!(found.starts_with(&format!("node \"lamp\": {sentence}")), "{found}");
        }
        let found = light(json!({}), json!({"area_light": kind, "length": 1})).unwrap_err();
        assert!(found.contains("its area_light has no radius; give it one in metres"), "{found}");
    }
    for (length, sentence) in [
        (json!(null), "its length is null; write a number of metres from 0 up"),
        (json!(-1), "its length is -1; write a number of metres from 0 up"),
        (
            json!(1e6),
            "its length with its caps and the node's scale is 1000002 m; it must be at most",
        ),
    ] {
        let extras = json!({"area_light": "capsule", "radius": 1, "length": length});
        let found = light(json!({}), extras).unwrap_err();
        assert!(found.starts_with(&format!("node \"lamp\": {sentence}")), "{found}");
    }
    let found = light(json!({}), json!({"area_light": "capsule", "radius": 1})).unwrap_err();
    assert!(found.contains("its area_light has no length"), "{found}");
}
