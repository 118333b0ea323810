//! A program built on wgpu that hosts antumbra's node.
//!
//! `cargo run --release --example embed_wgpu -- --out out/embed_wgpu`
//!
//! No window: a glTF scene with soft shadows, drawn a few times with two frames in flight; the last
//! one is written as files. The program turns no feature of wgpu's on. Whatever knows the node is
//! in `shadows`; the rest is a program that would look like this without shadows too:
//!
//! ```text
//!   shadows    antumbra's node, lent wgpu's device, textures and buffers
//!
//!   options    the command line                        device     device, textures, errors
//!   world      scene, light, camera                    geometry   vertex and index buffers
//!   gbuffer    draws depth, normal, mask               compose    visibility × irradiance
//!   output     copies out, EXR, PNG                    raw        what of it Vulkan code is lent
//!   occluder_maps   --own-shadow-map: what the light sees, drawn here
//! ```

#![allow(unsafe_code, reason = "the node and wgpu meet at raw Vulkan handles")]

mod compose;
mod device;
mod gbuffer;
mod geometry;
mod occluder_maps;
mod options;
mod output;
mod raw;
mod shadows;
mod world;

use antumbra::{ResourceBytes, Retired};
use compose::ComposePass;
use device::{Gpu, Target, WaitAtEnd};
use gbuffer::{GBuffer, GBufferPass};
use geometry::Object;
use occluder_maps::{LightView, OccluderPass};
use options::Options;
use output::Copied;
use shadows::Shadows;
use std::process::ExitCode;
use std::time::Instant;
use wgpu::{SubmissionIndex, TextureFormat, TextureUsages};
use world::{View, World};

/// The number of frames that are submitted before the device must have completed the first of them.
const FRAMES_IN_FLIGHT: usize = 2;

/// A result whose error, of any kind, is printed and ends the example.
type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Everything of the window's size, had there been a window.
struct Targets {
    gbuffer: GBuffer,
    visibility: Target,
    picture: Target,
}

impl Targets {
    fn new(gpu: &Gpu, pass: &GBufferPass, extent: [u32; 2]) -> Outcome<Self> {
        use TextureUsages as Usage;
        let usage = Usage::STORAGE_BINDING | Usage::TEXTURE_BINDING | Usage::COPY_SRC;
        Ok(Self {
            gbuffer: pass.images(gpu, extent)?,
            visibility: gpu.zeroed_target("visibility", TextureFormat::R32Float, extent, usage)?,
            picture: ComposePass::picture(gpu, extent)?,
        })
    }
}

/// The inputs of one frame.
struct Seen<'a> {
    world: &'a World,
    view: View,
    targets: &'a Targets,
    /// The program's own occluder maps.
    maps: Option<&'a LightView>,
    slot: usize,
}

/// The objects that a resize replaced, and the last frame that may use them.
struct Replaced {
    last_frame: u64,
    /// wgpu would keep what its own commands use; of the node's it does not know.
    _targets: Targets,
    node: Retired,
}

