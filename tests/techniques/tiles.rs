//! Tiles of pixels that are told at once: the image is what it is without, to the bit.

use antumbra::scene::{Camera, Role, Scene, generate};
use antumbra::stages::tiles::twin::{Bounds, listed_tile, rounded_tile};
use antumbra::techniques::common::twin::nodes_around;
use antumbra::techniques::soft_shadow_map::twin::{Node, Tile, may_shadow, superblocks_around};
use antumbra_harness::{HeadlessDevice, View};
use antumbra_tests::compare::Tolerance;
use antumbra_tests::measure::{Setup, model};
use antumbra_tests::{Function, device};
use num_traits::Float;
use proptest::prelude::Strategy;

type Pair = (f32, f32);
type Triple = (f32, f32, f32);

/// What a frame with tiles has listed: a word a tile.
struct Listed {
    image: Vec<f32>,
    tiles: Vec<u32>,
}

fn listed(device: &HeadlessDevice, setup: &Setup, words: &str) -> Listed {
    let mut stage = setup.stage(device, words);
    let plan = stage.plan(setup.light(), setup.window).unwrap();
    stage.run(&plan).unwrap();
    let list: Vec<u32> = stage.inspect_buffer(&plan, "visibility.tile_list").unwrap();
    let groups: Vec<u32> = stage.inspect_buffer(&plan, "visibility.tile_arguments").unwrap();
    let tiles = list[1..][..list[0] as usize].to_vec();
    // As many workgroups as the list takes.
    let a_group = if words.contains("technique") { 1 } else { 4 };
    assert_eq!(groups[0] * groups[1], list[0].div_ceil(a_group), "{words}");
    Listed { image: stage.visibility().unwrap(), tiles }
}

/// A view by the scene's own camera, of a size that is no multiple of a tile's.
fn framed(scene: &Scene) -> Setup<'_> {
    let extent = [157, 99];
    let view = View::of(&Camera::framing(scene, 157.0 / 99.0), extent);
    Setup { scene, view, extent, window: None, occluders_seen: true }
}

/// One image with tiles and without; how many tiles there are, and how many of them may feel an occluder.
fn same_image(device: &HeadlessDevice, setup: &Setup, words: &str, what: &str) -> (usize, usize) {
    let with = listed(device, setup, words);
    let mut stage = setup.stage(device, &format!("{words} classify=off"));
    let plan = stage.plan(setup.light(), setup.window).unwrap();
    stage.run(&plan).unwrap();
    let without = stage.visibility().unwrap();
    let pairs = with.image.iter().zip(&without);
    let differ = pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    assert_eq!(differ, 0, "{what}: tiles change the image");
    // Each tile is listed once or not at all; what is not listed is lit.
    let [columns, rows] = setup.extent.map(|e| e.div_ceil(8));
    let mut there = vec![false; (columns * rows) as usize];
    let mut shadowable = 0;
    for word in &with.tiles {
        let ([x, y], may_be_shadowed) = listed_tile(*word);
        let at = (y / 8 * columns + x / 8) as usize;
        assert!(!there[at], "{what}: tile {x}, {y} is listed twice");
        there[at] = true;
        shadowable += usize::from(may_be_shadowed);
    }
    for (i, v) in without.iter().enumerate() {
        let (x, y) = (i as u32 % setup.extent[0], i as u32 / setup.extent[0]);
        if !there[(y / 8 * columns + x / 8) as usize] {
            assert_eq!(*v, 1.0, "{what}: {x}, {y} was taken to be lit");
        }
    }
    println!(
        "{what}: {} of {} tiles listed, {shadowable} shadowable",
        with.tiles.len(),
        there.len()
    );
    (there.len(), shadowable)
}

