//! What leaving out what a scene does not call for saves, and what planning takes.

use crate::ready::{frame_ms, median_of};
use crate::table::Table;
use crate::{Bench, Scale};
use antumbra::frame::{Limits, plan_all};
use antumbra::graph::{MeshList, Scope};
use antumbra::scene::{Instance, Role, generate};
use antumbra::{Description, Frame, FramePlans, Geometry, HostImage, LightIndex};
use antumbra::{MeshBuffers, MeshInstance, Omit, RectangleLight, Slot};
use antumbra_bench::stats::median;
use antumbra_harness::{FrameTimes, HeadlessDevice, HeadlessOptions, Invocations, Stage, View};
use antumbra_harness::{cases, technique, technique_of};
use ash::vk::{self, Handle};
use glam::{DMat4, DVec3};
use std::time::Instant;

pub const BENCH: Bench = Bench {
    name: "planner",
    about: "The planner: what leaving out effects saves, and what planning takes",
    studies: &[("pruned", pruned), ("planning", planning)],
    full: Scale { rounds: 15, sides: &[], quick: false },
    quick: Scale { rounds: 5, sides: &[], quick: true },
};

/// The pixels of a view a side.
const SIDE: u32 = 256;

/// Each scene of `tests/planner`, with everything that its technique has and with what it calls for.
fn pruned(_: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    let wish = HeadlessOptions { statistics: true, ..Default::default() };
    let device = HeadlessDevice::new(&wish).unwrap();
    let columns = "passes|of|ms|of |vertices|of  |fragments|of   |threads|of    ";
    table.head(columns);
    for case in cases::cases() {
        let scene = &case.scene;
        let light = scene.light(None).unwrap().light;
        let view = View::map_of_ground(case.half, 8.0);
        let mut stages = [Omit::default(), Omit::Nothing].map(|omit| {
            let keep = |i: &Instance| i.role != Role::Occluder;
            let hard = technique("hard map=16");
            let mut stage = Stage::new(&device, scene, &view, [SIDE; 2], hard, keep).unwrap();
            stage.configure_with(technique_of(case.words).unwrap(), |d| d.omit = omit).unwrap();
            stage
        });
        let plans = stages.each_mut().map(|stage| stage.plan(light, None).unwrap());
        let mut times: [Vec<FrameTimes>; 2] = Default::default();
        // The first frame compiles what the driver compiles.
        for round in 0..=scale.rounds {
            for ((stage, plan), times) in stages.iter_mut().zip(&plans).zip(&mut times) {
                let frame = stage.run(plan).unwrap();
                if round > 0 {
                    times.push(frame);
                }
            }
        }
        let counts = [0, 1].map(|i| stages[i].count(&plans[i]).unwrap());
        let [passes, of] = plans.each_ref().map(|p| p.plan().steps.len());
        let [ms, of_ms] = times.map(|t| median_of(&t, frame_ms));
        let count = |of: fn(&Invocations) -> u64| {
            counts.map(|c| c.map_or_else(|| "-".into(), |c| of(&c).to_string())).join("|")
        };
        let counts = [count(|c| c.vertex), count(|c| c.fragment), count(|c| c.compute)].join("|");
        println!("{}", case.name);
        table.row(format!("{passes}|{of}|{ms:.2}|{of_ms:.2}|{counts}"));
    }
}

/// Frames of many meshes under many lights, of which each reaches some; no device.
fn planning(_: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("meshes|lights|reach m|scene|draws|us a frame|us a light");
    for (meshes, lights) in [(10, 1), (100, 4), (1000, 1), (1000, 4), (1000, 16)] {
        for (reach, stays) in [(None, false), (Some(8.0), false), (None, true), (Some(8.0), true)] {
            let all = instances(meshes);
            let description = Description { lights: 16, ..Description::new([1920, 1080]) };
            let of = |i: u32| Frame {
                light_index: LightIndex(i),
                reach,
                revision: stays.then_some(1),
                ..frame(lamp(i), &all)
            };
            let frames: Vec<Frame> = (0..lights).map(of).collect();
            let mut plans = FramePlans::new();
            let mut times = Vec::new();
            for _ in 0..=40 * scale.rounds {
                let started = Instant::now();
                plan_all(&description, Limits::default(), &frames, &mut plans).unwrap();
                times.push(1e6 * started.elapsed().as_secs_f64());
            }
            let draws = plans.all().iter().map(|p| p.meshes(MeshList::Occluders).len());
            let draws: usize = draws.sum();
            let us = median(&times);
            let each = us / f64::from(lights);
            let reach = reach.map_or_else(|| "-".into(), |r| r.to_string());
            let moves = if stays { "stays" } else { "moves" };
            table.row(format!("{meshes}|{lights}|{reach}|{moves}|{draws}|{us:.1}|{each:.1}"));
        }
    }
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
        opacity: None,
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
    let world_from_ndc = DMat4::from_scale(DVec3::new(50.0, 50.0, 4.0));
    let frame = Frame::new(Slot(0), light, world_from_ndc, meshes, depth);
    // An orthographic view does not say which end of depth is far.
    Frame { background: Some(0.0), ..frame }
}
