use super::*;
use glam::Vec4Swizzles as _;

fn ceiling() -> RectangleLight {
    RectangleLight::new(DVec3::new(0.0, 4.0, 0.0), DVec3::X * 0.5, DVec3::NEG_Z * 0.5).unwrap()
}

const UNIT: MeshBounds = [[-0.5; 3], [0.5; 3]];

#[test]
fn the_window_holds_every_corner_and_little_more() {
    let at = DMat4::from_translation(DVec3::new(0.3, 2.0, -0.1));
    let view = fit_occluders(&ceiling(), &[(UNIT, at)], None, 64).unwrap();
    assert!(view.near < 1.5 && view.near > 1.49);
    let to_clip = view.clip_from_light() * ceiling().light_from_world() * at;
    let mut widest: f64 = 0.0;
    for i in 0..8 {
        let corner = DVec3::from_array(std::array::from_fn(|a| f64::from(i >> a & 1) - 0.5));
        let clip = to_clip * corner.extend(1.0);
        let ndc = clip.xyz() / clip.w;
        assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0 && ndc.z > 0.0 && ndc.z < 1.0);
        assert!((ndc.z - view.near / clip.w).abs() < 1e-12);
        widest = widest.max(ndc.x.abs());
    }
    assert!((widest - 62.0 / 64.0).abs() < 1e-9, "one texel of margin, not {widest}");
}

#[test]
fn the_smallest_maps_hold_every_corner() {
    let at = DMat4::from_translation(DVec3::new(0.3, 2.0, -0.1));
    let wide = fit_occluders(&ceiling(), &[(UNIT, at)], None, 1 << 20).unwrap();
    for side in 1..8 {
        let view = fit_occluders(&ceiling(), &[(UNIT, at)], None, side).unwrap();
        let holds = |i: usize| view.min[i] < wide.min[i] && view.max[i] > wide.max[i];
        assert!(holds(0) && holds(1) && view.max[0].is_finite(), "{side}");
    }
}

#[test]
fn what_lies_behind_the_light_is_left_out() {
    let above = DMat4::from_translation(DVec3::new(0.0, 6.0, 0.0));
    assert_eq!(fit_occluders(&ceiling(), &[(UNIT, above)], None, 64), None);
    // Through the light's plane: clipped, finite.
    let across = DMat4::from_translation(DVec3::new(0.0, 4.0, 0.0));
    let view = fit_occluders(&ceiling(), &[(UNIT, across)], None, 64).unwrap();
    assert!(view.near > 0.0 && view.max[0].is_finite() && view.max[0] <= 11.0);
}

#[test]
fn a_ground_under_everything_is_aside() {
    let light = ceiling();
    let ground = ([[-4.0, 0.0, -4.0], [4.0, 0.0, 4.0]], DMat4::IDENTITY);
    let standing = (UNIT, DMat4::from_translation(DVec3::new(0.0, 0.5, 0.0)));
    let sunk = (UNIT, DMat4::from_translation(DVec3::new(0.0, 0.4, 0.0)));
    assert!(is_aside(&light, &ground, &[ground, standing]));
    assert!(!is_aside(&light, &ground, &[ground, sunk]), "it shadows what lies beneath it");
    assert!(!is_aside(&light, &standing, &[ground]), "a box is not flat");
    // A wall that the light shines past on both sides.
    let wall = ([[0.0, 0.0, -4.0], [0.0, 4.0, 4.0]], DMat4::IDENTITY);
    assert!(!is_aside(&light, &wall, &[ground]));
}

#[test]
fn receivers_are_cut_to_what_can_be_shadowed() {
    let light = ceiling();
    let card: MeshBounds = [[-0.5, 0.0, -0.5], [0.5, 0.0, 0.5]];
    let card_at = DMat4::from_translation(DVec3::new(0.0, 2.0, 0.0));
    let occluders = fit_occluders(&light, &[(card, card_at)], None, 64).unwrap();
    let ground: MeshBounds = [[-50.0, 0.0, -50.0], [50.0, 0.0, 50.0]];
    let view = fit_receivers(&light, &[(ground, DMat4::IDENTITY)], &occluders, 64).unwrap();
    // The penumbra's outer edge: the light's far edge through the card's edge, at x = 1.5.
    let edge = view.max[0] * 62.0 / 64.0 * 4.0;
    assert!((edge - 1.5).abs() < 0.05, "{edge}");
    // A light that stands on the ground, half of it beneath: its centre sees the ground edge-on.
    let standing = RectangleLight::new(DVec3::X * -3.0, DVec3::Z * 0.5, DVec3::Y * 0.5).unwrap();
    let wall = DMat4::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let walled = fit_occluders(&standing, &[(card, wall)], None, 64).unwrap();
    let seen = fit_receivers(&standing, &[(ground, DMat4::IDENTITY)], &walled, 64).unwrap();
    assert!((0..2).all(|i| seen.min[i] < seen.max[i]));
    // A shelf above the card receives nothing.
    let shelf = DMat4::from_translation(DVec3::new(0.0, 3.0, 0.0));
    assert_eq!(fit_receivers(&light, &[(card, shelf)], &occluders, 64), None);
}
