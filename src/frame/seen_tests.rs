use super::*;
use crate::scene::Lens;

/// Numbers from 0 to 1 that fill it evenly.
fn even(nth: u32, by: f64) -> f64 {
    (f64::from(nth) * by).fract()
}

fn place(nth: u32) -> DVec3 {
    DVec3::new(even(nth, 0.618), even(nth, 0.7548), even(nth, 0.5698))
}

/// A camera at the origin that looks along −z, with 45 degrees to each side.
fn frustum() -> Frustum {
    let lens = Lens::Perspective { yfov: 0.5 * std::f64::consts::PI };
    let camera = crate::scene::Camera { world_from_view: DMat4::IDENTITY, lens, near: 0.1 };
    Frustum::new(&camera.clip_from_view(1.0).inverse()).unwrap()
}

/// Every part of what the camera sees of the boxes lies in the bounds of its slice, however many boxes there are.
#[test]
fn slices_hold_what_is_seen() {
    let frustum = frustum();
    let ends = [0.0, 4.0, 12.0, 60.0];
    let turned = DMat4::from_rotation_y(0.7);
    for count in [1, 20, 400] {
        let boxes: Vec<Bounds> = (0..count)
            .map(|nth| {
                let size = if nth % 7 == 0 { 9.0 } else { 0.5 };
                let min = (place(nth + 1) - DVec3::new(0.5, 0.5, 1.0)) * DVec3::splat(50.0);
                Bounds { min, max: min + size * (0.1 + place(nth + 999)) }
            })
            .collect();
        let mut seen = [Bounds::NONE; 3];
        frustum.slices(boxes.iter().copied(), &ends, &turned, &mut seen);
        let mut whole = Bounds::NONE;
        boxes.iter().for_each(|of| whole.join(of));
        for (seen, pair) in seen.iter().zip(ends.windows(2)) {
            let most = frustum.slice(&whole, [pair[0], pair[1]], &turned);
            let slack = DVec3::splat(1e-9);
            assert!(!seen.is_some() || (most.min - slack).cmple(seen.min).all());
            for of in &boxes {
                for nth in 0..200 {
                    let p = of.min + (of.max - of.min) * place(nth);
                    let is_seen = (pair[0]..pair[1]).contains(&-p.z)
                        && p.truncate().abs().max_element() <= -p.z;
                    let shown = Bounds { min: seen.min - slack, max: seen.max + slack };
                    assert!(!is_seen || shown.holds(turned.transform_point3(p)), "{p} of {of:?}");
                }
            }
        }
    }
}

/// Boxes that the camera sees whole, or not at all, have bounds no larger than they are.
#[test]
fn slices_of_small_boxes_are_small() {
    let frustum = frustum();
    let at = |x: f64, z: f64| Bounds {
        min: DVec3::new(x, -0.5, z),
        max: DVec3::new(x + 1.0, 0.5, z + 1.0),
    };
    // The one on the right and the one behind the eye are not seen.
    let boxes = [at(0.0, -3.0), at(9.0, -3.0), at(0.0, 3.0), at(2.0, -9.0)];
    let mut seen = [Bounds::NONE; 2];
    frustum.slices(boxes.into_iter(), &[0.0, 5.0, 20.0], &DMat4::IDENTITY, &mut seen);
    assert_eq!(seen, [boxes[0], boxes[3]]);
}