fn main() -> ExitCode {
    let options = match options::parse() {
        Ok(options) => options,
        Err(line) => {
            eprintln!("{line}");
            return ExitCode::from(2);
        }
    };
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Outcome<()> {
    // ---- Set up -----------------------------------------------------------------------------
    let world = World::load(&options.scene)?;
    std::fs::create_dir_all(&options.out).map_err(|e| format!("{}: {e}", options.out.display()))?;
    let gpu = Gpu::new()?;
    println!("{}", gpu.name);
    let objects = Object::all(&gpu, &world.scene);
    let gbuffer_pass = GBufferPass::new(&gpu, objects.len());
    let compose_pass = ComposePass::new(&gpu);
    let mut targets = Targets::new(&gpu, &gbuffer_pass, options.size)?;
    let mut shadows = Shadows::new(&gpu, options.size, options.own_shadow_map)?;
    let meshes = objects.iter().map(shadows::mesh).collect::<Outcome<Vec<_>>>()?;
    let side = shadows.node.description().technique.map();
    let own_maps = match options.own_shadow_map {
        true => Some((
            OccluderPass::new(&gpu, objects.len()),
            LightView::new(&gpu, &world, &objects, side)?,
        )),
        false => None,
    };

    println!("frame  size       plan µs  record µs  passes");
    let mut running: [Option<(u64, SubmissionIndex)>; FRAMES_IN_FLIGHT] = [None, None];
    let mut replaced: Vec<Replaced> = Vec::new();
    let mut resizes = 0;
    let mut copies = None;
    let _before_anything_goes = WaitAtEnd(&gpu);
    for number in 0..options.frames {
        // ---- Wait for the slot --------------------------------------------------------------
        // The frame before last had it; what that one was the last to use can go.
        let slot = (number % FRAMES_IN_FLIGHT as u64) as usize;
        if let Some((done, submission)) = running[slot].take() {
            gpu.wait(submission)?;
            destroy_replaced(&mut replaced, &mut shadows, done);
        }

        // ---- Resize -------------------------------------------------------------------------
        // The frame before this one may still run on the old images: they wait until it is done.
        while resizes < options.resizes_before(number) {
            resizes += 1;
            let extent = options.size_after(resizes);
            let new = Targets::new(&gpu, &gbuffer_pass, extent)?;
            let started = Instant::now();
            let node = shadows.resize(extent)?;
            if options.resizes < 10 {
                let ms = started.elapsed().as_secs_f64() * 1e3;
                println!("resize to {}×{}: {ms:.2} ms", extent[0], extent[1]);
            }
            let old = std::mem::replace(&mut targets, new);
            replaced.push(Replaced { last_frame: number - 1, _targets: old, node });
        }

        // ---- What is seen -------------------------------------------------------------------
        let seen = Seen {
            world: &world,
            view: world.view(targets.picture.extent()),
            targets: &targets,
            maps: own_maps.as_ref().map(|(_, maps)| maps),
            slot,
        };
        let mut drawn = gpu.encoder("drawn");
        gbuffer_pass.record(&gpu, &mut drawn, &targets.gbuffer, &objects, &seen.view);
        if let Some((pass, maps)) = &own_maps {
            pass.record(&gpu, &mut drawn, maps, &objects);
        }

        // ---- Its shadows --------------------------------------------------------------------
        let started = Instant::now();
        let plan = shadows.plan(&seen, &meshes)?;
        let plan_time = started.elapsed();
        let started = Instant::now();
        let [border, node] = shadows.record(&plan, &seen)?;
        let record_time = started.elapsed();

        // ---- Its picture --------------------------------------------------------------------
        let mut shaded = gpu.encoder("shaded");
        compose_pass.record(&gpu, &mut shaded, &seen);
        let Targets { gbuffer, visibility, picture } = &targets;
        if number + 1 == options.frames {
            let wanted = [&gbuffer.depth, visibility, picture];
            copies = Some(wanted.map(|image| Copied::record(&gpu, &mut shaded, image)));
        }
        let commands = [drawn.finish(), border, node, shaded.finish()];
        running[slot] = Some((number, gpu.queue.submit(commands)));
        gpu.check()?;

        let [width, height] = picture.extent();
        println!(
            "{number:>5}  {:<9}  {:>7.1}  {:>9.1}  {:>6}",
            format!("{width}×{height}"),
            plan_time.as_secs_f64() * 1e6,
            record_time.as_secs_f64() * 1e6,
            plan.plan().steps.len(),
        );
    }

    // ---- Files ------------------------------------------------------------------------------
    if let Some([depth, visibility, picture]) = copies {
        depth.exr(&gpu, &options.out.join("depth.exr"))?;
        visibility.exr(&gpu, &options.out.join("visibility.exr"))?;
        picture.png(&gpu, &options.out.join("picture.png"))?;
    }

    // ---- Tear down --------------------------------------------------------------------------
    // The node before the device that it borrowed, and behind every frame.
    for (done, submission) in running.into_iter().flatten() {
        gpu.wait(submission)?;
        destroy_replaced(&mut replaced, &mut shadows, done);
    }
    println!("the node: {} Vulkan objects, and in memory:", shadows.node.object_count());
    for ResourceBytes { name, bytes } in shadows.node.memory() {
        println!("  {name:<32} {:>9.1} kB", bytes as f64 / 1e3);
    }
    let left = shadows.destroy();
    println!("the node is destroyed; its allocator holds {left} bytes");
    gpu.check()?;
    match left {
        0 => Ok(()),
        _ => Err(format!("the node left {left} bytes of device memory behind").into()),
    }
}

/// Destroys what no frame after `done` uses.
fn destroy_replaced(replaced: &mut Vec<Replaced>, shadows: &mut Shadows, done: u64) {
    while replaced.first().is_some_and(|r| r.last_frame <= done) {
        shadows.destroy_retired(replaced.remove(0).node);
    }
}
