//! A small engine that hosts antumbra's node.
//!
//! `cargo run --release --example embed -- --out out/embed`
//!
//! No window: twelve frames of a light that goes round, resized half way, a few of them written as
//! PNG. This file is the story, in order; the other files are the engine around it, in raw ash, and
//! would be there without shadows too:
//!
//! ```text
//!   device     instance, device, queue, allocator      world      objects, light, camera
//!   resources  images, buffers, barriers               geometry   vertex and index buffers
//!   gbuffer    draws depth, albedo, normal, mask       frames     two frames in flight
//!   compose    visibility × unshadowed irradiance      border     --host-barriers
//! ```

#![allow(unsafe_code, reason = "an engine calls Vulkan")]

mod border;
mod compose;
mod device;
mod frames;
mod gbuffer;
mod geometry;
mod resources;
mod world;

use antumbra::{
    BorderBarriers, Description, Frame, Host, HostImage, Requirements, Retired, ShadowNode,
};
use ash::vk;
use clap::Parser;
use compose::ComposePass;
use device::Gpu;
use frames::{FRAMES_IN_FLIGHT, FrameNotes, Frames};
use gbuffer::{GBuffer, GBufferPass};
use geometry::Model;
use resources::{COLOR_DRAWN, COMPOSE_READS, COMPOSE_WRITES, COPY_READS, DEPTH_DRAWN, Image};
use resources::{barrier, forget};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// What goes wrong in an example is told and ends it.
type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// A small engine that hosts antumbra's node: an animation without a window, a few frames as PNG.
#[derive(Parser)]
#[command(name = "embed")]
struct Options {
    /// The folder for the pictures; made where it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/embed")]
    out: PathBuf,
    /// How many frames
    #[arg(long, value_name = "N", default_value_t = 12)]
    frames: u64,
    /// Place the barriers at the node's border here, from what its plan says
    #[arg(long)]
    host_barriers: bool,
    /// Run under the validation layer with synchronization checks; any message fails the run
    #[arg(long)]
    validate: bool,
}

/// Everything of the window's size, had there been a window.
struct Targets {
    gbuffer: GBuffer,
    picture: Image,
}

