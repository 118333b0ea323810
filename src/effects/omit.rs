//! Which effects a node may leave out.

/// Which effects a node may leave out of a frame, by what that may add to the mean error: a mean of visible fractions
/// over the pixels that shadow touches, bounded as [`RULES`](super::RULES) say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Omit {
    /// None, for studying what each effect costs.
    Nothing,
    /// Those that change no pixel.
    Invisible,
    /// Those that add no more than this to the error each, 0 to 1.
    Below(f64),
}

impl Default for Omit {
    /// Below 1/256, a step of an 8-bit image.
    fn default() -> Self {
        Self::Below(1.0 / 256.0)
    }
}

impl Omit {
    /// The most that leaving an effect out may add to the error; none where nothing may be left out.
    pub(crate) fn most(self) -> Option<f64> {
        match self {
            Self::Nothing => None,
            Self::Invisible => Some(0.0),
            Self::Below(most) => Some(most),
        }
    }
}
