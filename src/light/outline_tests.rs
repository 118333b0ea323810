//! Outlines that are refused as lights, and the rectangles around others.

// A test may panic: that is how it fails.
#![allow(clippy::unwrap_used)]

use super::*;
use glam::{DQuat, EulerRot};

const L: [[f64; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];

fn flat(corners: &[[f64; 2]]) -> Vec<DVec3> {
    corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
}

/// The triangles of an outline have its area together, and none is turned the other way, whatever its bays.
#[test]
fn triangles_cover_an_outline() {
    // Teeth that hang down from a bar.
    let tooth = |i: usize| [[0.0f64, 0.0], [0.4, -2.0], [0.6, 0.0]][i % 3];
    let teeth = (0..14).map(|i| [(i / 3) as f64 + tooth(i)[0], tooth(i)[1]]);
    let comb: Vec<[f64; 2]> = teeth.chain([[6.0, 1.0], [-0.5, 1.0]]).collect();
    let fan: Vec<[f64; 2]> =
        (0..16).map(|i| (DVec2::from_angle(f64::from(i) * 0.39) * 2.0).to_array()).collect();
    for corners in [&L[..], &comb, &fan, &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]]] {
        let mut corners = corners.to_vec();
        if doubled_area(&corners) < 0.0 {
            corners.reverse();
        }
        let cut = triangles(&corners);
        let areas: Vec<f64> =
            cut.iter().map(|t| doubled_area(&t.map(|i| corners[usize::from(i)]))).collect();
        let whole = doubled_area(&corners);
        assert!(cut.len() <= corners.len() - 2 && areas.iter().all(|area| *area > 0.0));
        assert!((areas.iter().sum::<f64>() / whole - 1.0).abs() < 1e-12, "{areas:?}, not {whole}");
    }
}

/// The rectangle is the smallest, its light space takes the corners to where they were, and they run
/// counter-clockwise in it, wherever the polygon is, whichever way it is turned.
#[test]
fn a_rectangle_fits_round_a_polygon() {
    let place = DVec3::new(20_000.0, -300.0, 7_000.0);
    for angles in [[0.0; 3], [0.4, -1.1, 2.0], [3.0, 1.5, -0.2]] {
        let turn = DQuat::from_euler(EulerRot::XYZ, angles[0], angles[1], angles[2]);
        let mut corners: Vec<DVec3> = flat(&L).iter().map(|&p| turn * p + place).collect();
        for side in [1.0, -1.0] {
            let (light, outline) = RectangleLight::around(&corners).unwrap();
            assert!((light.emission() - turn * DVec3::Z * side).length() < 1e-10);
            assert!((light.axes.determinant() - 1.0).abs() < 1e-12);
            // 1.5 × 1: its longer side first.
            let [a, b] = light.half_extents();
            assert!((a - 1.5).abs() < 1e-10 && (b - 1.0).abs() < 1e-10, "{a} {b}");
            for (&[x, y], corner) in outline.iter().zip(&corners) {
                let there = light.world_from_light().transform_point3(DVec3::new(x, y, 0.0));
                assert!(there.distance(*corner) < 1e-10, "{there} {corner}");
            }
            assert!((doubled_area(&outline) - 8.0).abs() < 1e-9);
            assert_eq!(problem(&outline, light.half_extents()), None);
            corners.reverse();
        }
    }
}

/// A rectangle is its own; a triangle's is twice its size, whichever of its sides it lies on.
#[test]
fn no_rectangle_is_smaller() {
    let (light, outline) =
        RectangleLight::around(&flat(&[[1.0, 0.0], [2.0, 1.0], [0.0, 3.0], [-1.0, 2.0]])).unwrap();
    let [a, b] = light.half_extents();
    assert!((a - 2f64.sqrt()).abs() < 1e-12 && (b - 0.5f64.sqrt()).abs() < 1e-12);
    assert!((4.0 * a * b - 0.5 * doubled_area(&outline)).abs() < 1e-12);
    let (light, outline) =
        RectangleLight::around(&flat(&[[0.0, 0.0], [1.0, 0.0], [0.3, 0.7]])).unwrap();
    let [a, b] = light.half_extents();
    assert!((4.0 * a * b - doubled_area(&outline)).abs() < 1e-12);
    for size in [1e-200, 1e-9, 1e9, 1e200] {
        let corners: Vec<DVec3> = flat(&L).iter().map(|&p| p * size).collect();
        let [a, b] = RectangleLight::around(&corners).unwrap().0.half_extents();
        assert!((a / size - 1.5).abs() < 1e-12 && (b / size - 1.0).abs() < 1e-12);
    }
}

