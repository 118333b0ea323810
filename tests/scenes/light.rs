//! Where lights of each shape lie and shine, and those that are refused.

use antumbra::{Light, RectangleLight, Shape};
use glam::{DMat3, DMat4, DVec3};

fn axes(light: &RectangleLight) -> DMat3 {
    DMat3::from_mat4(light.world_from_light())
}

fn ceiling() -> RectangleLight {
    RectangleLight::new(
        DVec3::new(1.0, 3.0, -2.0),
        DVec3::new(0.3, 0.0, 0.0),
        DVec3::new(0.0, 0.0, -0.2),
    )
    .unwrap()
}

#[test]
fn emits_along_the_nodes_minus_z() {
    let light = ceiling();
    assert!((light.emission() - DVec3::NEG_Y).length() < 1e-15);
    assert_eq!(light.half_extents(), [0.3, 0.2]);
}

#[test]
fn a_light_faces_where_it_should() {
    let center = DVec3::new(5.0, 3.0, -2.0);
    for (emission, up) in [
        (DVec3::NEG_Y, DVec3::NEG_Z),
        (DVec3::new(1.0, -2.0, 0.5), DVec3::Y),
        (DVec3::Z * 1e-3, DVec3::new(0.1, 40.0, 3.0)),
    ] {
        let light = RectangleLight::facing(center, emission, up, [0.6, 0.4]).unwrap();
        assert!((light.emission() - emission.normalize()).length() < 1e-12);
        let [width, height] = light.half_extents();
        assert!((width - 0.3).abs() < 1e-12 && (height - 0.2).abs() < 1e-12);
        assert_eq!(light.center(), center);
        // The height runs along `up`, and the width across it.
        let [x, y] = [axes(&light).x_axis, axes(&light).y_axis];
        assert!(x.dot(up).abs() < 1e-12 * up.length() && y.dot(up).abs() > 0.4 * up.length());
        // As a node of glTF that shines so: X to the right, Y up.
        assert!(x.dot(emission.cross(up)) > 0.0);
    }
    let square = RectangleLight::new(DVec3::Y, DVec3::X, DVec3::NEG_Z).unwrap();
    let facing =
        RectangleLight::facing([0.0, 1.0, 0.0], DVec3::NEG_Y, [0.0, 0.0, -1.0f32], [2.0; 2]);
    assert_eq!(facing.unwrap(), square);
    let refused = |emission, up, size| {
        let light = RectangleLight::facing(center, emission, up, size);
        light.unwrap_err().to_string()
    };
    let (down, up) = (DVec3::NEG_Y, DVec3::Y);
    assert!(refused(DVec3::ZERO, up, [1.0; 2]).contains("no length"));
    assert!(refused(down, up, [1.0; 2]).contains("across its emission"));
    assert!(refused(down, DVec3::ZERO, [1.0; 2]).contains("across its emission"));
    assert!(refused(down, DVec3::X, [1.0, 0.0]).contains("above 0"));
    assert!(refused(down, DVec3::X, [-1.0, 1.0]).contains("above 0"));
    assert!(refused(down, DVec3::X, [f64::NAN, 1.0]).contains("finite"));
    assert!(refused(down, DVec3::INFINITY, [1.0; 2]).contains("finite"));
}

#[test]
fn light_space_is_a_right_handed_rigid_frame() {
    let light = ceiling();
    let there_and_back = light.world_from_light() * light.light_from_world();
    assert!(there_and_back.abs_diff_eq(DMat4::IDENTITY, 1e-14));
    assert!((axes(&light).determinant() - 1.0).abs() < 1e-14);
    let below = light.light_from_world().transform_point3(DVec3::new(1.0, 1.0, -2.0));
    assert!((below - DVec3::new(0.0, 0.0, 2.0)).length() < 1e-14);
}

