//! How the time of shadows from the triangles themselves grows, beside what a model of their cost predicts.
//!
//! A bumpy ball over the ground is made of more and more triangles, its shape the same; the pixels are those of the
//! ground. One variable at a time leaves the centre. Behind each time stand the exponent since the row before, as in
//! time ~ variable^exponent, and the model's.
//!
//! # The model
//! A shaft is s = w (1 - h) + L h wide where it passes the ball, for a tile w wide, a light L wide and the ball at the
//! share h of the way. The ball's area is that of T / 2 leaves, each e wide, and their boxes' parents are √2 wider a
//! level. So a shaft meets 2 (s + e)² / e² leaves, in front and behind, and as many boxes of each level above; a ray is a
//! shaft with s = 0. Of P pixels and P / 16 tiles the share in shadow or penumbra does all that, the others nothing.
//!
//! | | grows as |
//! |---|---|
//! | `tiles` | pixels, and tiles in shadow × nodes in a shaft |
//! | `gather` | tiles in shadow × (nodes + triangles in a shaft) |
//! | `cover` | pixels in shadow × triangles in a shaft × √samples |
//! | `rays` | pixels in shadow × rays × nodes that a ray meets |
//! | build, refit | triangles |
//!
//! What a tile does not do by one it does by the other: shafts of more leaves than the setting `leaves` send rays. The
//! model has one shaft for all tiles in shadow, and so one switch; real ones are at the ball's edge or in its middle. It
//! knows nothing of caches, nor of pixels that are done early because nothing of the light is left.

use crate::ready::{Ready, in_turns, median_of, passes_ms};
use crate::table::Table;
use crate::{Bench, Scale};
use antumbra::MeshInstance;
use antumbra::lent::Geometry;
use antumbra::scene::{Role, Scene, generate};
use antumbra::stages::hierarchy::LEAF;
use antumbra_bench::scenes::made;
use antumbra_harness::bumps::{bumpy_ball, cells_of};
use antumbra_harness::rays::RayTracer;
use antumbra_harness::{FrameTimes, HeadlessDevice};
use glam::{DMat4, DVec3};
use std::f64::consts::PI;

pub const BENCH: Bench = Bench {
    name: "traced",
    about: "Shadows from the triangles themselves: growth beside a model, builds and refits, trees beside obvhs's",
    studies: &[
        ("triangles", |d, s, t| growth(d, s, t, "", &triangles(s))),
        ("rays", |d, s, t| growth(d, s, t, "leaves=1", &triangles(s))),
        ("pixels", |d, s, t| growth(d, s, t, "", &pixels(s))),
        ("samples", |d, s, t| growth(d, s, t, "", &samples())),
        ("light", |d, s, t| growth(d, s, t, "", &lights())),
        ("tree", tree),
        ("area", area),
    ],
    full: Scale { rounds: 7, sides: &[120, 240, 480, 960], quick: false },
    quick: Scale { rounds: 3, sides: &[120, 240, 480], quick: true },
};

/// Where the ball's centre is, and the light, metres above the ground; half the side of the ground that pixels see.
const BALL_HEIGHT: f64 = 1.5;
const LIGHT_HEIGHT: f64 = 4.0;
const HALF: f64 = 2.2;
/// The ball's radius, metres.
const RADIUS: f64 = 0.4;

/// What a frame is made of.
#[derive(Clone, Copy, Debug)]
struct Point {
    triangles: u32,
    /// Pixels along a side of the image.
    side: u32,
    samples: u32,
    /// The side of the light, metres.
    light: f64,
}

const CENTER: Point = Point { triangles: 16_000, side: 480, samples: 64, light: 0.4 };

/// The passes that are told apart, by how their names begin, and `hierarchy`, which fits the boxes anew each frame.
const PASSES: [&str; 5] =
    ["traced.tiles", "traced.gather", "traced.cover", "traced.rays", "hierarchy."];

/// Below this many milliseconds a pass says nothing of how it grows.
const LEAST_MS: f64 = 0.3;

fn triangles(scale: &Scale) -> Vec<(f64, Point)> {
    let counts: &[u32] = match scale.quick {
        true => &[1_000, 4_000, 16_000, 64_000],
        false => &[1_000, 4_000, 16_000, 64_000, 256_000, 871_000],
    };
    let made = |&wished: &u32| 12 * cells_of(wished).pow(2);
    let point = |triangles| (f64::from(triangles), Point { triangles, ..CENTER });
    counts.iter().map(made).map(point).collect()
}

fn pixels(scale: &Scale) -> Vec<(f64, Point)> {
    let point = |&side: &u32| (f64::from(side * side), Point { side, ..CENTER });
    scale.sides.iter().map(point).collect()
}

