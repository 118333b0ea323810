//! Where an animation has the nodes at a time (glTF 2.0 §3.11).
//!
//! Animations are not a part of what every file is read for: what is wrong with one stops no scene that was not to be
//! shown at a time of it.

use super::Problem;
use super::accessor::Vectors;
use super::buffers::Buffers;
use super::json::{Root, at, by_name, from_json};
use crate::error::quoted;
use glam::DQuat;
use serde::Deserialize;
use std::collections::BTreeSet;

#[derive(Deserialize)]
struct Animations {
    #[serde(default)]
    animations: Vec<Animation>,
}

#[derive(Deserialize)]
struct Animation {
    name: Option<String>,
    #[serde(default)]
    channels: Vec<Channel>,
    #[serde(default)]
    samplers: Vec<Sampler>,
}

#[derive(Deserialize)]
struct Channel {
    sampler: usize,
    target: Target,
}

#[derive(Deserialize)]
struct Target {
    /// A channel without a node is an extension's.
    node: Option<usize>,
    path: String,
}

#[derive(Deserialize)]
struct Sampler {
    input: usize,
    output: usize,
    interpolation: Option<String>,
}

/// What an animation makes of a member of a node.
enum Change {
    Translation([f64; 3]),
    Rotation([f64; 4]),
    Scale([f64; 3]),
    Weights(Vec<f64>),
}

/// What an animation makes of nodes at a time.
pub(super) struct Changes(Vec<(usize, Change)>);

impl Changes {
    /// What the animation of this name or number makes of nodes at `time`, in seconds; before its first key and after its
    /// last it stands still.
    pub fn at(
        root: &Root,
        buffers: &Buffers,
        text: &[u8],
        (name, time): (&str, f64),
    ) -> Result<Self, Problem> {
        let Animations { animations } = from_json(text)?;
        let names = animations.iter().map(|animation| animation.name.as_deref());
        let number = by_name("animation", names, name)?;
        if !time.is_finite() {
            return Err(format!("an animation has no time {time}"));
        }
        let Some(animation) = animations.get(number) else { return Ok(Self(Vec::new())) };
        let mut rising = BTreeSet::new();
        let mut changes = Vec::new();
        for (nth, channel) in animation.channels.iter().enumerate() {
            let owner = |what: &'static str| {
                move || format!("the {what} of channel {nth} of animation {number}")
            };
            let Some(node) = channel.target.node else { continue };
            at(&root.nodes, node, "nodes", owner("target"))?;
            let sampler = at(&animation.samplers, channel.sampler, "samplers", owner("target"))?;
            let times = Vectors::<1>::open(root, buffers, sampler.input, false, &owner("input"))?;
            if rising.insert(sampler.input) {
                rise(&times, &owner("input"))?;
            }
            let keys = Keys::around(&times, time, sampler, &owner("input"))?;
            let output = owner("output");
            let vectors = || Vectors::<3>::open(root, buffers, sampler.output, false, &output);
            let change = match channel.target.path.as_str() {
                "translation" => Change::Translation(keys.value(&vectors()?, &output)?),
                "scale" => Change::Scale(keys.value(&vectors()?, &output)?),
                "rotation" => {
                    let of = Vectors::<4>::open(root, buffers, sampler.output, true, &output)?;
                    Change::Rotation(keys.rotation(&of, &output)?)
                }
                "weights" => {
                    let of = Vectors::<1>::open(root, buffers, sampler.output, true, &output)?;
                    Change::Weights(keys.weights(&of, times.len(), &output)?)
                }
                // Those of extensions, such as `pointer`.
                _ => continue,
            };
            changes.push((node, change));
        }
        Ok(Self(changes))
    }

    /// Moves the nodes.
    pub fn apply(self, root: &mut Root) -> Result<(), Problem> {
        for (index, change) in self.0 {
            let Some(node) = root.nodes.get_mut(index) else { continue };
            if node.matrix.is_some() && !matches!(change, Change::Weights(_)) {
                return Err(format!("nodes[{index}] has a matrix, and an animation moves it"));
            }
            match change {
                Change::Translation(of) => node.translation = Some(Box::new(of)),
                Change::Rotation(of) => node.rotation = Some(Box::new(of)),
                Change::Scale(of) => node.scale = Some(Box::new(of)),
                Change::Weights(of) => node.weights = Some(of.into()),
            }
        }
        Ok(())
    }
}

/// Holds that times are numbers, each later than the one before.
fn rise(times: &Vectors<1>, owner: &dyn Fn() -> String) -> Result<(), Problem> {
    let mut before = f32::NEG_INFINITY;
    for key in 0..times.len() {
        let time = times.get(key).map_or(f32::NAN, |[time]| time);
        if !time.is_finite() || time <= before {
            return Err(format!(
                "{}: its time {key} is {time}, after {before}; times must rise",
                owner()
            ));
        }
        before = time;
    }
    Ok(())
}

