use super::*;
use crate::stages::views::sun::{UnderSun, fit_sun};
use glam::{DMat4, DVec2, DVec3};

/// A box along light space's axes.
fn cuboid(min: [f32; 3], max: [f32; 3]) -> LightBox {
    LightBox::new(&[min, max], &DMat4::IDENTITY)
}

/// A room under a lamp: walls and floor, and a table.
fn room() -> Vec<LightBox> {
    vec![
        cuboid([-2.1, -2.0, 0.0], [-2.0, 2.0, 2.6]),
        cuboid([2.0, -2.0, 0.0], [2.1, 2.0, 2.6]),
        cuboid([-2.0, -2.0, 2.6], [2.0, 2.0, 2.7]),
        cuboid([-0.4, -0.4, 1.8], [0.4, 0.4, 1.9]),
    ]
}

/// Numbers from 0 to 1 that fill it evenly.
fn even(nth: u32, by: f64) -> f64 {
    (f64::from(nth) * by).fract()
}

fn is_within(region: &Region, p: DVec3) -> bool {
    let rim = |i: usize| f64::from(region.at[i]) + f64::from(region.slope[i]) * p.z;
    p.x >= rim(0) && p.y >= rim(1) && p.x <= rim(2) && p.y <= rim(3)
}

#[test]
fn one_view_is_enough_for_what_lies_below_a_lamp() {
    let table = [cuboid([-0.4, -0.4, 1.8], [0.4, 0.4, 1.9])];
    let floor = [cuboid([-9.0, -9.0, 2.6], [9.0, 9.0, 2.7])];
    for projection in [Projection::Behind, Projection::Centre, Projection::Orthographic] {
        let mut views = Vec::new();
        let why = fit_served([0.3; 2], [&table, &floor], projection, [256, 512], 8, &mut views);
        assert_eq!(views.len(), 1, "{why}");
        let alone = view_from([0.3; 2], &table, projection, 256).unwrap();
        assert_eq!((views[0].map, views[0].region), (alone, Region::ALL));
    }
    let mut views = Vec::new();
    let why =
        fit_served([0.3; 2], [&room(), &floor], Projection::Behind, [256, 512], 1, &mut views);
    assert!(views.len() == 1 && why.to_string().contains("no more are allowed"), "{why}");
    fit_served([0.3; 2], [&[], &floor], Projection::Behind, [256, 512], 4, &mut views);
    assert!(views.is_empty());
}

/// What makes a view from behind the light serve a region: rays from there to the light do not leave its window.
#[test]
fn rays_from_a_region_stay_in_its_view() {
    for half in [[0.3, 0.3], [1.3, 0.015], [0.0, 0.0], [2.0, 0.7]] {
        let boxes = room();
        let mut views = Vec::new();
        fit_served(half, [&boxes, &boxes], Projection::Behind, [256, 512], 4, &mut views);
        assert_eq!(views.len(), 4);
        assert!(views.iter().all(|served| served.map.side == 512));
        for Served { map, region, deepest } in &views[..3] {
            let tangent = region.tangent();
            assert!(*deepest <= map.far && tangent < WIDEST);
            for nth in 0..2000 {
                let z = 0.01 + 2.6 * even(nth, 0.618);
                let at = |i: usize, by: f64| (half[i] + tangent * z) * (2.0 * even(nth, by) - 1.0);
                let p = DVec3::new(at(0, 0.7548), at(1, 0.5698), z);
                assert!(is_within(region, p * DVec3::new(0.9999, 0.9999, 1.0)));
                let on = |i: usize, by: f64| half[i] * (2.0 * even(nth, by) - 1.0);
                let light = DVec3::new(on(0, 0.3247), on(1, 0.2), 0.0);
                let q = light + (p - light) * even(nth, 0.4142);
                let uv = q.truncate() / (q.z + map.behind()).max(1e-12);
                assert!(uv.abs().max_element() <= tangent * (1.0 + 1e-9), "{half:?}: {q} at {uv}");
            }
        }
    }
}

