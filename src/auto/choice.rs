//! What `auto` answers.

use crate::frame;
use crate::technique::Technique;
use std::fmt;

/// What to compute a light's shadow with.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The technique, with its settings.
    pub technique: Technique,
    /// The mean error over shadow and penumbra that the model promises, a visible fraction; none where nothing can be
    /// shadowed.
    pub error: Option<f64>,
    /// Milliseconds that the model expects; none where it knows nothing of it.
    pub ms: Option<f64>,
    /// Scene and light of the report that the situation is most like.
    pub alike: Option<[String; 2]>,
    /// Whether it is another one than in the frame before.
    pub changed: bool,
    /// What of the budget makes no sense or cannot be met; the choice is then the nearest to it.
    pub problem: Option<String>,
}

/// The techniques of some choices, each once and the most accurate first, as many as a node may have.
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
        if let Some([scene, light]) = &self.alike {
            write!(f, ", as in {scene} under the {light} light")?;
        }
        if let Some(problem) = &self.problem {
            write!(f, "; {problem}")?;
        }
        Ok(())
    }
}
