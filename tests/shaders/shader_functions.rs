//! GLSL functions alone, beside their twins; and the harness that does it, with wrong twins.

use antumbra::techniques::common::twin::{
    dehomogenize, fraction_above, fraction_of_disc_above, normal_of_plane, on_disc, plane_normal,
    towards_viewer, unfolded, unproject,
};
use antumbra::techniques::common::twin::{magnification, overlap, patch_occlusion};
use antumbra::techniques::soft_shadow_map::twin::{
    Kind, Node, Tile, classify, merged_sides, rectangle_mask, series,
};
use antumbra_tests::compare::Tolerance;
use antumbra_tests::{Function, device};
use glam::Vec3;
use num_traits::Float;
use proptest::prelude::{Just, Strategy, any};

type Pair = (f32, f32);
type Triple = (f32, f32, f32);

/// A micro-patch and a receiver as scenes have them: within a few windows of the light, in front of
/// the receiver and behind it.
fn patches() -> impl Strategy<Value = (Pair, f32, Pair, f32, Pair)> {
    let texel = (0.0..256.0_f32, 0.0..256.0_f32);
    let receiver = (-20.0..276.0_f32, -20.0..276.0_f32);
    (texel, 0.05..4.0_f32, receiver, 0.05..2.0_f32, (0.001..0.2_f32, 0.001..0.2_f32))
}

#[test]
fn magnification_of_a_patch() {
    Function::new("common/light_space.glsl", "float magnification(float w_o, float w_r)")
        .case((1.0, 0.5))
        .random(5_000, (1.0..4.0, 0.01..0.99))
        // A division may be off by 2.5 units in the last place (Vulkan, precision of operations).
        .f32(Tolerance::ulps(3), |x| vec![magnification(x[0], x[1])])
        .check(&device());
}

#[test]
fn overlap_with_the_light() {
    Function::new("common/light_space.glsl", "float overlap(float a, float b)")
        .case((-0.25, 0.25))
        .case((f32::MIN, f32::MAX))
        .random(10_000, (-2.0..3.0, -2.0..3.0))
        .f32(Tolerance::exact(), |x| vec![overlap(x[0], x[1])])
        .f64(Tolerance::absolute(6e-8), |x| vec![overlap(x[0], x[1])])
        .check(&device());
}

#[test]
fn occlusion_by_a_patch() {
    let prototype =
        "float patch_occlusion(vec2 lo, vec2 hi, float w_o, vec2 t, float w_r, vec2 scale)";
    let cases = patches().prop_map(|(lo, w_o, t, w_r, scale)| {
        let lo = (lo.0.floor(), lo.1.floor());
        (lo, (lo.0 + 1.0, lo.1 + 1.0), w_o, t, w_r, scale)
    });
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        vec![patch_occlusion([x[0], x[1]], [x[2], x[3]], x[4], [x[5], x[6]], x[7], [x[8], x[9]])]
    }
    Function::new("common/light_space.glsl", prototype)
        .case(((0.0, 0.0), (1.0, 1.0), 1.0, (0.5, 0.5), 0.5, (0.1, 0.1)))
        .random(20_000, cases)
        // An edge at the light's rim, ±½, carries the rounding of three factors: a few 2^-24 of ½,
        // and 1/(w_o − w_r) magnifies that of w where the two are close.
        .f32(Tolerance::absolute(2e-6), twin::<f32>)
        .f64(Tolerance::absolute(2e-6), twin::<f64>)
        .check(&device());
}

#[test]
fn both_sides_merged() {
    let any = (0.0..1.3_f32, 0.0..1.3_f32, 0.0..1.3_f32, 0.0..1.3_f32);
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        (0..4).map(|i| merged_sides(x[i], x[4 + i])).collect()
    }
    // The mean; umbra by either; half way between; a sum above 1.
    Function::new("common/light_space.glsl", "vec4 merged_sides(vec4 front, vec4 back)")
        .case(((0.2, 1.0, 0.95, 1.2), (0.4, 0.5, 0.55, 1.0)))
        .random(10_000, (any.clone(), any))
        .f32(Tolerance::absolute(2e-6), twin::<f32>)
        .f64(Tolerance::absolute(2e-6), twin::<f64>)
        .check(&device());
    assert!((merged_sides(0.2_f64, 0.4) - 0.3).abs() < 1e-12);
    assert!((merged_sides(1.0_f64, 0.5) - 1.0).abs() < 1e-12);
    assert!((merged_sides(0.95_f64, 0.55) - 0.85).abs() < 1e-12);
}

