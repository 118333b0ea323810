//! The reason why a pass runs or does not, kept as words and numbers. They become text when it is shown, so that
//! planning a frame formats none.

use std::fmt;

/// The most parts that a reason has.
const PARTS: usize = 10;

/// A piece of a sentence.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Part {
    /// No text.
    #[default]
    Nothing,
    /// Words, including the spaces around them.
    Words(&'static str),
    /// A whole number.
    Count(u64),
    /// A number, and how many decimals of it are shown.
    Decimal(f64, u8),
}

impl From<&'static str> for Part {
    fn from(words: &'static str) -> Self {
        Self::Words(words)
    }
}

impl From<usize> for Part {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<u64> for Part {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

/// A reason, as part of a sentence; its `Display` writes the text.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Why {
    parts: [Part; PARTS],
    len: u8,
}

impl Why {
    /// Appends a part. A reason has at most ten; further ones are left out.
    #[must_use]
    pub fn and(mut self, part: impl Into<Part>) -> Self {
        if let Some(place) = self.parts.get_mut(usize::from(self.len)) {
            *place = part.into();
            self.len += 1;
        }
        self
    }

    /// Appends a number that is shown with `decimals` decimals.
    #[must_use]
    pub fn number(self, number: f64, decimals: u8) -> Self {
        self.and(Part::Decimal(number, decimals))
    }

    /// Appends the parts of another reason.
    #[must_use]
    pub fn because(self, other: &Self) -> Self {
        other.parts[..usize::from(other.len)].iter().fold(self, |why, part| why.and(*part))
    }

    /// Whether there is room for another part.
    pub fn has_room(&self) -> bool {
        usize::from(self.len) < PARTS
    }
}

impl From<&'static str> for Why {
    fn from(words: &'static str) -> Self {
        Self::default().and(words)
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.parts.iter().try_for_each(|part| match part {
            Part::Nothing => Ok(()),
            Part::Words(words) => f.write_str(words),
            Part::Count(count) => write!(f, "{count}"),
            Part::Decimal(number, decimals) => write!(f, "{number:.*}", usize::from(*decimals)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_become_a_sentence() {
        let bound = Why::from("eq. 3 is ").number(0.123_45, 4);
        let why = Why::default().and(2u64).and(" of ").and(3usize).and(": ").because(&bound);
        assert_eq!(why.to_string(), "2 of 3: eq. 3 is 0.1235");
        assert_eq!(Why::default().to_string(), "");
    }

    #[test]
    fn what_has_no_room_is_left_out() {
        let full = (0..PARTS).fold(Why::default(), |why, _| why.and("."));
        assert!(!full.has_room());
        assert_eq!(full.and("!"), full);
    }
}
