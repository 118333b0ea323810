//! Lights of KHR_lights_punctual.

use super::*;
use antumbra::Shape;

/// Lights without a size get one from their node's extras, their own, or the options.
#[test]
fn punctual_lights_have_the_size_that_they_are_given() {
    let (file, primitives) = square();
    let of = |light: u32| json!({"KHR_lights_punctual": {"light": light}});
    let area = json!({"area_light": "rectangle", "width": 1, "height": 1});
    let members = json!({
        "extensionsRequired": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "point", "intensity": 50, "color": [1, 0.5, 0.25]},
            {"type": "spot", "extras": {"radius": 0.25}, "spot": {"outerConeAngle": 0.5}},
            {"type": "directional", "intensity": 1000},
        ]}},
        "nodes": [
            {"mesh": 0},
            {"name": "bulb", "translation": [0, 3, 0], "scale": [2, 3, 4], "extensions": of(0), "extras": {"radius": 0.5}},
            {"name": "bare", "translation": [1, 3, 0], "extensions": of(0)},
            {"name": "spot", "translation": [0, 0, 3], "extensions": of(1)},
            {"name": "sun", "extensions": of(2)},
            {"name": "panel", "extensions": of(0), "extras": area},
            {"name": "ring", "extensions": of(1), "extras": {"radius": 0}},
        ],
        "scenes": [{"nodes": [0, 1, 2, 3, 4, 5, 6]}],
    });
    let scene = file.scene(&primitives, members).unwrap();
    let names: Vec<_> = scene.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["bulb", "bare", "spot", "sun", "panel", "ring"]);
    let lights = &scene.lights;
    let pi = std::f64::consts::PI;
    let close = |a: f32, b: f64| assert!((f64::from(a) - b).abs() < 1e-6 * b, "{a} instead of {b}");
    assert!(matches!(lights[0].light.shape(), Shape::Sphere { radius } if radius == 0.5));
    assert_eq!(lights[0].color, [1.0, 0.5, 0.25]);
    close(lights[0].intensity, 50.0 / (pi * 0.25));
    assert!(matches!(lights[1].light.shape(), Shape::Point));
    assert!(!lights[1].light.is_one_sided());
    close(lights[1].intensity, 50.0);
    assert!(matches!(lights[2].light.shape(), Shape::Disc { radius } if radius == 0.25));
    assert_eq!(lights[2].light.emission(), DVec3::NEG_Z);
    close(lights[2].intensity, 1.0 / (pi * 0.0625));
    assert!(
        matches!(lights[3].light.shape(), Shape::Sun { angular_size } if (angular_size - 0.0093).abs() < 1e-9)
    );
    close(lights[3].intensity, 1000.0 / (pi * (0.00465f64).tan().powi(2)));
    assert!(matches!(lights[4].light.shape(), Shape::Rectangle));
    assert!(lights[5].light.is_one_sided() && lights[5].intensity == 1.0);
}

#[test]
fn punctual_lights_that_cannot_be_used_are_a_sentence() {
    let (file, primitives) = square();
    let refused = |light: Value, extras: Value, sentence: &str| {
        let members = json!({
            "extensions": {"KHR_lights_punctual": {"lights": [light]}},
            "nodes": [
                {"mesh": 0},
                {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}, "extras": extras},
            ],
            "scenes": [{"nodes": [0, 1]}],
        });
        let found = file.scene(&primitives, members).unwrap_err();
        assert!(found.contains("node \"lamp\"") && found.contains(sentence), "{found}");
    };
    refused(json!({"type": "area"}), json!({}), "lights[0] is of no type that there is");
    refused(
        json!({"type": "point"}),
        json!({"radius": "wide"}),
        "its radius is no number from 0 up",
    );
    refused(json!({"type": "point"}), json!({"radius": 1e9}), "its radius is 1000000000 m");
    refused(json!({"type": "spot", "intensity": -1}), json!({}), "finite numbers from 0 up");
    refused(json!({"type": "directional"}), json!({"angular_size": 4}), "its light cannot be used");
    let (file, primitives) = square();
    let members =
        json!({"nodes": [{"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 2}}}]});
    let found = file.scene(&primitives, members).unwrap_err();
    assert!(found.contains("KHR_lights_punctual.lights[2], and the file has 0"), "{found}");
}
