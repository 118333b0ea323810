//! The command line.

pub mod keys;

use antumbra::auto::Budget;
use antumbra::knob::{Knob, Values};
use antumbra::scene::Role;
use antumbra::{Error, Technique};
use clap::{CommandFactory, FromArgMatches, Parser};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

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
    /// The one light that is drawn, by its node; all lights without it
    #[arg(long, value_name = "NODE")]
    light: Option<String>,
    /// The camera that shows the scene, by its node; the first one without it, or one that frames the scene
    #[arg(long, value_name = "NODE")]
    camera: Option<String>,
    /// The scene of the file, by its name or number; the default one without it
    #[arg(long = "scene", value_name = "NAME")]
    part: Option<String>,
    /// Shows the file at a time of an animation, by its name or number
    #[arg(long, value_name = "NAME")]
    animation: Option<String>,
    /// The time of the animation, in seconds
    #[arg(
        long,
        value_name = "T",
        requires = "animation",
        allow_hyphen_values = true,
        default_value_t = 0.0,
        hide_default_value = true
    )]
    time: f64,
    /// The radius in metres of the file's point and spot lights whose extras say none
    #[arg(long, value_name = "R", default_value_t = 0.0, hide_default_value = true)]
    light_radius: f64,
    /// Makes area lights of the file's meshes that shine (emissiveFactor)
    #[arg(long)]
    emissive: bool,
    /// Overrides a node's role (occluder, receiver, both), repeatable
    #[arg(long = "role", value_name = "NODE=ROLE")]
    roles: Vec<String>,
    /// Frames to time, behind one that is not timed; the report has their median
    #[arg(long, value_name = "K", default_value_t = 1)]
    repeat: u32,
    /// Pixels a frame whose exact visible fraction is traced, 16 to 65536; the report then has the measured error of all
    /// timed frames together
    #[arg(long, value_name = "P", default_value_t = 0, hide_default_value = true)]
    audit: u32,
    /// Run under the validation layer with synchronization checks; any message fails the run
    #[arg(long)]
    validate: bool,
    /// For auto: the mean error over shadow and penumbra that it may make, 0.02 or 2%; 2 % where neither this nor
    /// --max-ms is given. For a technique that is named: the most that each effect left out may add to its error
    #[arg(long, value_name = "E", allow_hyphen_values = true)]
    max_error: Option<String>,
    /// For auto: the milliseconds of the device that a frame may take, 20 or 20ms
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    max_ms: Option<String>,
}

/// The checked options of a run.
#[derive(Debug)]
pub struct Options {
    pub scene: PathBuf,
    pub out: PathBuf,
    /// The budget that technique and settings are chosen by; `None` where they are given.
    pub auto: Option<Budget>,
    /// The most that leaving out one effect may add to the error, where a technique is named.
    pub max_error: Option<f64>,
    pub settings: Technique,
    pub size: [u32; 2],
    /// The node of the one light that is drawn; `None` for all.
    pub light: Option<String>,
    /// The node of the camera; `None` for the first.
    pub camera: Option<String>,
    /// The scene of the file; `None` for the default one.
    pub part: Option<String>,
    /// An animation, and the time of it that is shown, in seconds.
    pub animation: Option<(String, f64)>,
    /// The radius of lights of the file that say none, metres.
    pub light_radius: f64,
    /// Whether meshes that shine are lights.
    pub emissive: bool,
    pub roles: Vec<(String, Role)>,
    pub repeat: u32,
    /// The pixels of each frame that are traced to measure its error; 0 for none.
    pub audit: u32,
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
/// The help text where it was requested; one line for anything wrong.
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
            Stop::Wrong(sentence(&e.to_string()))
        } else {
            Stop::Help(e.to_string())
        }
    })?;
    let a = Arguments::from_arg_matches(&matches).map_err(|e| Stop::Wrong(e.to_string()))?;
    check_out(&a.out)?;
    let max_error = a.max_error.as_deref().map(fraction).transpose()?;
    let max_ms = a.max_ms.as_deref().map(milliseconds).transpose()?;
    let (auto, mut settings) = technique_of(&a, Budget { max_error, max_ms })?;
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
    if a.audit != 0 && !(16..=65_536).contains(&a.audit) {
        let problem =
            format!("{} pixels cannot be audited; give 16 to 65536, or 0 for none", a.audit);
        return Err(wrong("--audit", problem));
    }
    if !(a.light_radius.is_finite() && a.light_radius >= 0.0) {
        let problem = format!("a light has no radius of {}; give metres from 0 up", a.light_radius);
        return Err(wrong("--light-radius", problem));
    }
    Ok(Options {
        scene: a.scene,
        out: a.out,
        auto,
        max_error: max_error.filter(|_| auto.is_none()),
        settings,
        size: size(&a.size)?,
        light: a.light,
        camera: a.camera,
        part: a.part,
        animation: a.animation.map(|name| (name, a.time)),
        light_radius: a.light_radius,
        emissive: a.emissive,
        roles,
        repeat: a.repeat,
        audit: a.audit,
        validate: a.validate,
    })
}