/// What a technique with tiles makes of every scene and light, with and without.
fn same_with_and_without(all_words: &[&str]) {
    let device = device();
    for (nth_side, side) in [0.05, 0.5, 2.0].into_iter().enumerate() {
        let light = || generate::square_light(side).unwrap();
        let tilted = generate::rectangle_light(side, 0.5 * side, 0.4).unwrap();
        let bunny = generate::normalized(&model("bunny"), light()).unwrap();
        let mut blocks = bunny.clone();
        blocks.instances.iter_mut().for_each(|i| i.role = Role::Both);
        let scenes = [
            ("card", generate::card(tilted)),
            ("box", generate::tall_box(light())),
            ("foliage", generate::foliage(light(), 100, 3).with_occluders_as(Role::Both)),
            ("bunny", bunny.with_occluders_as(Role::Both)),
            ("all block", blocks),
        ];
        for (nth_scene, (name, scene)) in scenes.iter().enumerate() {
            let mut setups =
                vec![("framed", framed(scene)), ("ground", Setup::ground(scene, 4.0, 120))];
            // A part of the occluders alone.
            let window = Some([[-0.1, -0.2], [0.3, 0.1]]);
            setups.push(("window", Setup { window, ..framed(scene) }));
            // Every scene meets every light; views and settings take turns.
            let (seen, setup) = &setups[(nth_side + nth_scene) % setups.len()];
            let words = all_words[(nth_side + 2 * nth_scene) % all_words.len()];
            let what = format!("{name} {seen}, L = {side}, {words}");
            let (all, shadowable) = same_image(&device, setup, words, &what);
            assert!(side > 1.0 || shadowable < all, "{what}: no tile was spared");
            assert!(shadowable > 0 || *seen == "window", "{what}: nothing is shadowed");
        }
    }
}

#[test]
fn soft_shadow_maps_are_the_same_with_tiles() {
    same_with_and_without(&[
        "map=96 sides=mean",
        "map=65 sides=one",
        "map=64 sides=two tolerance=0.01",
    ]);
}

#[test]
fn percentage_closer_soft_shadows_are_the_same_with_tiles() {
    same_with_and_without(&["technique=pcss map=96", "technique=pcss map=300 taps=64"]);
}

#[test]
fn occlusion_textures_are_the_same_with_tiles() {
    same_with_and_without(&[
        "technique=occlusion-textures map=96",
        "technique=occlusion-textures map=65 slices=7 combine=product placement=uniform fill=on",
        "technique=occlusion-textures map=64 slices=32 combine=sum",
    ]);
}

#[test]
fn occlusion_textures_by_levels_are_the_same_with_tiles() {
    same_with_and_without(&[
        "technique=occlusion-textures map=96 prefilter=mip slices=8",
        "technique=occlusion-textures map=65 prefilter=n-buffer slices=5 combine=max fill=on",
        "technique=occlusion-textures map=300 prefilter=mip slices=6 combine=product",
    ]);
}

/// Tiles that no occluder can shadow take no workgroup.
#[test]
fn a_view_of_lit_ground_lists_nothing() {
    let device = device();
    let scene = generate::card(generate::square_light(0.4).unwrap());
    let mut setup = Setup::ground(&scene, 1.0, 64);
    let aside = glam::DMat4::from_translation(glam::DVec3::new(-6.0, 0.0, 0.0));
    setup.view = View { clip_from_world: setup.view.clip_from_world * aside };
    for words in [
        "map=64",
        "technique=pcss map=64",
        "technique=occlusion-textures map=64",
        "technique=occlusion-textures map=64 combine=product",
        "technique=occlusion-textures map=64 slices=8 prefilter=n-buffer",
    ] {
        let listed = listed(&device, &setup, words);
        assert!(listed.tiles.is_empty(), "{words}");
        assert!(listed.image.iter().all(|v| *v == 1.0), "{words}");
    }
}

#[test]
fn bounds_are_rounded_outwards() {
    fn twin<T: Float>(x: &[T]) -> Vec<T> {
        let b = rounded_tile(&Bounds { t_min: [x[0], x[1]], t_max: [x[2], x[3]], w: [x[4], x[5]] });
        vec![b.t_min[0], b.t_min[1], b.t_max[0], b.t_max[1], b.w[0], b.w[1]]
    }
    let glue = "void rounded(vec2 t_min, vec2 t_max, vec2 w, out vec2 a, out vec2 b, out vec2 c) { \
                Tile t = rounded_tile(Tile(t_min, t_max, w)); a = t.t_min; b = t.t_max; c = t.w; }";
    let prototype =
        "void rounded(vec2 t_min, vec2 t_max, vec2 w, out vec2 a, out vec2 b, out vec2 c)";
    let at = || (-500.0..900.0_f32, -500.0..900.0_f32);
    let cases = (at(), at(), (0.0..4.0_f32, 0.0..4.0_f32));
    let test = Function::new("common/lists.glsl", prototype).glue(glue).random(5_000, cases);
    let device = device();
    for case in test.outputs(&device) {
        let (i, o) = (&case.input, &case.output);
        // A part in a thousand of a texel is more than what t is rounded to here.
        assert!(o[0] < i[0] && o[1] < i[1] && o[2] > i[2] && o[3] > i[3], "{i:?}: {o:?}");
        assert!(o[4] <= i[4] && o[5] >= i[5], "{i:?}: {o:?}");
    }
    // One sum of numbers up to 900 may round otherwise where it is contracted.
    test.f32(Tolerance::absolute(1.3e-4), twin::<f32>)
        .f64(Tolerance::absolute(1.3e-4), twin::<f64>)
        .check(&device);
}

