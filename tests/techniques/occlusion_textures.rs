//! Occlusion textures: against an independent version of the published formulas, the truth, and what is known
//! in closed form.

use antumbra::ash::vk;
use antumbra::scene::{Mesh, Role, Scene, generate};
use antumbra::stages::depth_layers::MapView;
use antumbra::stages::depth_layers::{self, Projection};
use antumbra::techniques::common::twin::fraction_above;
use antumbra::techniques::occlusion_textures::{Combine, twin};
use antumbra::truth::Receiver;
use antumbra::{Description, RectangleLight, Technique, frame};
use antumbra_harness::{HeadlessDevice, View};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, as_measured, model, percent, settings, summary};
use glam::{DMat4, DVec3};

fn light(side: f64) -> RectangleLight {
    generate::square_light(side).unwrap()
}

/// The view of a scene's own camera, everything in it seen.
fn seen(scene: &Scene) -> Setup<'_> {
    let extent = [320, 240];
    let view = View::of(&scene.camera.unwrap(), extent);
    Setup { scene, view, extent, window: None, occluders_seen: true }
}

fn image(device: &HeadlessDevice, setup: &Setup, words: &str) -> Vec<f32> {
    setup.visibility(&mut setup.stage(device, &format!("technique=occlusion-textures {words}")))
}

fn normalized(name: &str, side: f64) -> Scene {
    generate::normalized(&model(name), light(side)).unwrap()
}

fn largest(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn mean(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / a.len() as f64
}

/// Name, scene, whether its occluders are in the picture.
fn scenes() -> Vec<(&'static str, Scene, bool)> {
    vec![
        ("card", generate::card(light(0.4)), false),
        ("stacked cards, 1 m", generate::stacked_cards(light(1.0)), false),
        ("slats", generate::slats(light(0.4), 24), false),
        ("tall box, 1 m", generate::tall_box(light(1.0)), false),
        ("bunny", normalized("bunny", 0.4), false),
        ("bunny, 1 m", normalized("bunny", 1.0), false),
        ("suzanne, 1 m", normalized("suzanne", 1.0), false),
        ("foliage", generate::foliage(light(0.4), 300, 7), false),
        ("bunny, both", model("bunny"), true),
        ("suzanne, both", model("suzanne").with_occluders_as(Role::Both), true),
    ]
}

fn setup_of<'a>(name: &str, scene: &'a Scene, both: bool, side: u32) -> Setup<'a> {
    if both {
        seen(scene)
    } else {
        Setup::ground(scene, if name.contains("1 m") { 3.5 } else { 2.2 }, side)
    }
}

