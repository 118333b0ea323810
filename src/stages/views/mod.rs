//! Views of techniques that look at the occluders from more places than the light's centre.

mod line;
mod point;

pub use line::Line;
pub use point::LightPoint;

use glam::DMat4;
use smallvec::SmallVec;

/// The views that a technique has of its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Views {
    /// None: the occluders are seen from the light's centre, or from behind it.
    #[default]
    Centre,
    /// From points on the light, each with a map.
    Points(Vec<LightPoint>),
    /// From samples on lines of the light.
    Lines(Vec<Line>),
}

impl Views {
    /// How many there are.
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

    /// Light space to the clip space of each view.
    pub fn clips(&self) -> SmallVec<[DMat4; 1]> {
        match self {
            Self::Centre => SmallVec::new(),
            Self::Points(points) => points.iter().map(LightPoint::clip_from_light).collect(),
            Self::Lines(lines) => lines.iter().map(Line::line_from_light).collect(),
        }
    }
}
