//! GLSL functions alone, beside their twins; and the harness that does it, with wrong twins.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used)]

use antumbra::twin::numbers::{clamp_unit, interval_overlap_unit};
use antumbra_tests::compare::Tolerance;
use antumbra_tests::{Function, device};
use proptest::prelude::{Strategy, any};

#[test]
fn overlap_with_the_unit_interval() {
    Function::new("common/numbers.glsl", "float interval_overlap_unit(float a, float b)")
        .case((0.25, 0.75))
        .case((f32::MIN, f32::MAX))
        .random(10_000, (-2.0..3.0, -2.0..3.0))
        .f32(Tolerance::exact(), |x| vec![interval_overlap_unit(x[0], x[1])])
        .f64(Tolerance::absolute(6e-8), |x| vec![interval_overlap_unit(x[0], x[1])])
        .check(&device());
}

#[test]
fn clamp_to_the_unit_interval() {
    Function::new("common/numbers.glsl", "float clamp_unit(float x)")
        .case(f32::INFINITY)
        .random(1_000, any::<f32>().prop_filter("no NaN", |x| !x.is_nan()))
        .f32(Tolerance::exact(), |x| vec![clamp_unit(x[0])])
        .check(&device());
}

/// A twin that is wrong in one small corner is caught, and the report shows a case of that corner.
#[test]
fn a_wrong_twin_is_caught_with_a_case_that_shows_it() {
    let wrong = |x: &[f32]| vec![if x[0] > 2.9 { 0.125 } else { clamp_unit(x[0]) }];
    let problem = Function::new("common/numbers.glsl", "float clamp_unit(float x)")
        .random(10_000, -3.0..3.0)
        .f32(Tolerance::ulps(4), wrong)
        .try_check(&device())
        .unwrap_err();
    assert!(problem.contains("float clamp_unit(float x)"), "{problem}");
    assert!(problem.contains("the twin in f32"), "{problem}");
    assert!(problem.contains("worst:    [2.9"), "{problem}");
    assert!(problem.contains("found:    [1.0]\n  expected: [0.125]"), "{problem}");
}

/// One unit in the last place of one result is caught where nothing is allowed.
#[test]
fn a_twin_off_by_one_ulp_is_caught() {
    let off = |x: &[f32]| vec![clamp_unit(x[0]).next_up()];
    let function = Function::new("common/numbers.glsl", "float clamp_unit(float x)").case(0.5);
    let device = device();
    assert!(function.f32(Tolerance::exact(), off).try_check(&device).is_err());
    let function = Function::new("common/numbers.glsl", "float clamp_unit(float x)").case(0.5);
    assert!(function.f32(Tolerance::ulps(1), off).try_check(&device).is_ok());
}

/// GLSL's own functions stand for every type that can go in and out.
#[test]
fn every_kind_of_parameter_and_result_goes_through() {
    let device = device();
    let builtin = |prototype| Function::new("common/numbers.glsl", prototype);
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