#[test]
fn a_line_has_no_height_and_shines_across_itself() {
    let line = RectangleLight::line(DVec3::Y, DVec3::X * 2.0, DVec3::new(5.0, -1.0, 0.0));
    let line = line.unwrap();
    assert!((line.emission() - DVec3::NEG_Y).length() < 1e-15 && line.is_line());
    assert_eq!(line.half_extents(), [2.0, 0.0]);
    assert!((axes(&line).determinant() - 1.0).abs() < 1e-14);
    let make = |u, emission| {
        let light = RectangleLight::line(DVec3::ZERO, u, emission);
        light.unwrap_err().to_string()
    };
    assert!(make(DVec3::ZERO, DVec3::Y).contains("longer than 0"));
    assert!(make(DVec3::X, DVec3::X * 3.0).contains("across"));
    assert!(make(DVec3::X, DVec3::ZERO).contains("across"));
    assert!(make(DVec3::X, DVec3::NAN).contains("finite"));
}

#[test]
fn a_sun_is_as_wide_as_it_looks_and_shines_where_it_should() {
    for emission in [DVec3::NEG_Y, DVec3::new(1.0, -2.0, 0.5), DVec3::Z * 1e-3] {
        let (center, radius) = (DVec3::new(5.0, -1.0, 2.0), 3.0);
        let sun = RectangleLight::sun(emission, 0.0093, center, radius).unwrap();
        assert!((sun.emission() - emission.normalize()).length() < 1e-12);
        let away = center - sun.center();
        assert!((away.normalize() - emission.normalize()).length() < 1e-12);
        let [a, b] = sun.half_extents();
        assert!(a == b && (2.0 * (a / away.length()).atan() - 0.0093).abs() < 1e-12);
    }
    let make = |emission, size, radius| {
        let light = RectangleLight::sun(emission, size, DVec3::ZERO, radius);
        light.unwrap_err().to_string()
    };
    assert!(make(DVec3::ZERO, 0.01, 1.0).contains("direction"));
    assert!(make(DVec3::Y, 0.01, f64::NAN).contains("finite"));
    assert!(make(DVec3::Y, 0.01, 0.0).contains("radius"));
    for size in [0.0, -0.1, 1.1, f64::NAN] {
        assert!(make(DVec3::Y, size, 1.0).contains("angular size"));
    }
}

#[test]
fn bad_lights_are_refused_with_a_sentence() {
    let make = |u: DVec3, v: DVec3| RectangleLight::new(DVec3::ZERO, u, v).unwrap_err();
    assert!(make(DVec3::ZERO, DVec3::Y).to_string().contains("above 0"));
    assert!(make(DVec3::X, DVec3::X).to_string().contains("perpendicular"));
    assert!(make(DVec3::NAN, DVec3::Y).to_string().contains("finite"));
}

