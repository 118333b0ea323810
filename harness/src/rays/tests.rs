//! What is compiled for AVX2 finds what is compiled for any processor.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use super::*;
use antumbra::scene::generate;
use lanes::dot;

#[test]
fn both_kinds_of_lanes_compute_the_same() {
    fn results<V: Lanes>() -> Vec<f32> {
        let a = V::load(&[0.0, -1.0, 2.5, -3.5, 1e-8, 1e8, -0.0, f32::INFINITY]);
        let b = V::load(&[1.0, -2.0, 2.5, 3.0, -1e-8, 1e7, 0.0, f32::INFINITY]);
        let of = [a.add(b), a.mul(b), a.div(V::splat(4.0)), a.min(b), a.max(b), a.abs(), a.flip(b)];
        let more = [
            a.sub(V::splat(1.0)),
            a.mul_add(V::splat(2.0), b),
            b.mul_sub(V::splat(2.0), V::splat(1.0)),
        ];
        let mask = [a.le(b) as f32, dot([a, b, a], [b, a, b]).le(V::splat(0.0)) as f32];
        of.into_iter().chain(more).flat_map(V::store).chain(mask).collect()
    }
    let portable = results::<Portable>();
    assert_eq!(&portable[80..], [205.0, 89.0], "{:?}", &portable[80..]);
    if has_avx2() {
        // SAFETY: the processor has AVX2 and FMA.
        let avx2 = unsafe { of_avx2(results::<lanes::Avx2>) };
        assert_eq!(avx2, portable);
    }
}

#[target_feature(enable = "avx2,fma")]
fn of_avx2<T>(f: impl FnOnce() -> T) -> T {
    f()
}

#[test]
fn both_kinds_of_lanes_find_the_same_fractions_but_for_a_few_rays_at_edges() {
    let scene = generate::foliage(generate::square_light(0.8).unwrap(), 100, 5);
    let light = scene.light(None).unwrap().light;
    let tracer = RayTracer::new(&scene).unwrap();
    let at =
        |i: u32| DVec3::new(f64::from(i % 64) * 0.04 - 1.28, 0.0, f64::from(i / 64) * 0.04 - 1.28);
    let receivers: Vec<_> =
        (0..4096).map(|i| Receiver { position: at(i), normal: DVec3::Y }).collect();
    let light = Light::of(light.rectangle(), tracer.tree.origin);
    let image =
        Image { tracer: &tracer, light, receivers: &receivers, width: 64, position_error: 0.0 };
    let points = lattice::<2>(16, 7);
    let (mut portable, mut best) = (vec![1.0; 4096], vec![1.0; 4096]);
    for band in 0..8 {
        let pixels = band * 512..(band + 1) * 512;
        image.band_by::<Portable, 2, false>(&points, band, &mut portable[pixels.clone()]);
        image.band::<2, false>(&points, band, &mut best[pixels]);
    }
    let rays: f32 = portable.iter().zip(&best).map(|(a, b)| 16.0 * (a - b).abs()).sum();
    let dark = portable.iter().filter(|v| **v < 1.0).count();
    assert!(dark > 1000 && rays <= 8.0, "{dark} pixels in shadow, {rays} of 65,536 rays differ");
}

#[test]
fn every_point_of_a_lattice_has_a_line_and_a_column_to_itself() {
    fn check<const K: usize>(n: u32, step: u32) {
        let points = lattice::<K>(n, step);
        assert_eq!(points.there.iter().map(|t| t.count_ones()).sum::<u32>(), n);
        for axis in 0..2 {
            let mut all: Vec<f32> =
                (0..n as usize).map(|i| points.at[i / 8][axis][i % 8]).collect();
            all.sort_by(f32::total_cmp);
            let even = (0..n).map(|i| (2 * i + 1) as f32 / n as f32 - 1.0);
            assert!(all.into_iter().eq(even), "{n} points by {step}");
        }
    }
    let [one, four, sixteen, most] = LATTICES;
    check::<1>(one.0, one.1);
    check::<1>(four.0, four.1);
    check::<2>(sixteen.0, sixteen.1);
    check::<8>(most.0, most.1);
}
