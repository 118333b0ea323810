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
    /// How many frames; more where the resizes need more
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub frames: u64,
    /// How many of the frames are of another size than the one before; the last is --size again
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub resizes: u64,
    /// Draw the occluder maps here, with pipelines of wgpu, and hand them to the node
    #[arg(long)]
    pub own_shadow_map: bool,
}

impl Options {
    /// Frame `number` and its size: each of the first frames behind frame 0 has another one than
    /// the frame before it, and the last of them is back at what was asked for.
    pub fn size_of_frame(&self, number: u64) -> [u32; 2] {
        let [w, h] = self.size;
        match number {
            0 => self.size,
            n if n >= self.resizes => self.size,
            n if n % 2 == 1 => [w.div_ceil(2), h.div_ceil(2)],
            _ => [w.div_ceil(4) * 3, h.div_ceil(3) * 2],
        }
    }

    /// How many frames there are.
    pub fn frame_count(&self) -> u64 {
        self.frames.max(self.resizes + 1)
    }
}

/// Reads the command line; what is wrong with it comes back as one line, help exits.
pub fn parse() -> Result<Options, String> {
    Options::try_parse().map_err(|e| {
        if !e.use_stderr() {
            e.exit();
        }
        // The first paragraph names the argument; usage and tips follow it.
        let text = e.to_string();
        let lines: Vec<_> = text.lines().map(str::trim).take_while(|l| !l.is_empty()).collect();
        let line = lines.join(" ");
        line.strip_prefix("error: ").unwrap_or(&line).to_string()
    })
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']);
    match sides.and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?])) {
        Some([w, h]) if (1..=16384).contains(&w) && (1..=16384).contains(&h) => Ok([w, h]),
        _ => Err("write it as WxH with sides of 1 to 16384".into()),
    }
}
