//! Hard by the size of their numbers, and by the sides of their maps.

use super::{CARD, HardCase, LIGHT, Limit, TWO_LINES, base, card, light, sheet};
use crate::hard_cases::set::{Place, Set};
use glam::{DMat4, DVec3};

fn of(name: impl Into<String>) -> HardCase {
    HardCase::new(Limit::Numbers, name, base())
}

pub(super) fn all() -> Vec<HardCase> {
    [scales(), distances(), maps(), borders()].concat()
}

fn scales() -> Vec<HardCase> {
    let scaled = |exponent: i32, baked: bool| {
        let how = if baked { "vertices" } else { "transforms" };
        let place = Place { scale: 10.0_f64.powi(exponent), baked, ..Place::HERE };
        HardCase { place, ..of(format!("1e{exponent} times as large, by {how}")) }
    };
    let both = |exponent| [scaled(exponent, false), scaled(exponent, true)];
    [-12, -6, -3, -1, 1, 3, 5, 12].into_iter().flat_map(both).collect()
}

/// Why ray marching needs twice the way.
const FROM_BEHIND: &str =
    "seen from as far behind the light: 2e3 m are known to 2e-3 m (two roundings of 2^-21)";

fn distances() -> Vec<HardCase> {
    let far = |name: &str, offset| HardCase { place: Place { offset, ..Place::HERE }, ..of(name) };
    let high = |gap: f64| {
        let set =
            Set { light: light([100.0; 2], DVec3::Y * 1e3), blocks: vec![card(gap)], ..base() };
        HardCase { set, ..of(format!("{gap:e} m over the receiver, 1e3 m under the light")) }
    };
    let subnormal = |of: f64| {
        let mut set = base();
        set.blocks[0].at.w_axis.z = of;
        set.light = light([0.5; 2], DVec3::new(of, LIGHT, -of));
        set
    };
    vec![
        far("1e6 m away", DVec3::new(1e6, -1e6, 1e6)),
        far("1e7 m away along one axis", DVec3::new(0.0, 0.0, 1e7)),
        high(1e-1),
        high(1e-3).known_for(&["ray-march"], FROM_BEHIND),
        HardCase { set: subnormal(1e-310), ..of("subnormal coordinates") },
        HardCase { set: subnormal(-0.0), ..of("negative zeros") },
    ]
}

fn maps() -> Vec<HardCase> {
    let sided = |map: u32| HardCase { map, ..of(format!("maps of {map} × {map}")) };
    let mut all: Vec<_> = [1, 2, 3, 5, 7, 16, 17, 31, 64, 127, 251, 509].map(sided).into();
    // Four lines of eight samples would take more memory than they may have.
    all.push(HardCase { noise: vec![TWO_LINES], ..sided(1021) });
    all
}

/// A window that ends within the occluder, so that border texels hold it: what is beyond is not known.
fn borders() -> Vec<HardCase> {
    let cut = |half: f64, map: u32| {
        let window = Some([[-half; 2], [half; 2]]);
        let side = 2.0 * half * (LIGHT - CARD);
        let seen = Some(vec![sheet([side; 2], DMat4::from_translation(DVec3::Y * CARD))]);
        HardCase {
            window,
            map,
            seen,
            ..of(format!("{map} × {map} texels within ±{half} of the occluder"))
        }
    };
    vec![cut(0.1, 128), cut(0.2, 128), cut(0.2, 61)]
}
