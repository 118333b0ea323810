//! An engine built on vk-graph that hosts antumbra's node.
//!
//! `cargo run --release --example embed_vk_graph -- --out out/embed_vk_graph`
//!
//! vk-graph owns the device, the images and every barrier; the node is one command of its graph.
//! This file is the story, in order. Of the others, `shadows` is all that is there for the node;
//! the rest is the engine, and would be there without shadows too:
//!
//! ```text
//!   options    the command line                        device     vk-graph's device, by name
//!   world      scene, light, camera                    geometry   vertex and index buffers
//!   targets    the images of the picture's size        gbuffer    draws depth, normal, mask
//!   shadows    the node as a foreign pass              compose    visibility × irradiance
//!   frames     two frames in flight, read-back         shot       what a frame's passes are given
//!   output     EXR and PNG
//! ```

#![allow(unsafe_code, reason = "lending the device is a promise that only the engine can make")]

mod compose;
mod device;
mod frames;
mod gbuffer;
mod geometry;
mod options;
mod output;
mod shadows;
mod shot;
mod targets;
mod world;

use compose::ComposePass;
use device::Gpu;
use frames::{FRAMES_IN_FLIGHT, Frames, ReadBack};
use gbuffer::GBufferPass;
use options::Options;
use shadows::Shadows;
use shot::Shot;
use std::process::ExitCode;
use std::time::Instant;
use targets::Targets;
use vk_graph::Graph;
use world::World;

/// A result whose error, of any kind, is printed and ends the example.
type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    // Bad input is 2, a device that will not do is 1.
    let tell = |problem: &dyn std::fmt::Display, status: u8| {
        eprintln!("{}", problem.to_string().replace('\n', " "));
        ExitCode::from(status)
    };
    let options = match options::parse() {
        Ok(options) => options,
        Err(problem) => return tell(&problem, 2),
    };
    let world = match World::load(&options.scene) {
        Ok(world) => world,
        Err(problem) => return tell(&problem, 2),
    };
    match run(&options, &world) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => tell(&problem, 1),
    }
}

fn run(options: &Options, world: &World) -> Outcome<()> {
    // ---- Set up -----------------------------------------------------------------------------
    let gpu = Gpu::open()?;
    println!("{}", gpu.name());
    let gbuffer_pass = GBufferPass::new(&gpu)?;
    let compose_pass = ComposePass::new(&gpu)?;
    let models = geometry::upload(&gpu, &world.scene)?;
    let mut targets = Targets::new(&gpu, options.size)?;
    let mut shadows = Shadows::new(&gpu, options.size, options.settings)?;
    let mut frames = Frames::new(&gpu);

    println!("frame  size        plan µs  passes  barriers");
    let exposure = world.exposure();
    let mut resizes = 0;
    let mut read_back = None;
    for number in 0..options.frames {
        // ---- Wait for the slot --------------------------------------------------------------
        // The frame before last had it; what that one was the last to use can go.
        if let Some(done) = frames.wait(number)? {
            shadows.frame_done(done);
        }

        // ---- Resize -------------------------------------------------------------------------
        // The frame before this one may still run on the old images: its graph keeps those of the
        // engine, `shadows` those of the node.
        while number > 0 && resizes < resizes_due(options, number) {
            resizes += 1;
            let extent = size_after(options, resizes);
            targets = Targets::new(&gpu, extent)?;
            shadows.resize(extent, number - 1)?;
        }

        // ---- Graph --------------------------------------------------------------------------
        let clip_from_world = world.clip_from_world(targets.extent);
        let shot = Shot {
            slot: antumbra::Slot(Frames::slot_of(number)),
            clip_from_world,
            world_from_ndc: clip_from_world.inverse(),
            light: &world.light,
            exposure,
            models: &models,
            targets: &targets,
            lie: options.lie,
        };
        // Pure: what the node will do this frame, from what the engine says of it.
        let started = Instant::now();
        let plan = shadows.plan(&shot)?;
        let planned = started.elapsed();
        let steps = &plan.plan().steps;
        let (passes, barriers) =
            (steps.len(), steps.iter().map(|s| s.barriers.len()).sum::<usize>());

        let mut graph = Graph::new();
        gbuffer_pass.add(&mut graph, &shot);
        let recorded = shadows.add(&mut graph, &shot, plan)?;
        compose_pass.add(&mut graph, &shot);
        if number + 1 == options.frames {
            read_back = Some(ReadBack::add(&gpu, &mut graph, &targets)?);
        }
        frames.submit(number, graph)?;

        // The submit has recorded every command, the node's too.
        recorded.try_recv().map_err(|_| "the graph left the node out")??;
        let [width, height] = targets.extent;
        println!(
            "{number:>5}  {:<10}  {:>7.1}  {passes:>6}  {barriers:>8}",
            format!("{width}×{height}"),
            planned.as_secs_f64() * 1e6,
        );
    }

    // ---- Tear down --------------------------------------------------------------------------
    // Wait for the frames in flight; then the node may go, before the device that it borrowed.
    for number in options.frames..options.frames + u64::from(FRAMES_IN_FLIGHT) {
        if let Some(done) = frames.wait(number)? {
            shadows.frame_done(done);
        }
    }
    let (objects, memory) = (shadows.node.object_count(), shadows.node.memory());
    let bytes: u64 = memory.iter().map(|r| r.bytes).sum();
    println!("the node: {objects} Vulkan objects, {bytes} bytes");
    match shadows.destroy()? {
        0 => println!("the node is gone: 0 bytes left"),
        left => return Err(format!("the node is gone, but {left} of its bytes are left").into()),
    }
    if let Some(read_back) = &read_back {
        output::write(&options.out, targets.extent, read_back)?;
    }
    Ok(())
}

/// The number of resizes that come before a frame: they are spread over the run.
fn resizes_due(options: &Options, number: u64) -> u64 {
    let steps = (options.frames - 1).max(1);
    (options.resizes * number + steps / 2) / steps
}

/// The size behind a resize: other ones, and --size behind the last.
fn size_after(options: &Options, resize: u64) -> [u32; 2] {
    if resize == options.resizes {
        return options.size;
    }
    // Larger, narrower, flatter; in quarters of --size.
    let quarters = [[5, 5], [2, 3], [4, 1]][(resize % 3) as usize];
    [0, 1].map(|axis| (options.size[axis] * quarters[axis] / 4).clamp(1, 16384))
}
