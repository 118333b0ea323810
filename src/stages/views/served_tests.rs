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

/// A lamp of these half-extents over boxes that block and receive, with maps of 512² where it has several views.
fn lamp(half: [f64; 2], boxes: &[LightBox], projection: Projection, most: u32) -> Lamp<'_> {
    Lamp {
        half,
        occluders: boxes,
        receivers: boxes,
        visible: None,
        projection,
        sides: [256, 512],
        most,
    }
}

/// What a camera at `eye` sees of receivers, looking along `to` with 37 degrees to each side.
fn seen(eye: DVec3, to: DVec3, receivers: &[LightBox]) -> Visible<'_> {
    let along = to.normalize();
    let right = along.any_orthonormal_vector();
    let corner = |i: usize| {
        let [x, y] = [i & 1, i >> 1 & 1].map(|end| 1.5 * end as f64 - 0.75);
        let ray = along + right * x + along.cross(right) * y;
        eye + ray * if i >> 2 == 1 { 100.0 } else { 0.0 }
    };
    Visible::new(std::array::from_fn(corner), receivers)
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
        let visible = Some(seen(DVec3::new(0.0, 3.0, 2.0), -DVec3::Y, &floor));
        let of = Lamp { receivers: &floor, visible, ..lamp([0.3; 2], &table, projection, 8) };
        let (why, follows) = fit_served(&of, &mut views);
        assert!(!follows, "where one view is enough it is the same for every camera");
        assert_eq!(views.len(), 1, "{why}");
        let alone = view_from([0.3; 2], &table, projection, 256).unwrap();
        assert_eq!((views[0].map, views[0].region), (alone, Region::ALL));
    }
    let mut views = Vec::new();
    let (why, _) = fit_served(&lamp([0.3; 2], &room(), Projection::Behind, 1), &mut views);
    assert!(views.len() == 1 && why.to_string().contains("no more are allowed"), "{why}");
    fit_served(&lamp([0.3; 2], &[], Projection::Behind, 4), &mut views);
    assert!(views.is_empty());
}

/// What makes a view from behind the light serve a region: rays from there to the light do not leave its window, whether
/// that is around the axis or aside, where the camera sees.
#[test]
fn rays_from_a_region_stay_in_its_view() {
    let boxes = room();
    for half in [[0.3, 0.3], [1.3, 0.015], [0.0, 0.0], [2.0, 0.7]] {
        let corner = seen(DVec3::new(1.0, 0.5, 1.5), DVec3::new(0.7, 0.5, 1.0), &boxes);
        for visible in [None, Some(corner)] {
            let cut = visible.is_some();
            let mut views = Vec::new();
            let of = Lamp { visible, ..lamp(half, &boxes, Projection::Behind, 4) };
            assert!(fit_served(&of, &mut views).1);
            assert_eq!(views.iter().any(|view| view.aside != [0.0; 2]), cut, "{views:?}");
            assert!(cut || views.len() == 4);
            assert!(views.iter().all(|served| served.map.side == 512));
            let (_, nested) = views.split_last().unwrap();
            nested.iter().for_each(|served| rays_stay_in(half, served));
        }
    }
}

/// Fails where a ray from a view's region to the light leaves its window.
fn rays_stay_in(half: [f64; 2], served: &Served) {
    let Served { map, region, aside, deepest } = served;
    let tangents = region.tangents();
    assert!(*deepest <= map.far && tangents.iter().all(|&t| t < WIDEST));
    for nth in 0..2000 {
        let z = 0.01 + 2.6 * even(nth, 0.618);
        let at = |i: usize, by: f64| (half[i] + tangents[i] * z) * (2.0 * even(nth, by) - 1.0);
        let p = DVec3::new(at(0, 0.7548), at(1, 0.5698), z);
        assert!(is_within(region, p * DVec3::new(0.9999, 0.9999, 1.0)));
        // The light is the same in the view's space, and the ray as straight.
        let on = |i: usize, by: f64| half[i] * (2.0 * even(nth, by) - 1.0);
        let light = DVec3::new(on(0, 0.3247), on(1, 0.2), 0.0);
        let [from, to] =
            [p, light].map(|q| DVec3::new(q.x + aside[0] * q.z, q.y + aside[1] * q.z, q.z));
        let q = served.view_from_light().transform_point3(to + (from - to) * even(nth, 0.4142));
        let uv = q.truncate() / (q.z + map.behind()).max(1e-12);
        let most = DVec2::from_array(tangents) * (1.0 + 1e-6);
        assert!(uv.abs().cmple(most).all(), "{half:?}: {q} at {uv}");
    }
}