/// How values go from key to key.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Step,
    Linear,
    /// Each key has a tangent on its way in, its value, and a tangent on its way out.
    Cubic,
}

/// The keys on either side of a time.
struct Keys {
    way: Way,
    before: usize,
    after: usize,
    /// How far from the one to the other, 0 to 1, and seconds from the one to the other.
    share: f64,
    seconds: f64,
}

impl Keys {
    fn around(
        times: &Vectors<1>,
        time: f64,
        sampler: &Sampler,
        owner: &dyn Fn() -> String,
    ) -> Result<Self, Problem> {
        let way = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Way::Linear,
            Some("STEP") => Way::Step,
            Some("CUBICSPLINE") => Way::Cubic,
            Some(other) => {
                return Err(format!(
                    "{} is interpolated by {}, which glTF has not",
                    owner(),
                    quoted(other)
                ));
            }
        };
        let of = |key: usize| times.get(key).map_or(f64::INFINITY, |[time]| f64::from(time));
        let (mut low, mut high) = (0, times.len());
        while low < high {
            let middle = low.midpoint(high);
            if of(middle) <= time { low = middle + 1 } else { high = middle }
        }
        let last = times.len().checked_sub(1).ok_or_else(|| format!("{} has no times", owner()))?;
        let (before, after) = (low.saturating_sub(1), low.min(last));
        let seconds = of(after) - of(before);
        let share =
            if seconds > 0.0 { ((time - of(before)) / seconds).clamp(0.0, 1.0) } else { 0.0 };
        Ok(Self { way, before, after, share, seconds })
    }

    /// The weights of a key's value, of the one after it, and of the tangents out of the one and into the other.
    fn weights_of(&self) -> [f64; 4] {
        let t = self.share;
        match self.way {
            Way::Step => [1.0, 0.0, 0.0, 0.0],
            Way::Linear => [1.0 - t, t, 0.0, 0.0],
            Way::Cubic => {
                let (t2, t3) = (t * t, t * t * t);
                let s = self.seconds;
                [
                    2.0 * t3 - 3.0 * t2 + 1.0,
                    3.0 * t2 - 2.0 * t3,
                    s * (t3 - 2.0 * t2 + t),
                    s * (t3 - t2),
                ]
            }
        }
    }

    /// The value and the tangents of `nth` of `count` values a key: at the key before, at the one after, out of the one,
    /// into the other.
    fn four<const N: usize>(
        &self,
        of: &Vectors<N>,
        [nth, count]: [usize; 2],
        owner: &dyn Fn() -> String,
    ) -> Result<[[f64; N]; 4], Problem> {
        let get = |key: usize, part: usize| {
            let each = if self.way == Way::Cubic { 3 } else { 1 };
            let place = (key * each + part) * count + nth;
            let value = of.get(place).filter(|value| value.iter().all(|x| x.is_finite()));
            value
                .map(|value| value.map(f64::from))
                .ok_or_else(|| format!("{} has no finite value {place} for key {key}", owner()))
        };
        match self.way {
            Way::Cubic => Ok([
                get(self.before, 1)?,
                get(self.after, 1)?,
                get(self.before, 2)?,
                get(self.after, 0)?,
            ]),
            _ => Ok([get(self.before, 0)?, get(self.after, 0)?, [0.0; N], [0.0; N]]),
        }
    }

    fn nth<const N: usize>(
        &self,
        of: &Vectors<N>,
        place: [usize; 2],
        owner: &dyn Fn() -> String,
    ) -> Result<[f64; N], Problem> {
        let four = self.four(of, place, owner)?;
        let weights = self.weights_of();
        Ok(std::array::from_fn(|i| (0..4).map(|k| weights[k] * four[k][i]).sum()))
    }

    fn value<const N: usize>(
        &self,
        of: &Vectors<N>,
        owner: &dyn Fn() -> String,
    ) -> Result<[f64; N], Problem> {
        self.nth(of, [0, 1], owner)
    }

    /// Linear is along the shorter arc between two rotations.
    fn rotation(&self, of: &Vectors<4>, owner: &dyn Fn() -> String) -> Result<[f64; 4], Problem> {
        if self.way != Way::Linear {
            return self.value(of, owner);
        }
        let [a, b, ..] = self.four(of, [0, 1], owner)?.map(DQuat::from_array);
        let sound = |q: DQuat| q.length_squared() > 0.0;
        if !(sound(a) && sound(b)) {
            return Err(format!("{} has a rotation of length 0", owner()));
        }
        Ok(a.normalize().slerp(b.normalize(), self.share).to_array())
    }

    /// As many weights as there are for each of `keys` keys.
    fn weights(
        &self,
        of: &Vectors<1>,
        keys: usize,
        owner: &dyn Fn() -> String,
    ) -> Result<Vec<f64>, Problem> {
        let each = if self.way == Way::Cubic { 3 * keys } else { keys };
        let count = of.len() / each.max(1);
        (0..count).map(|nth| Ok(self.nth(of, [nth, count], owner)?[0])).collect()
    }
}
