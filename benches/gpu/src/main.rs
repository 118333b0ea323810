//! What a GPU's compiler makes of the shaders.

use antumbra_gpu::compile;
use antumbra_gpu::compiled::compile_for;
use antumbra_gpu::families::FAMILIES;
use clap::Parser;
use std::process::ExitCode;

/// What a GPU's compiler makes of the shaders, without a GPU.
#[derive(Parser)]
struct Options {
    /// Compiles for the family that RADV_FORCE_FAMILY names and prints JSON; the program calls itself so.
    #[arg(long, hide = true)]
    compile_here: bool,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::from(2)
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    if options.compile_here {
        let compiled = compile::everything()?;
        let text = serde_json::to_string(&compiled).map_err(|e| e.to_string())?;
        println!("{text}");
        return Ok(());
    }
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let scene = antumbra::scene::from_gltf(&root.join("scenes/bunny.glb")).map_err(|e| e.to_string())?;
    for name in antumbra_gpu::frame::TECHNIQUES {
        println!("{name}");
        for pass in antumbra_gpu::frame::frame_of(name, &scene).map_err(|e| e.to_string())? {
            println!("{:<40} x{} {:?} {} {} kB", pass.name, pass.times, pass.launch, pass.read/1000, pass.written/1000);
        }
    }
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    for family in &FAMILIES {
        let compiled = compile_for(&program, family)?;
        println!("{} {} {}", family.architecture, compiled.device, compiled.driver);
        for shader in &compiled.shaders {
            println!(
                "{:<55} {:<16} {:>2} {:?}",
                shader.module(),
                shader.stage,
                shader.waves(),
                shader.figures
            );
        }
    }
    Ok(())
}
