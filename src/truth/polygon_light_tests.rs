//! The frame of an outline. What is refused is tested in `tests/scenes/truth`.

// A test may panic: that is how it fails.
#![allow(clippy::unwrap_used)]

use super::*;

fn flat(corners: &[[f64; 2]]) -> Vec<DVec3> {
    corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
}

#[test]
fn emits_to_where_its_corners_run_counter_clockwise() {
    let mut corners = flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]);
    assert!((PolygonLight::new(&corners).unwrap().frame().rows[2] - DVec3::Z).length() < 1e-15);
    corners.reverse();
    assert!((PolygonLight::new(&corners).unwrap().frame().rows[2] + DVec3::Z).length() < 1e-15);
}

#[test]
fn its_bounding_rectangle_is_the_square_from_minus_one_to_one() {
    // An L, far from the origin and out of every axis.
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.0);
    let corners = flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]]);
    let place = DVec3::new(20_000.0, -300.0, 7_000.0);
    let corners: Vec<DVec3> = corners.iter().map(|&p| turn * p + place).collect();
    let light = PolygonLight::new(&corners).unwrap();
    let local: Vec<DVec3> = corners.iter().map(|&p| light.frame().local(p)).collect();
    let (low, high) =
        local.iter().fold((DVec3::MAX, DVec3::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
    // Positions 20 km away are rounded to 2⁻³⁸ m.
    assert!((high.truncate() - DVec2::ONE).length() < 1e-10);
    assert!((low.truncate() + DVec2::ONE).length() < 1e-10);
    assert!(high.z.abs().max(low.z.abs()) < 1e-10);
}
