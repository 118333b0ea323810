//! The views of a frame's occluders, for people.

use crate::stages::depth_layers::Eye;
use crate::stages::views::Served;
use std::fmt;

/// A view through which a light is seen in a frame: the window of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedView {
    /// The least x and y of its window: tangents, or metres under a sun.
    pub min: [f64; 2],
    /// The largest.
    pub max: [f64; 2],
    /// The size of a texel of its maps, in the same units.
    pub texel: [f64; 2],
    /// The distances between which it shows occluders, metres: from the light's plane, or under a sun from the highest
    /// occluder.
    pub distances: [f64; 2],
    /// Whether it is a sun's.
    pub is_parallel: bool,
}

impl PlannedView {
    pub(super) fn of(Served { map, aside, .. }: &Served) -> Self {
        let is_parallel = map.eye == Eye::Infinity;
        let before = if is_parallel { map.near } else { map.behind() };
        Self {
            min: [0, 1].map(|i| map.min[i] + aside[i]),
            max: [0, 1].map(|i| map.max[i] + aside[i]),
            texel: map.texels_per_uv().map(|per| 1.0 / per),
            distances: [map.near - before, map.far - before],
            is_parallel,
        }
    }
}

/// A line of [`FramePlan::explain`](super::FramePlan::explain).
impl fmt::Display for PlannedView {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min, max, texel: [x, y], distances: [near, far], is_parallel } = *self;
        if is_parallel {
            let [wide, high] = [max[0] - min[0], max[1] - min[1]];
            write!(f, "{wide:.2} by {high:.2} m in texels of {x:.4} by {y:.4} m, {far:.2} m deep")
        } else {
            write!(
                f,
                "tangents {:.2} to {:.2} and {:.2} to {:.2} in texels of {x:.4} by {y:.4}, {near:.2} to {far:.2} m away",
                min[0], max[0], min[1], max[1]
            )
        }
    }
}
