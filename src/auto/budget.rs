//! What a host asks of `auto`.

/// The most that a light's shadow may err and cost; with neither, [`Budget::DEFAULT_ERROR`] stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// The mean error over the pixels in shadow and penumbra, a visible fraction above 0.
    pub max_error: Option<f64>,
    /// Milliseconds of the device for all lights of a frame together, above 0.
    pub max_ms: Option<f64>,
}

/// A budget that can be worked with, and what was wrong with the one given.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sound {
    pub max_error: f64,
    pub max_ms: f64,
    pub problem: Option<String>,
}

impl Budget {
    /// What an error of nobody's wish may be: what a careful eye finds in a still picture.
    pub const DEFAULT_ERROR: f64 = 0.02;

    /// The nearest budget that makes sense, and a sentence where that is not the one given.
    pub(crate) fn sound(&self) -> Sound {
        let mut problem = None;
        let mut check = |name: &str, value: f64, instead: f64, what: &str| {
            if value > 0.0 {
                return value;
            }
            let given = if value.is_nan() { "not a number".into() } else { format!("{value}") };
            problem = Some(format!("{name} is {given}, and must be above 0; {what}"));
            if value.is_nan() { instead } else { 0.0 }
        };
        let default = match self.max_ms {
            None => Self::DEFAULT_ERROR,
            // The best that the time buys.
            Some(_) => 0.0,
        };
        let most = "the nearest to it is chosen";
        let max_error =
            self.max_error.map_or(default, |e| check("max_error", e, Self::DEFAULT_ERROR, most));
        let max_ms = self.max_ms.map_or(f64::INFINITY, |t| check("max_ms", t, f64::INFINITY, most));
        Sound { max_error, max_ms, problem }
    }
}