/// An error of clap as one line: its first paragraph, which names the argument, and its tips. The usage is left out.
fn sentence(text: &str) -> String {
    let lines = || text.lines().map(str::trim);
    let first: Vec<_> = lines().take_while(|line| !line.is_empty()).collect();
    let first = first.join(" ");
    let tips = lines().filter_map(|line| line.strip_prefix("tip: "));
    let parts: Vec<&str> =
        std::iter::once(first.strip_prefix("error: ").unwrap_or(&first)).chain(tips).collect();
    parts.join("; ")
}

/// Holds the folder for the results against what is there, before anything is rendered.
fn check_out(out: &Path) -> Result<(), Stop> {
    match out.ancestors().find(|path| path.exists()) {
        Some(path) if !path.is_dir() => {
            Err(wrong("--out", format!("{} is a file; name a folder", path.display())))
        }
        _ => Ok(()),
    }
}

/// An error: a fraction from 0 to 1, or a percentage with its sign.
fn fraction(text: &str) -> Result<f64, Stop> {
    let refuse = |problem: String| Err(wrong("--max-error", problem));
    let percent = text.trim().strip_suffix('%');
    let number = percent.unwrap_or(text).trim().parse::<f64>();
    match (number, percent) {
        (Ok(x), None) if (1.0..100.0).contains(&x) => {
            let percent = (100.0 * x).round();
            refuse(format!("{text} is {percent} %; write {} or {text}%", percent / 1e4))
        }
        (Ok(x), None) if (0.0..1.0).contains(&x) => Ok(x),
        (Ok(x), Some(_)) if (0.0..100.0).contains(&x) => Ok(x / 100.0),
        _ => refuse(format!("{text} is no error from 0 to 100 %; write 0.02 or 2%")),
    }
}

/// A time above 0, with its unit or without.
fn milliseconds(text: &str) -> Result<f64, Stop> {
    let number = text.trim().strip_suffix("ms").unwrap_or(text).trim().parse::<f64>();
    match number {
        Ok(ms) if ms > 0.0 && ms.is_finite() => Ok(ms),
        _ => Err(wrong("--max-ms", format!("{text} is no time above 0; write 20 or 20ms"))),
    }
}

fn assignments(a: &Arguments) -> Result<Vec<(&str, &str)>, Stop> {
    let pair = |text| {
        let (key, value) = str::split_once(text, '=')
            .ok_or_else(|| wrong("--set", format!("\"{text}\" is not KEY=VALUE")))?;
        Ok((key.trim(), value.trim()))
    };
    a.settings.iter().map(|text| pair(text.as_str())).collect()
}

/// The budget of `auto`, or the technique that was given: by its name, or by settings that it has.
fn technique_of(a: &Arguments, budget: Budget) -> Result<(Option<Budget>, Technique), Stop> {
    let given = assignments(a)?;
    match (a.technique.as_deref(), &given[..]) {
        (None | Some(AUTO), []) => match budget.max_error {
            Some(0.0) => Err(wrong(
                "--max-error",
                "no technique can promise an error of 0; write 0.02 or 2%",
            )),
            _ => Ok((Some(budget), Technique::default())),
        },
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
            let keys: Vec<&str> = given.iter().map(|(key, _)| *key).collect();
            Ok((None, keys::technique(&keys).map_err(|problem| wrong("--set", problem))?))
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
