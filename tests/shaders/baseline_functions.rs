//! The GLSL functions of the baseline alone, beside their twins.

use antumbra::techniques::back_projection::twin::{
    filled_occlusion, level_of, level_side, level_start,
};
use antumbra::techniques::common::twin::{MapPlane, clearance};
use antumbra::techniques::pcss::twin::{disc_to_square, pixel_turn};
use antumbra_tests::compare::Tolerance;
use antumbra_tests::{Function, device};
use num_traits::Float;
use proptest::prelude::Strategy;

#[test]
fn a_disc_as_a_square() {
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        disc_to_square(x[0], x[1]).to_vec()
    }
    let prototype = "vec2 square_of(float radius, float turn)";
    let glue = "vec2 square_of(float radius, float turn) \
                { return disc_to_square(vec2(radius, turn)); }";
    Function::new("pcss/disc.glsl", prototype)
        .glue(glue)
        .case((1.0, 0.0))
        .case((0.5, 0.125))
        .case((1.0, 2.0))
        .random(5_000, (0.0..1.0_f32, 0.0..2.0_f32))
        // Turns up to 2 have a step of 2^-23, eight of which are one along the sides; where a turn
        // comes to a corner from either side both coordinates are the radius.
        .f32(Tolerance::absolute(1e-6), twin::<f32>)
        .f64(Tolerance::absolute(4e-6), twin::<f64>)
        .check(&device());
}

#[test]
fn turns_of_pixels() {
    let glue = "uint turn_of(uint x, uint y) { return floatBitsToUint(pixel_turn(x, y)); }";
    Function::new("pcss/disc.glsl", "uint turn_of(uint x, uint y)")
        .glue(glue)
        .case((0, 0))
        .random(5_000, (0..16384_u32, 0..16384_u32))
        .bits(|x| vec![pixel_turn(x[0], x[1]).to_bits()])
        .check(&device());
}

#[test]
fn clearance_above_a_receivers_plane() {
    let glue = "float clear_of(vec3 p, vec3 n, vec2 per, vec2 first, vec2 at, float w_o, \
                float reach) { return clearance(map_plane(p, n, true, per, first, 0.0, 0.0), at, w_o, reach); }";
    let prototype =
        "float clear_of(vec3 p, vec3 n, vec2 per, vec2 first, vec2 at, float w_o, float reach)";
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        let plane = MapPlane {
            position: [x[0], x[1], x[2]],
            normal: [x[3], x[4], x[5]],
            texels_per_uv: [x[6], x[7]],
            first: [x[8], x[9]],
        };
        vec![clearance(&plane, [x[10], x[11]], x[12], x[13])]
    }
    let position = (-2.0..2.0_f32, -2.0..2.0_f32, 1.0..4.0_f32);
    let normal = (-0.6..0.6_f32, -0.6..0.6_f32, -0.8..-0.5_f32);
    let map = (100.0..400.0_f32, 100.0..400.0_f32);
    let place = || (0.0..256.0_f32, 0.0..256.0_f32);
    Function::new("common/compare.glsl", prototype)
        .glue(glue)
        .random(10_000, (position, normal, map, place(), place(), 0.2..1.5_f32, 0.0..0.1_f32))
        // Sums of terms of a few units, each with the rounding of two products.
        .f32(Tolerance::absolute(8e-6), twin::<f32>)
        .f64(Tolerance::absolute(8e-6), twin::<f64>)
        .check(&device());
}

#[test]
fn occlusion_without_gaps() {
    let prototype = "float filled_occlusion(vec2 lo, vec2 t, float k, float k_left, float k_above, \
                     vec2 scale)";
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        vec![filled_occlusion([x[0], x[1]], [x[2], x[3]], x[4], [x[5], x[6]], [x[7], x[8]])]
    }
    let texel = (0..256_u32, 0..256_u32).prop_map(|(x, y)| (x as f32, y as f32));
    let near = (-6.0..6.0_f32, -6.0..6.0_f32);
    let cases = (texel, near, 0.3..3.0_f32, 0.0..3.0_f32, 0.0..3.0_f32, 0.05..0.2_f32).prop_map(
        |(lo, d, k, left, above, scale)| {
            // Half of the neighbours are not there.
            let some = |k: f32| if k < 1.0 { 0.0 } else { k };
            (lo, (lo.0 + d.0, lo.1 + d.1), k, some(left), some(above), (scale, scale))
        },
    );
    Function::new("back_projection/filled.glsl", prototype)
        .case(((0.0, 0.0), (0.5, 0.5), 0.0, 1.0, 1.0, (0.1, 0.1)))
        .random(20_000, cases)
        // Edges within ±½ of the light, each with the rounding of a difference of texels times three.
        .f32(Tolerance::absolute(2e-6), twin::<f32>)
        .f64(Tolerance::absolute(2e-5), twin::<f64>)
        .check(&device());
}

#[test]
fn levels_of_a_map() {
    let glue = "uvec3 levels_of(uint map, uint level) { return uvec3(level_side(int(map), \
                int(level)), level_start(int(map), int(level)), level_of(int(map))); }";
    Function::new("back_projection/levels.glsl", "uvec3 levels_of(uint map, uint level)")
        .glue(glue)
        .case((16, 1))
        .case((4096, 13))
        .random(2_000, (1..=4096_u32, 1..=13_u32))
        .bits(|x| vec![level_side(x[0], x[1]), level_start(x[0], x[1]), level_of(x[0])])
        .check(&device());
}
