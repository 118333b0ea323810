//! The error and time that a host allows.

/// The most error and time that shadows may have; with neither given, [`Budget::DEFAULT_ERROR`] is the most error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// The most mean error of the visible fraction over the pixels in shadow and penumbra, above 0.
    pub max_error: Option<f64>,
    /// The most time on the device for all lights of a frame together, milliseconds above 0.
    pub max_ms: Option<f64>,
}

/// A budget whose values are valid, and what was wrong with the host's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ValidBudget {
    pub max_error: f64,
    pub max_ms: f64,
    pub problem: Option<String>,
}

impl Budget {
    /// The most error where the host gives no budget: about what a careful eye finds in a still picture.
    pub const DEFAULT_ERROR: f64 = 0.02;

    /// The valid budget that is nearest to this one, with a sentence where they differ.
    pub(crate) fn valid(&self) -> ValidBudget {
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
            // The least error that the time allows.
            Some(_) => 0.0,
        };
        let most = "the nearest to it is chosen";
        let max_error =
            self.max_error.map_or(default, |e| check("max_error", e, Self::DEFAULT_ERROR, most));
        let max_ms = self.max_ms.map_or(f64::INFINITY, |t| check("max_ms", t, f64::INFINITY, most));
        ValidBudget { max_error, max_ms, problem }
    }
}