#[test]
fn receivers_widen_bounds() {
    let glue = "void widened(vec3 a, vec3 b, out vec2 t_min, out vec2 t_max, out vec2 w) { \
                Tile t = with_receiver(with_receiver(empty_tile(), a.xy, a.z), b.xy, b.z); \
                t_min = t.t_min; t_max = t.t_max; w = is_empty_tile(empty_tile()) && !is_empty_tile(t) \
                ? t.w : vec2(0.0); }";
    let prototype = "void widened(vec3 a, vec3 b, out vec2 t_min, out vec2 t_max, out vec2 w)";
    let receiver = || (-300.0..600.0_f32, -300.0..600.0_f32, 0.01..5.0_f32);
    Function::new("common/lists.glsl", prototype)
        .glue(glue)
        .random(2_000, (receiver(), receiver()))
        .f32(Tolerance::exact(), |x| {
            let (low, high) = (|i: usize| x[i].min(x[i + 3]), |i: usize| x[i].max(x[i + 3]));
            vec![low(0), low(1), high(0), high(1), low(2), high(2)]
        })
        .check(&device());
}

/// Nodes, tiles and the light as scenes have them, powers of two where a division must not be rounded.
fn nodes_and_tiles() -> impl Strategy<Value = (Triple, [f32; 4], Pair, Pair)> {
    let node = (0..32_u32, 0..32_u32, 0.1..1.5_f32)
        .prop_map(|(x, y, w_max)| (x as f32 * 8.0, y as f32 * 8.0, w_max));
    let tile = (-60.0..320.0_f32, -60.0..320.0_f32, 0.0..9.0_f32, 0.0..9.0_f32)
        .prop_map(|(x, y, width, height)| [x, y, x + width, y + height]);
    let scale = (0..6_i32, 0..6_i32).prop_map(|(x, y)| (2f32.powi(-x - 6), 2f32.powi(-y - 6)));
    (node, tile, (0.05..1.0_f32, 0.05..0.5_f32), scale)
}

#[test]
fn nodes_that_may_shadow_a_tile() {
    let glue = "bool node_may_shadow(vec3 node, vec4 t, vec2 w, vec2 scale) { \
                return may_shadow(Node(1.0, 0.0, 0.0, node.z, 0.0, 0.0, uvec2(0u)), node.xy, 8.0, t.xy, t.zw, \
                w.x, scale); }";
    let prototype = "bool node_may_shadow(vec3 node, vec4 t, vec2 w, vec2 scale)";
    fn tile(x: &[f32]) -> Tile<f32> {
        Tile { t_min: [x[3], x[4]], t_max: [x[5], x[6]], w: [x[7], x[7] + x[8]] }
    }
    let test = Function::new("soft_shadow_map/node.glsl", prototype)
        .glue(glue)
        .random(20_000, nodes_and_tiles());
    let device = device();
    let shadowable = test.outputs(&device).iter().filter(|c| c.output[0] == 1.0).count();
    assert!((2_000..18_000).contains(&shadowable), "{shadowable}");
    test.f32(Tolerance::exact(), |x| {
        let node = Node { count: 1.0, w: [0.0, 0.0, x[2]], lo: [x[0], x[1]], side: 8.0 };
        vec![f32::from(may_shadow(&node, &tile(x), [x[9], x[10]]))]
    })
    .check(&device);

    let glue = "ivec4 around(vec3 node, vec4 t, vec2 w, vec2 scale) { \
                return superblocks_around(t.xy, t.zw, w.x, 8, node.z, scale); }";
    Function::new(
        "soft_shadow_map/node.glsl",
        "ivec4 around(vec3 node, vec4 t, vec2 w, vec2 scale)",
    )
    .glue(glue)
    .random(20_000, nodes_and_tiles())
    .f32(Tolerance::exact(), |x| superblocks_around(&tile(x), 8.0, x[2], [x[9], x[10]]).concat())
    .check(&device);
}

