//! What leaving out what a scene does not call for saves, and what planning takes.
//!
//! `cargo bench --bench planner` (`-- --quick` for fewer rounds, names of tables for those alone).
//! Everything is measured in one process, the things that are compared in turns, and told as medians.

// A bench tells what goes wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../technique/mod.rs"]
mod technique;

use antumbra::frame::{Limits, plan_all};
use antumbra::graph::{MeshList, Scope};
use antumbra::scene::{Role, generate};
use antumbra::{Description, Frame, FramePlans, Geometry, HostImage, MeshBuffers, MeshInstance};
use antumbra::{RectangleLight, Technique};
use antumbra_harness::cases;
use antumbra_harness::{FrameTimes, HeadlessDevice, HeadlessOptions, Stage, View};
use ash::vk::{self, Handle};
use glam::{DMat4, DVec3};
use std::time::Instant;
use technique::table::Table;
use technique::{Options, Study, make_tables};

const STUDIES: [Study; 2] = [("pruned", pruned), ("planning", planning)];

fn main() {
    let full = Options { rounds: 15, sides: &[256] };
    make_tables(&STUDIES, full, Options { rounds: 5, sides: &[256] });
}

/// The pixels of a view a side.
const SIDE: u32 = 256;

fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

fn settings(words: &str) -> Settings {
    let mut settings = Technique::default();
    for word in words.split_whitespace() {
        match word.split_once('=').unwrap() {
            ("technique", name) => settings.technique = name.parse().unwrap(),
            (key, value) => settings.set(key, value).unwrap(),
        }
    }
    settings
}

/// Each scene of `tests/planner`, with everything that its technique has and with what it calls for.
fn pruned(_: &HeadlessDevice, options: &Options) -> Table {
    let wish = HeadlessOptions { statistics: true, ..Default::default() };
    let device = HeadlessDevice::new(&wish).unwrap();
    let columns = [
        "passes",
        "of",
        "ms",
        "of ",
        "vertices",
        "of  ",
        "fragments",
        "of   ",
        "threads",
        "of    ",
    ];
    let mut table = Table::new("pruned", &columns);
    for case in cases::cases() {
        let scene = &case.scene;
        let light = scene.light(None).unwrap().light;
        let view = View::map_of_ground(case.half, 8.0);
        let mut stages = [Some(1.0 / 256.0), None].map(|max_error| {
            let keep = |i: &antumbra::scene::Instance| i.role != Role::Occluder;
            let mut stage = Stage::new(
                &device,
                scene,
                &view,
                [SIDE; 2],
                settings("technique=hard map=16"),
                keep,
            )
            .unwrap();
            stage.configure_with(settings(case.words), |d| d.max_error = max_error).unwrap();
            stage
        });
        let plans = stages.each_mut().map(|stage| stage.plan(&light, None).unwrap());
        let mut times: [Vec<FrameTimes>; 2] = Default::default();
        // The first frame compiles what the driver compiles.
        for round in 0..=options.rounds {
            for ((stage, plan), times) in stages.iter_mut().zip(&plans).zip(&mut times) {
                let frame = stage.run(plan).unwrap();
                if round > 0 {
                    times.push(frame);
                }
            }
        }
        let counts = [0, 1].map(|i| stages[i].count(&plans[i]).unwrap());
        let ms = times.map(|t| median(t.iter().map(|t| 1e3 * t.frame.as_secs_f64()).collect()));
        let mut row = Vec::new();
        let mut both = |of: [String; 2]| row.extend(of);
        both(plans.each_ref().map(|p| p.plan.steps.len().to_string()));
        both(ms.map(|ms| format!("{ms:.2}")));
        let told = |of: fn(&antumbra_harness::Invocations) -> u64| {
            counts.map(|c| c.map_or_else(|| "-".into(), |c| of(&c).to_string()))
        };
        both(told(|c| c.vertex));
        both(told(|c| c.fragment));
        both(told(|c| c.compute));
        println!("{}", case.name);
        table.row(row);
    }
    table
}

/// Frames of many meshes under many lights, of which each reaches some; no device.
fn planning(_: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["meshes", "lights", "reach m", "scene", "draws", "us a frame", "us a light"];
    let mut table = Table::new("planning", &columns);
    for (meshes, lights) in [(10, 1), (100, 4), (1000, 1), (1000, 4), (1000, 16)] {
        for (reach, stays) in [(None, false), (Some(8.0), false), (None, true), (Some(8.0), true)] {
            let all = instances(meshes);
            let description = Description { lights: 16, ..Description::new([1920, 1080]) };
            let of = |i: u32| Frame {
                light_index: i,
                reach,
                revision: stays.then_some(1),
                ..frame(lamp(i), &all)
            };
            let frames: Vec<Frame> = (0..lights).map(of).collect();
            let mut plans = FramePlans::new();
            let mut times = Vec::new();
            for _ in 0..=40 * options.rounds {
                let started = Instant::now();
                plan_all(&description, Limits::default(), &frames, &mut plans).unwrap();
                times.push(1e6 * started.elapsed().as_secs_f64());
            }
            let draws = plans.all().iter().map(|p| p.meshes(MeshList::Occluders).len());
            let us = median(times);
            table.row(vec![
                meshes.to_string(),
                lights.to_string(),
                reach.map_or_else(|| "-".into(), |r| r.to_string()),
                if stays { "stays" } else { "moves" }.into(),
                draws.sum::<usize>().to_string(),
                format!("{us:.1}"),
                format!("{:.1}", us / f64::from(lights)),
            ]);
        }
    }
    table
}

/// Boxes on a ground, in rows.
fn instances(count: u32) -> Vec<MeshInstance> {
    let buffers = MeshBuffers {
        positions: vk::Buffer::from_raw(3),
        positions_offset: 0,
        positions_stride: 12,
        indices: None,
        count: 36,
    };
    let mesh = |bounds, at, role| MeshInstance {
        geometry: Geometry::Buffers(buffers),
        world_from_mesh: DMat4::from_translation(at),
        bounds,
        role,
        double_sided: false,
        cut_out: false,
    };
    let ground = mesh([[-50.0, 0.0, -50.0], [50.0, 0.0, 50.0]], DVec3::ZERO, Role::Receiver);
    let place =
        |i: u32| DVec3::new(f64::from(i % 32) * 3.0 - 48.0, 0.5, f64::from(i / 32) * 3.0 - 48.0);
    let cube = |i| mesh([[-0.5; 3], [0.5; 3]], place(i), Role::Both);
    std::iter::once(ground).chain((1..count).map(cube)).collect()
}

fn lamp(i: u32) -> RectangleLight {
    let light = generate::square_light(0.5).unwrap();
    let at = DVec3::new(f64::from(i % 4) * 20.0 - 30.0, 4.0, f64::from(i / 4) * 20.0 - 30.0);
    RectangleLight::new(at, DVec3::X * light.half_extents()[0], DVec3::NEG_Z * 0.25).unwrap()
}

fn frame(light: RectangleLight, meshes: &[MeshInstance]) -> Frame<'_> {
    let depth = HostImage {
        image: vk::Image::from_raw(1),
        view: vk::ImageView::from_raw(2),
        format: vk::Format::D32_SFLOAT,
        extent: [1920, 1080],
        usage: vk::ImageUsageFlags::SAMPLED,
        before: Scope::FRAGMENT_SAMPLED,
        after: Scope::FRAGMENT_SAMPLED,
    };
    let above = DMat4::from_scale(DVec3::new(50.0, 50.0, 4.0));
    Frame { background: Some(0.0), ..Frame::new(light, above, meshes, depth) }
}
