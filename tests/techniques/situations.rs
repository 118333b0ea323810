//! Situations that people report (`tests/support/situations.rs`), each beside the traced truth.
//!
//! A bound is what was measured and about half as much again, for what drivers and texels do to a few pixels; umbra is
//! some hundreds of pixels, so that a share of it has steps of a few tenths of a percent. A known fault says why, and has
//! a least figure, too: where it is mended its test fails, and what was a fault becomes a bound.

use antumbra_harness::{GBuffer, HeadlessDevice, View};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent, settings};
use antumbra_tests::situations::{self, Situation};

const EXTENT: [u32; 2] = [160, 120];

/// The images of some techniques by their words, and the truth.
fn images(
    device: &HeadlessDevice,
    situation: &Situation,
    words: &[&str],
) -> (Vec<f32>, Vec<Vec<f32>>) {
    let Situation { scene, camera } = situation;
    let view = View::of(camera, EXTENT);
    let setup = Setup { scene, view, extent: EXTENT, window: None, occluders_seen: true };
    let mut stage = setup.stage(device, "technique=hard");
    let (truth, _) = setup.traced(&stage, 128);
    let mut image = |words: &&str| {
        let technique = settings(&format!("technique={words}"));
        stage.configure_with(technique, |d| d.normals = Some(GBuffer::NORMALS)).unwrap();
        setup.visibility(&mut stage)
    };
    let images = words.iter().map(&mut image).collect();
    (truth, images)
}

/// What can be wrong with an image.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Figure {
    /// The mean error over shadow and penumbra, percent.
    Error,
    /// The share of pixels that see the whole lamp and are less than half lit, percent.
    Dark,
    /// The share of pixels in umbra that are lit by more than a tenth, percent.
    Leak,
}
use Figure::{Dark, Error, Leak};

/// What a technique makes of a situation.
struct Row {
    words: &'static str,
    /// The most of each figure: error, dark, leak.
    most: [f64; 3],
    /// Figures that are wrong: the least that they are, and why.
    faults: &'static [(Figure, f64, &'static str)],
}

const fn row(words: &'static str, most: [f64; 3]) -> Row {
    Row { words, most, faults: &[] }
}

const fn faulty(
    words: &'static str,
    most: [f64; 3],
    faults: &'static [(Figure, f64, &'static str)],
) -> Row {
    Row { words, most, faults }
}

/// The figures of an image beside the truth.
fn figures(truth: &[f32], image: &[f32]) -> [f64; 3] {
    let share = |of: &dyn Fn(f32) -> bool, wrong: &dyn Fn(f32) -> bool| {
        let there = truth.iter().zip(image).filter(|(t, _)| of(**t));
        let found = there.clone().filter(|(_, v)| wrong(**v)).count();
        100.0 * found as f64 / there.count().max(1) as f64
    };
    let dark = share(&|t| t == 1.0, &|v| v < 0.5);
    let leak = share(&|t| t == 0.0, &|v| v > 0.1);
    [percent(truth, image), dark, leak]
}

/// Holds every technique of a table to its figures.
///
/// A raster of 4 sub-pixel bits, as SwiftShader's, moves the surfaces of an image this small by more than what is asked for
/// here: what lies on the floor by its thickness, and the floor itself beneath the truth's receivers.
fn hold(name: &str, situation: &Situation, rows: &[Row]) {
    let device = device();
    if device.leaves_to_others(name) {
        return;
    }
    let words: Vec<&str> = rows.iter().map(|row| row.words).collect();
    let (truth, images) = images(&device, situation, &words);
    let mut wrong = Vec::new();
    for (row, image) in rows.iter().zip(&images) {
        let found = figures(&truth, image);
        let [error, dark, leak] = found;
        println!("{name}, {}: {error:.2} %, {dark:.2} % dark, {leak:.2} % leak", row.words);
        for (figure, (found, most)) in
            [Error, Dark, Leak].into_iter().zip(found.into_iter().zip(row.most))
        {
            if !(0.0..=most).contains(&found) {
                wrong.push(format!("{}: {figure:?} is {found:.2}, beyond {most}", row.words));
            }
            let fault = row.faults.iter().find(|(of, ..)| *of == figure);
            if let Some((_, least, why)) = fault
                && found < *least
            {
                let words = row.words;
                wrong.push(format!("{words}: {figure:?} is {found:.2}; is it mended, that {why}?"));
            }
        }
    }
    assert!(wrong.is_empty(), "{name}:\n{}", wrong.join("\n"));
}

