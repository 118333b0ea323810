//! The GLSL functions of ray marching alone, beside their twins.

use antumbra::graph::STORAGE_BYTES;
use antumbra::techniques::common::twin::{area_above, in_triangle};
use antumbra::techniques::ray_march::twin::{
    beveled, bounds_of, cell_of, filter_weight, filter_width, md5, one_interval, pcg, sobol,
    step_down, two_intervals,
};
use antumbra_tests::compare::Tolerance;
use antumbra_tests::{Function, device};
use glam::Vec3;
use num_traits::Float;
use proptest::prelude::{Just, Strategy, any};
use proptest::prop_oneof;

/// A layer's height: nothing, or something.
fn height() -> impl Strategy<Value = f32> {
    prop_oneof![1 => Just(0.0f32), 3 => 0.1..1.0f32, 1 => Just(0.5f32)]
}

#[test]
fn columns_of_layers() {
    let all = (height(), height(), height(), height());
    Function::new("ray_march/column.glsl", "vec4 bounds_of(vec4 column)")
        .random(2_000, all)
        .f32(Tolerance::exact(), |x| bounds_of([x[0], x[1], x[2], x[3]]).to_vec())
        .check(&device());
    Function::new("ray_march/column.glsl", "vec4 one_interval(float top, float far_back)")
        .random(500, (height(), height()))
        .f32(Tolerance::exact(), |x| one_interval(x[0], x[1]).to_vec())
        .check(&device());
    let all = (height(), height(), height(), height());
    Function::new(
        "ray_march/column.glsl",
        "vec4 two_intervals(float top, float near_back, float far_front, float far_back)",
    )
    .random(4_000, all)
    .f32(Tolerance::exact(), |x| two_intervals(x[0], x[1], x[2], x[3]).to_vec())
    .check(&device());
    let all = (height(), height(), height(), height());
    Function::new("ray_march/column.glsl", "vec2 beveled(vec2 piece, float above, float below)")
        // A sheet stays what it is, and a thin plate keeps its middle.
        .case(([0.5, 0.5], 0.1, 0.1))
        .case(([0.5, 0.4], 1.0, 1.0))
        .random(2_000, all.prop_map(|(a, b, c, d)| ([a, b], c, d)))
        .f32(Tolerance::exact(), |x| beveled([x[0], x[1]], x[2], x[3]).to_vec())
        .check(&device());
    let all = (height(), height(), height(), height());
    Function::new(
        "ray_march/column.glsl",
        "float step_down(float h, float neighbour, float behind_it, float opposite)",
    )
    // A plane goes on.
    .case((0.5, 0.25, 0.0, 0.75))
    .random(4_000, all)
    .f32(Tolerance::exact(), |x| vec![step_down(x[0], x[1], x[2], x[3])])
    .check(&device());
}

#[test]
fn hashes() {
    let words = || (any::<u32>(), any::<u32>(), any::<u32>(), any::<u32>());
    Function::new("ray_march/noise.glsl", "uvec4 md5(uvec4 message, uint key)")
        .case((0, 0, 0, 0, 0))
        .case((1, 2, 3, 4, 5))
        .random(4_000, (words(), any::<u32>()))
        .bits(|x| md5([x[0], x[1], x[2], x[3]], x[4]).to_vec())
        .check(&device());
    Function::new("ray_march/noise.glsl", "uvec4 pcg(uvec4 v)")
        .case((0, 0, 0, 0))
        .random(4_000, words())
        .bits(|x| pcg([x[0], x[1], x[2], x[3]]).to_vec())
        .check(&device());
}

#[test]
fn points_of_a_sequence_and_cells_of_a_grid() {
    Function::new("ray_march/noise.glsl", "uvec2 sobol(uint n)")
        .case(0)
        .case(u32::MAX)
        .random(4_000, any::<u32>())
        .bits(|x| sobol(x[0]).to_vec())
        .check(&device());
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        let whole = |i: usize| x[i].to_u32().unwrap();
        cell_of(whole(0), whole(1), whole(2)).to_vec()
    }
    let grids = (1..=256u32).prop_flat_map(|count| (0..count, Just(count), 1..=count));
    Function::new("ray_march/noise.glsl", "vec4 cell_of(int n, int count, int rows)")
        .case((0, 1, 1))
        .case((255, 256, 16))
        .random(4_000, grids)
        .f32(Tolerance::ulps(4), twin::<f32>)
        .f64(Tolerance::absolute(3e-7), twin::<f64>)
        .check(&device());
}