#[test]
fn parts_and_points_of_discs() {
    let slope = ((-2.0..2.0f32, -2.0..2.0f32), -2.5..2.5f32);
    Function::new("ray_march/noise.glsl", "float fraction_of_disc_above(vec2 slope, float c)")
        .case(([0.0, 0.0], 0.0))
        .case(([1.0, 0.0], 0.0))
        .random(2_000, slope.prop_map(|((x, y), c)| ([x, y], c)))
        // Drivers' arc cosines are off by 2^-11 of a radian, at most.
        .f32(Tolerance::absolute(4e-4), |x| vec![fraction_of_disc_above([x[0], x[1]], x[2])])
        .check(&device());
    Function::new("ray_march/noise.glsl", "vec2 on_disc(vec2 q)")
        .case(([0.0, 0.0],))
        .case(([1.0, 1.0],))
        .random(2_000, (-1.0..1.0f32, -1.0..1.0f32).prop_map(|(x, y)| ([x, y],)))
        // Sines and cosines may be off by 2^-11, as Vulkan allows.
        .f32(Tolerance::absolute(5e-4), |x| on_disc([x[0], x[1]]).to_vec())
        .check(&device());
}

#[test]
fn part_of_the_light_above_a_plane() {
    let flat = (-1.0..1.0_f32, -1e-6..1e-6_f32);
    let any = (-1.0..1.0_f32, -1.0..1.0_f32);
    for slope in [any, flat] {
        Function::new("common/light_space.glsl", "float fraction_above(vec2 slope, float c)")
            .case(((0.0, 0.0), -1.0))
            .case(((0.0, 0.0), 1.0))
            .case(((1.0, 1.0), 0.0))
            .random(10_000, (slope, -2.0..2.0_f32))
            .f32(Tolerance::absolute(1e-6), |x| vec![fraction_above([x[0], x[1]], x[2])])
            .f64(Tolerance::absolute(2e-6), |x| vec![fraction_above([x[0], x[1]], x[2])])
            .check(&device());
    }
}

#[test]
fn pixels_to_light_space() {
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        unproject(&x[..16], [x[16], x[17]], [x[18], x[19]], x[20]).to_vec()
    }
    Function::new(
        "common/light_space.glsl",
        "vec4 unproject(mat4 light_from_ndc, vec2 pixel, vec2 extent, float depth)",
    )
    .random(
        5_000,
        (
            proptest::array::uniform16(-2.0_f32..2.0),
            (0.0..640.0_f32, 0.0..480.0_f32),
            (640.0..641.0_f32, 480.0..481.0_f32),
            0.0..1.0_f32,
        ),
    )
    // Four products of at most 2, each with the rounding of a coordinate within ±1.
    .f32(Tolerance::absolute(4e-6), twin::<f32>)
    .f64(Tolerance::absolute(4e-6), twin::<f64>)
    .check(&device());
}

#[test]
fn normals_face_the_viewer() {
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        let v = |i: usize| [x[i], x[i + 1], x[i + 2]];
        plane_normal(v(0), v(3), v(6)).to_vec()
    }
    let step = || (-1.0..1.0_f32, -1.0..1.0_f32, -1.0..1.0_f32);
    // Steps that are nearly parallel lose digits to cancellation in their cross product.
    let apart = |x: &(Triple, Triple, Triple)| {
        let (a, b, c) = (Vec3::from(x.0), Vec3::from(x.1), Vec3::from(x.2));
        let n = a.cross(b);
        n.length() > 0.1 && n.normalize().dot(c).abs() > 1e-3
    };
    let steps = (step(), step(), step()).prop_filter("neither parallel nor edge-on", apart);
    // Scenes of any scale: whose squares of squares would not be floats.
    let scaled = (steps.clone(), -30..=30_i32).prop_map(|((a, b, c), exponent)| {
        let scale = |v: Triple| -> Triple { (Vec3::from(v) * 10.0_f32.powi(exponent)).into() };
        (scale(a), scale(b), c)
    });
    Function::new(
        "common/light_space.glsl",
        "vec3 plane_normal(vec3 along_x, vec3 along_y, vec3 to_viewer)",
    )
    .case(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)))
    .random(5_000, steps)
    .random(5_000, scaled)
    .f32(Tolerance::absolute(4e-6), twin::<f32>)
    .f64(Tolerance::absolute(4e-6), twin::<f64>)
    .check(&device());
}

