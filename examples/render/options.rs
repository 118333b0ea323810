//! The command line.

use antumbra::auto::Budget;
use antumbra::knob::{Knob, Values};
use antumbra::scene::Role;
use antumbra::{Error, Technique};
use clap::{CommandFactory, FromArgMatches, Parser};
use std::ffi::OsString;
use std::path::PathBuf;

/// Renders a glTF scene's soft shadows into EXR, PNG and JSON files.
#[derive(Parser, Debug)]
#[command(name = "render")]
struct Arguments {
    /// The scene: glTF 2.0, .glb or .gltf
    scene: PathBuf,
    /// The folder for the results; made where it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How the visible fraction is computed
    #[arg(long, value_name = "T")]
    technique: Option<String>,
    /// A setting of the technique, repeatable; see below
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    /// Image size
    #[arg(long, value_name = "WxH", default_value = "640x480")]
    size: String,
    /// The light's node; the first light without it
    #[arg(long, value_name = "NODE")]
    light: Option<String>,
    /// Overrides a node's role (occluder, receiver, both), repeatable
    #[arg(long = "role", value_name = "NODE=ROLE")]
    roles: Vec<String>,
    /// Frames to time
    #[arg(long, value_name = "K", default_value_t = 1)]
    repeat: u32,
    /// Run under the validation layer with synchronization checks; any message fails the run
    #[arg(long)]
    validate: bool,
    /// Mean error over shadow and penumbra that --technique auto may make, a visible fraction; with another technique,
    /// what leaving an effect out may add to it
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    max_error: Option<f64>,
    /// Milliseconds of the device that --technique auto may take
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    max_ms: Option<f64>,
}

/// What to render, checked.
#[derive(Debug)]
pub struct Options {
    pub scene: PathBuf,
    pub out: PathBuf,
    /// What technique and settings are chosen by; none where they are given.
    pub auto: Option<Budget>,
    /// What leaving an effect out may add to the error, where it is given.
    pub max_error: Option<f64>,
    pub settings: Technique,
    pub size: [u32; 2],
    pub light: Option<String>,
    pub roles: Vec<(String, Role)>,
    pub repeat: u32,
    pub validate: bool,
}

/// Help text, or what is wrong as one line.
#[derive(Debug)]
pub enum Stop {
    Help(String),
    Wrong(String),
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        Self::Wrong(error.to_string())
    }
}

fn wrong(option: &str, problem: impl AsRef<str>) -> Stop {
    Stop::Wrong(format!("{option}: {}", problem.as_ref()))
}

/// The settings as the end of the help text, each with the techniques that have it.
fn knobs() -> String {
    let mut text = String::from("Settings (--set KEY=VALUE):\n");
    let all = Technique::all();
    let mut shown: Vec<Knob> = Vec::new();
    for knob in all.iter().flat_map(Technique::knobs) {
        if shown.contains(&knob) {
            continue;
        }
        let having: Vec<_> = all.iter().filter(|t| t.knobs().contains(&knob)).collect();
        let names: Vec<_> = having.iter().map(|t| t.name()).collect();
        let names =
            if names.len() == all.len() { "all techniques".into() } else { names.join(", ") };
        let default = having[0].get(knob.key).unwrap_or_default();
        let Knob { key, unit, values, about } = knob;
        let range = match values {
            Values::Choice(_) | Values::Switch => values.to_string(),
            _ => format!("{values}, {unit}"),
        };
        text.push_str(&format!("  {key:<14} {about} [{range}; default {default}; {names}]\n"));
        shown.push(knob);
    }
    text
}