#[test]
fn bad_polygons_are_refused_with_a_sentence() {
    let refusal = |corners: &[DVec3]| RectangleLight::around(corners).unwrap_err().to_string();
    let refused = |corners: &[[f64; 2]]| refusal(&flat(corners));
    let number = "the light cannot be used: it must have 3 to 16 corners, and has ";
    assert_eq!(refused(&L[..2]), format!("{number}2"));
    assert_eq!(refusal(&[DVec3::ZERO; 17]), format!("{number}17"));
    assert!(refusal(&[]).contains("has 0"));
    assert!(refused(&[[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0]]).contains("finite"));
    assert!(refused(&[[f64::MIN, 0.0], [f64::MAX, 0.0], [0.0, 1.0]]).contains("finite"));
    assert!(refused(&[[1.0, 1.0]; 3]).contains("enclose an area"));
    assert!(refused(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).contains("enclose an area"));
    let mut warped = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    warped[3].z = 1e-3;
    assert!(refusal(&warped).contains("one plane"));
    // A bow tie of unequal halves, a spike, a corner on an edge, a corner twice, two turns.
    let bow = [[0.0, 0.0], [2.0, 0.0], [0.5, 1.0], [1.0, 1.0]];
    let spike = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    let touching = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let doubled = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    let twice = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    for outline in [&bow[..], &spike, &touching, &doubled, &twice] {
        let turn = DQuat::from_euler(EulerRot::XYZ, 0.4, -1.1, 2.0);
        let turned: Vec<DVec3> = flat(outline).iter().map(|&p| turn * p).collect();
        for corners in [flat(outline), turned] {
            assert!(refusal(&corners).contains("neither touch nor cross"), "{outline:?}");
        }
    }
    // A corner in the middle of a straight side is fine, and so are corners a millionth apart.
    for fine in [1.0, 1e-6] {
        let straight = [[0.0, 0.0], [fine, 0.0], [2.0, 0.0], [0.0, 1.0]];
        assert!(RectangleLight::around(&flat(&straight)).is_ok());
    }
}

#[test]
fn an_outline_must_lie_in_its_rectangle_and_run_the_right_way() {
    let half = [1.0, 0.5];
    let whole = [[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]];
    assert_eq!(problem(&whole, half), None);
    // As f32 has a third.
    let third = f64::from(1.0_f32 / 3.0);
    assert_eq!(problem(&whole.map(|[x, y]| [x * 3.0 * third, y]), half), None);
    let mut reversed = whole;
    reversed.reverse();
    assert!(problem(&reversed, half).unwrap().contains("counter-clockwise"));
    let wide = problem(&whole.map(|[x, y]| [x * 1.001, y]), half).unwrap();
    assert!(wide.starts_with("its corner 0 at (-1.001, -0.5) lies outside"), "{wide}");
    assert!(problem(&[[0.0; 2]; 2], half).unwrap().contains("3 to 16"));
    assert!(problem(&[[0.0; 2]; 4], half).unwrap().contains("area"));
    assert!(
        problem(&[[0.0; 2], [1.0, 0.0], [0.0, f64::INFINITY]], half).unwrap().contains("finite")
    );
    let bow = [[-1.0, -0.5], [1.0, -0.5], [-0.5, 0.5], [0.5, 0.5]];
    assert!(problem(&bow, half).unwrap().contains("cross itself"));
}

/// A light and its outline turned are where they were.
#[test]
fn a_quarter_turn_leaves_the_polygon_in_its_place() {
    let (light, outline) = RectangleLight::around(&flat(&L)).unwrap();
    let places = |light: &RectangleLight, outline: &[[f64; 2]]| {
        let place = |&[x, y]: &[f64; 2]| DVec3::new(x, y, 0.0);
        let place = |p| light.world_from_light().transform_point3(place(p));
        outline.iter().map(place).collect::<Vec<_>>()
    };
    let whole = crate::Light::with_outline(light, &outline).unwrap().quarter_turned();
    let (turned, corners) = (whole.rectangle(), whole.outline().unwrap());
    for (there, here) in places(turned, corners).into_iter().zip(places(&light, &outline)) {
        assert!(there.distance(here) < 1e-12, "{there} {here}");
    }
    assert_eq!(problem(corners, turned.half_extents()), None);
}

/// A light carries its outline, and is refused where that is none.
#[test]
fn a_light_with_an_outline_that_is_none_is_refused() {
    use crate::Light;
    use crate::scene::generate::{line_light, square_light};
    let corners = [[-0.25, -0.25], [0.25, -0.25], [0.0, 0.25]];
    let square = square_light(0.5).unwrap();
    let refuse = |rectangle, corners: &[[f64; 2]]| {
        Light::with_outline(rectangle, corners).unwrap_err().to_string()
    };
    let light = Light::with_outline(square, &corners).unwrap();
    assert_eq!(light.outline(), Some(&corners[..]));
    assert_eq!(light.quarter_turned().outline().unwrap()[0], [-0.25, 0.25]);
    assert_eq!(Light::from(square).outline(), None);
    let reversed: Vec<_> = corners.iter().rev().copied().collect();
    assert!(refuse(square, &reversed).contains("its corners must run counter-clockwise"));
    assert!(refuse(square, &corners[..2]).contains("3 to 16 corners, and has 2"));
    assert!(refuse(square, &[[0.0, 0.0], [0.1, 0.0], [0.1, f64::NAN]]).contains("finite"));
    assert!(refuse(square_light(0.4).unwrap(), &corners).contains("lies outside"));
    assert!(refuse(line_light(1.0, 0.0).unwrap(), &corners).contains("has no outline"));
    let triangle = [[0.0, 3.0, 0.0], [0.0, 3.0, 1.0], [1.0, 3.0, 0.0]];
    let polygon = Light::polygon(&triangle).unwrap();
    assert!(polygon.emission().y.abs() > 0.999 && polygon.outline().unwrap().len() == 3);
}
