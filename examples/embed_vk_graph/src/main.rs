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
//!   frames     two frames in flight, read-back         output     EXR and PNG
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
mod targets;
mod world;

use compose::ComposePass;
use device::Gpu;
use frames::{Frames, ReadBack};
use gbuffer::GBufferPass;
use options::Options;
use shadows::Shadows;
use std::process::ExitCode;
use targets::Targets;
use vk_graph::Graph;
use world::World;

/// What goes wrong in an example is told and ends it.
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
    let mut frames = Frames::new(&gpu);
    let mut shadows = Shadows::new(&gpu, options.size, options.settings)?;
    targets.visibility = shadows.visibility(&gpu);

    let count = options.frames.max(options.resizes + 1);
    let mut read_back = None;
    println!("frame  size      plan µs  record µs  passes");
    for number in 0..count {
        if let Some(done) = frames.wait(number)? {
            shadows.frame_done(done);
        }
        if (1..=options.resizes).contains(&number) {
            let extent = size_after(options, number);
            targets = Targets::new(&gpu, extent)?;
            shadows.resize(extent, number - 1)?;
            targets.visibility = shadows.visibility(&gpu);
        }
        let clip_from_world = world.clip_from_world(targets.extent);
        let world_from_ndc = clip_from_world.inverse();

        let mut graph = Graph::new();
        let nodes = targets.bind(&mut graph);
        let drawn: Vec<_> = models.iter().map(|m| (m, m.bind(&mut graph))).collect();
        gbuffer_pass.add(&mut graph, &nodes, &drawn, &clip_from_world);
        let told = shadows.add(
            &mut graph,
            &targets,
            &nodes,
            &drawn,
            world.light.light,
            world_from_ndc,
            Frames::slot_of(number),
            options.lie,
        )?;
        compose_pass.add(&mut graph, &nodes, targets.extent, &world_from_ndc, world);
        if number + 1 == count {
            read_back = Some(ReadBack::add(&gpu, &mut graph, &targets, &nodes)?);
        }
        frames.submit(number, graph)?;
        println!("{number} {:?} {:?} {} {:?}", targets.extent, told.plan, told.passes, told.recorded.get());
    }
    for number in count..count + u64::from(frames::FRAMES_IN_FLIGHT) {
        if let Some(done) = frames.wait(number)? {
            shadows.frame_done(done);
        }
    }
    println!("{:?}", shadows.size());
    if let Some(read_back) = &read_back {
        output::write(&options.out, targets.extent, read_back)?;
    }
    let left = shadows.destroy()?;
    println!("{left} bytes left");
    Ok(())
}

/// The size behind a resize: other ones, and --size behind the last.
fn size_after(options: &Options, resize: u64) -> [u32; 2] {
    const OTHERS: [[u32; 2]; 3] = [[5, 5], [2, 3], [4, 1]];
    let [width, height] = options.size;
    if resize == options.resizes {
        return options.size;
    }
    let [a, b] = OTHERS[(resize % 3) as usize];
    [(width * a / 4).clamp(1, 16384), (height * b / 4).clamp(1, 16384)]
}
