//! A small engine that hosts antumbra's node.
//!
//! `cargo run --release --example embed -- --out out/embed`
//!
//! No window: twelve frames of a light that goes round, resized half way, a few of them written as
//! PNG; or, with `--walk`, sixty of a figure that walks, posed on the device. This file is the engine's story, in order; `shadows` is all that it does for its soft shadows;
//! the rest is an engine in raw ash, and would be there without shadows too:
//!
//! ```text
//!   device     instance, device, queue, allocator      world      objects, light, camera
//!   resources  images, buffers, barriers               geometry   vertex and index buffers
//!   gbuffer    draws depth, albedo, normal, mask       jelly      a mesh that moves in its shader
//!   compose    visibility × unshadowed irradiance      frames     two frames in flight
//!   posing     poses meshes on the device              skin       what they hang on, and their box
//!   figure     a figure that walks
//! ```

#![allow(unsafe_code, reason = "an engine calls Vulkan")]

mod compose;
mod device;
mod figure;
mod files;
mod frames;
mod gbuffer;
mod geometry;
mod jelly;
mod posing;
#[cfg(test)]
mod refusals;
mod resources;
mod shadows;
mod skin;
#[cfg(test)]
mod walk;
mod world;

use antumbra::{BorderBarriers, LightIndex, ResourceBytes, Retired, Slot, Technique};
use ash::vk;
use clap::Parser;
use compose::ComposePass;
use device::Gpu;
use frames::{FRAMES_IN_FLIGHT, FrameNotes, Frames};
use gbuffer::{GBuffer, GBufferPass};
use geometry::Model;
use posing::PosingPass;
use resources::{COLOR_DRAWN, COMPOSE_READS, COMPOSE_WRITES, COPY_READS, Image, barrier};
use shadows::Shadows;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use world::{Seen, World};

/// A result whose error, of any kind, is printed and ends the example.
type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// A small engine that hosts antumbra's node: an animation without a window, a few frames as PNG.
#[derive(Parser)]
#[command(name = "embed")]
struct Options {
    /// A glTF scene with an area light, instead of the world that this example brings
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// A figure that walks, posed on the device, instead of that world
    #[arg(long, conflicts_with = "scene")]
    walk: bool,
    /// The folder for the pictures, and visibility.exr and depth.exr of the last frame
    #[arg(long, value_name = "DIR", default_value = "out/embed")]
    out: PathBuf,
    /// Width and height
    #[arg(long, value_name = "WxH", default_value = "640x480", value_parser = parse_size)]
    size: [u32; 2],
    /// How many frames
    #[arg(long, value_name = "N", default_value_t = 12, default_value_if("walk", "true", "60"))]
    frames: u64,
    /// How many times everything is resized on the way; with more than one, the last is back to --size
    #[arg(long, value_name = "N", default_value_t = 1)]
    resizes: u64,
    /// Place the barriers at the node's border here, from what its plan says
    #[arg(long)]
    host_barriers: bool,
    /// Run under the validation layer with synchronization checks; any message fails the run
    #[arg(long)]
    validate: bool,
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    parsed
        .filter(|s| s.iter().all(|&e| (1..=16384).contains(&e)))
        .ok_or_else(|| "write width and height as in 640x480, each 1 to 16384".into())
}

/// Everything of the window's size, had there been a window.
struct Targets {
    gbuffer: GBuffer,
    picture: Image,
}

