//! The slices themselves: where they lie, their tables, and what happens while something moves through them.

use antumbra::RectangleLight;
use antumbra::scene::{Role, Scene, generate};
use antumbra::techniques::occlusion_textures::twin::BINS;
use antumbra_harness::HeadlessDevice;
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, model};
use glam::{DMat4, DVec3};

const PUBLISHED: &str = "combine=product placement=uniform";

fn light(side: f64) -> RectangleLight {
    generate::square_light(side).unwrap()
}

fn largest(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The placement that a frame used: the slice of every bin, and the upper plane, lower plane and texture of
/// every slice.
fn placement(device: &HeadlessDevice, scene: &Scene, words: &str) -> (Vec<usize>, Vec<[f32; 3]>) {
    let setup = Setup::ground(scene, 1.0, 8);
    let mut stage = setup.stage(device, &format!("technique=occlusion-textures {words}"));
    let plan = stage.plan(setup.light(), None).unwrap();
    stage.run(&plan).unwrap();
    let name = "occlusion_textures.placement";
    let (texels, _) = stage.inspect::<[f32; 4]>(&plan, name).unwrap();
    let bins = BINS as usize;
    let slices: Vec<usize> = texels[..bins].iter().map(|t| t[0] as usize).collect();
    let count = slices.iter().max().unwrap() + 1;
    (slices, texels[bins..][..count].iter().map(|t| [t[0], t[1], t[2]]).collect())
}

/// Slices follow each other without a gap from the first bin to the last, all of them are there, and a
/// texture lies within its slice.
#[test]
fn slices_are_a_partition() {
    let device = device();
    let bunny = generate::normalized(&model("bunny"), light(0.4)).unwrap();
    let card = generate::card(light(0.4));
    for (name, scene) in [("bunny", &bunny), ("card", &card)] {
        for count in [4, 7, 16, 31, 32] {
            for words in ["", "placement=uniform", PUBLISHED] {
                let words = format!("slices={count} {words}");
                let (bins, planes) = placement(&device, scene, &words);
                assert_eq!((bins[0], planes.len()), (0, count), "{name}, {words}");
                assert!(bins.windows(2).all(|b| b[1] == b[0] || b[1] == b[0] + 1), "{words}");
                assert!(planes.windows(2).all(|p| p[0][1] == p[1][0]), "{name}, {words}");
                let inside = |p: &[f32; 3]| p[0] < p[1] && p[0] <= p[2] && p[2] <= p[1];
                assert!(planes.iter().all(inside), "{name}, {words}: {planes:?}");
                // Every bin's distance is within its slice.
                let (near, far) = (planes[0][0], planes[count - 1][1]);
                for (bin, slice) in bins.iter().enumerate() {
                    let distance = near + (far - near) * (bin as f32 + 0.5) / BINS as f32;
                    let [upper, lower, _] = planes[*slice];
                    assert!(upper < distance && distance < lower, "{name}, {words}: bin {bin}");
                }
                if words.contains("uniform") {
                    let bin = (far - near) / BINS as f32;
                    let equal = (far - near) / count as f32;
                    let even = |p: &[f32; 3]| ((p[1] - p[0]) - equal).abs() <= 1.01 * bin;
                    assert!(planes.iter().all(even), "{name}, {words}: {planes:?}");
                }
            }
        }
    }
}

/// Three cards at 1.5, 2 and 2.5 m from the light: a texture each, at its card's distance to within a bin of
/// 1.0025 m / 960, which uniform slices do not have.
#[test]
fn fitted_textures_lie_where_the_occluders_are() {
    let device = device();
    let scene = generate::stacked_cards(light(0.4));
    for count in [4, 8, 16] {
        let (_, planes) = placement(&device, &scene, &format!("slices={count}"));
        for distance in [1.5f32, 2.0, 2.5] {
            let nearest =
                planes.iter().map(|p| (p[2] - distance).abs()).fold(f32::INFINITY, f32::min);
            assert!(nearest < 1.1e-3, "{count} slices: {nearest} m from {distance}: {planes:?}");
        }
        let (_, uniform) = placement(&device, &scene, &format!("slices={count} placement=uniform"));
        let apart = uniform.iter().map(|p| (p[2] - 2.0).abs()).fold(f32::INFINITY, f32::min);
        assert!(apart > 1.1e-3, "{count} slices: {apart}");
    }
}

/// Whole numbers: every sum of a table of 4096² texels is what its mask says.
#[test]
fn a_table_of_the_largest_map_is_exact() {
    let device = device();
    let scene = generate::card(light(0.4));
    let setup = Setup::ground(&scene, 1.0, 8);
    let words = "technique=occlusion-textures map=4096 slices=4 combine=product";
    let mut stage = setup.stage(&device, words);
    let plan = stage.plan(setup.light(), None).unwrap();
    stage.run(&plan).unwrap();
    let (mask, [width, height]) = stage.inspect::<u32>(&plan, "occlusion_textures.mask").unwrap();
    assert_eq!([width, height], [4096; 2]);
    let (sums, _) = stage.inspect::<[u32; 4]>(&plan, "occlusion_textures.filtered").unwrap();
    let mut above = vec![[0u32; 4]; 4096];
    for (y, (bits, row)) in mask.chunks_exact(4096).zip(sums.chunks_exact(4096)).enumerate() {
        let mut before = [0u32; 4];
        for (x, (bits, sum)) in bits.iter().zip(row).enumerate() {
            for (slice, b) in before.iter_mut().enumerate() {
                *b += bits >> slice & 1;
                above[x][slice] += *b;
            }
            assert_eq!(*sum, above[x], "texel {x}, {y}");
        }
    }
    let most = sums.last().unwrap().iter().max().unwrap();
    println!("the largest sum is {most}");
    assert!(*most > 1 << 23, "a float of 16 bits could hold {most}");
}

/// How much more or less of the light any pixel sees from one of 101 frames to the next, while a card sinks
/// by 0.1 m, a millimetre a frame, between two others that stay where they are.
fn flicker(device: &HeadlessDevice, words: &str, tilt: f64) -> f32 {
    let mut scene = generate::stage(light(1.0));
    let mut card = |name: &str, at: DVec3, side: f64, turn: f64| {
        let mut mesh = generate::quad(side, side);
        mesh.double_sided = true;
        let place = DMat4::from_translation(at) * DMat4::from_rotation_x(turn);
        scene.add(name, mesh, place, Role::Occluder);
    };
    card("above", DVec3::new(0.6, 3.0, 0.0), 0.1, 0.0);
    card("below", DVec3::new(-0.6, 1.0, 0.0), 0.1, 0.0);
    card("between", DVec3::new(0.0, 2.15, 0.0), 1.0, tilt);
    let setup = Setup::ground(&scene, 2.2, 48);
    let mut stage = setup.stage(device, &format!("technique=occlusion-textures map=96 {words}"));
    let mut before: Option<Vec<f32>> = None;
    let mut worst = 0.0f32;
    for step in 0..=100 {
        let mut meshes = stage.instances().to_vec();
        let down = DMat4::from_translation(DVec3::NEG_Y * 0.001 * f64::from(step));
        let between = meshes.last_mut().unwrap();
        between.world_from_mesh = down * between.world_from_mesh;
        let meshes = &*meshes.leak();
        let plan = stage.plan_with(setup.light(), |frame| frame.meshes = meshes).unwrap();
        stage.run(&plan).unwrap();
        let now = stage.visibility().unwrap();
        worst = worst.max(before.map_or(0.0, |b| largest(&b, &now)));
        before = Some(now);
    }
    worst
}

/// A card parallel to the light goes from one slice to the next all at once, and its texture then jumps by a
/// slice's thickness t = 2 m/16. Its edge at x = ½, 2 m under the light and 2 m above the ground, is seen from
/// the ground at x in front of the light's point l = (x − x_e r)/(1 − r), r = 4 m/d = 2, so that a jump of d by
/// t moves l by (x − x_e) t · r/d ≤ t on a penumbra where x − x_e ≤ 1: of a light of 1 m, t along each axis.
/// Nothing jumps by more than 2t, published or not. A card that is tilted goes over row by row, and a fitted
/// texture stays with its card.
#[test]
fn nothing_flickers_when_an_occluder_goes_through_slices() {
    let device = device();
    let thickness = 2.0 / 16.0;
    for (words, tilt, most) in [
        (PUBLISHED, 0.0, 2.0 * thickness),
        ("placement=uniform", 0.0, 2.0 * thickness),
        ("placement=uniform", 0.5, FLICKER[0]),
        ("", 0.0, FLICKER[1]),
        ("", 0.5, FLICKER[2]),
    ] {
        let worst = flicker(&device, words, tilt);
        println!("{words}, tilted by {tilt}: {worst:.4} of at most {most}");
        assert!(worst > 0.0 && worst <= most, "{words}, {tilt}: {worst}");
    }
}

/// Measured, and half as much more. A millimetre moves what is seen of the light by 0.001; a row of texels at
/// the card's edge that comes or goes, 1 cm seen twice as large, by 0.02.
const FLICKER: [f32; 3] = [0.055, 0.045, 0.04];
