//! The command line.

use clap::Parser;
use std::path::{Path, PathBuf};

/// Error against time of every technique, in one report.
#[derive(Parser, Debug, Clone)]
#[command(name = "cargo bench --bench accuracy_cost --")]
pub struct Options {
    /// Under five minutes on two cores: small images, few points; what does not fit is left out and
    /// named
    #[arg(long)]
    pub quick: bool,
    /// A folder of glTF scenes of one's own, measured beside the project's, under their first light
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
    #[arg(long, conflicts_with_all = ["quick", "scenes"])]
    pub choices: bool,
    /// Measure nothing: make of what `--choices` has measured in --out the table that `auto` chooses by
    #[arg(long, conflicts_with = "report")]
    pub write_choices: bool,
    /// Measure nothing: how the table that `auto` chooses by does in what `--choices` has measured in --out
    #[arg(long, conflicts_with = "report")]
    pub exam: bool,
    /// Measure nothing: make the report anew of what was measured, by whatever commit
    #[arg(long)]
    pub report: bool,
    /// Measure nothing: copy the headline table of --out, with the command that made it, into
    /// docs/accuracy.md
    #[arg(long, conflicts_with = "report")]
    pub write_docs: bool,
    /// What cargo itself passes
    #[arg(long, hide = true)]
    bench: bool,
}

impl Options {
    /// The project's root. cargo runs a bench in its package's folder, so that relative folders on
    /// the command line are taken from here.
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

    /// The command that makes this run; where it goes changes no number, and is left out.
    pub fn command(&self) -> String {
        let mut words = String::new();
        if self.quick {
            words.push_str(" --quick");
        }
        if self.choices {
            words.push_str(" --choices");
        }
        if let Some(folder) = &self.scenes {
            let shown = folder.strip_prefix(Self::root()).unwrap_or(folder);
            words.push_str(&format!(" --scenes {}", shown.display()));
        }
        let dashes = if words.is_empty() { "" } else { " --" };
        format!("cargo bench --bench accuracy_cost{dashes}{words}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_is_told_without_where_it_went() {
        let parse =
            |words: &[&str]| Options::parse_from(["x"].iter().chain(words)).resolved().command();
        assert_eq!(parse(&["--bench"]), "cargo bench --bench accuracy_cost");
        assert_eq!(parse(&["--quick"]), "cargo bench --bench accuracy_cost -- --quick");
        assert_eq!(
            parse(&["--scenes", "mine", "--out", "/elsewhere"]),
            "cargo bench --bench accuracy_cost -- --scenes mine"
        );
    }
}