#[test]
fn windows_grow_by_one_factor_up_to_what_lies_furthest_aside() {
    let boxes = room();
    for most in 2..=8 {
        let mut views = Vec::new();
        let why =
            fit_served([0.3; 2], [&boxes, &boxes], Projection::Centre, [64, 128], most, &mut views);
        let tangents: Vec<f64> = views.iter().map(|v| v.map.max[0]).collect();
        assert!(views.len() as u32 <= most && why.to_string().contains("64.00"), "{why}");
        let ratios: Vec<f64> = tangents.windows(2).map(|pair| pair[1] / pair[0]).collect();
        assert!(ratios.iter().all(|r| (r / ratios[0] - 1.0).abs() < 1e-9), "{ratios:?}");
        assert!((ratios[0] > 0.9 * LEAST_RATIO) && views.last().unwrap().region == Region::ALL);
    }
}

/// Rays to a sun do as well, whose parts need not lie in each other.
#[test]
fn rays_to_a_sun_stay_in_the_view_that_serves_their_receiver() {
    let ground = cuboid([-100.0, -80.0, 0.0], [100.0, 80.0, 1.0]);
    let posts: Vec<LightBox> = (0..20)
        .map(|i| {
            let x = i as f32 * 4.0 - 40.0;
            cuboid([x, -1.0, -3.0], [x + 0.2, -0.8, 0.0])
        })
        .chain([ground])
        .collect();
    let part = |from: f64, to: f64| [DVec3::new(from, -5.0, -3.0), DVec3::new(to, 5.0, 1.0)];
    let parts = [part(-4.0, 3.0), part(2.0, 20.0), part(19.0, 99.0)];
    let half = 0.05;
    let under = UnderSun {
        half,
        occluders: &posts,
        receivers: &posts,
        parts: &parts,
        side: 128,
        receiver_side: 128,
    };
    let mut views = Vec::new();
    let found = fit_sun(&under, &mut views).unwrap();
    assert_eq!(views.len(), 3);
    assert_eq!(views[2].region, Region::ALL);
    for (Served { map, region, deepest }, part) in views.iter().zip(&parts).take(2) {
        assert!(map.near < *deepest && *deepest <= 0.0 && map.far == 0.0);
        for nth in 0..1000 {
            let t = DVec3::new(even(nth, 0.618), even(nth, 0.7548), even(nth, 0.5698));
            let p = part[0] + (part[1] - part[0]) * t - found.origin;
            assert!(is_within(region, p), "{p} is in the part, and not in {region:?}");
            let towards = half * (2.0 * DVec2::new(even(nth, 0.3247), even(nth, 0.2)) - 1.0);
            let q = p.truncate() + towards * (p.z - map.near).max(0.0) * even(nth, 0.4142);
            let [min, max] = [map.min, map.max].map(DVec2::from_array);
            assert!(q.cmpge(min).all() && q.cmple(max).all(), "{q} is outside {map:?}");
        }
    }
    // One view where one part is all.
    fit_sun(&UnderSun { parts: &[], ..under }, &mut views).unwrap();
    assert_eq!(views.len(), 1);
    assert!(fit_sun(&UnderSun { occluders: &[], ..under }, &mut views).is_none());
}

/// A texel of a sun's view stays where it is while what is seen moves by less than a step of its size.
#[test]
fn a_suns_texels_stay_where_they_are() {
    let posts = [cuboid([-50.0, -50.0, -3.0], [50.0, 50.0, 0.0])];
    let texels = |shift: f64| {
        let part = |from: f64, to: f64| {
            [DVec3::new(from + shift, -5.0, -3.0), DVec3::new(to + shift, 5.0, 0.0)]
        };
        let parts = [part(-4.0, 4.0), part(3.0, 30.0)];
        let under = UnderSun {
            half: 0.005,
            occluders: &posts,
            receivers: &posts,
            parts: &parts,
            side: 128,
            receiver_side: 128,
        };
        let mut views = Vec::new();
        let found = fit_sun(&under, &mut views).unwrap();
        let map = views[0].map;
        (1.0 / map.texels_per_uv()[0], found.origin.x + map.min[0])
    };
    let (size, first) = texels(0.0);
    for shift in [0.013, 0.4, 1.7] {
        let (other, begins) = texels(shift);
        assert!((other / size - 1.0).abs() < 1e-9, "{other}, not {size}");
        let steps = (begins - first) / size;
        assert!((steps - steps.round()).abs() < 1e-6, "moved by {steps} texels");
    }
}