fn samples() -> Vec<(f64, Point)> {
    let point = |samples| (f64::from(samples), Point { samples, ..CENTER });
    [64, 256, 1024].map(point).to_vec()
}

fn lights() -> Vec<(f64, Point)> {
    [0.1, 0.2, 0.4, 0.8, 1.6].map(|light| (light, Point { light, ..CENTER })).to_vec()
}

impl Point {
    fn scene(&self) -> Scene {
        let light = generate::square_light(self.light).unwrap();
        let mut scene = generate::stage(light);
        let place = DMat4::from_translation(DVec3::Y * BALL_HEIGHT);
        scene.add("ball", bumpy_ball(cells_of(self.triangles)), place, Role::Occluder);
        scene
    }

    fn ready(&self, device: &HeadlessDevice, words: &str) -> Ready {
        let words = format!("traced samples={} {words}", self.samples);
        Ready::over(device, &self.scene(), &words, HALF, self.side)
    }

    /// Boxes that a shaft meets, of this width each.
    fn met(&self, shaft: f64, width: f64, all: f64) -> f64 {
        (2.0 * ((shaft + width) / width).powi(2)).min(all)
    }

    /// Nodes and leaves that a shaft of this width meets.
    fn in_shaft(&self, shaft: f64) -> [f64; 2] {
        let leaves = f64::from(self.triangles / LEAF);
        let width = (4.0 * PI * RADIUS * RADIUS / leaves).sqrt();
        let levels = leaves.log2().ceil() as i32;
        let level = |k: i32| {
            let all = leaves / 2f64.powi(k);
            self.met(shaft, width * 2f64.powf(0.5 * f64::from(k)), all)
        };
        [(0..=levels).map(level).sum(), level(0)]
    }

    /// What each of [`PASSES`] costs, in units of its own; a shaft may have `most` leaves.
    fn model(&self, most: f64) -> [f64; 5] {
        let h = BALL_HEIGHT / LIGHT_HEIGHT;
        let tile = 4.0 * 2.0 * HALF / f64::from(self.side);
        let [nodes, leaves] = self.in_shaft(tile * (1.0 - h) + self.light * h);
        let pixels = f64::from(self.side * self.side);
        let radius = (RADIUS + 0.5 * self.light * h) / (1.0 - h);
        let shadowed = pixels * (PI * radius * radius / (4.0 * HALF * HALF)).min(1.0);
        let by_shaft = f64::from(u8::from(leaves <= most));
        let walked = nodes.min(nodes * most / leaves);
        // Nanoseconds of a core: eight lanes walk eight shafts, or test eight pixels.
        let tiles = 53.0 * pixels + 35.0 / 8.0 * shadowed / 16.0 * walked;
        let gather = by_shaft * shadowed / 16.0 * (35.0 * nodes + 22.0 * 2.0 * leaves) / 8.0;
        let test = 55.0 / 8.0 * (f64::from(self.samples) / 64.0).sqrt();
        let cover = by_shaft * shadowed * 2.0 * leaves * test;
        let rays = (1.0 - by_shaft) * shadowed * 64.0 * self.in_shaft(0.0)[0];
        [tiles, gather, cover, rays, f64::from(self.triangles)]
    }
}

/// The exponent between two rows; nothing where one of them is too small to tell.
fn exponent([x0, y0]: [f64; 2], [x1, y1]: [f64; 2], least: f64) -> String {
    if y0.min(y1) <= least { "-".into() } else { format!("{:.2}", (y1 / y0).ln() / (x1 / x0).ln()) }
}

fn growth(
    device: &HeadlessDevice,
    scale: &Scale,
    table: &mut Table,
    words: &str,
    points: &[(f64, Point)],
) {
    table.head(
        "x|frame ms|tiles ms|exp.|model|gather ms|exp.|model|cover ms|exp.|model|rays ms|exp.|model|fit ms|exp.|model",
    );
    let most = if words.is_empty() { 1024.0 } else { 1.0 };
    let mut ready: Vec<_> = points.iter().map(|(_, p)| p.ready(device, words)).collect();
    let all = in_turns(&mut ready, scale.rounds);
    let measured: Vec<[f64; 5]> = all
        .iter()
        .map(|times| PASSES.map(|pass| median_of(times, |t| passes_ms(t, |n| n.starts_with(pass)))))
        .collect();
    let modelled: Vec<[f64; 5]> = points.iter().map(|(_, p)| p.model(most)).collect();
    let row = |name: String, frame: String, from: usize, to: usize, show: bool| {
        let cells = (0..PASSES.len()).map(|pass| {
            let at = |of: &[[f64; 5]], i: usize| [points[i].0, of[i][pass]];
            let ms = if show { format!("{:.2}", measured[to][pass]) } else { String::new() };
            if from == to {
                return format!("{ms}||");
            }
            let found = exponent(at(&measured, from), at(&measured, to), LEAST_MS);
            let model = exponent(at(&modelled, from), at(&modelled, to), 0.0);
            format!("{ms}|{found}|{model}")
        });
        format!("{name}|{frame}|{}", cells.collect::<Vec<_>>().join("|"))
    };
    for (i, (x, _)) in points.iter().enumerate() {
        let frame = median_of(&all[i], crate::ready::frame_ms);
        table.row(row(format!("{x}"), format!("{frame:.1}"), i.saturating_sub(1), i, true));
    }
    table.row(row("all".into(), String::new(), 0, points.len() - 1, false));
}