/// Settings and the mean error in percent; in the order of [`scenes`].
type Row = (&'static str, [f64; 10]);

const PUBLISHED: &str = "combine=product placement=uniform";
const FILLED: &str = "combine=product placement=uniform fill=on";

/// Measured on lavapipe, 256² maps, 16 slices; the truth's own noise is about 0.4 of it, 1 on slats and foliage.
/// What explains them:
/// * the product takes a solid's slices, which hide the same part of the light, as independent: too dark, and
///   with each filled into the next one twice as much so;
/// * on leaves at random it is right, unless they are filled; the correlated combination finds the same;
/// * the box stands on the ground, whose pixels are in the published version faded out of the slices that
///   they are next to;
/// * on the bunny and Suzanne as their own occluders what is in the next slice is not seen.
const TABLE: &[Row] = &[
    (PUBLISHED, [0.20, 3.82, 19.21, 5.30, 8.22, 8.37, 8.75, 1.34, 6.42, 8.17]),
    (FILLED, [0.20, 12.49, 30.79, 10.25, 16.96, 18.18, 21.31, 13.31, 10.50, 13.61]),
    (
        "combine=product placement=uniform slices=4",
        [0.20, 6.16, 19.20, 8.42, 5.05, 5.82, 7.23, 1.96, 8.34, 7.62],
    ),
    ("", [0.20, 1.24, 1.16, 0.53, 0.97, 1.13, 0.60, 1.27, 2.13, 1.28]),
    ("fill=on", [0.20, 1.24, 1.16, 0.50, 0.91, 1.11, 0.64, 1.33, 2.27, 1.32]),
    ("slices=4", [0.20, 1.28, 1.16, 0.51, 1.44, 1.57, 0.73, 1.44, 4.56, 3.86]),
    ("placement=uniform", [0.20, 1.50, 1.16, 1.13, 0.89, 1.12, 0.54, 1.27, 2.23, 1.39]),
    ("prefilter=n-buffer", [0.63, 2.04, 2.12, 0.51, 2.10, 2.31, 1.86, 1.77, 2.27, 2.29]),
    ("prefilter=mip", [0.63, 3.05, 2.03, 0.53, 4.71, 4.11, 4.91, 3.15, 4.28, 4.34]),
];

/// The published product's error against the correlated combination's, which is to be at most so much of it:
/// a solid's slices are nested. Leaves at random are independent, as the product takes them, and the truth's
/// noise is most of what is left of both: there both are compared with their slices filled.
const SHARE: f64 = 0.6;

#[test]
fn errors_are_what_they_were_measured_to_be() {
    let device = device();
    let mut problems = Vec::new();
    for (nth, (name, scene, both)) in scenes().iter().enumerate() {
        let setup = setup_of(name, scene, *both, 160);
        let mut truth = None;
        let mut errors = Vec::new();
        for (words, measured) in TABLE {
            let mut stage = setup.stage(&device, &format!("technique=occlusion-textures {words}"));
            let image = setup.visibility(&mut stage);
            let (truth, noise) = truth.get_or_insert_with(|| setup.traced(&stage, 512));
            let s = summary(truth, &image);
            let line = format!(
                "{name}, {words}: mean {:.2} %, bias {:.2}, p99 {:.3}, on lit pixels {:.3} % (truth's noise {:.2} points)",
                percent(truth, &image),
                100.0 * s.bias,
                s.p99,
                100.0 * s.lit_error,
                100.0 * *noise
            );
            println!("{line}");
            errors.push((*words, s.mean_abs_error));
            if !as_measured(100.0 * s.mean_abs_error, measured[nth]) || s.lit_error > 0.003 {
                problems.push(line);
            }
        }
        let error = |words: &str| errors.iter().find(|(w, _)| *w == words).unwrap().1;
        // Like against like.
        let (ours, published) =
            if name.contains("foliage") { ("fill=on", FILLED) } else { ("", PUBLISHED) };
        let (ours, published) = (error(ours), error(published));
        let share = if name.contains("card") { 1.0 } else { SHARE };
        // A card is in one slice, whatever the combination.
        if ours > share * published + 1e-4 {
            problems.push(format!("{name}: {ours} of {published}"));
        }
    }
    assert!(problems.is_empty(), "not as measured:\n{}", problems.join("\n"));
}

/// The view of a scene and its occluders' triangles in light space.
fn in_light_space(scene: &Scene, map: u32) -> (MapView, Vec<[DVec3; 3]>) {
    let light = *scene.light(None).unwrap().light.rectangle();
    let to_light = light.light_from_world();
    let occluders = || scene.instances.iter().filter(|i| i.role.blocks());
    let boxes: Vec<_> =
        occluders().map(|i| (scene.meshes[i.mesh].bounds(), i.world_from_mesh)).collect();
    let triangles = occluders().flat_map(|i| {
        let mesh: &Mesh = &scene.meshes[i.mesh];
        let point = move |k: &u32| {
            let p = DVec3::from_array(mesh.positions[*k as usize].map(f64::from));
            (to_light * i.world_from_mesh).transform_point3(p)
        };
        mesh.indices.chunks_exact(3).map(move |t| [0, 1, 2].map(|j| point(&t[j])))
    });
    let view = depth_layers::view(&light, &boxes, Projection::Behind, map).unwrap();
    (view, triangles.collect())
}

/// The published formulas by a way that shares nothing with the shaders. They agree but for texels through
/// whose centre an edge goes, of which a raster may take another one than exact arithmetic: their errors are
/// within 2 points, and on scenes apart from their receivers so small is what is between them that it is held to
/// half a point. A point that shadows itself takes the plane it lies in from its neighbours' depths, where the
/// twin knows its triangle.
#[test]
fn an_independent_version_of_the_published_formulas_says_the_same() {
    let device = device();
    for (name, scene, both) in scenes() {
        let setup = setup_of(name, &scene, both, 48);
        let light = setup.light();
        let (view, triangles) = in_light_space(&scene, 64);
        let mut truth = None;
        let of = |slices, fill, way| (slices, fill, way);
        let ways = [4, 16]
            .into_iter()
            .flat_map(|slices| [false, true].map(|fill| of(slices, fill, Combine::Product)))
            .chain([of(16, false, Combine::Sum), of(16, false, Combine::Max)]);
        for (slices, fill, way) in ways {
            let combine = way.name();
            let words = format!(
                "technique=occlusion-textures map=64 placement=uniform slices={slices} fill={} combine={combine}",
                if fill { "on" } else { "off" }
            );
            let mut stage = setup.stage(&device, &words);
            let ours = setup.visibility(&mut stage);
            let twin = twin::Published::new(&light, &view, slices, fill, &triangles);
            let its = |way| -> Vec<f32> {
                let receivers = Setup::receivers(&stage);
                receivers.iter().map(|r| twin_at(&twin, &light, r, way, both)).collect()
            };
            let (truth, _) = truth.get_or_insert_with(|| setup.traced(&stage, 256));
            let found = its(way);
            let (a, b) = (percent(truth, &ours), percent(truth, &found));
            let apart = 100.0 * mean(&ours, &found);
            println!(
                "{name}, {slices} slices, fill={fill}, {combine}: {a:.2} %, twin {b:.2} %, apart {apart:.3} %"
            );
            assert!(
                (a - b).abs() < 2.0 && apart < if both { 1.0 } else { 0.5 },
                "{name}, {words}: {a} against {b}, {apart}"
            );
            // It notices another combination.
            if name == "bunny" && way == Combine::Product {
                assert!(100.0 * mean(&ours, &its(Combine::Max)) > 0.5, "slices={slices}");
            }
        }
    }
}

/// What the twin says of a receiver; of one that blocks too, no more than is above its own plane.
fn twin_at(
    twin: &twin::Published,
    light: &RectangleLight,
    r: &Receiver,
    way: Combine,
    blocks: bool,
) -> f32 {
    if r.normal == DVec3::ZERO {
        return 1.0;
    }
    let to_light = light.light_from_world();
    let p = to_light.transform_point3(r.position);
    if p.z <= 0.0 {
        return 1.0;
    }
    let mut v = twin.visible(p, way);
    if blocks {
        let n = to_light.transform_vector3(r.normal);
        let half = light.half_extents();
        v = v.min(fraction_above([n.x * half[0], n.y * half[1]], n.dot(p)));
    }
    v as f32
}

/// Kernels of every size from three prefilters: tables are exact, and the others' interpolation between
/// levels is off by what it is.
#[test]
fn prefilters_agree_as_far_as_they_can() {
    let device = device();
    for (side, n_buffer, mip) in N_BUFFER_AND_MIP {
        let scene = normalized("suzanne", side);
        let setup = Setup::ground(&scene, 2.0 + 1.5 * side, 96);
        let of = |prefilter: &str| {
            image(&device, &setup, &format!("{PUBLISHED} map=100 prefilter={prefilter}"))
        };
        let exact = of("sat");
        let found = ["n-buffer", "mip"].map(|p| 100.0 * mean(&of(p), &exact));
        println!("light of {side} m: n-buffer off by {:.2} %, mip by {:.2} %", found[0], found[1]);
        assert!(found[0] < n_buffer && found[1] < mip, "{side}: {found:?}");
    }
}

/// A light's side, and what the mean difference to exact means was measured to be, in percent, and a third more.
const N_BUFFER_AND_MIP: [(f64, f64, f64); 3] =
    [(0.05, 0.07, 0.35), (0.4, 0.4, 1.0), (2.0, 0.63, 0.8)];

/// A light as wide as it is not long: the kernel is no square, nor are the texels.
#[test]
fn oblong_lights_are_no_worse() {
    let device = device();
    for (width, height) in [(1.0, 0.1), (0.1, 1.0)] {
        let lamp = generate::rectangle_light(width, height, 0.0).unwrap();
        let scene = generate::card(lamp);
        let setup = Setup::ground(&scene, 2.2, 96);
        for prefilter in ["sat", "n-buffer", "mip"] {
            let mut stage = setup
                .stage(&device, &format!("technique=occlusion-textures prefilter={prefilter}"));
            let image = setup.visibility(&mut stage);
            let error = percent(&setup.closed_form_of_card(&stage), &image);
            println!("{width} × {height} m, {prefilter}: {error:.2} %");
            let most: f64 = if prefilter == "mip" { 6.0 } else { 2.0 };
            assert!(error < most, "{width} × {height}, {prefilter}: {error}");
        }
    }
}

/// A card parallel to the light lies in one slice and has no thickness: one kernel is the whole answer, exact
/// to a texel, for lights up to far larger than the scene.
#[test]
fn everything_in_one_slice_is_one_kernel() {
    let device = device();
    for side in [0.05, 0.4, 2.0, 12.0] {
        let scene = generate::card(light(side));
        let setup = Setup::ground(&scene, f64::min(1.5 + 0.5 * side, 4.0), 96);
        for words in ["", PUBLISHED, "combine=max", "combine=sum", "slices=4", "slices=32"] {
            let mut stage = setup.stage(&device, &format!("technique=occlusion-textures {words}"));
            let image = setup.visibility(&mut stage);
            assert!(image.iter().all(|v| v.is_finite() && (0.0..=1.0).contains(v)));
            let truth = setup.closed_form_of_card(&stage);
            let worst = largest(&truth, &image);
            // An edge is off by half a texel of 1/254 m, which is seen twice as large: along both axes, of the
            // light's side. From a light smaller than that the whole edge may be.
            let most = (4.0 / 254.0 / side).min(1.0) as f32 + 1e-3;
            println!("light of {side} m, {words}: {worst:.4} of at most {most:.4}");
            assert!(worst <= most, "{side}, {words}: {worst}");
        }
    }
}

/// Slices that are thinner than floats resolve, far from the light, are as good as one.
#[test]
fn a_scene_thinner_than_a_slice_could_be_works() {
    let device = device();
    let mut scene = generate::stage(light(0.4));
    for (nth, x) in [-0.3, 0.3].into_iter().enumerate() {
        let mut mesh = generate::quad(0.5, 0.5);
        mesh.double_sided = true;
        // A tenth of a micrometre apart.
        let at = DVec3::new(x, 2.0 + 1e-7 * nth as f64, 0.0);
        scene.add(&format!("card {nth}"), mesh, DMat4::from_translation(at), Role::Occluder);
    }
    let setup = Setup::ground(&scene, 2.2, 64);
    let mut stage = setup.stage(&device, "technique=occlusion-textures");
    let image = setup.visibility(&mut stage);
    let (truth, noise) = setup.traced(&stage, 512);
    let error = percent(&truth, &image);
    println!("{error:.2} %, noise {noise:.4}");
    assert!(error < 1.5, "{error}");
}

/// The same passes over as many texels and pixels, whatever the light's size; what a pixel then costs is in the
/// bench.
#[test]
fn the_work_does_not_grow_with_the_light() {
    let device = device();
    let work = |side: f64| {
        let scene = normalized("bunny", side);
        let setup = Setup::ground(&scene, 2.2, 32);
        let mut stage = setup.stage(&device, "technique=occlusion-textures");
        let plan = stage.plan(setup.light(), None).unwrap();
        let plan = plan.plan();
        let passes = plan.steps.iter().map(|s| &plan.graph.passes()[s.pass]);
        passes.map(|p| format!("{} {:?}", p.name, p.work)).collect::<Vec<_>>()
    };
    let small = work(0.05);
    assert!(small.len() > 8, "{small:?}");
    assert_eq!(small, work(2.0));
}

#[test]
fn bad_input_is_refused_with_a_sentence() {
    let refuse = |words: &str| {
        let technique = format!("occlusion-textures {words}").parse::<Technique>();
        technique.and_then(|t| t.check()).unwrap_err().to_string()
    };
    for (slices, legal) in [
        ("1", "4 to 32"),
        ("3", "4 to 32"),
        ("33", "0 to 32"),
        ("-1", "0 to 32"),
        ("many", "0 to 32"),
    ] {
        let error = refuse(&format!("slices={slices}"));
        assert!(error.contains("slices") && error.contains(legal), "{error}");
    }
    assert!(refuse("combine=min").contains("product, sum, max, correlated"));
    assert!(refuse("prefilter=none").contains("mip, n-buffer, sat"));
    // What fits, and what would.
    for (words, most) in [
        ("slices=16 map=1449", 1448),
        ("slices=32 map=1025", 1024),
        ("slices=4 combine=product map=2000 prefilter=n-buffer", 1),
    ] {
        let error = refuse(words);
        assert!(error.contains("fewer slices"), "{words}: {error}");
        if most > 1 {
            assert!(error.contains(&format!("map={most},")), "{words}: {error}");
            let fits = words.replace(&format!("map={}", most + 1), &format!("map={most}"));
            assert!(settings(&format!("technique=occlusion-textures {fits}")).check().is_ok());
        }
    }
    let words = settings("technique=occlusion-textures");
    let mut description = Description { technique: words, ..Description::new([64, 64]) };
    assert!(description.check().is_ok());
    description.occluder_maps = Some(vk::Format::D32_SFLOAT);
    let error = description.check().unwrap_err().to_string();
    assert!(error.contains("lend meshes"), "{error}");
    let graph = frame::full_graph(&Description { technique: words, ..Description::new([64, 64]) });
    assert!(graph.passes().iter().any(|p| p.name == "occlusion_textures.visibility"));
}