#[test]
fn planes_of_the_image_turn_into_normals() {
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        normal_of_plane(&x[..12], [x[12], x[13]], x[14], [x[15], x[16]]).to_vec()
    }
    let glue = "vec3 turned(vec4 x, vec4 y, vec4 z, vec2 pixel, float depth, vec2 steps) \
                { return normal_of_plane(mat3x4(x, y, z), pixel, depth, steps); }";
    let prototype = "vec3 turned(vec4 x, vec4 y, vec4 z, vec2 pixel, float depth, vec2 steps)";
    // A camera that looks along z with reversed depth, its centre at (320, 240): a plane through a pixel.
    let camera = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (-0.5, -0.4, 0.0, 1e-3));
    let steps = (-1e-4..1e-4_f32, -1e-4..1e-4_f32);
    let pixel = (0..640_u32, 0..480_u32).prop_map(|(x, y)| (x as f32, y as f32));
    let cases = (pixel, 0.01..1.0_f32, steps)
        .prop_map(move |(pixel, depth, steps)| (camera.0, camera.1, camera.2, pixel, depth, steps));
    Function::new("common/light_space.glsl", prototype)
        .glue(glue)
        .case((camera.0, camera.1, camera.2, (0.0, 0.0), 0.5, (0.0, 0.0)))
        .random(5_000, cases)
        // The depth at the image's corner is a difference of numbers up to 1; steps are as small as 1e-4 of it.
        .f32(Tolerance::absolute(2e-3), twin::<f32>)
        .f64(Tolerance::absolute(2e-3), twin::<f64>)
        .check(&device());
}

#[test]
fn octahedra_unfold() {
    Function::new("common/light_space.glsl", "vec3 unfolded(vec2 flat_n)")
        .case(((0.0, 0.0),))
        .case(((1.0, 0.0),))
        .case(((-1.0, -1.0),))
        .case(((0.5, -0.5),))
        .random(5_000, ((-1.0..1.0_f32, -1.0..1.0_f32),))
        .f32(Tolerance::absolute(4e-7), |x| unfolded([x[0], x[1]]).to_vec())
        .f64(Tolerance::absolute(4e-7), |x| unfolded([x[0], x[1]]).to_vec())
        .check(&device());
}

#[test]
fn homogeneous_points_and_the_eye() {
    Function::new("common/light_space.glsl", "vec3 dehomogenize(vec4 p)")
        .random(2_000, (-9.0..9.0_f32, -9.0..9.0_f32, -9.0..9.0_f32, 0.1..9.0_f32))
        .f32(Tolerance::ulps(3), |x| dehomogenize([x[0], x[1], x[2], x[3]]).to_vec())
        .check(&device());
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        towards_viewer(&x[..16], [x[16], x[17], x[18]], x[19]).to_vec()
    }
    let matrix = |w: f32| {
        let mut m = [0.5; 16];
        m[8..12].copy_from_slice(&[1.0, 2.0, 3.0, w]);
        m
    };
    let p = (0.25, -0.5, 4.0);
    Function::new(
        "common/light_space.glsl",
        "vec3 towards_viewer(mat4 light_from_ndc, vec3 p, float background)",
    )
    .case((matrix(2.0), p, 0.0))
    .case((matrix(-2.0), p, 1.0))
    .case((matrix(0.0), p, 0.0))
    .case((matrix(0.0), p, 1.0))
    .f32(Tolerance::ulps(3), twin::<f32>)
    .f64(Tolerance::absolute(1e-6), twin::<f64>)
    .check(&device());
}

