//! How alike two situations are, by what decides the errors of shadow techniques.

use crate::effects::Situation;

/// What of a situation decides a technique's error, as a point: lengths by the light's side, as logarithms, so that a
/// scene of any scale lies at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likeness {
    /// log₂ of the occluders' size over the light's side.
    pub size: f64,
    /// log₂ of 1 + the widest penumbra over the occluders' size.
    pub penumbra: f64,
    /// log₂ of 1 + the most edges across the occluders.
    pub edges: f64,
    /// 1 where occluders may lie before each other or before themselves.
    pub layers: f64,
    /// 1 where some mesh blocks and receives.
    pub both: f64,
    /// 1 where an occluder is open.
    pub open: f64,
    /// 1 where receivers come as near to the light as occluders do: occluders stand on what they shadow.
    pub contact: f64,
}

/// The names of the parts, as columns of a table.
pub const PARTS: [&str; 7] = ["size", "penumbra", "edges", "layers", "both", "open", "contact"];

/// What a unit of each part counts in a distance: a kind of scene is further from another than twice the size is.
const WEIGHTS: [f64; 7] = [1.0, 1.0, 0.5, 1.5, 2.0, 1.5, 1.0];

impl Likeness {
    /// Of a situation.
    pub fn of(s: &Situation) -> Self {
        let side = s.light[0].max(s.light[1]).max(f64::MIN_POSITIVE);
        let size = s.size.max(f64::MIN_POSITIVE);
        let is = |yes: bool| f64::from(u8::from(yes));
        Self {
            size: (size / side).log2().clamp(-8.0, 16.0),
            penumbra: (1.0 + s.penumbra / size).log2().min(8.0),
            edges: (1.0 + s.edges * size).log2().min(16.0),
            layers: is(s.overlap || s.thickness > 0.01),
            both: is(s.both > 0),
            open: is(s.open),
            contact: is(s.receiver_distances[0] <= s.occluder_distances[1]),
        }
    }

    /// In the order of [`PARTS`].
    pub fn parts(&self) -> [f64; 7] {
        [self.size, self.penumbra, self.edges, self.layers, self.both, self.open, self.contact]
    }

    /// As [`Self::parts`] gives them.
    pub fn from_parts([size, penumbra, edges, layers, both, open, contact]: [f64; 7]) -> Self {
        Self { size, penumbra, edges, layers, both, open, contact }
    }

    /// How far apart two are, 0 for the same.
    pub fn distance(&self, other: &Self) -> f64 {
        let (a, b) = (self.parts(), other.parts());
        let square = |i: usize| (WEIGHTS[i] * (a[i] - b[i])).powi(2);
        (0..PARTS.len()).map(square).sum::<f64>().sqrt()
    }
}
