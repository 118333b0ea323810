//! The command line.

use clap::Parser;
use std::path::{Path, PathBuf};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    /// Width and height of the views.
    pub view: [u32; 2],
    /// Side of the grids on the ground.
    pub grid: u32,
    /// Rays a pixel of the traced truth.
    pub rays: u32,
    /// Rounds in turns.
    pub rounds: usize,
    /// Only what the quick run has.
    pub quick: bool,
}

/// Rays are cheap beside frames on two cores, so that even the quick truth takes 256: with 64, its
/// noise was half of the differences that count here.
pub const QUICK: Scale = Scale { view: [256, 192], grid: 96, rays: 256, rounds: 3, quick: true };

/// See [`QUICK`].
pub const FULL: Scale = Scale { view: [512, 384], grid: 160, rays: 512, rounds: 7, quick: false };

/// For `--choices`: as large as the full run, with half of its truth's rays.
pub const CHOICE: Scale = Scale { rays: 256, rounds: 3, ..FULL };

/// Error against time of every technique, in one report.
#[derive(Parser, Debug, Clone)]
#[command(name = "cargo bench --bench accuracy_cost --")]
pub struct Options {
    /// Under five minutes on two cores: small images, few points; what does not fit is left out and
    /// named
    #[arg(long)]
    pub quick: bool,
    /// A folder of glTF scenes of one's own, measured beside the project's, under one of their lights at a time
    #[arg(long, value_name = "DIR")]
    pub scenes: Option<PathBuf>,
    /// Where index.html, accuracy_cost.json, accuracy_cost.csv and headline.md go; what was measured
    /// before with the same options and commit is not measured again
    #[arg(long, value_name = "DIR", default_value = "out/accuracy_cost")]
    pub out: PathBuf,
    /// Measure only groups whose name holds this, such as "bunny" or "light size"
    #[arg(long, value_name = "TEXT")]
    pub only: Option<String>,
    /// Measure what `auto` chooses among in every view, and nothing else
    #[arg(long, conflicts_with_all = ["quick", "scenes"], group = "of_choices")]
    pub choices: bool,
    /// With `--choices` or `--exam`: of so many pixels, for an exam in images that the table has not seen
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size, requires = "of_choices")]
    pub size: Option<[u32; 2]>,
    /// With `--choices` or `--write-choices`: only what `auto` chooses among of this technique, in turns with a few
    /// of the others, by whose times in the table these are scaled; the rest of the table stays
    #[arg(long, value_name = "TECHNIQUE")]
    pub renew: Option<String>,
    /// Measure nothing: make of what `--choices` has measured in --out the table that `auto` chooses by
    #[arg(long, conflicts_with = "report")]
    pub write_choices: bool,
    /// Measure nothing: how the table that `auto` chooses by does in what `--choices` has measured in --out
    #[arg(long, conflicts_with = "report", group = "of_choices")]
    pub exam: bool,
    /// The table of hard cases on this device, and nothing else; what other devices did stays beside it in --out. With
    /// `--write-docs` it is copied into docs/hard_cases.md
    #[arg(long, conflicts_with_all = ["quick", "scenes", "report", "of_choices"])]
    pub hard_cases: bool,
    /// Measure over what lights, distances and resolutions each technique errs as in between, and nothing
    /// else: envelope.md, .csv and .json
    #[arg(long, conflicts_with_all = ["quick", "scenes", "only", "of_choices", "write_choices", "report"])]
    pub envelope: bool,
    /// Measure nothing: make the report anew of what was measured, by whatever commit
    #[arg(long)]
    pub report: bool,
    /// Measure nothing: copy the headline table of --out, with the command that made it, into
    /// docs/accuracy.md, or with `--envelope` the tables of that into docs/envelope.md
    #[arg(long, conflicts_with = "report")]
    pub write_docs: bool,
    /// What cargo itself passes
    #[arg(long, hide = true)]
    bench: bool,
}

impl Options {
    /// The project's root. cargo runs a bench in its package's folder, so that relative folders on
    /// the command line begin here.
    pub fn root() -> PathBuf {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        here.ancestors().nth(2).unwrap_or(here).to_path_buf()
    }

    /// With its folders absolute.
    pub fn resolved(mut self) -> Self {
        let root = Self::root();
        self.out = root.join(&self.out);
        self.scenes = self.scenes.map(|scenes| root.join(scenes));
        self
    }

    /// How much is measured of what `auto` chooses among.
    pub fn choice(&self) -> Scale {
        Scale { view: self.size.unwrap_or(CHOICE.view), ..CHOICE }
    }

    /// The command that makes this run; where it goes changes no number, and is left out.
    pub fn command(&self) -> String {
        let switches = [(self.quick, " --quick"), (self.choices, " --choices")];
        let mut words: String = switches.iter().filter(|s| s.0).map(|s| s.1).collect();
        if let Some([width, height]) = self.size {
            words.push_str(&format!(" --size {width}x{height}"));
        }
        if let Some(technique) = &self.renew {
            words.push_str(&format!(" --renew {technique}"));
        }
        if let Some(folder) = &self.scenes {
            let shown = folder.strip_prefix(Self::root()).unwrap_or(folder);
            words.push_str(&format!(" --scenes {}", shown.display()));
        }
        let dashes = if words.is_empty() { "" } else { " --" };
        format!("cargo bench --bench accuracy_cost{dashes}{words}")
    }
}

/// Reads a width and a height in pixels.
fn size(word: &str) -> Result<[u32; 2], String> {
    let sides = word.split_once('x').map(|(w, h)| [w, h].map(str::parse::<u32>));
    match sides {
        Some([Ok(width @ 1..=4096), Ok(height @ 1..=4096)]) => Ok([width, height]),
        _ => Err(format!("{word:?} is no size; write one such as 640x480, of sides up to 4096")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_says_nothing_of_where_the_report_goes() {
        let parse =
            |words: &[&str]| Options::parse_from(["x"].iter().chain(words)).resolved().command();
        assert_eq!(parse(&["--bench"]), "cargo bench --bench accuracy_cost");
        let sized = "cargo bench --bench accuracy_cost -- --choices --size 640x480";
        assert_eq!(parse(&["--choices", "--size", "640x480"]), sized);
        for bad in
            [&["--size", "640x480"][..], &["--exam", "--size", "640"], &["--exam", "--size", "0x9"]]
        {
            assert!(Options::try_parse_from(["x"].iter().chain(bad)).is_err(), "{bad:?}");
        }
        assert_eq!(parse(&["--quick"]), "cargo bench --bench accuracy_cost -- --quick");
        assert_eq!(
            parse(&["--scenes", "mine", "--out", "/elsewhere"]),
            "cargo bench --bench accuracy_cost -- --scenes mine"
        );
    }
}