#[test]
fn the_series_of_a_node() {
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        (0..4).map(|i| series([x[0], x[1], x[2], x[3]], x[4], x[5 + i])).collect()
    }
    let moments = (1.0..64.0_f32, -0.1..0.1_f32, 0.0..0.05_f32, -0.01..0.01_f32);
    let w_r = (0.1..1.0_f32, 0.1..1.0_f32, 0.1..1.0_f32, 0.1..1.0_f32);
    Function::new("soft_shadow_map/node.glsl", "vec4 series(vec4 s, float mean, vec4 w_r)")
        .random(5_000, (moments, 1.5..3.0_f32, w_r))
        .f32(Tolerance::relative(2e-6), twin::<f32>)
        .f64(Tolerance::relative(2e-6), twin::<f64>)
        .check(&device());
}

#[test]
fn texels_of_a_rectangle() {
    let glue = "uvec2 mask_of(uint x0, uint y0, uint x1, uint y1) { \
                return rectangle_mask(ivec2(x0, y0), ivec2(x1, y1)); }";
    let prototype = "uvec2 mask_of(uint x0, uint y0, uint x1, uint y1)";
    let sides = || (0..=8_u32, 0..=8_u32);
    let corners = (sides(), sides())
        .prop_map(|(x, y)| (x.0.min(x.1), y.0.min(y.1), x.0.max(x.1), y.0.max(y.1)));
    Function::new("soft_shadow_map/node.glsl", prototype)
        .glue(glue)
        .case((0, 0, 8, 8))
        .case((3, 4, 3, 8))
        .random(3_000, corners)
        .bits(|x| {
            let mask = rectangle_mask([x[0], x[1]], [x[2], x[3]]);
            vec![mask as u32, (mask >> 32) as u32]
        })
        .check(&device());
}

#[test]
fn how_a_node_lies_to_its_receivers() {
    let glue = "int kind_of(vec4 a, vec2 lo, float side, vec4 t, vec2 w_r, vec2 scale, float spread) \
                { return classify(Node(a.x, a.y, a.z, a.w, 0.0, 0.0, uvec2(0u)), lo, side, t.xy, \
                t.zw, w_r, scale, spread); }";
    let prototype =
        "int kind_of(vec4 a, vec2 lo, float side, vec4 t, vec2 w_r, vec2 scale, float spread)";
    fn twin(x: &[f32]) -> Vec<f32> {
        let node = Node { count: x[0], w: [x[1], x[2], x[3]], lo: [x[4], x[5]], side: x[6] };
        let tile = Tile { t_min: [x[7], x[8]], t_max: [x[9], x[10]], w: [x[11], x[12]] };
        let kind = classify(&node, &tile, [x[13], x[14]], x[15]);
        vec![match kind {
            Kind::Outside => 0.0,
            Kind::Inside => 1.0,
            Kind::Mixed => 2.0,
        }]
    }
    // Nodes 0.8 to 1.2 times as near as a mean of 1/m, receivers behind and beside them; powers of two
    // keep the comparisons away from the rounding of a division.
    let node = (0..3_u32, 0.5..1.0_f32, 0.0..0.25_f32).prop_map(|(count, mean, deviation)| {
        (count as f32 * 8.0, mean, mean - deviation, mean + deviation)
    });
    let lo = (0..32_u32, 0..32_u32).prop_map(|(x, y)| (x as f32 * 8.0, y as f32 * 8.0));
    let tile = (0.0..256.0_f32, 0.0..256.0_f32, 0.0..8.0_f32)
        .prop_map(|(x, y, size)| (x, y, x + size, y + size));
    let w_r = (0.1..0.6_f32, 0.0..0.1_f32).prop_map(|(w, more)| (w, w + more));
    let scale = (0..6_i32, 0..6_i32).prop_map(|(x, y)| (2f32.powi(-x - 6), 2f32.powi(-y - 6)));
    let cases = (node, lo, Just(8.0_f32), tile, w_r, scale, 0.01..0.5_f32);
    let test =
        Function::new("soft_shadow_map/node.glsl", prototype).glue(glue).random(20_000, cases);
    let device = device();
    let outputs = test.outputs(&device);
    for kind in [0.0, 1.0, 2.0] {
        let count = outputs.iter().filter(|c| c.output[0] == kind).count();
        assert!(count > 200, "only {count} cases of kind {kind}");
    }
    test.f32(Tolerance::exact(), twin).check(&device);
}

