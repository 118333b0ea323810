//! Outlines that are refused as lights, and others that are not.

use antumbra::truth::PolygonLight;
use glam::DVec3;

fn flat(corners: &[[f64; 2]]) -> Vec<DVec3> {
    corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
}

#[test]
fn bad_outlines_are_refused_with_a_sentence() {
    let refusal = |corners: &[DVec3]| PolygonLight::new(corners).unwrap_err().to_string();
    let refused = |corners: &[[f64; 2]]| refusal(&flat(corners));
    assert!(refused(&[[0.0, 0.0], [1.0, 0.0]]).contains("from 3 to"));
    assert!(refusal(&vec![DVec3::ZERO; 4097]).contains("from 3 to"));
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
