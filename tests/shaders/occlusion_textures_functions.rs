//! The GLSL functions of occlusion textures alone, beside their twins.

use antumbra::techniques::occlusion_textures::Combine;
use antumbra::techniques::occlusion_textures::twin::{
    bin_of, hidden_with, hidden_with_correlated, kernel_of, packed, slice_weight, solid_of,
    tile_kernel_of, tile_means, tile_sums,
};
use antumbra_tests::compare::Tolerance;
use antumbra_tests::{Function, device};
use num_traits::Float;
use proptest::prelude::{Just, Strategy, any};

#[test]
fn distances_lie_in_bins() {
    Function::new(
        "occlusion_textures/slices.glsl",
        "int bin_of(float stored, float near, float span)",
    )
    // The near plane, the far one, and what lies in front and behind.
    .case((1.0, 2.0, 1.0))
    .case((2.0 / 3.0, 2.0, 1.0))
    .case((1.5, 2.0, 1.0))
    .case((0.1, 2.0, 1.0))
    .random(4_000, (0.05..1.0f32, 0.5..4.0f32, 0.1..8.0f32))
    .f32(Tolerance::absolute(1.0), |x| vec![bin_of(x[0], x[1], x[2]) as f32])
    .check(&device());
}

#[test]
fn kernels_and_weights() {
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        let map = [x[0], x[1], x[2], x[3], x[4]];
        kernel_of(map, [x[5], x[6], x[7]], x[8], [x[9], x[10]]).to_vec()
    }
    let glue = "vec4 kernel(vec2 per, vec2 first, float eye, vec3 p, float plane, vec2 light)
{
    return kernel_of(MapWindow(per, first, eye, false), p, plane, light);
}";
    let map = ((50.0..300.0f32, 50.0..300.0f32), (0.0..256.0f32, 0.0..256.0f32), 0.0..2.0f32);
    let point = (-2.0..2.0f32, -2.0..2.0f32, 0.5..5.0f32);
    let all = (map, point, 0.2..5.0f32, (0.0..1.0f32, 0.0..1.0f32));
    Function::new(
        "occlusion_textures/slices.glsl",
        "vec4 kernel(vec2 per, vec2 first, float eye, vec3 p, float plane, vec2 light)",
    )
    .glue(glue)
    .random(4_000, all)
    // Up to 300 · 2 · 25 / 0.2 texels away, eight roundings of 2⁻²⁴.
    .f64(Tolerance::relative(1e-6).or_absolute(4e-2), twin::<f64>)
    .check(&device());
    fn weight<T: Float>(x: &[T]) -> Vec<T> {
        vec![slice_weight(x[0], x[1], x[2], x[3] != T::zero())]
    }
    let slices = (0.5..3.0f32, 0.02..0.5f32, 0.0..4.0f32, any::<bool>())
        .prop_map(|(upper, thick, z, blocks)| (z, upper, upper + thick, blocks));
    Function::new(
        "occlusion_textures/slices.glsl",
        "float slice_weight(float z, float upper, float lower, bool blocks)",
    )
    .random(4_000, slices)
    .f64(Tolerance::absolute(3e-5), weight::<f64>)
    .check(&device());
}

/// The kernel of a tile is what its twin says, and holds those of its points, in every plane above them.
#[test]
fn kernels_of_tiles_hold_those_of_their_points() {
    const LIGHT: [f64; 2] = [0.3, 0.7];
    let glue = "vec4 tile(vec2 per, vec2 first, float eye, vec3 p, vec3 q, float plane, out vec4 t, out float w)
{
    MapWindow m = MapWindow(per, first, eye, false);
    Tile tile = with_receiver(empty_tile(), centred(m, p, 1.0 / p.z), 1.0 / p.z);
    tile = rounded_tile(with_receiver(tile, centred(m, q, 1.0 / q.z), 1.0 / q.z));
    t = vec4(tile.t_min, tile.t_max);
    w = tile.w.x;
    return tile_kernel(m, tile, plane, vec2(0.3, 0.7));
}";
    let prototype = "vec4 tile(vec2 per, vec2 first, float eye, vec3 p, vec3 q, float plane, out vec4 t, out float w)";
    let map = ((50.0..300.0f32, 50.0..300.0f32), (0.0..256.0f32, 0.0..256.0f32), 0.0..2.0f32);
    let point = || (-2.0..2.0f32, -2.0..2.0f32, 2.0..5.0f32);
    let cases = (map, point(), point(), 0.2..5.0f32);
    let test =
        Function::new("occlusion_textures/slices.glsl", prototype).glue(glue).random(4_000, cases);
    for case in test.outputs(&device()) {
        let (i, o) = (&case.input, &case.output);
        let map: [f64; 5] = std::array::from_fn(|k| i[k]);
        let (held, t) = (&o[..4], [o[4], o[5], o[6], o[7]]);
        for p in [[i[5], i[6], i[7]], [i[8], i[9], i[10]]] {
            let own = kernel_of(map, p, i[11], LIGHT);
            assert!(held[0] <= own[0] && held[1] <= own[1], "{i:?}: {held:?}, {own:?}");
            assert!(held[2] >= own[2] && held[3] >= own[3], "{i:?}: {held:?}, {own:?}");
        }
        let twin = tile_kernel_of(map, t, o[8], i[11], LIGHT);
        for (a, b) in held.iter().zip(twin) {
            assert!((a - b).abs() < 2e-3, "{i:?}: {held:?}, {twin:?}");
        }
    }
}

