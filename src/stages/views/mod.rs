//! Views of the occluders: those that share a light's receivers, and those of techniques that see the occluders from
//! points or lines all over the light.

pub mod inner;
mod line;
mod point;
mod served;
mod sun;
mod visible;

pub use line::Line;
pub use point::LightPoint;
pub(crate) use served::{Lamp, Region, Served, fit_served};
pub(crate) use sun::{Extent, UnderSun, fit_sun};
pub(crate) use visible::Visible;

use crate::knob::MOST_VIEWS;
use glam::DMat4;
use smallvec::SmallVec;

/// The views that a technique has of its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Views {
    /// There are none: the occluders are seen from the light's centre, or from behind it.
    #[default]
    Centre,
    /// There is a view from each of these points on the light, with a map each.
    Points(Vec<LightPoint>),
    /// There is a view for each of these lines, which the samples on it share.
    Lines(Vec<Line>),
}

impl Views {
    /// The number of views.
    pub fn count(&self) -> usize {
        match self {
            Self::Centre => 0,
            Self::Points(points) => points.len(),
            Self::Lines(lines) => lines.len(),
        }
    }

    /// The points; none for other views.
    pub fn points(&self) -> &[LightPoint] {
        if let Self::Points(points) = self { points } else { &[] }
    }

    /// The lines; none for other views.
    pub fn lines(&self) -> &[Line] {
        if let Self::Lines(lines) = self { lines } else { &[] }
    }

    /// The matrices from light space to the clip space of each view.
    pub fn clips(&self) -> SmallVec<[DMat4; MOST_VIEWS as usize]> {
        match self {
            Self::Centre => SmallVec::new(),
            Self::Points(points) => points.iter().map(LightPoint::clip_from_light).collect(),
            Self::Lines(lines) => lines.iter().map(Line::line_from_light).collect(),
        }
    }
}