/// The objects that a resize replaced, and the last frame that may use them.
struct Replaced {
    last_frame: u64,
    targets: Targets,
    node: Retired,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let outcome = run(&options);
    if let Err(problem) = &outcome {
        eprintln!("{problem}");
    }
    // Counted behind everything, so that what is said of the teardown counts too.
    let messages = device::messages();
    if options.validate {
        println!("{messages} validation messages");
    }
    if outcome.is_ok() && messages == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn run(options: &Options) -> Outcome<()> {
    std::fs::create_dir_all(&options.out)?;

    // ---- Set up -----------------------------------------------------------------------------
    let mut world = match &options.scene {
        Some(path) => World::from_file(path, options.size)?,
        None if options.walk => World::walk()?,
        None => World::built_in(),
    };
    let mut gpu = Gpu::new(options.validate)?;
    let posing_pass = PosingPass::new(&gpu)?;
    let gbuffer_pass = GBufferPass::new(&gpu)?;
    let compose_pass = ComposePass::new(&gpu)?;
    let mut frames = Frames::new(&gpu)?;
    let mut models = std::mem::take(&mut world.objects)
        .into_iter()
        .map(|object| Model::new(&mut gpu, &posing_pass, object))
        .collect::<Outcome<Vec<_>>>()?;
    let mut extent = options.size;
    let mut targets = make_targets(&gbuffer_pass, &mut gpu, extent)?;
    let border_barriers =
        if options.host_barriers { BorderBarriers::Host } else { BorderBarriers::Node };
    let mut shadows = Shadows::new(&mut gpu, extent, Technique::default(), border_barriers)?;

    println!("{}", gpu.name);
    println!("frame  size      plan µs  record µs  passes  GPU ms  node MB");
    let mut replaced: Vec<Replaced> = Vec::new();
    let mut resizes = 0;
    for number in 0..options.frames {
        // ---- Wait for the slot --------------------------------------------------------------
        // The frame before last had it; what that one was the last to use can go.
        let slot = (number % FRAMES_IN_FLIGHT as u64) as usize;
        if let Some(done) = frames.wait(&gpu, slot)? {
            tell(options, &shadows, &frames, slot, &done)?;
            destroy_replaced(&mut replaced, &mut gpu, done.number);
        }

        // ---- Resize -------------------------------------------------------------------------
        // The frame before this one may still run on the old images: they wait until it is done.
        while number > 0 && resizes < resizes_due(options, number) {
            resizes += 1;
            extent = size_after(options, resizes);
            let new = make_targets(&gbuffer_pass, &mut gpu, extent)?;
            let started = Instant::now();
            let retired = shadows.node.resize(&mut gpu.allocator, extent)?;
            if options.resizes < 10 {
                let ms = started.elapsed().as_secs_f64() * 1e3;
                println!("resize to {}×{}: {ms:.1} ms", extent[0], extent[1]);
            }
            replaced.push(Replaced {
                last_frame: number - 1,
                targets: std::mem::replace(&mut targets, new),
                node: retired,
            });
        }

        // ---- Pose ---------------------------------------------------------------------------
        // The processor says where joints are and how large the box around them is; the device does the rest.
        let seconds = number as f64 / 12.0;
        models.iter_mut().try_for_each(|model| model.pose(slot, seconds))?;

        // ---- Plan ---------------------------------------------------------------------------
        let last = number + 1 == options.frames;
        // In the last frame the light looks at the sky: the plan is one pass then.
        let light = world.light(seconds, number > 0 && last)?;
        let clip_from_world = world.clip_from_world(extent);
        let Targets { gbuffer, picture } = &targets;
        let seen = Seen {
            light: &light,
            clip_from_world: &clip_from_world,
            models: &models,
            gbuffer,
            seconds,
            slot,
            revision: world.revision(&models),
        };
        let started = Instant::now();
        shadows.plan(&seen)?;
        let plan_time = started.elapsed();

        // ---- Record -------------------------------------------------------------------------
        let copies = if last { 3 } else { 1 };
        let cmd = frames.begin(&mut gpu, slot, extent, copies)?;
        posing_pass.record(&gpu, cmd, slot, &models);
        gbuffer_pass.record(&gpu, cmd, &seen);
        let started = Instant::now();
        shadows.record(&gpu, cmd, &seen)?;
        let record_time = started.elapsed();

        // What the node was lent, and visibility, are ready to be fetched, as the frame says. The
        // engine takes care of the rest.
        for image in [&gbuffer.albedo, &gbuffer.normal] {
            barrier(&gpu, cmd, image, COLOR_DRAWN, COMPOSE_READS);
        }
        barrier(&gpu, cmd, picture, COPY_READS.forgotten(), COMPOSE_WRITES);
        let visibility = shadows.node.visibility().ok_or("the node has a result of its own")?;
        let push =
            compose::Push::new(&clip_from_world.inverse(), light.rectangle(), world::RADIANCE);
        compose_pass.record(&gpu, cmd, slot, (gbuffer, &visibility), picture, &push);
        barrier(&gpu, cmd, picture, COMPOSE_WRITES, COPY_READS);
        let (color, depth) = (vk::ImageAspectFlags::COLOR, vk::ImageAspectFlags::DEPTH);
        let out = [(picture.raw, color), (visibility.image, color), (gbuffer.depth.raw, depth)];
        for &(image, aspect) in &out[1..copies] {
            let (before, after) = (COMPOSE_READS, COPY_READS);
            let barrier = antumbra::frame::ImageBarrier { image, layer: 0, aspect, before, after };
            gpu.place(cmd, &barrier);
        }
        let notes = FrameNotes {
            number,
            extent,
            plan: plan_time,
            record: record_time,
            passes: shadows.planned().map_or(0, |plan| plan.plan().steps.len()),
        };
        frames.submit(&gpu, slot, &out[..copies], notes)?;
    }

    // ---- Tear down --------------------------------------------------------------------------
    // Wait for the frames in flight, oldest first; then everything may go, the node before the
    // device that it borrowed.
    for number in options.frames..options.frames + FRAMES_IN_FLIGHT as u64 {
        let slot = (number % FRAMES_IN_FLIGHT as u64) as usize;
        if let Some(done) = frames.wait(&gpu, slot)? {
            tell(options, &shadows, &frames, slot, &done)?;
            destroy_replaced(&mut replaced, &mut gpu, done.number);
        }
    }
    println!("the node: {} Vulkan objects, and in memory:", shadows.node.object_count());
    for ResourceBytes { name, bytes } in shadows.node.memory() {
        println!("  {name:<32} {:>9.1} kB", bytes as f64 / 1e3);
    }
    shadows.destroy(&mut gpu);
    targets.destroy(&mut gpu);
    models.into_iter().for_each(|model| model.destroy(&mut gpu));
    frames.destroy(&mut gpu);
    compose_pass.destroy(&gpu);
    gbuffer_pass.destroy(&gpu);
    posing_pass.destroy(&gpu);
    match gpu.destroy() {
        0 => println!("{resizes} resizes; all memory was given back"),
        bytes => return Err(format!("{bytes} bytes were never given back").into()),
    }
    Ok(())
}

/// The number of resizes that come before a frame: they are spread over the run.
fn resizes_due(options: &Options, number: u64) -> u64 {
    let steps = (options.frames - 1).max(1);
    (options.resizes * number + steps / 2) / steps
}

/// The size behind the n-th resize.
fn size_after(options: &Options, n: u64) -> [u32; 2] {
    if options.resizes > 1 && n == options.resizes {
        return options.size;
    }
    let factor = [1.25, 0.5, 0.8][(n - 1) as usize % 3];
    options.size.map(|e| ((f64::from(e) * factor) as u32).max(1))
}

fn make_targets(pass: &GBufferPass, gpu: &mut Gpu, extent: [u32; 2]) -> Outcome<Targets> {
    let gbuffer = pass.images(gpu, extent)?;
    Ok(Targets { gbuffer, picture: ComposePass::picture(gpu, extent)? })
}

impl Targets {
    fn destroy(self, gpu: &mut Gpu) {
        self.gbuffer.destroy(gpu);
        self.picture.destroy(gpu);
    }
}

/// Destroys what no frame after `done` uses.
fn destroy_replaced(replaced: &mut Vec<Replaced>, gpu: &mut Gpu, done: u64) {
    while replaced.first().is_some_and(|r| r.last_frame <= done) {
        let old = replaced.remove(0);
        old.targets.destroy(gpu);
        old.node.destroy(&mut gpu.allocator);
    }
}

/// One line about a frame that is done, and its picture where it is one of a few.
fn tell(
    options: &Options,
    shadows: &Shadows,
    frames: &Frames,
    slot: usize,
    done: &FrameNotes,
) -> Outcome<()> {
    let node = &shadows.node;
    // None where the device has no timestamps.
    let gpu_ms = node.timings(Slot(slot as u32), LightIndex(0)).map_or_else(
        || "-".into(),
        |rows| format!("{:.1}", rows.iter().map(|pass| pass.ms).sum::<f64>()),
    );
    println!(
        "{:>5}  {:<8}  {:>7.1}  {:>9.1}  {:>6}  {gpu_ms:>6}  {:>7.2}",
        done.number,
        format!("{}×{}", done.extent[0], done.extent[1]),
        done.plan.as_secs_f64() * 1e6,
        done.record.as_secs_f64() * 1e6,
        done.passes,
        node.memory().iter().map(|r| r.bytes).sum::<u64>() as f64 / 1e6,
    );
    let last = done.number + 1 == options.frames;
    if done.number.is_multiple_of(3) || last {
        let path = options.out.join(format!("frame_{:02}.png", done.number));
        files::png(&path, frames.copy(slot, done, 0)?, done.extent)?;
    }
    if last {
        for (number, name) in [(1, "visibility.exr"), (2, "depth.exr")] {
            files::exr(&options.out.join(name), frames.copy(slot, done, number)?, done.extent)?;
        }
    }
    Ok(())
}