#[test]
fn nodes_of_a_searched_part_of_the_map() {
    let part = (-500.0..1500.0_f32, -500.0..1500.0_f32, 0.0..400.0_f32, 0.0..400.0_f32)
        .prop_map(|(x, y, width, height)| ([x, y], [x + width, y + height]));
    Function::new("common/nearest.glsl", "ivec4 nodes_around(int map, vec2 lo, vec2 hi)")
        .random(20_000, (16..4097_i32, part))
        // No case lies within the rounding of a division of the edge of a node.
        .f32(Tolerance::exact(), |x| {
            let all = nodes_around(x[0] as u32, [x[1], x[2]], [x[3], x[4]]);
            all.concat().iter().map(|&i| i as f32).collect()
        })
        .check(&device());
}

/// The place of a workgroup of a list: every other one first. A workgroup behind the list keeps its number.
fn alternating(group: u32, groups: u32) -> u32 {
    let evens = groups.div_ceil(2);
    match group {
        _ if group >= groups => group,
        _ if group < evens => 2 * group,
        _ => 2 * (group - evens) + 1,
    }
}

/// A word says where a tile is, and as many workgroups as are dispatched reach every place in the list.
#[test]
fn the_list_holds_every_tile_of_the_largest_image() {
    let device = device();
    let glue =
        "uint word(int x, int y, bool shadowable) { return tile_word(ivec2(x, y), shadowable); }";
    Function::new("common/lists.glsl", "uint word(int x, int y, bool shadowable)")
        .glue(glue)
        .case((4095, 4095, true))
        .random(2_000, (0..4096_i32, 0..4096_i32, proptest::bool::ANY))
        .bits(|x| vec![x[0] | x[1] << 15 | x[2] << 30])
        .check(&device);
    // What is kept of every tile is in rows as long as the image, its last tile a part of one.
    let glue = "int nth(int x, int y, int width) { return nth_tile(tile_word(ivec2(x, y), true), ivec2(width, 1)); }";
    Function::new("common/lists.glsl", "int nth(int x, int y, int width)")
        .glue(glue)
        .random(2_000, (0..512_i32, 0..512_i32, 1..4096_i32))
        .bits(|x| vec![x[1] * x[2].div_ceil(8) + x[0]])
        .check(&device);
    assert_eq!(listed_tile(3 | 5 << 15 | 1 << 30), ([24, 40], true));
    assert_eq!(listed_tile(3 | 5 << 15), ([24, 40], false));
    // The place of each of a group's tiles in a list of `count`, and that the group is dispatched.
    let glue = "uvec3 reached(uint at, uint count) { uvec2 n = groups_with(at); uint group = at / TILES_A_GROUP; \
                uvec2 id = uvec2(group % GROUPS_A_ROW, group / GROUPS_A_ROW); \
                return uvec3(tile_in_list(id, at % TILES_A_GROUP, count), n); }";
    let largest = 4096 * 4096_u32;
    Function::new("common/lists.glsl", "uvec3 reached(uint at, uint count)")
        .glue(glue)
        .case((0_u32, 1_u32))
        .case((largest - 1, largest))
        .random(2_000, (0..largest, 0..=largest))
        .bits(|x| {
            let group = x[0] / 4;
            let place = 4 * alternating(group, x[1].div_ceil(4)) + x[0] % 4;
            vec![place, (group + 1).min(16384), group / 16384 + 1]
        })
        .check(&device);
    // Each group of a list has a place of its own in it.
    for groups in [1, 2, 3, 64, 4097_u32] {
        let mut places: Vec<u32> = (0..groups).map(|group| alternating(group, groups)).collect();
        places.sort_unstable();
        assert_eq!(places, (0..groups).collect::<Vec<_>>());
    }
    // Both stay under what every device dispatches.
    assert!(largest / 4 / 16384 < 65535);
}