#[test]
fn parts_and_points_of_polygons() {
    let pair = || (-2.0..2.0f32, -2.0..2.0f32).prop_map(|(x, y)| [x, y]);
    Function::new("ray_march/noise.glsl", "float area_above(vec2 a, vec2 b)")
        // Above the line, below it, along it, and a place where an edge only touches it.
        .case(([0.0, 1.0], [2.0, 1.0]))
        .case(([0.0, -1.0], [2.0, -1.0]))
        .case(([0.0, 0.0], [2.0, 0.0]))
        .case(([0.0, 0.0], [2.0, -1.0]))
        .random(2_000, (pair(), pair()))
        .f32(Tolerance::absolute(2e-6), |x| vec![area_above([x[0], x[1]], [x[2], x[3]])])
        .f64(Tolerance::absolute(2e-5), |x| vec![area_above([x[0], x[1]], [x[2], x[3]])])
        .check(&device());
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        let corners = [[x[0], x[1]], [x[2], x[3]], [x[4], x[5]]];
        in_triangle(corners, [x[6], x[7]]).to_vec()
    }
    let s = (0.0..1.0f32, 0.0..1.0f32).prop_map(|(x, y)| [x, y]);
    Function::new("ray_march/noise.glsl", "vec2 in_triangle(vec2 a, vec2 b, vec2 c, vec2 s)")
        .random(2_000, (pair(), pair(), pair(), s))
        .f32(Tolerance::absolute(4e-6), twin::<f32>)
        .f64(Tolerance::absolute(8e-6), twin::<f64>)
        .check(&device());
    // The unit square, counter-clockwise: what of it lies above a line at 0.3.
    let square = [[0.0, -0.3], [1.0, -0.3], [1.0, 0.7], [0.0, 0.7]];
    let edges = (0..4).map(|i| (square[i], square[(i + 1) % 4]));
    let above: f64 = edges.map(|(a, b)| -area_above::<f64>(a, b)).sum();
    assert!((above - 0.7).abs() < 1e-12, "{above}");
}

#[test]
fn the_filters_width_and_weights() {
    // The power's error grows with its logarithm: 3 + 2·|log₂| units in the last place.
    Function::new(
        "ray_march/noise.glsl",
        "float filter_width(float penumbra, float pixel, float noise)",
    )
    .random(4_000, (0.001..2.0f32, 0.001..0.1f32, 0.001..0.4f32))
    .f64(Tolerance::relative(2e-5), |x| vec![filter_width(x[0], x[1], x[2])])
    .check(&device());
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        vec![filter_weight([x[0], x[1], x[2]], [x[3], x[4], x[5]], [x[6], x[7], x[8]], x[9])]
    }
    let vector = || (-1.0..1.0f32, -1.0..1.0f32, -1.0..1.0f32);
    Function::new(
        "ray_march/noise.glsl",
        "float filter_weight(vec3 apart, vec3 normal, vec3 its_normal, float width)",
    )
    .random(4_000, (vector(), direction(), direction(), 0.3..2.0f32))
    // Sixteen products, and an exponential of up to 9.
    .f64(Tolerance::relative(1e-5).or_absolute(1e-6), twin::<f64>)
    .check(&device());
}

/// Unit vectors of every direction.
fn direction() -> impl Strategy<Value = [f32; 3]> {
    (-1.0..1.0f32, -1.0..1.0f32, -1.0..1.0f32)
        .prop_filter("a direction", |(x, y, z)| x * x + y * y + z * z > 0.01)
        .prop_map(|(x, y, z)| Vec3::new(x, y, z).normalize().to_array())
}

