//! Numbers worked out by hand, and wrong images that must be noticed.

use antumbra::truth::metrics::*;

/// Values are multiples of 1/8 where exactness is wanted: their differences are exact.
const TRUTH: [f32; 8] = [1.0, 1.0, 1.0, 0.75, 0.5, 0.25, 0.0, 0.0];

fn between(image: &[f32]) -> ErrorSummary {
    ErrorSummary::between(&TRUTH, image, None).unwrap()
}

#[test]
fn the_truth_has_no_error_and_its_lit_pixels_are_not_counted() {
    let same = between(&TRUTH);
    let expected =
        ErrorSummary { pixels: 5, penumbra_pixels: 3, lit_pixels: 3, ..ErrorSummary::default() };
    assert_eq!(same, expected);
}

#[test]
fn every_number_is_what_a_hand_gets() {
    //         counted:  no   yes   no   yes  yes  yes   yes   yes
    let image = [1.0, 0.5, 1.0, 1.0, 0.5, 0.0, 0.25, 0.0];
    // errors:            -.5        .25   0   -.25  .25   0
    let e = between(&image);
    assert_eq!(e.pixels, 6);
    assert_eq!(e.mean_abs_error, 1.25 / 6.0);
    assert_eq!(e.rmse, ((0.25 + 3.0 * 0.0625) / 6.0_f64).sqrt());
    assert_eq!((e.p99, e.worst), (0.5, 0.5));
    assert_eq!(e.bias, -0.25 / 6.0);
    assert_eq!((e.penumbra_pixels, e.penumbra_mean), (3, 0.5 / 3.0));
    // The 0.25 called umbra; the 0.75 called lit.
    assert_eq!((e.false_umbra, e.false_light), (1.0 / 6.0, 1.0 / 6.0));
    assert_eq!((e.lit_pixels, e.lit_error), (3, 0.5 / 3.0));
}

#[test]
fn wrong_images_are_noticed_each_by_the_number_that_is_about_it() {
    let all_lit = between(&[1.0; 8]);
    assert_eq!((all_lit.false_light, all_lit.lit_error), (1.0, 0.0));
    assert_eq!(all_lit.bias, all_lit.mean_abs_error);

    let all_dark = between(&[0.0; 8]);
    // All 8 count, as the image puts them in shadow; the two true umbra pixels are right.
    assert_eq!((all_dark.pixels, all_dark.false_umbra), (8, 0.75));
    assert_eq!((all_dark.lit_error, all_dark.bias), (1.0, -all_dark.mean_abs_error));

    let occlusion = between(&TRUTH.map(|v| 1.0 - v));
    assert_eq!((occlusion.worst, occlusion.lit_error), (1.0, 1.0));

    let mut shifted = TRUTH;
    shifted.rotate_left(1);
    assert!(between(&shifted).mean_abs_error > 0.1);

    // Errors that cancel in the mean are seen by the others.
    let cancelling = between(&[1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.0, 0.0]);
    assert_eq!((cancelling.bias, cancelling.mean_abs_error), (0.0, 0.1));
    // Sums that leave 0..1 are errors, not clamped away.
    assert_eq!(between(&[1.0, 1.0, 1.25, 0.75, 0.5, 0.25, 0.0, 0.0]).lit_error, 0.25 / 3.0);
}

#[test]
fn rounding_of_lit_pixels_does_not_dilute_the_mean() {
    let mut image = TRUTH;
    image[..3].fill(1.0 - FULL_TOLERANCE / 2.0);
    image[4] = 0.625;
    let e = between(&image);
    assert_eq!((e.pixels, e.mean_abs_error), (5, 0.025));
    assert!(e.lit_error > 0.0);
}

#[test]
fn the_percentile_is_the_nearest_rank() {
    let truth = vec![0.0; 200];
    let image: Vec<f32> = (1..=200).map(|i| i as f32 / 256.0).collect();
    let e = ErrorSummary::between(&truth, &image, None).unwrap();
    assert_eq!((e.p99, e.worst), (198.0 / 256.0, 200.0 / 256.0));
    let one = ErrorSummary::between(&[0.5], &[0.25], None).unwrap();
    assert_eq!((one.p99, one.worst), (0.25, 0.25));
}

