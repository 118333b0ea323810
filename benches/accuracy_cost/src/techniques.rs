//! Techniques and what sweeps, as data.
//!
//! A technique is named as on a command line. One that the crate does not have yet is a row that
//! says so, and fills in by itself when `Technique::from_str` knows its name.

use crate::Problem;
use antumbra::Technique;

/// The name of the technique that is not the node's: rays on all cores of the processor.
pub const RAY_TRACER: &str = "cpu-rays";

/// The name of the paper's own scheme: depth read back, one side's rectangles made by the processor,
/// blended (Atty 2006 section 4.1).
pub const READBACK: &str = "cpu-quads";

/// The name of ray marching at fragments as they are drawn, by the node's maps.
pub const FORWARD: &str = "ray-march-forward";

/// A curve: one technique whose quality sweeps with one setting.
pub struct Curve {
    /// The technique's name, as on a command line.
    pub technique: &'static str,
    /// What a reader sees.
    pub label: &'static str,
    /// The settings as words of a command line, `{}` in place of the value that sweeps.
    words: &'static str,
    /// The values, from the coarsest.
    values: &'static str,
    /// The values that the quick run measures.
    quick: &'static str,
    /// The value that stands for the technique in the picture strip; without one the curve is not in it.
    shown: &'static str,
}

/// One point of a curve.
pub struct Step {
    /// The settings as words of a command line.
    pub words: String,
    /// The value that sweeps.
    pub x: f64,
    pub in_quick: bool,
    /// Whether it stands for the technique in the picture strip.
    pub shown: bool,
}

impl Curve {
    /// The points, from the coarsest.
    pub fn steps(&self) -> impl Iterator<Item = Step> {
        self.values.split(' ').map(|value| Step {
            words: self.words.replace("{}", value),
            x: value.parse().unwrap_or(f64::NAN),
            in_quick: self.quick.split(' ').any(|quick| quick == value),
            shown: self.shown == value,
        })
    }
}

const fn curve(
    [technique, label]: [&'static str; 2],
    words: &'static str,
    values: &'static str,
    quick: &'static str,
    shown: &'static str,
) -> Curve {
    Curve { technique, label, words, values, quick, shown }
}

/// The curve of PCSS as engines run it.
pub const PCSS_FINE: &str = "PCSS, 1024² maps";

const SSM: &str = "soft-shadow-map";
const SIDES: &str = "64 128 256 512";
const PROJECTED: &str = "receivers=map map={} receiver_map={}";
const BLENDED: &str = "receivers=map accumulate=blend map={} receiver_map={}";
const AS_PUBLISHED: &str = "layers=2 sampling=jittered hash=md5 rays={}";

/// The curves of error against time: their settings, values, quick values and the one in the picture strip.
pub const CURVES: &[Curve] = &[
    curve([SSM, "soft shadow map"], "map={}", SIDES, "64 128 256", "256"),
    curve([SSM, "soft shadow map, larger of two sides"], "sides=two map={}", SIDES, "128", ""),
    curve([SSM, "soft shadow map, one side"], "sides=one map={}", SIDES, "128", ""),
    curve([SSM, "soft shadow map, projected"], PROJECTED, SIDES, "128", ""),
    curve([SSM, "soft shadow map, blended"], BLENDED, "64 128 256", "", ""),
    curve([READBACK, "the paper's scheme, through the CPU"], "map={}", "64 128 256", "128", ""),
    curve([SSM, "soft shadow map 256, looser"], "tolerance={} map=256", "0.01 0.001 0", "", ""),
    curve([RAY_TRACER, "ray tracer on the CPU"], "rays={}", "1 4 16 64", "1 4 16", "4"),
    curve(["hard", "hard shadow map, 3×3"], "map={}", "256 512 1024", "512", "512"),
    // Engines give it maps of 1024² or more, and 32 taps or more.
    curve(["pcss", "PCSS"], "taps={}", "8 16 32 64", "16 32", "32"),
    curve(["pcss", PCSS_FINE], "map=1024 taps={}", "16 32 64", "32", ""),
    curve(["many-lights", "many hard lights"], "samples={}", "1 4 16 64", "4 16", "16"),
    curve(["back-projection", "back-projection"], "map={}", SIDES, "128 256", "256"),
    curve(["ray-march", "ray march"], "rays={}", "1 4 16 64", "4 16", "16"),
    curve(["ray-march", "ray march, unfiltered"], "filter=off rays={}", "16 64 256", "", ""),
    curve(["ray-march", "ray march as published, two layers"], AS_PUBLISHED, "4 9 16", "4", ""),
    curve(["ray-march", "ray march, 16 rays"], "rays=16 map={}", "64 128 512", "", ""),
    curve(["occlusion-textures", "occlusion textures"], "slices={}", "4 8 16", "4 8 16", "8"),
    curve(["linear-light", "linear light"], "error={}", "0.05 0.02 0.01", "0.05 0.02", "0.02"),
    curve(["traced", "triangles, traced"], "samples={}", "64 256", "64 256", "64"),
];

/// The curves that are measured in scenes with lights of their own, where a frame takes longer and there are many lights:
/// one of each technique that takes rectangles and suns, and is no mere comparison. Those that the processor runs know no
/// suns.
pub fn of_whole(is_sun: bool) -> impl Iterator<Item = &'static Curve> {
    const LABELS: [&str; 9] = [
        "soft shadow map",
        "ray tracer on the CPU",
        "hard shadow map, 3×3",
        "PCSS",
        PCSS_FINE,
        "many hard lights",
        "ray march",
        "occlusion textures",
        "triangles, traced",
    ];
    let takes = move |c: &&Curve| !is_sun || c.technique != RAY_TRACER;
    CURVES.iter().filter(|c| LABELS.contains(&c.label)).filter(takes)
}