/// What levels are interpolated from around a kernel lies within the reach that tiles take for them.
#[test]
fn levels_reach_no_further_than_tiles_look() {
    for shorter in (10..40_000).map(|s| 0.01 * f64::from(s)) {
        let window = 2f64.powi(shorter.max(1.0).log2() as i32 + 1);
        let reach = 3.0 * shorter.max(1.0) + 1.0;
        // N-buffers move into the map, by a window at most; a node of a mip pyramid begins up to a window and
        // a half before what is asked for.
        assert!(window + 1.0 <= reach && 1.5 * window <= reach, "{shorter}");
    }
    Function::new("occlusion_textures/slices.glsl", "float level_reach(float shorter)")
        .random(1_000, 0.1..400.0f32)
        .f64(Tolerance::relative(3e-7), |x| vec![3.0 * x[0].max(1.0) + 1.0])
        .check(&device());
}

#[test]
fn combinations() {
    for (code, combine) in [(0, Combine::Product), (1, Combine::Sum), (2, Combine::Max)] {
        Function::new(
            "occlusion_textures/slices.glsl",
            "float hidden_with(int combine, float hidden, float more)",
        )
        .random(1_000, (Just(code), 0.0..=1.0f32, 0.0..=1.0f32))
        .f64(Tolerance::absolute(2e-7), move |x| vec![hidden_with(combine, x[1], x[2])])
        .check(&device());
    }
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        vec![hidden_with_correlated(x[0], x[1], [x[2], x[3], x[4]])]
    }
    // Shares as a window has them: what both block is between what they must and what they can.
    let share = || 0.0..=1.0f32;
    let windows = (share(), share(), share(), share(), share()).prop_map(
        |(hidden, before, own, covered, t)| {
            let (least, most) = ((own + covered - 1.0).max(0.0), own.min(covered));
            (hidden, before, (own, covered, least + t * (most - least)))
        },
    );
    Function::new(
        "occlusion_textures/slices.glsl",
        "float hidden_with_correlated(float hidden, float before, vec3 window)",
    )
    .case((0.0, 0.0, (0.0, 0.0, 0.0)))
    .case((1.0, 1.0, (1.0, 1.0, 1.0)))
    .random(4_000, windows)
    // The share of two small differences: 2⁻²⁴ over 10⁻³, times a difference of up to a quarter.
    .f64(Tolerance::absolute(1e-4), twin::<f64>)
    .check(&device());
}

#[test]
fn columns_of_faces() {
    let glue = "uint column(uvec4 fronts, uvec4 backs)
{
    Column c = Column(0u, 0u, 0);
    for (int i = 0; i < 4; ++i) {
        c = walk(c, i, int(fronts[i]), int(backs[i]));
    }
    return solid_of(c) & 15u;
}";
    let four = || (0..3u32, 0..3u32, 0..3u32, 0..3u32);
    Function::new("occlusion_textures/solid.glsl", "uint column(uvec4 fronts, uvec4 backs)")
        .glue(glue)
        // A box, a box in one slice, two boxes, a sheet, a box above an open sheet.
        .case(((1, 0, 0, 0), (0, 0, 0, 1)))
        .case(((0, 1, 0, 0), (0, 1, 0, 0)))
        .case(((1, 0, 1, 0), (0, 1, 0, 1)))
        .case(((0, 1, 0, 0), (0, 0, 0, 0)))
        .case(((1, 0, 0, 1), (0, 1, 0, 0)))
        .random(4_000, (four(), four()))
        .bits(|x| {
            let faces: Vec<_> = (0..4).map(|i| (x[i], x[4 + i])).collect();
            vec![solid_of(&faces)]
        })
        .check(&device());
}

