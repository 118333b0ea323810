use super::*;
use glam::DMat4;

/// Numbers from 0 to 1 that fill it evenly.
fn even(nth: u32, by: f64) -> f64 {
    (f64::from(nth) * by).fract()
}

/// A pyramid with its tip at `eye` that looks along `to`, and its four sides' corners.
fn pyramid(eye: DVec3, to: DVec3) -> [DVec3; 8] {
    let along = to.normalize();
    let right = along.any_orthonormal_vector();
    std::array::from_fn(|i| {
        let [x, y] = [i & 1, i >> 1 & 1].map(|end| end as f64 - 0.5);
        let ray = along + right * x + along.cross(right) * y;
        eye + ray * if i >> 2 == 1 { 30.0 } else { 0.0 }
    })
}

/// The window holds every point of a receiver that the camera sees beneath the opening.
#[test]
fn a_window_holds_what_is_seen() {
    let half = [0.3, 0.1];
    let tangent = 2.0;
    let mut some = 0;
    for nth in 0..200 {
        let at = |by: [f64; 3]| DVec3::from_array(by.map(|by| 2.0 * even(nth, by) - 1.0));
        let flat = nth % 2 == 0;
        let turned = DMat4::from_translation(3.0 * at([0.7548, 0.5698, 0.618]) + 3.0 * DVec3::Z)
            * DMat4::from_rotation_x(3.0 * even(nth, 0.4142))
            * DMat4::from_rotation_y(3.0 * even(nth, 0.3247));
        let deep = if flat { 0.0 } else { 0.8 };
        let receiver = [LightBox::new(&[[-2.0, -1.0, 0.0], [2.0, 1.0, deep]], &turned)];
        let corners = pyramid(4.0 * at([0.2, 0.7321, 0.4142]), at([0.8192, 0.6711, 0.5497]));
        let visible = Visible::new(corners, &receiver);
        let window = visible.within(half, tangent);
        let planes = planes_around(&corners);
        let (mut seen, mut any) = (window.unwrap_or(Window::around(0.0)), false);
        for i in 0..4000 {
            let in_box = DVec3::new(even(i, 0.618), even(i, 0.7548), even(i, 0.5698));
            let place =
                DVec3::new(-2.0, -1.0, 0.0) + in_box * DVec3::new(4.0, 2.0, f64::from(deep));
            let p = turned.transform_point3(place);
            let beneath = (0..2).all(|i| p[i].abs() <= half[i] + tangent * p.z);
            if p.z > 0.0 && beneath && planes.iter().all(|n| n.dot(p.extend(1.0)) >= 0.0) {
                any = true;
                seen.add(half, p, tangent);
            }
        }
        if any {
            some += 1;
            let window = window.unwrap_or_else(|| panic!("{nth}: what is seen has no window"));
            for i in 0..2 {
                let [less, more] = [window.min[i] - seen.min[i], seen.max[i] - window.max[i]];
                assert!(less < 1e-6 && more < 1e-6, "{nth}: {window:?} lacks {seen:?}");
            }
        }
    }
    assert!(some > 25, "only {some} of 200 receivers are seen");
}

/// A floor two metres below the light: the camera sees a square of it, two metres wide, and the window holds no more.
#[test]
fn a_window_holds_no_more_than_is_seen() {
    let half = [0.3, 0.1];
    let floor = [LightBox::new(&[[-9.0, -9.0, 2.0], [9.0, 9.0, 2.0]], &DMat4::IDENTITY)];
    let visible = Visible::new(pyramid(DVec3::new(1.0, 0.0, 0.0), DVec3::Z), &floor);
    let window = visible.within(half, 2.0).unwrap();
    let expected = Window { min: [0.15, -0.45], max: [0.85, 0.45] };
    for i in 0..2 {
        let off = [window.min[i] - expected.min[i], window.max[i] - expected.max[i]];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{window:?}, not {expected:?}");
    }
    // What is under the opening ends it.
    let window = visible.within(half, 0.5).unwrap();
    assert!((window.max[0] - 0.5).abs() < 1e-9, "{window:?}");
    assert_eq!(Visible::new(pyramid(DVec3::ZERO, -DVec3::Z), &floor).within(half, 2.0), None);
}

/// Beyond the first receivers their boxes count as they are, which is no less.
#[test]
fn more_receivers_than_are_cut_have_no_smaller_window() {
    let half = [0.1; 2];
    let cards: Vec<LightBox> = (0..3 * MOST_CUT as u32)
        .map(|nth| {
            let at = DVec3::new(even(nth, 0.618) - 0.5, even(nth, 0.7548) - 0.5, 2.0);
            LightBox::new(&[[-0.1, -0.1, 0.0], [0.1, 0.1, 0.1]], &DMat4::from_translation(at))
        })
        .collect();
    let corners = pyramid(DVec3::new(0.2, 0.1, 0.0), DVec3::Z);
    let window = Visible::new(corners, &cards).within(half, 2.0).unwrap();
    for some in cards.chunks(MOST_CUT) {
        let part = Visible::new(corners, some).within(half, 2.0).unwrap();
        assert_eq!(window.with(&part), window);
    }
}

/// A window in steps holds what it is made from, is not much larger, and stays while that moves a little.
#[test]
fn windows_move_in_steps() {
    let mut still = 0;
    let mut before = None;
    for nth in 0..1000 {
        let x = 0.3 + 0.001 * f64::from(nth);
        let window = Window { min: [x, -0.2], max: [x + 0.9, 0.6] };
        let stepped = window.stepped(0.5, 8.0);
        assert_eq!(window.with(&stepped), stepped);
        assert!((0..2).all(|i| stepped.half()[i] <= 1.26 * window.half()[i]), "{stepped:?}");
        still += u32::from(before == Some(stepped));
        before = Some(stepped);
    }
    // Either end moves by 32 steps.
    assert!(still > 930, "the window moved {} times", 1000 - still);
    // Narrow windows are widened, and those that hold nearly all are whole.
    let narrow = Window { min: [0.2; 2], max: [0.1; 2] }.stepped(0.5, 8.0);
    assert!(narrow.half().iter().all(|half| (0.25..0.4).contains(half)), "{narrow:?}");
    assert_eq!(Window::around(7.7).stepped(0.5, 8.0), Window::around(8.0));
}