fn of_tree(times: &FrameTimes) -> f64 {
    passes_ms(times, |name| name.starts_with("hierarchy."))
}

/// One triangle fewer, which is another list, so that the hierarchy is built anew.
fn shorten(meshes: &mut [MeshInstance]) {
    for mesh in meshes.iter_mut().filter(|m| m.role.blocks()) {
        if let Geometry::Buffers(buffers) = &mut mesh.geometry {
            buffers.count -= 3;
        }
    }
}

fn shift(meshes: &mut [MeshInstance], by: f64) {
    for mesh in meshes.iter_mut().filter(|m| m.role.blocks()) {
        mesh.world_from_mesh = DMat4::from_translation(DVec3::X * by) * mesh.world_from_mesh;
    }
}

/// The passes of the hierarchy, built, fitted to a mesh that moved, and kept; and the whole frame of each.
fn tree(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table
        .head("triangles|build ms|a million|refit ms|a million|kept ms|frame: built|refitted|kept");
    let counts: &[u32] = if scale.quick {
        &[64_000, 256_000]
    } else {
        &[16_000, 64_000, 256_000, 871_000, 1_000_000]
    };
    for &wished in counts {
        let triangles = 12 * cells_of(wished).pow(2);
        let point = Point { triangles, ..CENTER };
        let mut ready = point.ready(device, "");
        let mut times: [Vec<FrameTimes>; 3] = Default::default();
        for round in 0..scale.rounds as u64 {
            let even = round % 2 == 0;
            // The list differs from that of the frame before; then the mesh moves; then it stands.
            let built = |m: &mut [MeshInstance]| {
                if even {
                    shorten(m);
                }
            };
            let moved = |m: &mut [MeshInstance]| {
                built(m);
                shift(m, 0.01 * (1 + round) as f64);
            };
            times[0].push(ready.with_meshes(Some(2 * round), built).run());
            times[1].push(ready.with_meshes(Some(2 * round + 1), moved).run());
            times[2].push(ready.with_meshes(Some(2 * round + 1), moved).run());
        }
        let [build, refit, kept] = times.each_ref().map(|t| median_of(t, of_tree));
        let frames = times.each_ref().map(|t| median_of(t, crate::ready::frame_ms));
        let [of_build, of_refit] = [build, refit].map(|ms| ms * 1e6 / f64::from(triangles));
        let tree = format!("{build:.1}|{of_build:.0}|{refit:.1}|{of_refit:.0}|{kept:.2}");
        let frames = frames.map(|ms| format!("{ms:.1}")).join("|");
        table.row(format!("{triangles}|{tree}|{frames}"));
    }
}

/// The surface-area cost of the device's tree beside that of obvhs's.
fn area(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|triangles|cost|obvhs's|ratio");
    let light = || generate::square_light(CENTER.light).unwrap();
    let balls: &[u32] = if scale.quick { &[64_000] } else { &[64_000, 871_000] };
    let balls = balls
        .iter()
        .map(|&triangles| (format!("ball of {triangles}"), Point { triangles, ..CENTER }.scene()));
    let made =
        ["bunny", "suzanne", "foliage", "hills"].map(|n| (n.into(), made(n, light()).unwrap()));
    for (name, scene) in made.into_iter().chain(balls) {
        let mut ready = Ready::over(device, &scene, "traced", HALF, 32);
        let blocking = || scene.instances.iter().filter(|i| i.role.blocks());
        let count = |i: &antumbra::scene::Instance| scene.meshes[i.mesh].indices.len() / 3;
        let leaves = blocking().map(|i| count(i).div_ceil(LEAF as usize)).sum();
        let here = ready.tree(leaves).cost();
        let there = RayTracer::new(&scene).unwrap().tree_cost();
        let triangles: usize = blocking().map(count).sum();
        table.row(format!("{name}|{triangles}|{here:.1}|{there:.1}|{:.2}", here / there));
    }
}