#[test]
fn a_light_knows_its_shape_and_a_rectangle_around_it() {
    let at = DVec3::new(5.0, -1.0, 2.0);
    let half = |light: &Light| light.rectangle().half_extents();
    for emission in [DVec3::NEG_Y * 7.0, DVec3::new(1.0, -2.0, 0.5), DVec3::Z * 1e-3] {
        let disc = Light::disc(at, emission, 0.3).unwrap();
        assert_eq!((disc.shape(), half(&disc)), (Shape::Disc { radius: 0.3 }, [0.3; 2]));
        assert!(disc.center() == at && disc.is_one_sided());
        assert!((disc.emission() - emission.normalize()).length() < 1e-12);
        assert!((axes(disc.rectangle()).determinant() - 1.0).abs() < 1e-12);

        let capsule = Light::capsule(at, emission, 0.3).unwrap();
        let half_length = emission.length();
        assert_eq!(capsule.shape(), Shape::Capsule { half_length, radius: 0.3 });
        assert_eq!(half(&capsule), [half_length + 0.3, 0.3]);
        assert!(capsule.center() == at && !capsule.is_one_sided());
        let frame = axes(capsule.rectangle());
        assert!((frame.x_axis - emission.normalize()).length() < 1e-12);
        assert!((frame.determinant() - 1.0).abs() < 1e-12);

        // Techniques that know rectangles alone see the one that they always saw.
        let sun = Light::sun(emission, 0.0093, at, 3.0).unwrap();
        assert_eq!(sun.shape(), Shape::Sun { angular_size: 0.0093 });
        assert_eq!(*sun.rectangle(), RectangleLight::sun(emission, 0.0093, at, 3.0).unwrap());
        assert!(!sun.is_one_sided());
    }
    let sphere = Light::sphere([5.0, -1.0, 2.0], 0.3).unwrap();
    assert_eq!((sphere.shape(), half(&sphere)), (Shape::Sphere { radius: 0.3 }, [0.3; 2]));
    let point = Light::point([5.0f32, -1.0, 2.0]).unwrap();
    assert_eq!((point.shape(), half(&point)), (Shape::Point, [0.0; 2]));
    assert!(!point.rectangle().is_line(), "a point has no length either");
    let half_point = RectangleLight::point(at, DVec3::NEG_Y * 3.0).unwrap();
    assert!(half_point.is_point() && !half_point.is_line());
    assert!((half_point.emission() - DVec3::NEG_Y).length() < 1e-12);
    assert!((axes(&half_point).determinant() - 1.0).abs() < 1e-12);
    let half_point = Light::from(half_point);
    assert!(half_point.shape() == Shape::Point && half_point.is_one_sided());
    assert!(!half_point.is_round() && point.is_round());
    assert!(sphere.center() == at && point.center() == at);
    assert!(!sphere.is_one_sided() && !point.is_one_sided());
    let ball = Light::capsule(at, DVec3::ZERO, 0.3).unwrap();
    assert_eq!(ball.shape(), Shape::Capsule { half_length: 0.0, radius: 0.3 });

    let rectangle = Light::from(ceiling());
    assert_eq!((rectangle.shape(), *rectangle.rectangle()), (Shape::Rectangle, ceiling()));
    let line = Light::from(RectangleLight::line(at, DVec3::X, DVec3::Y).unwrap());
    assert!(line.shape() == Shape::Line && line.is_one_sided() && rectangle.is_one_sided());
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let polygon = Light::polygon(&corners).unwrap();
    assert!(matches!(polygon.shape(), Shape::Polygon(corners) if corners.len() == 3));
    assert!(polygon.is_one_sided() && polygon.shape().name() == "polygon");
}

#[test]
fn lights_of_no_size_or_no_place_are_refused_with_a_sentence() {
    let refused = |light: Result<Light, antumbra::Error>, part: &str| {
        let sentence = light.unwrap_err().to_string();
        assert!(sentence.starts_with("the light cannot be used: "), "{sentence}");
        assert!(sentence.contains(part), "{sentence}");
    };
    let (zero, down) = (DVec3::ZERO, DVec3::NEG_Y);
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-16, 1e15] {
        let part = "it must be above 0, and twice that from 1e-15 to 1e15 m";
        refused(Light::disc(zero, down, radius), part);
        refused(Light::sphere(zero, radius), part);
        refused(Light::capsule(zero, DVec3::X, radius), part);
    }
    assert!(Light::sphere(zero, 1e-15).is_ok() && Light::sphere(zero, 5e14).is_ok());
    for place in [DVec3::NAN, DVec3::X * f64::INFINITY] {
        refused(Light::disc(place, down, 1.0), "position");
        refused(Light::sphere(place, 1.0), "position");
        refused(Light::capsule(place, DVec3::X, 1.0), "position");
        refused(Light::point(place), "position");
        refused(RectangleLight::point(place, down).map(Light::from), "position");
        refused(RectangleLight::point(zero, place).map(Light::from), "emission");
        refused(Light::disc(zero, place, 1.0), "emission");
        refused(Light::capsule(zero, place, 1.0), "axis");
        refused(Light::sun(down, 0.1, place, 1.0), "finite");
        refused(Light::sun(place, 0.1, zero, 1.0), "finite");
    }
    refused(Light::disc(zero, zero, 1.0), "have a length");
    refused(Light::capsule(zero, DVec3::X * 1e15, 1.0), "at most 1e15 m");
    refused(Light::sun(down, 1.1, zero, 1.0), "angular size");
    refused(Light::sun(down, 0.1, zero, 0.0), "radius");
}
