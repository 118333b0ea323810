//! The command line.

use clap::Parser;
use std::path::PathBuf;

/// A wgpu program that hosts antumbra's node: a glTF scene's soft shadows, without a window.
#[derive(Parser, Debug)]
#[command(name = "embed_wgpu")]
pub struct Options {
    /// The scene: glTF 2.0, .glb or .gltf
    #[arg(
        long,
        value_name = "FILE",
        default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/bunny.glb"),
        hide_default_value = true
    )]
    pub scene: PathBuf,
    /// The folder for the results; made where it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/embed_wgpu")]
    pub out: PathBuf,
    /// Image size
    #[arg(long, value_name = "WxH", default_value = "640x480", value_parser = size)]
    pub size: [u32; 2],
    /// How many frames
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..))]
    pub frames: u64,
    /// How many times everything is resized on the way, in the end back to --size
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub resizes: u64,
    /// Draw the occluder maps here, with pipelines of wgpu, and hand them to the node
    #[arg(long)]
    pub own_shadow_map: bool,
}

impl Options {
    /// The number of resizes that come before a frame: they are spread over the run, none before the first.
    pub fn resizes_before(&self, frame: u64) -> u64 {
        self.resizes * frame / (self.frames - 1).max(1)
    }

    /// The size behind the n-th resize.
    pub fn size_after(&self, n: u64) -> [u32; 2] {
        if n == self.resizes {
            return self.size;
        }
        let factor = [1.25, 0.5, 0.8][n as usize % 3];
        self.size.map(|e| ((f64::from(e) * factor) as u32).max(1))
    }
}

/// Reads the command line; what is wrong with it comes back as one line, help exits.
pub fn parse() -> Result<Options, String> {
    let options = Options::try_parse().map_err(|e| {
        if !e.use_stderr() {
            e.exit();
        }
        // The first paragraph names the argument; usage and tips follow it.
        let text = e.to_string();
        let lines: Vec<_> = text.lines().map(str::trim).take_while(|l| !l.is_empty()).collect();
        let line = lines.join(" ");
        line.strip_prefix("error: ").unwrap_or(&line).to_string()
    })?;
    if options.resizes > 0 && options.frames < 2 {
        return Err("--resizes: they come between frames; give --frames 2 or more".into());
    }
    Ok(options)
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']);
    match sides.and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?])) {
        Some([w, h]) if (1..=16384).contains(&w) && (1..=16384).contains(&h) => Ok([w, h]),
        _ => Err("write it as WxH with sides of 1 to 16384".into()),
    }
}