/// A mask, a tile, and whether it holds correlated slices, `each` of them.
fn tiles(each: i32) -> impl Strategy<Value = (u32, i32, bool)> {
    (any::<u32>(), any::<bool>()).prop_flat_map(move |(mask, correlated)| {
        (Just(mask), 0..if correlated { 32 / each } else { 8 }, Just(correlated))
    })
}

#[test]
fn tiles_hold_slices() {
    let glue = "uvec4 sums(uint mask, int tile, bool correlated)
{
    Sums s = tile_sums(mask, tile, correlated);
    return uvec4(s.four.xy, s.four.z << 1 | s.four.w, s.fifth);
}";
    let file = "occlusion_textures/tile.glsl";
    Function::new(file, "uvec4 sums(uint mask, int tile, bool correlated)")
        .glue(glue)
        .case((u32::MAX, 15, true))
        .case((1, 0, true))
        .case((1, 1, true))
        .random(4_000, tiles(2))
        .bits(|x| {
            let [a, b, c, d, e] = tile_sums(x[0], x[1], x[2] != 0);
            vec![a, b, c << 1 | d, e]
        })
        .check(&device());
    Function::new(file, "uvec4 tile_means(uint mask, int tile, bool correlated)")
        .case((u32::MAX, 31, true))
        .case((1, 0, true))
        .case((1, 1, true))
        .random(4_000, tiles(1))
        .bits(|x| tile_means(x[0], x[1], x[2] != 0).to_vec())
        .check(&device());
}

/// Five sums of up to 2²⁴ in 128 bits, there and back.
#[test]
fn five_sums_fit_into_a_texel() {
    let sum = || 0..=1u32 << 24;
    let file = "occlusion_textures/tile.glsl";
    Function::new(file, "uvec4 texel(uvec4 four, uint fifth)")
        .glue("uvec4 texel(uvec4 four, uint fifth) { return packed(Sums(four, fifth)); }")
        .case(((1 << 24, 1 << 24, 1 << 24, 1 << 24), 1 << 24))
        .random(4_000, ((sum(), sum(), sum(), sum()), sum()))
        .bits(|x| packed([x[0], x[1], x[2], x[3], x[4]]).to_vec())
        .check(&device());
    Function::new(file, "uvec4 sums(uvec4 four, uint fifth)")
        .glue(
            "uvec4 sums(uvec4 four, uint fifth)
{
    Sums s = unpacked(packed(Sums(four, fifth)));
    return uvec4(s.four.xyz, s.fifth ^ s.four.w << 1);
}",
        )
        .random(4_000, ((sum(), sum(), sum(), sum()), sum()))
        .bits(|x| vec![x[0], x[1], x[2], x[4] ^ x[3] << 1])
        .check(&device());
}

/// Where the right answer is known: a pair of slices that are independent, identical (one behind the other)
/// or disjoint. The published product is right only for the first.
#[test]
fn pairs_of_slices_of_which_the_answer_is_known() {
    for (a, b) in [(0.3, 0.3), (0.5, 0.2), (0.05, 0.9), (0.4, 0.6), (0.25, 0.5)] {
        let of = |both: f64, before: f64| hidden_with_correlated(a, before, [b, a, both]);
        let (lesser, greater) = (f64::min(a, b), f64::max(a, b));
        let independent = a + b - a * b;
        assert!((of(a * b, 0.0) - independent).abs() < 1e-12, "independent: {a}, {b}");
        // FEW of 10⁻³ beside a share of at least 0.03.
        assert!((of(lesser, lesser) - greater).abs() < 5e-3, "nested: {a}, {b}");
        let apart = (a + b).min(1.0);
        assert!((of((a + b - 1.0).max(0.0), 0.0) - apart).abs() < 5e-3, "disjoint: {a}, {b}");
        let product = hidden_with(Combine::Product, a, b);
        assert!((product - greater).abs() > 4e-3 && (product - apart).abs() > 4e-3);
    }
    // However many slices: four quarters side by side hide all, a solid through four hides its own share.
    let (mut side_by_side, mut solid) = (0.0, 0.0);
    for k in 0..4 {
        side_by_side = hidden_with_correlated(side_by_side, 0.25, [0.25, 0.25 * f64::from(k), 0.0]);
        let above = if k == 0 { 0.0 } else { 0.25 };
        solid = hidden_with_correlated(solid, above, [0.25, above, above]);
    }
    assert!((side_by_side - 1.0).abs() < 0.02, "{side_by_side}");
    assert!((solid - 0.25).abs() < 1e-3, "{solid}");
}
