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

/// The settings, and whether the quick run measures them.
type Step = (&'static str, bool);

/// A curve: one technique whose quality sweeps.
pub struct Curve {
    /// The technique's name, as on a command line.
    pub technique: &'static str,
    /// What a reader sees.
    pub label: &'static str,
    /// The key of the setting that sweeps.
    pub sweeps: &'static str,
    /// The settings of each point, from the coarsest, as words of a command line.
    pub steps: &'static [Step],
    /// Which point stands for the technique in the picture strip; none leaves it out there.
    pub shown: Option<usize>,
}

/// The curves of error against time.
pub const CURVES: &[Curve] = &[
    Curve {
        technique: "soft-shadow-map",
        label: "soft shadow map",
        sweeps: "map",
        steps: &[("map=64", true), ("map=128", true), ("map=256", true), ("map=512", false)],
        shown: Some(2),
    },
    Curve {
        technique: "soft-shadow-map",
        label: "soft shadow map, larger of two sides",
        sweeps: "map",
        steps: &[
            ("sides=two map=64", false),
            ("sides=two map=128", true),
            ("sides=two map=256", false),
            ("sides=two map=512", false),
        ],
        shown: None,
    },
    Curve {
        technique: "soft-shadow-map",
        label: "soft shadow map, one side",
        sweeps: "map",
        steps: &[
            ("sides=one map=64", false),
            ("sides=one map=128", true),
            ("sides=one map=256", false),
            ("sides=one map=512", false),
        ],
        shown: None,
    },
    Curve {
        technique: "soft-shadow-map",
        label: "soft shadow map, projected",
        sweeps: "map",
        steps: &[
            ("receivers=map map=64 receiver_map=64", false),
            ("receivers=map map=128 receiver_map=128", true),
            ("receivers=map map=256 receiver_map=256", false),
            ("receivers=map map=512 receiver_map=512", false),
        ],
        shown: None,
    },
    Curve {
        technique: "soft-shadow-map",
        label: "soft shadow map, blended",
        sweeps: "map",
        steps: &[
            ("receivers=map accumulate=blend map=64 receiver_map=64", false),
            ("receivers=map accumulate=blend map=128 receiver_map=128", false),
            ("receivers=map accumulate=blend map=256 receiver_map=256", false),
        ],
        shown: None,
    },
    Curve {
        technique: READBACK,
        label: "the paper's scheme, through the CPU",
        sweeps: "map",
        steps: &[("map=64", false), ("map=128", true), ("map=256", false)],
        shown: None,
    },
    Curve {
        technique: "soft-shadow-map",
        label: "soft shadow map 256, looser",
        sweeps: "tolerance",
        steps: &[
            ("tolerance=0.01 map=256", false),
            ("tolerance=0.001 map=256", false),
            ("tolerance=0 map=256", false),
        ],
        shown: None,
    },
    Curve {
        technique: RAY_TRACER,
        label: "ray tracer on the CPU",
        sweeps: "rays",
        steps: &[("rays=1", true), ("rays=4", true), ("rays=16", true), ("rays=64", false)],
        shown: Some(1),
    },
    Curve {
        technique: "hard",
        label: "hard shadow map, 3×3",
        sweeps: "map",
        steps: &[("map=256", false), ("map=512", true), ("map=1024", false)],
        shown: Some(1),
    },
    Curve {
        technique: "pcss",
        label: "PCSS",
        sweeps: "taps",
        steps: &[("taps=8", true), ("taps=16", true), ("taps=32", true)],
        shown: Some(1),
    },
    Curve {
        technique: "many-lights",
        label: "many hard lights",
        sweeps: "samples",
        steps: &[
            ("samples=1", false),
            ("samples=4", true),
            ("samples=16", true),
            ("samples=64", false),
        ],
        shown: Some(2),
    },
    Curve {
        technique: "back-projection",
        label: "back-projection",
        sweeps: "map",
        steps: &[("map=64", false), ("map=128", true), ("map=256", true), ("map=512", false)],
        shown: Some(2),
    },
    Curve {
        technique: "ray-march",
        label: "ray march",
        sweeps: "rays",
        steps: &[("rays=1", false), ("rays=4", true), ("rays=16", true), ("rays=64", false)],
        shown: Some(2),
    },
    Curve {
        technique: "ray-march",
        label: "ray march, unfiltered",
        sweeps: "rays",
        steps: &[
            ("filter=off rays=16", false),
            ("filter=off rays=64", false),
            ("filter=off rays=256", false),
        ],
        shown: None,
    },
    Curve {
        technique: "ray-march",
        label: "ray march as published, two layers",
        sweeps: "rays",
        steps: &[
            ("layers=2 sampling=jittered hash=md5 rays=4", true),
            ("layers=2 sampling=jittered hash=md5 rays=9", false),
            ("layers=2 sampling=jittered hash=md5 rays=16", false),
        ],
        shown: None,
    },
    Curve {
        technique: "ray-march",
        label: "ray march, 16 rays",
        sweeps: "map",
        steps: &[("rays=16 map=64", false), ("rays=16 map=128", false), ("rays=16 map=512", false)],
        shown: None,
    },
    Curve {
        technique: "occlusion-textures",
        label: "occlusion textures",
        sweeps: "slices",
        steps: &[("slices=4", true), ("slices=8", true), ("slices=16", true)],
        shown: Some(1),
    },
    Curve {
        technique: "linear-light",
        label: "linear light",
        sweeps: "error",
        steps: &[("error=0.05", true), ("error=0.02", true), ("error=0.01", false)],
        shown: Some(1),
    },
];

/// How a visible fraction is to be computed.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// By the node.
    Node(Box<Technique>),
    /// By the node's maps, at fragments as they are drawn.
    Forward(Box<Technique>),
    /// By so many rays a pixel on the processor.
    Rays(u32),
    /// By the paper's own scheme, with maps of this side.
    Readback(u32),
}