/// Reads and checks a command line.
///
/// # Errors
/// The help text where it was asked for; one line for anything wrong.
pub fn parse(arguments: impl Iterator<Item = OsString>) -> Result<Options, Stop> {
    let technique = format!(
        "How the visible fraction is computed: {}; auto without it, or, with --set, the technique that has these settings",
        techniques()
    );
    let command = Arguments::command()
        .mut_arg("technique", |argument| argument.help(technique))
        .after_help(knobs());
    let matches = command.try_get_matches_from(arguments).map_err(|e| {
        if e.use_stderr() {
            // The first paragraph names the argument; usage and tips follow it.
            let text = e.to_string();
            let first: Vec<_> =
                text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
            let line = first.join(" ");
            Stop::Wrong(line.strip_prefix("error: ").unwrap_or(&line).to_string())
        } else {
            Stop::Help(e.to_string())
        }
    })?;
    let a = Arguments::from_arg_matches(&matches).map_err(|e| Stop::Wrong(e.to_string()))?;
    let (auto, mut settings) = technique_of(&a)?;
    for (key, value) in assignments(&a)? {
        settings.set(key, value)?;
    }
    settings.check()?;
    let roles = a
        .roles
        .iter()
        .map(|assignment| {
            let (node, role) = assignment
                .rsplit_once('=')
                .ok_or_else(|| wrong("--role", format!("\"{assignment}\" is not NODE=ROLE")))?;
            Ok((node.to_string(), role.parse::<Role>()?))
        })
        .collect::<Result<_, Stop>>()?;
    if a.repeat == 0 {
        return Err(wrong("--repeat", "0 frames cannot be timed; give 1 or more"));
    }
    Ok(Options {
        scene: a.scene,
        out: a.out,
        auto,
        max_error: a.max_error.filter(|_| auto.is_none()),
        settings,
        size: size(&a.size)?,
        light: a.light,
        roles,
        repeat: a.repeat,
        validate: a.validate,
    })
}

fn assignments(a: &Arguments) -> Result<Vec<(&str, &str)>, Stop> {
    let pair = |text| {
        let (key, value) = str::split_once(text, '=')
            .ok_or_else(|| wrong("--set", format!("\"{text}\" is not KEY=VALUE")))?;
        Ok((key.trim(), value.trim()))
    };
    a.settings.iter().map(|text| pair(text.as_str())).collect()
}

/// The budget of `auto`, or the technique that was asked for: by its name, or by settings that it has.
fn technique_of(a: &Arguments) -> Result<(Option<Budget>, Technique), Stop> {
    let budget = Budget { max_error: a.max_error, max_ms: a.max_ms };
    let given = assignments(a)?;
    match (a.technique.as_deref(), &given[..]) {
        (None | Some(AUTO), []) => Ok((Some(budget), Technique::default())),
        (Some(AUTO), [(key, _), ..]) => {
            Err(wrong("--set", format!("{key} is for auto to choose; name a --technique")))
        }
        (named, _) if a.max_ms.is_some() => Err(wrong(
            "--max-ms",
            format!("is a budget for --technique auto, and not for {}", named.unwrap_or("--set")),
        )),
        (Some(name), _) => match Technique::all().into_iter().find(|t| t.name() == name) {
            Some(technique) => Ok((None, technique)),
            None => {
                let problem = format!("\"{name}\" is not one of {}", techniques());
                Err(wrong("--technique", problem))
            }
        },
        (None, given) => {
            let all = std::iter::once(Technique::default()).chain(Technique::all());
            let has = |t: &Technique, key: &str| t.get(key).is_some();
            let technique = all.into_iter().find(|t| given.iter().all(|(key, _)| has(t, key)));
            // A key that none has is refused by name when it is set.
            Ok((None, technique.unwrap_or_default()))
        }
    }
}

/// The name of no technique of its own.
const AUTO: &str = "auto";

fn techniques() -> String {
    let names = std::iter::once(AUTO).chain(Technique::NAMES.iter().copied());
    names.collect::<Vec<_>>().join(", ")
}

fn size(text: &str) -> Result<[u32; 2], Stop> {
    let sides = text.split_once(['x', 'X', '×']);
    let parsed = sides.and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    match parsed {
        Some([w, h]) if (1..=16384).contains(&w) && (1..=16384).contains(&h) => Ok([w, h]),
        _ => Err(wrong("--size", format!("\"{text}\" is not WxH with sides of 1 to 16384"))),
    }
}