/// What a resize replaced, and the last frame that may use it.
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
    // The engine first: it would look like this without shadows too.
    let mut gpu = Gpu::new(options.validate)?;
    let gbuffer_pass = GBufferPass::new(&gpu)?;
    let compose_pass = ComposePass::new(&gpu)?;
    let mut frames = Frames::new(&gpu)?;
    let models = world::objects()
        .into_iter()
        .map(|object| Model::new(&mut gpu, object))
        .collect::<Outcome<Vec<_>>>()?;
    let mut extent = [640, 480];
    let mut targets = make_targets(&gbuffer_pass, &mut gpu, extent)?;

    // Lend the device. The node never creates or submits anything behind the engine's back.
    // SAFETY: the handles belong together and live until `gpu.destroy` below, behind the node; what
    // each frame lends is alive, in the said state, until the frame's fence is signalled; a slot is
    // recorded, and replaced objects are destroyed, only behind that fence.
    let mut host = unsafe {
        Host::borrow(
            gpu.instance.clone(),
            gpu.physical_device,
            gpu.device.clone(),
            gpu.queue_family,
        )
    }
    .with_pipeline_cache(gpu.pipeline_cache);
    if let Some(debug_utils) = &gpu.debug_utils {
        host = host.with_debug_utils(debug_utils.clone());
    }
    // One sentence with everything that is missing; on a device of Vulkan 1.1, nothing is.
    Requirements::of(&host).met()?;

    // The node. Its memory comes from the engine's allocator.
    let description = Description {
        frames_in_flight: FRAMES_IN_FLIGHT as u32,
        depth_format: gbuffer::DEPTH,
        mask_format: Some(gbuffer::MASK),
        position_strides: vec![geometry::STRIDE],
        ..Description::new(extent)
    };
    let mut node = ShadowNode::new(host.clone(), &mut gpu.allocator, description)?;

    println!("{}", gpu.name);
    println!("frame  size      plan µs  record µs  passes  GPU ms  node MB");
    let mut replaced: Vec<Replaced> = Vec::new();
    for number in 0..options.frames {
        // ---- Wait for the slot --------------------------------------------------------------
        // The frame before last had it; what that one was the last to use can go.
        let slot = (number % FRAMES_IN_FLIGHT as u64) as usize;
        if let Some(done) = frames.wait(&gpu, slot)? {
            tell(options, &node, &frames, slot, &done)?;
            destroy_replaced(&mut replaced, &mut gpu, done.number);
        }

        // ---- Resize -------------------------------------------------------------------------
        // The frame before this one may still run on the old images: they wait until it is done.
        if number > 0 && number == options.frames / 2 {
            extent = [800, 600];
            let new = make_targets(&gbuffer_pass, &mut gpu, extent)?;
            let started = Instant::now();
            let retired = node.resize(&mut gpu.allocator, extent)?;
            println!("resize to 800×600: {:.1} ms", started.elapsed().as_secs_f64() * 1e3);
            replaced.push(Replaced {
                last_frame: number - 1,
                targets: std::mem::replace(&mut targets, new),
                node: retired,
            });
        }

        // ---- Plan ---------------------------------------------------------------------------
        // Pure: what the node will do this frame, from what the engine says of it.
        let seconds = number as f64 / 12.0;
        // In the last frame the light looks at the sky: the plan is one pass then.
        let light = world::light(seconds, number > 0 && number + 1 == options.frames)?;
        let clip_from_world = world::clip_from_world(extent);
        let world_from_ndc = clip_from_world.inverse();
        let meshes: Vec<_> = models.iter().map(|model| model.for_node(seconds)).collect();
        let lend = |image: &Image, before| HostImage {
            image: image.raw,
            view: image.view,
            before,
            after: COMPOSE_READS,
        };
        let frame = Frame {
            light,
            world_from_ndc,
            background: 0.0, // reversed depth
            meshes: &meshes,
            depth: lend(&targets.gbuffer.depth, DEPTH_DRAWN),
            mask: Some(lend(&targets.gbuffer.mask, COLOR_DRAWN)),
            visibility_before: forget(COMPOSE_READS),
            visibility_after: COMPOSE_READS,
            window: None,
            slot: slot as u32,
            border_barriers: if options.host_barriers {
                BorderBarriers::Host
            } else {
                BorderBarriers::Node
            },
        };
        let started = Instant::now();
        let plan = node.plan(&frame)?;
        let plan_time = started.elapsed();

        // ---- Record -------------------------------------------------------------------------
        let cmd = frames.begin(&mut gpu, slot, extent)?;
        let Targets { gbuffer, picture } = &targets;
        gbuffer_pass.record(&gpu, cmd, gbuffer, &models, &clip_from_world, seconds);

        // The node: between the G-buffer and whoever reads visibility.
        let started = Instant::now();
        let visibility = node.visibility();
        if options.host_barriers {
            border::around(&gpu, cmd, &frame, &plan, &visibility, || node.record(cmd, &plan))?;
        } else {
            node.record(cmd, &plan)?;
        }
        let record_time = started.elapsed();

        // Depth and visibility are ready to be fetched: the frame said so. The rest is the engine's.
        let color = vk::ImageAspectFlags::COLOR;
        for image in [&gbuffer.albedo, &gbuffer.normal] {
            barrier(&gpu, cmd, image.raw, color, COLOR_DRAWN, COMPOSE_READS);
        }
        barrier(&gpu, cmd, picture.raw, color, forget(COPY_READS), COMPOSE_WRITES);
        let push = compose::Push::new(&world_from_ndc, &light, world::RADIANCE);
        compose_pass.record(&gpu, cmd, slot, (gbuffer, &visibility), picture, &push);
        barrier(&gpu, cmd, picture.raw, color, COMPOSE_WRITES, COPY_READS);

        let notes = FrameNotes {
            number,
            extent,
            plan: plan_time,
            record: record_time,
            passes: plan.plan.steps.len(),
        };
        frames.submit(&gpu, slot, picture, notes)?;
    }

    // ---- Tear down --------------------------------------------------------------------------
    // Wait for the frames in flight, oldest first; then everything may go, the node before the
    // device that it borrowed.
    for number in options.frames..options.frames + FRAMES_IN_FLIGHT as u64 {
        let slot = (number % FRAMES_IN_FLIGHT as u64) as usize;
        if let Some(done) = frames.wait(&gpu, slot)? {
            tell(options, &node, &frames, slot, &done)?;
            destroy_replaced(&mut replaced, &mut gpu, done.number);
        }
    }
    println!("the node in memory:");
    for (name, bytes) in node.memory() {
        println!("  {name:<32} {:>9.1} kB", bytes as f64 / 1e3);
    }
    node.destroy(&mut gpu.allocator);
    targets.destroy(&mut gpu);
    models.into_iter().for_each(|model| model.destroy(&mut gpu));
    frames.destroy(&mut gpu);
    compose_pass.destroy(&gpu);
    gbuffer_pass.destroy(&gpu);
    gpu.destroy();
    Ok(())
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
    node: &ShadowNode,
    frames: &Frames,
    slot: usize,
    done: &FrameNotes,
) -> Outcome<()> {
    let [width, height] = done.extent;
    // None where the device has no timestamps, or the node was resized since.
    let gpu_ms = node.timings(slot as u32).map_or_else(
        || "-".into(),
        |rows| format!("{:.1}", rows.iter().map(|(_, ms)| ms).sum::<f64>()),
    );
    println!(
        "{:>5}  {:<8}  {:>7.1}  {:>9.1}  {:>6}  {gpu_ms:>6}  {:>7.2}",
        done.number,
        format!("{width}×{height}"),
        done.plan.as_secs_f64() * 1e6,
        done.record.as_secs_f64() * 1e6,
        done.passes,
        node.memory().iter().map(|(_, bytes)| bytes).sum::<u64>() as f64 / 1e6,
    );
    if done.number.is_multiple_of(3) || done.number + 1 == options.frames {
        let path = options.out.join(format!("frame_{:02}.png", done.number));
        let bytes = width as usize * height as usize * 4;
        let pixels = &frames.pixels(slot)?[..bytes];
        image::save_buffer(path, pixels, width, height, image::ColorType::Rgba8)?;
    }
    Ok(())
}