const TEXEL: &str =
    "a texel's width and slope is the least height over a surface that has a contact shadow";
const ONE_WIDTH: &str = "a pixel has one width of penumbra, from the mean distance of its blockers";
const FROM_THE_CENTRE: &str =
    "what surrounds the lamp closely looks otherwise from its centre than from its rim";
const CREASE: &str = "a texel over a crease that is steeper than the bias holds both facets";
const ABOUT_ALL: f64 = 100.0;

#[test]
fn shadows_are_sharp_at_a_foot_and_soft_at_a_top() {
    hold(
        "contact-hardening",
        &situations::post_and_board(0.0015),
        &[
            row("traced", [1.4, 0.05, 0.5]),
            row("ray-march", [1.8, 0.1, 1.0]),
            row("soft-shadow-map", [3.8, 0.1, 1.0]),
            row("occlusion-textures", [3.0, 0.1, 5.0]),
            faulty("pcss", [8.0, 0.1, 11.0], &[(Error, 3.0, ONE_WIDTH)]),
        ],
    );
}

#[test]
fn a_board_through_the_floor_casts_the_same_shadow() {
    hold(
        "poke-through",
        &situations::post_and_board(-0.004),
        &[
            row("traced", [1.4, 0.05, 0.5]),
            row("ray-march", [2.2, 0.1, 0.5]),
            row("soft-shadow-map", [3.0, 0.1, 1.5]),
            row("occlusion-textures", [2.5, 0.1, 2.0]),
            row("pcss", [8.0, 0.1, 10.0]),
        ],
    );
}

#[test]
fn wires_cast_a_faint_even_shadow() {
    hold(
        "fence",
        &situations::fence(-0.5),
        &[
            row("traced", [3.2, 0.1, 1.5]),
            row("ray-march", [7.3, 0.2, 1.0]),
            row("soft-shadow-map", [6.2, 0.2, 1.0]),
            row("occlusion-textures", [5.3, 0.1, 1.0]),
            row("pcss", [7.4, 0.2, 1.0]),
        ],
    );
    hold(
        "fence-standing",
        &situations::fence(0.0),
        &[
            row("ray-march", [5.6, 0.2, 1.0]),
            row("soft-shadow-map", [7.0, 0.3, 1.0]),
            row("occlusion-textures", [4.0, 0.1, 1.0]),
            row("pcss", [7.0, 0.2, 1.0]),
        ],
    );
}

#[test]
fn a_rug_and_a_mat_make_lines_and_no_acne() {
    hold(
        "decal",
        &situations::decal(),
        &[
            row("traced", [1.0, 0.05, 1.0]),
            faulty("ray-march", [25.0, 0.05, 24.0], &[(Error, 8.0, TEXEL)]),
            faulty("soft-shadow-map", [30.0, 0.1, 31.0], &[(Error, 8.0, TEXEL)]),
            faulty("occlusion-textures", [19.0, 0.05, 46.0], &[(Error, 6.0, TEXEL)]),
            faulty("pcss", [24.0, 0.05, 31.0], &[(Error, 8.0, TEXEL)]),
        ],
    );
}

#[test]
fn a_rim_around_a_lamp_makes_the_penumbra() {
    hold(
        "downlight",
        &situations::downlight(),
        &[
            row("traced", [1.6, 0.05, 1.0]),
            row("ray-march", [1.7, 0.1, 1.0]),
            row("soft-shadow-map", [2.6, 0.1, 2.5]),
            row("occlusion-textures", [1.7, 0.1, 2.0]),
            faulty("pcss", [27.0, 0.1, 9.0], &[(Error, 9.0, FROM_THE_CENTRE)]),
        ],
    );
}