/// How a visible fraction is to be computed.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// The node's passes over a G-buffer.
    Node(Box<Technique>),
    /// Rays by the node's maps, at fragments as they are drawn.
    Forward(Box<Technique>),
    /// So many rays a pixel on the processor.
    Rays(u32),
    /// The paper's own scheme, with maps of this side.
    Readback(u32),
}

/// The method that a technique's name and settings ask for; `None` where the crate does not have the
/// technique yet.
///
/// # Errors
/// A sentence for a setting that is refused.
pub fn method(technique: &str, words: &str) -> Result<Option<Method>, Problem> {
    let number = |key: &str| {
        let value = words.strip_prefix(key).and_then(|value| value.strip_prefix('=')?.parse().ok());
        value.ok_or_else(|| Problem(format!("{words}: no {key}")))
    };
    match technique {
        RAY_TRACER => return Ok(Some(Method::Rays(number("rays")?))),
        READBACK => return Ok(Some(Method::Readback(number("map")?))),
        _ => {}
    }
    let is_forward = technique == FORWARD;
    let technique = if is_forward { "ray-march" } else { technique };
    if !Technique::NAMES.contains(&technique) {
        return Ok(None);
    }
    let settings: Technique = format!("{technique} {words}").parse()?;
    settings.check()?;
    let settings = Box::new(settings);
    Ok(Some(if is_forward { Method::Forward(settings) } else { Method::Node(settings) }))
}

/// The value of a setting among the words, as a number.
pub fn value_of(words: &str, key: &str) -> Option<f64> {
    words
        .split_whitespace()
        .find_map(|w| w.split_once('=').filter(|(k, _)| *k == key)?.1.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_there_is_understood_and_what_is_not_is_not_there() {
        for curve in CURVES {
            for Step { words, x, .. } in curve.steps() {
                let found = method(curve.technique, &words);
                let known = [RAY_TRACER, READBACK].contains(&curve.technique)
                    || curve.technique.parse::<Technique>().is_ok();
                match found {
                    Ok(found) => assert_eq!(found.is_some(), known, "{} {words}", curve.technique),
                    Err(e) => panic!("{} {words}: {e}", curve.technique),
                }
                assert!(x.is_finite() && words.contains(&format!("={x}")), "{words}");
            }
            let count = |keep: fn(&Step) -> bool| curve.steps().filter(keep).count();
            assert_eq!(count(|s| s.shown), usize::from(!curve.shown.is_empty()), "{}", curve.label);
            assert_eq!(count(|s| s.in_quick), curve.quick.split_whitespace().count());
        }
        assert_eq!(method("time-machine", "map=1").unwrap(), None);
        assert!(method("soft-shadow-map", "map=4097").unwrap_err().0.contains("0 to 4096"));
    }
}