/// A twin that is wrong in one small corner is caught, and the report shows a case of that corner.
#[test]
fn a_wrong_twin_is_caught_with_a_case_that_shows_it() {
    let wrong = |x: &[f32]| vec![if x[0] > 2.9 { 0.125 } else { x[0].abs() }];
    let problem = Function::new("common/light_space.glsl", "float abs(float x)")
        .random(10_000, -3.0..3.0)
        .f32(Tolerance::ulps(4), wrong)
        .try_check(&device())
        .unwrap_err();
    assert!(problem.contains("float abs(float x)"), "{problem}");
    assert!(problem.contains("the twin in f32"), "{problem}");
    assert!(problem.contains("worst:    x = 2.9"), "{problem}");
    assert!(problem.contains("expected: returned = 0.125"), "{problem}");
}

/// A failure names the inputs by their parameters and stands before what passed, in the order of the checks.
#[test]
fn a_failure_comes_first_with_its_names() {
    let abs = || Function::new("common/light_space.glsl", "float abs(float x)").case(-0.5);
    let device = device();
    abs().f32(Tolerance::exact(), |x| vec![x[0].abs()]).check(&device);
    let wrong = abs().f32(Tolerance::exact(), |_| vec![0.25]);
    let checked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| wrong.check(&device)));
    let panic = checked.unwrap_err();
    let text = panic.downcast_ref::<String>().unwrap();
    let at = |part: &str| text.find(part).unwrap_or_else(|| panic!("no {part:?} in:\n{text}"));
    let order =
        ["1 of 1 cases differ", "x = -0.5", "returned = 0.5", "returned = 0.25", "passed before"];
    assert!(order.map(at).is_sorted(), "{text}");
    assert!(text.ends_with("against the twin in f32: 1 cases, the same in all"), "{text}");
}

/// One unit in the last place of one result is caught where nothing is allowed.
#[test]
fn a_twin_off_by_one_ulp_is_caught() {
    let off = |x: &[f32]| vec![x[0].abs().next_up()];
    let function = Function::new("common/light_space.glsl", "float abs(float x)").case(0.5);
    let device = device();
    assert!(function.f32(Tolerance::exact(), off).try_check(&device).is_err());
    let function = Function::new("common/light_space.glsl", "float abs(float x)").case(0.5);
    assert!(function.f32(Tolerance::ulps(1), off).try_check(&device).is_ok());
}

/// GLSL's own functions stand for every type that can go in and out.
#[test]
fn every_kind_of_parameter_and_result_goes_through() {
    let device = device();
    let builtin = |prototype| Function::new("common/light_space.glsl", prototype);
    builtin("vec3 cross(vec3 a, vec3 b)")
        .case(([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
        .f32(Tolerance::exact(), |_| vec![0.0, 0.0, 1.0])
        .check(&device);
    builtin("mat4 transpose(mat4 m)")
        .random(100, proptest::array::uniform16(-1.0_f32..1.0))
        .f32(Tolerance::exact(), |m| (0..16).map(|i| m[i % 4 * 4 + i / 4]).collect())
        .check(&device);
    builtin("int bitCount(uint x)")
        .random(1_000, any::<u32>())
        .bits(|x| vec![x[0].count_ones()])
        .check(&device);
    builtin("ivec2 abs(ivec2 x)")
        .case([-7, 9])
        .f64(Tolerance::exact(), |x| vec![x[0].abs(), x[1].abs()])
        .check(&device);
    builtin("bool isnan(float x)")
        .case(f32::NAN)
        .case(1.0)
        .f32(Tolerance::exact(), |x| vec![f32::from(x[0].is_nan())])
        .check(&device);
    builtin("float modf(float x, out float whole)")
        .case(2.75)
        .f32(Tolerance::exact(), |x| vec![x[0].fract(), x[0].trunc()])
        .check(&device);
    let cases = builtin("uint floatBitsToUint(float x)").case(1.0).outputs(&device);
    assert_eq!(cases[0].output, [f64::from(0x3f80_0000)]);
}
