//! The cases themselves, as data.

mod lights;
mod numbers;
mod occluders;
mod receivers;
mod scenes;

use super::set::{Block, Floor, Pixels, Place, Set, Shape};
use super::techniques::Held;
use antumbra::RectangleLight;
use antumbra::scene::Role;
use glam::{DMat4, DVec3};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Where the light of most cases is, m above the ground.
const LIGHT: f64 = 4.0;

/// Where their occluder is.
const CARD: f64 = 2.0;

/// What makes a case hard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Limit {
    Light,
    /// What blocks it.
    Occluder,
    /// Where it is looked at.
    Receiver,
    /// The size of its numbers, and the sides of its maps.
    Numbers,
    /// Many things together, as in rooms, streets and halls.
    Scene,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

/// A technique that samples less than elsewhere, for a scene that is slow to draw.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// The name of the technique in [`super::techniques::ALL`].
    pub technique: &'static str,
    /// Its settings, as on a command line.
    pub words: &'static str,
    /// What sampling may add to a pixel.
    pub worst: f64,
    /// And in the mean.
    pub mean: f64,
    /// The reason for both bounds.
    pub why: &'static str,
}

/// One hard case.
#[derive(Clone, Debug)]
pub struct HardCase {
    pub limit: Limit,
    pub name: String,
    /// Its light, occluders, receivers and pixels.
    pub set: Set,
    /// The occluders that can be known, where those are fewer.
    pub seen: Option<Vec<Block>>,
    /// Where all of it goes.
    pub place: Place,
    /// The side of the maps, texels.
    pub map: u32,
    /// Least and largest tangents of the occluder map; fitted without.
    pub window: Option<[[f64; 2]; 2]>,
    /// Techniques that sample less than elsewhere.
    pub noise: Vec<Noise>,
    /// What techniques are known to get wrong, by their names, and why.
    pub known: Vec<(&'static str, &'static str)>,
}

impl HardCase {
    /// A case where nothing else is out of the ordinary.
    fn new(limit: Limit, name: impl Into<String>, set: Set) -> Self {
        Self {
            limit,
            name: name.into(),
            set,
            seen: None,
            place: Place::HERE,
            map: 64,
            window: None,
            noise: Vec::new(),
            known: Vec::new(),
        }
    }

    /// This case, known to be wrong with some techniques.
    fn known_for(mut self, techniques: &[&'static str], why: &'static str) -> Self {
        self.known.extend(techniques.iter().map(|name| (*name, why)));
        self
    }

    /// What can be known of it.
    pub fn truth_set(&self) -> Set {
        let blocks = self.seen.as_ref().unwrap_or(&self.set.blocks).clone();
        Set { blocks, ..self.set.clone() }
    }

    /// What it is called.
    pub fn title(&self) -> String {
        format!("{}: {}", self.limit, self.name)
    }

    /// What a technique samples here, where that is less than elsewhere.
    pub fn noise_of(&self, held: &Held) -> Option<&Noise> {
        self.noise.iter().find(|noise| noise.technique == held.name)
    }

    /// The settings of a technique.
    pub fn words_of(&self, held: &Held) -> String {
        self.noise_of(held).map_or(held.words, |noise| noise.words).into()
    }

    /// Why a technique is known to get it wrong.
    pub fn known(&self, held: &Held) -> Option<&'static str> {
        self.known.iter().find(|(name, _)| *name == held.name).map(|(_, why)| *why)
    }
}

/// Where a scene or its maps are too large for four lines of eight samples.
const TWO_LINES: Noise = Noise {
    technique: "linear-light",
    words: "technique=linear-light lines=2 samples=2",
    worst: 2.0 / 4.0,
    mean: 1.0 / 8.0 + 0.01,
    why: "half a texel's diagonal, the texel that a skin ends at and that of a bilinear filter; two lines, so that each \
          of two edges is off by up to 1/4, in the mean 1/16; 0.01 along the lines",
};

/// Why maps from the light's centre lose what is near the light.
const ASIDE: &str = "a map from the light's centre is too coarse, or looks not far enough aside, for what is this near to the light";

/// Why shadows of what crosses the light's plane are coarse.
const FLATTENED: &str =
    "what a map's centre sees edge-on, or a slice flattens, hides more or less than it does";

/// Why a soft shadow map is wrong at a second receiver.
const ONE_RECEIVER: &str = "receivers=map knows one receiver a texel, as the light's centre sees it, and no shadow of its own";

/// Why linear lights are off where receivers lie at distances of all kinds.
const SKINS: &str = "a skin ends at the receiver beside the occluder's edge; receivers elsewhere read what is not theirs";

/// All of them.
pub fn all() -> Vec<HardCase> {
    let easy = vec![HardCase::new(Limit::Light, "nothing hard", base())];
    let limits = [lights::all(), occluders::all(), receivers::all(), numbers::all(), scenes::all()];
    [easy, limits.concat()].concat()
}

/// A rectangle that shines down, width along x and depth along z.
fn light(sides: [f64; 2], center: DVec3) -> RectangleLight {
    let [w, h] = sides.map(|side| 0.5 * side);
    facing(center, DVec3::X * w, DVec3::NEG_Z * h)
}

/// A light by its half-axes; it shines along half_v × half_u.
#[expect(clippy::panic, reason = "the lights are written above, and all of them are lights")]
fn facing(center: DVec3, half_u: DVec3, half_v: DVec3) -> RectangleLight {
    RectangleLight::new(center, half_u, half_v).unwrap_or_else(|e| panic!("{e}"))
}

/// A rectangle of the usual light's place.
fn lamp(sides: [f64; 2]) -> RectangleLight {
    light(sides, DVec3::Y * LIGHT)
}

fn moved(x: f64, y: f64, z: f64) -> DMat4 {
    DMat4::from_translation(DVec3::new(x, y, z))
}

/// A card of these sides, lying.
fn sheet(sides: [f64; 2], at: DMat4) -> Block {
    Block { shape: Shape::Card(sides), at, role: Role::Occluder }
}

/// A card of one metre at a height, off the middle, so that no edge lies on a pixel's or a texel's centre by
/// symmetry.
fn card(y: f64) -> Block {
    sheet([1.0; 2], moved(0.0371, y, -0.0193))
}

fn ground() -> Floor {
    Floor { at: DMat4::IDENTITY, size: [20.0; 2], role: Role::Receiver, tiles: 1 }
}

/// A card of 1 m halfway between the ground and a light of half a metre 4 m above it.
fn base() -> Set {
    Set {
        light: lamp([0.5; 2]),
        blocks: vec![card(CARD)],
        floors: vec![ground()],
        pixels: Pixels::Above { at: DMat4::IDENTITY, half: 2.0, top: 8.0 },
    }
}
