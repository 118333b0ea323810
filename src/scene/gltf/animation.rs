//! Where an animation has the nodes at a time (glTF 2.0 §3.11).
//!
//! Animations are not a part of what every file is read for: what is wrong with one stops no scene that was not to be
//! shown at a time of it.

use super::Problem;
use super::accessor::Vectors;
use super::buffers::Buffers;
use super::document::{Document, item};
use super::json::{Root, at, by_name, shortened};
use glam::DQuat;
use gltf::json::animation::{Channel, Interpolation, Property, Sampler};
use gltf::json::validation::Checked;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use serde_json::value::RawValue;
use std::collections::BTreeSet;

/// An animation, whose channels are read one by one: those of extensions have no node, and the crate has no such one.
#[derive(Default, Deserialize)]
struct Animation<'a> {
    #[serde(default)]
    name: Value,
    #[serde(borrow, default)]
    channels: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    samplers: Vec<&'a RawValue>,
}

/// The part of a channel by which an extension's is known.
#[derive(Deserialize)]
struct Targeted {
    target: Option<Target>,
}

#[derive(Deserialize)]
struct Target {
    node: Option<IgnoredAny>,
}

/// An animation of the document.
fn read<'a>(text: &'a RawValue, number: usize) -> Result<Animation<'a>, Problem> {
    serde_json::from_str(text.get())
        .map_err(|e| format!("animations[{number}] is wrong: {}", shortened(&e.to_string())))
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
        document: &Document,
        (name, time): (&str, f64),
    ) -> Result<Self, Problem> {
        let animations = || document.animations.iter().enumerate();
        let names: Vec<Value> = animations()
            .map(|(number, text)| read(text, number).map(|of| of.name).unwrap_or_default())
            .collect();
        let number = by_name("animation", names.iter().map(Value::as_str), name)?;
        if !time.is_finite() {
            return Err(format!("an animation has no time {time}"));
        }
        let Some((number, text)) = animations().nth(number) else { return Ok(Self(Vec::new())) };
        let animation = read(text, number)?;
        let mut rising = BTreeSet::new();
        let mut changes = Vec::new();
        for nth in 0..animation.channels.len() {
            let owner = |what: &'static str| {
                move || format!("the {what} of channel {nth} of animation {number}")
            };
            let channels = &animation.channels;
            let targeted: Targeted = item(channels, nth, "channels", owner("target"))?;
            if targeted.target.is_some_and(|target| target.node.is_none()) {
                continue;
            }
            let channel: Channel = item(channels, nth, "channels", owner("target"))?;
            let node = channel.target.node.value();
            at(&root.nodes, node, "nodes", owner("target"))?;
            let sampler = channel.sampler.value();
            let sampler: Sampler = item(&animation.samplers, sampler, "samplers", owner("target"))?;
            let [input, of] = [sampler.input.value(), sampler.output.value()];
            let times = Vectors::<1>::open(root, buffers, input, false, &owner("input"))?;
            if rising.insert(input) {
                rise(&times, &owner("input"))?;
            }
            let keys = Keys::around(&times, time, &sampler, &owner("input"))?;
            let output = owner("output");
            let vectors = || Vectors::<3>::open(root, buffers, of, false, &output);
            let change = match channel.target.path {
                Checked::Valid(Property::Translation) => {
                    Change::Translation(keys.value(&vectors()?, &output)?)
                }
                Checked::Valid(Property::Scale) => Change::Scale(keys.value(&vectors()?, &output)?),
                Checked::Valid(Property::Rotation) => {
                    let of = Vectors::<4>::open(root, buffers, of, true, &output)?;
                    Change::Rotation(keys.rotation(&of, &output)?)
                }
                Checked::Valid(Property::MorphTargetWeights) => {
                    let of = Vectors::<1>::open(root, buffers, of, true, &output)?;
                    Change::Weights(keys.weights(&of, times.len(), &output)?)
                }
                // Those of extensions, such as `pointer`.
                Checked::Invalid => continue,
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
        let way = match sampler.interpolation {
            Checked::Valid(Interpolation::Linear) => Way::Linear,
            Checked::Valid(Interpolation::Step) => Way::Step,
            Checked::Valid(Interpolation::CubicSpline) => Way::Cubic,
            Checked::Invalid => {
                return Err(format!(
                    "{} is interpolated by none of LINEAR, STEP and CUBICSPLINE, and glTF has no other",
                    owner()
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