/// The regions of views that are cut to what is seen lie within each other, and the last view's window has all of it.
#[test]
fn every_visible_receiver_has_a_view() {
    let boxes = room();
    let half = [0.3, 0.2];
    for nth in 0..60 {
        let aim = DVec3::new(even(nth, 0.7548), even(nth, 0.5698), even(nth, 0.618)) - 0.5;
        let eye = DVec3::new(1.9 * even(nth, 0.3247), -1.2, 0.3 + 2.0 * even(nth, 0.2));
        let of = || Lamp {
            visible: Some(seen(eye, aim, &boxes)),
            ..lamp(half, &boxes, Projection::Behind, 6)
        };
        let mut views = Vec::new();
        fit_served(&of(), &mut views);
        let visible = of().visible.unwrap();
        let Some(all) = visible.within(half, WIDEST) else { continue };
        let ends = |view: &Served, wide: [f64; 2]| {
            Window { min: view.aside, max: view.aside }.padded(wide)
        };
        let windows: Vec<Window> = views
            .iter()
            .map(|view| ends(view, view.region.tangents()))
            .take(views.len() - 1)
            .collect();
        for pair in windows.windows(2) {
            let wider = pair[1].padded([1e-6; 2]);
            assert_eq!(pair[0].with(&wider), wider, "{windows:?}");
        }
        // The last view has no region; the map's window is as the eye sees it, and no wider than the occluders.
        let last = views.last().unwrap();
        let shown = Window { min: last.map.min, max: last.map.max };
        let reach = [0, 1].map(|i| shown.max[i].max(-shown.min[i]));
        let whole = ends(last, reach);
        let occluders = tangents_within(&boxes, WIDEST).unwrap();
        for i in 0..2 {
            let least = all.min[i].max(occluders.0[i]);
            let most = all.max[i].min(occluders.1[i]);
            assert!(whole.min[i] <= least && whole.max[i] >= most, "{whole:?} for {all:?}");
        }
    }
}

/// A camera that sees little takes few views, and texels that are finer.
#[test]
fn a_camera_that_sees_little_takes_few_views() {
    let boxes = room();
    let mut all = Vec::new();
    fit_served(&lamp([0.3; 2], &boxes, Projection::Behind, 6), &mut all);
    // The table alone, from above one of its corners.
    let at_table = seen(DVec3::new(0.3, 0.3, 1.2), DVec3::new(-0.1, -0.1, 1.0), &boxes[3..]);
    let of = Lamp { visible: Some(at_table), ..lamp([0.3; 2], &boxes, Projection::Behind, 6) };
    let mut few = Vec::new();
    let (why, _) = fit_served(&of, &mut few);
    assert!(few.len() < 3 && all.len() == 6, "{why}");
    assert!(why.to_string().contains("shadows that are seen need up to 0."), "{why}");
    let texels = |views: &[Served]| views[0].map.texels_per_uv()[0];
    assert!(texels(&few) > 1.5 * texels(&all), "{} {}", texels(&few), texels(&all));
    // A camera that looks away sees no receiver.
    let away = seen(DVec3::new(0.0, 0.0, -1.0), -DVec3::Z, &boxes);
    let of = Lamp { visible: Some(away), ..lamp([0.3; 2], &boxes, Projection::Behind, 6) };
    let (why, _) = fit_served(&of, &mut few);
    assert!(few.len() == 1 && why.to_string().contains("sees no receiver"), "{why}");
}

#[test]
fn windows_grow_by_one_factor_up_to_what_lies_furthest_aside() {
    let boxes = room();
    for most in 2..=8 {
        let mut views = Vec::new();
        let (why, _) = fit_served(&lamp([0.3; 2], &boxes, Projection::Centre, most), &mut views);
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
    for (Served { map, region, deepest, .. }, part) in views.iter().zip(&parts).take(2) {
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
