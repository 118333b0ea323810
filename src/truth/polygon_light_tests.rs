//! Outlines that are refused as lights, and others that are not.

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

#[test]
fn bad_outlines_are_refused_with_a_sentence() {
    let refusal = |corners: &[DVec3]| PolygonLight::new(corners).unwrap_err().to_string();
    let refused = |corners: &[[f64; 2]]| refusal(&flat(corners));
    assert!(refused(&[[0.0, 0.0], [1.0, 0.0]]).contains("from 3 to"));
    assert!(refusal(&vec![DVec3::ZERO; MAX_CORNERS + 1]).contains("from 3 to"));
    assert!(refused(&[[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]]).contains("finite"));
    assert!(refused(&[[f64::MIN, 0.0], [f64::MAX, 0.0], [0.0, 1.0]]).contains("finite"));
    assert!(refused(&[[1.0, 1.0]; 3]).contains("enclose an area"));
    assert!(refused(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).contains("enclose an area"));
    let mut warped = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    warped[3].z = 1e-3;
    assert!(refusal(&warped).contains("one plane"));

    let crossing = "neither touch nor cross";
    // A bow tie of unequal halves, a spike, a corner on an edge, a corner twice, two turns.
    let bow = [[0.0, 0.0], [2.0, 0.0], [0.5, 1.0], [1.0, 1.0]];
    let spike = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    let touching = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let doubled = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    let twice = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    for outline in [&bow[..], &spike, &touching, &doubled, &twice] {
        assert!(refused(outline).contains(crossing), "{outline:?}");
    }
    // A corner in the middle of a straight side is fine.
    let straight = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0]];
    assert!(PolygonLight::new(&flat(&straight)).is_ok());
}

#[test]
fn tiny_and_huge_outlines_are_lights_too() {
    for size in [1e-200, 1e-9, 1e9, 1e200] {
        let corners: Vec<DVec3> =
            flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).iter().map(|&p| p * size).collect();
        assert!(PolygonLight::new(&corners).is_ok(), "{size}");
    }
}