#[test]
fn the_mask_hides_pixels_and_whatever_they_hold() {
    let mut image = TRUTH;
    image[0] = f32::NAN;
    image[5] = 1.0;
    let mut mask = [true; 8];
    (mask[0], mask[5]) = (false, false);
    let e = ErrorSummary::between(&TRUTH, &image, Some(&mask)).unwrap();
    assert_eq!((e.pixels, e.lit_pixels, e.worst), (4, 2, 0.0));
    let nothing = ErrorSummary::between(&TRUTH, &image, Some(&[false; 8])).unwrap();
    assert_eq!(nothing, ErrorSummary::default());
}

#[test]
fn unusable_input_is_refused_with_the_pixel_named() {
    let refusal = |truth: &[f32], image: &[f32], mask: Option<&[bool]>| {
        ErrorSummary::between(truth, image, mask).unwrap_err().to_string()
    };
    assert!(refusal(&[1.0, 1.0], &[1.0], None).contains("the image must have as many"));
    assert!(refusal(&[1.0], &[1.0], Some(&[])).contains("the mask must have as many"));
    assert!(refusal(&[1.0, 1.0], &[1.0, f32::NAN], None).contains("image at pixel 1"));
    assert!(refusal(&[1.0, f32::NAN], &[1.0, 1.0], None).contains("truth at pixel 1"));
    assert!(refusal(&[1.0, 1.5], &[1.0, 1.0], None).contains("truth at pixel 1"));
}

/// Σ E |e| / Σ E over the pixels that count: those of index 1, 3 to 7 (see `every_number_is_what_a_hand_gets`).
#[test]
fn the_seen_error_weighs_each_counted_pixel_by_its_light() {
    let image = [1.0, 0.5, 1.0, 1.0, 0.5, 0.0, 0.25, 0.0];
    let seen = |irradiance: &[f64], mask| seen_error(&TRUTH, &image, irradiance, mask);
    // Errors: 0.5 of weight 2, 0.25 of weight 4 and 0 of weight 10; what is lit in both has none, however bright.
    let light = [99.0, 2.0, 99.0, 4.0, 5.0, 0.0, 0.0, 5.0];
    assert_eq!(seen(&light, None).unwrap(), (2.0 * 0.5 + 4.0 * 0.25) / 16.0);
    // Another unit changes nothing, and neither does a mask but for what it hides.
    assert_eq!(seen(&light.map(|e| 8.0 * e), None).unwrap(), 2.0 / 16.0);
    let mut mask = [true; 8];
    mask[1] = false;
    assert_eq!(seen(&light, Some(&mask)).unwrap(), 1.0 / 14.0);
    // Even light makes it the plain mean, and no light none.
    assert_eq!(seen(&[3.0; 8], None).unwrap(), between(&image).mean_abs_error);
    assert_eq!(seen(&[0.0; 8], None).unwrap(), 0.0);
    // An error where the light is bright is seen more than the same where it is dim.
    let [bright, dim] =
        [[1.0, 9.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0], [9.0, 1.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0]];
    let lit = |irradiance: &[f64]| {
        seen_error(&TRUTH, &[1.0, 0.5, 1.0, 0.75, 0.5, 0.25, 0.0, 0.0], irradiance, None)
    };
    assert!(lit(&bright).unwrap() > 3.0 * lit(&dim).unwrap());
}

#[test]
fn a_seen_error_of_no_light_is_refused_in_a_sentence() {
    let refused =
        |irradiance: &[f64]| seen_error(&TRUTH, &TRUTH, irradiance, None).unwrap_err().to_string();
    assert!(refused(&[1.0; 7]).contains("as many pixels as the truth (7 against 8)"));
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        let mut irradiance = [1.0; 8];
        irradiance[2] = wrong;
        let sentence = refused(&irradiance);
        assert!(sentence.contains("the irradiance at pixel 2"), "{sentence}");
    }
}
