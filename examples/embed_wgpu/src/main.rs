//! A wgpu program that hosts antumbra's node.

#![allow(unsafe_code, reason = "an engine calls Vulkan")]

mod compose;
mod device;
mod gbuffer;
mod geometry;
mod options;
mod output;
mod world;

use compose::ComposePass;
use device::{Gpu, Target};
use gbuffer::{GBuffer, GBufferPass};
use geometry::Object;
use options::Options;
use output::Copied;
use std::process::ExitCode;
use wgpu::TextureUsages as Usage;
use world::World;

/// What goes wrong in an example is told and ends it.
type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

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
    let world = World::load(&options.scene)?;
    let gpu = Gpu::new()?;
    let objects = Object::all(&gpu, &world.scene);
    let gbuffer_pass = GBufferPass::new(&gpu, objects.len());
    let compose_pass = ComposePass::new(&gpu);
    std::fs::create_dir_all(&options.out)?;
    let gbuffer = gbuffer_pass.images(&gpu, options.size);
    let picture = ComposePass::picture(&gpu, options.size);
    let visibility = gpu.zeroed_target(
        "visibility",
        wgpu::TextureFormat::R32Float,
        options.size,
        Usage::STORAGE_BINDING | Usage::TEXTURE_BINDING | Usage::COPY_SRC,
    );
    gpu.check()?;
    println!("{}", gpu.name);
    let view = world.view(options.size);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    gbuffer_pass.record(&gpu, &mut encoder, &gbuffer, &objects, &view);
    compose_pass.record(&gpu, &mut encoder, (&gbuffer, &visibility), &picture, (&world, &view));
    let a = Copied::record(&gpu, &mut encoder, &gbuffer.depth);
    let b = Copied::record(&gpu, &mut encoder, &picture);
    let i = gpu.queue.submit([encoder.finish()]);
    gpu.wait(i)?;
    gpu.check()?;
    a.exr(&gpu, &options.out.join("depth.exr"))?;
    b.png(&gpu, &options.out.join("picture.png"))?;
    gpu.check()?;
    Ok(())
}