/// Next to nothing is in shadow, so that a mean over shadow is the mean over what is wrong.
#[test]
fn facets_that_the_lamp_reaches_have_no_dots() {
    hold(
        "facets",
        &situations::facets(),
        &[
            row("traced", [ABOUT_ALL, 0.0, 0.0]),
            faulty("ray-march", [ABOUT_ALL, 0.45, 0.0], &[(Dark, 0.1, CREASE)]),
            faulty("soft-shadow-map", [ABOUT_ALL, 1.0, 0.0], &[(Dark, 0.2, CREASE)]),
            row("occlusion-textures", [ABOUT_ALL, 0.05, 0.0]),
            faulty("pcss", [ABOUT_ALL, 0.3, 0.0], &[(Dark, 0.05, CREASE)]),
        ],
    );
}

#[test]
fn a_room_of_sheets_is_dark_but_for_its_door() {
    const SEAMS: &str =
        "a slice flattens a sheet that is edge-on to the lamp, and light passes where sheets meet";
    hold(
        "thin-room",
        &situations::thin_room(),
        &[
            row("traced", [0.6, 0.1, 0.3]),
            row("ray-march", [0.6, 0.1, 0.6]),
            row("soft-shadow-map", [1.5, 0.1, 1.4]),
            faulty("occlusion-textures", [7.1, 0.1, 10.5], &[(Leak, 2.0, SEAMS)]),
            row("pcss", [1.7, 0.1, 1.4]),
        ],
    );
}

#[test]
fn under_a_table_under_a_box_is_umbra() {
    const WALLS: &str = "blockers are looked for among walls that reach up to the lamp";
    hold(
        "lamp-in-room",
        &situations::lamp_in_room(),
        &[
            row("traced", [1.9, 0.1, 1.0]),
            row("ray-march", [1.9, 0.1, 0.5]),
            row("soft-shadow-map", [4.7, 0.1, 1.0]),
            row("occlusion-textures", [3.1, 0.1, 1.0]),
            faulty("pcss", [25.0, 0.3, 100.0], &[(Leak, 50.0, WALLS)]),
        ],
    );
}

#[test]
fn boxes_that_touch_let_no_light_through() {
    hold(
        "touching-boxes",
        &situations::touching_boxes(),
        &[
            row("traced", [1.0, 0.05, 0.2]),
            row("ray-march", [1.3, 0.05, 0.2]),
            row("soft-shadow-map", [1.5, 0.05, 0.9]),
            row("occlusion-textures", [2.3, 0.05, 0.5]),
            row("pcss", [3.3, 0.05, 1.8]),
        ],
    );
}

/// A ball that blocks and receives under a line, which asks for 1 % by default.
#[test]
fn a_tube_over_a_ball() {
    const SEARCHED: &str = "no more samples are added before the error is what was asked for";
    hold(
        "tube-light",
        &situations::tube_light(),
        &[
            row("traced", [1.0, 0.1, 1.0]),
            faulty("linear-light", [6.1, 0.1, 2.0], &[(Error, 2.0, SEARCHED)]),
            row("linear-light error=0", [1.0, 0.1, 0.5]),
            row("hard", [26.0, 0.1, 1.0]),
        ],
    );
}

/// A table that cannot be missed proves nothing: the situation of another lamp is beyond it.
#[test]
fn a_wrong_image_is_beyond_the_figures() {
    let device = device();
    let (truth, _) = images(&device, &situations::touching_boxes(), &[]);
    let (other, _) = images(&device, &situations::post_and_board(0.0015), &[]);
    let [error, dark, leak] = figures(&truth, &other);
    assert!(error > 20.0 && dark > 1.0 && leak > 20.0, "{error} {dark} {leak}");
    assert_eq!(figures(&truth, &truth), [0.0; 3]);
}