/// There and back, to within what 32 bits lose, for normals of every direction.
#[test]
fn normals_fold_and_unfold() {
    let glue = "vec3 there_and_back(vec3 n) { return unfolded(folded(normalize(n))); }";
    Function::new("ray_march/noise.glsl", "vec3 there_and_back(vec3 n)")
        .glue(glue)
        .case((0.0, 0.0, 1.0))
        .case((0.0, 0.0, -1.0))
        .case((1.0, 0.0, 0.0))
        .random(4_000, direction())
        .f64(Tolerance::absolute(1e-6), |x| {
            let length = (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt();
            x.iter().map(|v| v / length).collect()
        })
        .check(&device());
}

/// What the two hashes must do for pixels: each of their bits is set half of the time, the numbers fill
/// every part of the square evenly, and neighbours in the image, in the list of rays and in time have
/// nothing in common. 65,536 numbers each: a bit's share is within 4.5 standard deviations of 1/512, a
/// correlation of 1/256, and of the 256 parts' χ² (mean 255, standard deviation 22.6) within 5.
#[test]
fn hashes_of_neighbours_have_nothing_in_common() {
    type Hash = fn(u32, u32, u32, u32) -> [u32; 4];
    let hashes: [(&str, Hash); 2] = [
        ("md5", |x, y, ray, seed| md5([x, y, ray, 0], seed)),
        ("pcg", |x, y, ray, seed| pcg([x, y, ray, seed])),
    ];
    let unit = |word: u32| f64::from(word >> 8) / 16_777_216.0;
    for (name, hash) in hashes {
        let pixels = || (0..256u32).flat_map(|y| (0..256u32).map(move |x| (x, y)));
        let words: Vec<[u32; 4]> = pixels().map(|(x, y)| hash(x, y, 3, 1)).collect();
        let count = words.len() as f64;
        for word in 0..2 {
            for bit in 0..32 {
                let set = words.iter().filter(|w| w[word] >> bit & 1 == 1).count() as f64;
                assert!((set / count - 0.5).abs() < 4.5 / 512.0, "{name}, word {word}, bit {bit}");
            }
        }
        let mut parts = [0.0f64; 256];
        for w in &words {
            parts[((unit(w[0]) * 16.0) as usize) * 16 + (unit(w[1]) * 16.0) as usize] += 1.0;
        }
        let even = count / 256.0;
        let chi: f64 = parts.iter().map(|p| (p - even).powi(2) / even).sum();
        assert!((chi - 255.0).abs() < 5.0 * 22.6, "{name}: chi squared {chi}");

        let correlation = |other: &dyn Fn(u32, u32) -> [u32; 4], a: usize, b: usize| {
            let sum: f64 = pixels()
                .zip(&words)
                .map(|((x, y), w)| (unit(w[a]) - 0.5) * (unit(other(x, y)[b]) - 0.5))
                .sum();
            12.0 * sum / count
        };
        type Neighbour = (&'static str, fn(Hash, u32, u32) -> [u32; 4]);
        let neighbours: [Neighbour; 5] = [
            ("right", |h, x, y| h(x + 1, y, 3, 1)),
            ("below", |h, x, y| h(x, y + 1, 3, 1)),
            ("across", |h, x, y| h(x + 1, y + 1, 3, 1)),
            ("the next ray", |h, x, y| h(x, y, 4, 1)),
            ("the next seed", |h, x, y| h(x, y, 3, 2)),
        ];
        let mut most = 0.0f64;
        for (which, neighbour) in neighbours {
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let r = correlation(&|x, y| neighbour(hash, x, y), a, b);
                most = most.max(r.abs());
                assert!(r.abs() < 4.5 / 256.0, "{name}: {which}, {a}{b}: {r}");
            }
        }
        let own = correlation(&|x, y| hash(x, y, 3, 1), 0, 1);
        assert!(own.abs() < 4.5 / 256.0, "{name}: its two numbers: {own}");
        println!("{name}: chi squared {chi:.0} of 255, largest correlation {most:.4}");
    }
}

/// As many workgroups as are dispatched reach every place in the list of the largest image, in rows that every
/// device takes.
#[test]
fn the_list_reaches_every_pixel_of_the_largest_image() {
    let glue = "uvec3 reached(uint at) { uvec2 n = groups_up_to(at); uint group = at / PIXELS_A_GROUP; \
                uvec2 id = uvec2(group % GROUPS_A_ROW, group / GROUPS_A_ROW); \
                return uvec3(place_in_list(id, at % PIXELS_A_GROUP), n); }";
    // The list's words behind its head, three a pixel, in the largest buffer.
    let most = ((STORAGE_BYTES - 80) / 12) as u32;
    assert!(most > 3840 * 2160);
    Function::new("common/lists.glsl", "uvec3 reached(uint at)")
        .glue(glue)
        .case(0_u32)
        .case(most - 1)
        .random(2_000, (0..most).prop_map(|at| at))
        .bits(|x| {
            let group = x[0] / 64;
            vec![x[0], (group + 1).min(16384), group / 16384 + 1]
        })
        .check(&device());
    assert!(most / 64 > GROUPS && most / 64 / 16384 < GROUPS, "a row alone would not do");
}

/// Workgroups that every device takes in a direction (maxComputeWorkGroupCount).
const GROUPS: u32 = 65_535;