/// The method that a technique's name and settings ask for; `None` where the crate does not have the
/// technique yet.
///
/// # Errors
/// A sentence for a setting that is refused.
pub fn method(technique: &str, words: &str) -> Result<Option<Method>, Problem> {
    if technique == RAY_TRACER {
        let rays = words.strip_prefix("rays=").and_then(|rays| rays.parse().ok());
        return rays.map(|rays| Some(Method::Rays(rays))).ok_or(format!("{words}: no rays"));
    }
    if technique == READBACK {
        let side = words.strip_prefix("map=").and_then(|side| side.parse().ok());
        return side.map(|side| Some(Method::Readback(side))).ok_or(format!("{words}: no map"));
    }
    let is_forward = technique == FORWARD;
    let technique = if is_forward { "ray-march" } else { technique };
    if !Technique::NAMES.contains(&technique) {
        return Ok(None);
    }
    let settings: Technique = format!("{technique} {words}").parse().map_err(told)?;
    settings.check().map_err(told)?;
    let settings = Box::new(settings);
    Ok(Some(if is_forward { Method::Forward(settings) } else { Method::Node(settings) }))
}

#[allow(clippy::needless_pass_by_value, reason = "it is what map_err gives")]
fn told(error: antumbra::Error) -> Problem {
    error.to_string()
}

/// The value of a setting among the words, as a number; its place among the steps where it is none.
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
            for (words, _) in curve.steps {
                let found = method(curve.technique, words);
                let known = [RAY_TRACER, READBACK].contains(&curve.technique)
                    || curve.technique.parse::<Technique>().is_ok();
                match found {
                    Ok(found) => assert_eq!(found.is_some(), known, "{} {words}", curve.technique),
                    Err(e) => panic!("{} {words}: {e}", curve.technique),
                }
                assert!(value_of(words, curve.sweeps).is_some(), "{words}");
            }
            assert!(curve.shown.is_none_or(|shown| shown < curve.steps.len()));
        }
        assert_eq!(method("time-machine", "map=1").unwrap(), None);
        assert!(method("soft-shadow-map", "map=0").unwrap_err().contains("1 to 4096"));
    }

    #[test]
    fn labels_tell_curves_apart() {
        for (i, a) in CURVES.iter().enumerate() {
            assert!(CURVES[..i].iter().all(|b| b.label != a.label), "{}", a.label);
        }
    }
}
