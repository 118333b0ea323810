//! The features of a situation that decide the errors of shadow techniques, and a distance between situations by them.

use crate::effects::Situation;

/// The features of a situation that decide a technique's error, as a point. Lengths are logarithms of ratios, so that a
/// scene has the same features at any scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features {
    /// log₂ of the occluders' size over the light's side, −8 to 16.
    pub size: f64,
    /// log₂ of 1 + the widest penumbra over the occluders' size, 0 to 8.
    pub penumbra: f64,
    /// log₂ of 1 + the most shadow edges across the occluders, 0 to 16.
    pub edges: f64,
    /// 1 where an occluder may hide another or parts of itself from the light, otherwise 0.
    pub layers: f64,
    /// 1 where some mesh blocks and receives, otherwise 0.
    pub both: f64,
    /// 1 where an occluder is open, otherwise 0.
    pub open: f64,
    /// 1 where receivers come as near to the light as occluders do, as where occluders stand on what they shadow;
    /// otherwise 0.
    pub contact: f64,
}

/// The names of the features, as columns of the table.
pub const FEATURES: [&str; 7] = ["size", "penumbra", "edges", "layers", "both", "open", "contact"];

/// The weight of each feature in a distance: another kind of scene is further away than another size.
const WEIGHTS: [f64; 7] = [1.0, 1.0, 0.5, 1.5, 2.0, 1.5, 1.0];

impl Features {
    /// The features of a situation.
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

    /// The values of the features, in the order of [`FEATURES`].
    pub fn values(&self) -> [f64; 7] {
        [self.size, self.penumbra, self.edges, self.layers, self.both, self.open, self.contact]
    }

    /// The features with these values, in the order of [`FEATURES`].
    pub fn from_values([size, penumbra, edges, layers, both, open, contact]: [f64; 7]) -> Self {
        Self { size, penumbra, edges, layers, both, open, contact }
    }

    /// The weighted distance between two situations' features, 0 where they are equal.
    pub fn distance(&self, other: &Self) -> f64 {
        let (a, b) = (self.values(), other.values());
        let square = |i: usize| (WEIGHTS[i] * (a[i] - b[i])).powi(2);
        (0..FEATURES.len()).map(square).sum::<f64>().sqrt()
    }
}
