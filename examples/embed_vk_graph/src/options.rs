//! The command line.

use antumbra::Technique;
use clap::Parser;
use std::path::PathBuf;

/// antumbra's node in an engine built on vk-graph: a scene's soft shadows, as a foreign pass.
#[derive(Parser)]
#[command(name = "embed_vk_graph")]
pub struct Options {
    /// The scene: glTF 2.0, .glb or .gltf
    #[arg(
        long,
        value_name = "FILE",
        default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/bunny.glb")
    )]
    pub scene: PathBuf,
    /// The folder for visibility.exr, depth.exr and picture.png; made where it does not exist
    #[arg(long, value_name = "DIR", default_value = "out/embed_vk_graph")]
    pub out: PathBuf,
    /// Image size
    #[arg(long, value_name = "WxH", default_value = "640x480", value_parser = size)]
    pub size: [u32; 2],
    /// How many frames
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub frames: u64,
    /// Resize G-buffer and node so many times, to other sizes and at last back to --size
    #[arg(long, value_name = "N", default_value_t = 0,
          value_parser = clap::value_parser!(u64).range(..=1_000_000))]
    pub resizes: u64,
    /// A setting of the technique, repeatable
    #[arg(long = "set", value_name = "KEY=VALUE")]
    assignments: Vec<String>,
    /// Tell vk-graph that the node only reads the visibility image, as a careless engine might: the
    /// barrier behind the node then leaves out the node's write, which the validation layer's
    /// synchronization checks report as a hazard
    #[arg(long)]
    pub lie: bool,
    /// The technique that the assignments describe.
    #[arg(skip)]
    pub settings: Technique,
}

/// Reads and checks the command line; the error is one line.
pub fn parse() -> Result<Options, String> {
    let mut options = match Options::try_parse() {
        Ok(options) => options,
        // Help was requested.
        Err(e) if !e.use_stderr() => e.exit(),
        Err(e) => {
            // The first paragraph names the argument; usage and tips follow it.
            let text = e.to_string();
            let first: Vec<_> =
                text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
            let line = first.join(" ");
            return Err(line.strip_prefix("error: ").unwrap_or(&line).into());
        }
    };
    for assignment in &options.assignments {
        let (key, value) = assignment
            .split_once('=')
            .ok_or_else(|| format!("--set: \"{assignment}\" is not KEY=VALUE"))?;
        options.settings.set(key.trim(), value.trim()).map_err(|e| e.to_string())?;
    }
    options.settings.check().map_err(|e| e.to_string())?;
    Ok(options)
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']);
    let parsed = sides.and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    parsed
        .filter(|size: &[u32; 2]| size.iter().all(|side| (1..=16384).contains(side)))
        .ok_or_else(|| "it is not WxH with sides of 1 to 16384".into())
}
