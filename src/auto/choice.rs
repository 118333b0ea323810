//! The choice that [`super::Auto`] makes for a light.

use crate::frame;
use crate::technique::Technique;
use std::fmt;

/// The technique chosen for a light's shadow, and what is expected of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The technique, with its settings.
    pub technique: Technique,
    /// The promised mean error of the visible fraction over the pixels in shadow and penumbra, 0 to 1; `None` where
    /// nothing can be shadowed, and where nothing can be promised because meshes are drawn whole that textures cut out.
    pub error: Option<f64>,
    /// The expected time on the device, milliseconds; `None` where the table has none: for lines and polygons, and
    /// where nothing can be shadowed.
    pub ms: Option<f64>,
    /// Scene and light of the table's view that is nearest to the situation.
    pub nearest: Option<[String; 2]>,
    /// Whether the technique differs from the light's last one.
    pub changed: bool,
    /// A sentence where the budget is not valid or cannot be met; the choice is then the nearest to it.
    pub problem: Option<String>,
    /// A sentence where a technique that works with the triangles themselves was no candidate, and why.
    pub left_out: Option<String>,
}

/// The different techniques of some choices, most accurate first, as many as a node may have.
pub(crate) fn distinct(choices: &[Choice]) -> (Technique, Vec<Technique>) {
    let mut by_error: Vec<&Choice> = choices.iter().collect();
    by_error.sort_by(|a, b| {
        let [a, b] = [a, b].map(|c| c.error.unwrap_or(f64::INFINITY));
        a.total_cmp(&b)
    });
    let mut all: Vec<Technique> = Vec::new();
    for choice in by_error {
        if !all.contains(&choice.technique) {
            all.push(choice.technique);
        }
    }
    all.truncate(frame::MOST_TECHNIQUES);
    let mut all = all.into_iter();
    (all.next().unwrap_or_default(), all.collect())
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "auto: {}", self.technique)?;
        if let Some(error) = self.error {
            write!(f, ", error ≤ {error:.4}")?;
        }
        if let Some(ms) = self.ms {
            write!(f, ", {ms:.1} ms expected")?;
        }
        if let Some([scene, light]) = &self.nearest {
            write!(f, ", as in {scene} under the {light} light")?;
        }
        if let Some(problem) = &self.problem {
            write!(f, "; {problem}")?;
        }
        if let Some(left_out) = &self.left_out {
            write!(f, "; {left_out}")?;
        }
        Ok(())
    }
}
