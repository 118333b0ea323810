//! The tables of `docs/gpu.md`.

use crate::compiled::{Compiled, Shader};
use crate::families::Family;
use crate::frame::{FramePass, Launch};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The memory bandwidth that floors of time are stated for, in bytes a second.
const BANDWIDTH: f64 = 500e9;

/// The compute and fragment shaders of a family by their modules: of several pipelines with one module the one with the
/// fewest waves. Vertex shaders are left out, since meshes have few vertices beside the texels that they cover.
pub fn by_module(compiled: &Compiled) -> BTreeMap<&str, &Shader> {
    let mut modules = BTreeMap::<&str, &Shader>::new();
    // A draw of depth alone has an empty fragment shader, without a module.
    let runs_often = |s: &&Shader| !s.module().is_empty() && !s.module().ends_with(".vert");
    for shader in compiled.shaders.iter().filter(runs_often) {
        let known = modules.entry(shader.module()).or_insert(shader);
        if (shader.waves(), known.code()) < (known.waves(), shader.code()) {
            *known = shader;
        }
    }
    modules
}

/// What keeps a SIMD from more waves' work: its own units, or the wait for memory that the waves it holds do not fill.
fn bound(shader: &Shader) -> &'static str {
    let waves = shader.waves() as f64;
    match shader.figure("Inverse Throughput") as f64 * waves > 1.05 * shader.latency() as f64 {
        true => "units",
        false => "waiting",
    }
}

/// A line for each shader: waves of every family, then the first family's registers, shared memory, code and cycles.
pub fn shaders(compiled: &[(Family, Compiled)]) -> String {
    let families: Vec<_> = compiled.iter().map(|(_, all)| by_module(all)).collect();
    let Some(modules) = families.first() else { return String::new() };
    let names: Vec<_> = compiled.iter().map(|(f, _)| f.architecture).collect();
    let mut text = format!(
        "| shader | waves: {} | registers | spilled | shared, bytes | code, bytes | cycles | bound by |\n|---|{}---|---|---|---|---|---|\n",
        names.join(" | "),
        "---|".repeat(names.len())
    );
    for (module, shader) in modules {
        let waves: Vec<String> = families
            .iter()
            .map(|modules| match modules.get(module) {
                Some(shader) => shader.waves().to_string(),
                None => "–".into(),
            })
            .collect();
        let spilled = families.iter().filter_map(|modules| modules.get(module));
        let spilled: Vec<_> = spilled.map(|shader| shader.spilled().to_string()).collect();
        let spilled = match spilled.iter().all(|count| count == "0") {
            true => "0".into(),
            false => spilled.join(", "),
        };
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| `{module}` | {} | {} | {spilled} | {} | {} | {} | {} |",
            waves.join(" | "),
            shader.figure("VGPRs"),
            shader.figure("LDS size"),
            shader.code(),
            shader.latency(),
            bound(shader),
        );
    }
    text
}

/// A table for a technique's frame: a line for each kind of pass.
pub fn frame(technique: &str, passes: &[FramePass], family: &Family, all: &Compiled) -> String {
    let modules = by_module(all);
    let mut text = format!(
        "### `{technique}`\n\n| pass | times | waves of a step | of those that {} holds | read, MB | written, MB | at 500 GB/s, µs |\n|---|---|---|---|---|---|---|\n",
        family.architecture
    );
    let (mut read, mut written) = (0, 0);
    for pass in passes {
        let held = pass.shader.and_then(|module| modules.get(module)).map(|shader| {
            let held = shader.waves() * family.simds;
            move |waves: u64| format!("{:.3}", waves as f64 / held as f64)
        });
        let (waves, part) = match pass.launch {
            Launch::Waves { least, most } => {
                let range = |a: String, b: String| if a == b { a } else { format!("{a} to {b}") };
                let part = held.map_or("–".into(), |held| range(held(least), held(most)));
                (range(least.to_string(), most.to_string()), part)
            }
            Launch::Listed => ("as listed".into(), "–".into()),
            Launch::Meshes => ("as the meshes have".into(), "–".into()),
            Launch::Draw => ("a draw".into(), "–".into()),
            Launch::Command => ("none".into(), "–".into()),
        };
        let _ = writeln!(
            text,
            "| `{}` | {} | {waves} | {part} | {} | {} | {} |",
            pass.name,
            pass.times,
            megabytes(pass.read),
            megabytes(pass.written),
            micros(pass.read + pass.written),
        );
        read += pass.read;
        written += pass.written;
    }
    let _ = writeln!(
        text,
        "| all | | | | {} | {} | {} |",
        megabytes(read),
        megabytes(written),
        micros(read + written)
    );
    text
}

fn megabytes(bytes: u64) -> String {
    format!("{:.2}", bytes as f64 / 1e6)
}

fn micros(bytes: u64) -> String {
    format!("{:.1}", bytes as f64 / BANDWIDTH * 1e6)
}
