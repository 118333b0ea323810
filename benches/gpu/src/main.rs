//! What a GPU's compiler makes of the shaders.

use antumbra_gpu::{compile, page};
use clap::Parser;
use std::process::ExitCode;

/// What a GPU's compiler makes of the shaders, without a GPU: the tables of docs/gpu.md.
#[derive(Parser)]
struct Options {
    /// Replaces the tables of docs/gpu.md instead of printing them.
    #[arg(long)]
    write_docs: bool,
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
        println!("{}", serde_json::to_string(&compiled).map_err(|e| e.to_string())?);
        return Ok(());
    }
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let (compiled, said) = page::everything(&program);
    said.iter().for_each(|sentence| eprintln!("{sentence}"));
    if compiled.is_empty() {
        return Err("no shader was compiled".into());
    }
    let tables = page::tables(&compiled, &page::frames().map_err(|e| e.to_string())?);
    match options.write_docs {
        true => page::write(&tables),
        false => {
            print!("{tables}");
            Ok(())
        }
    }
}
