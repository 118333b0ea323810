//! A light as one value: where it is, where it shines, and its outline where it is a polygon.

use super::RectangleLight;
use super::outline::{self, CORNERS};
use crate::Error;
use crate::plain::Vector;
use glam::DVec3;

/// As many corners as an outline may have.
const MOST: usize = *CORNERS.end();

/// A light: a rectangle, a line or a sun's rectangle, or a polygon within its rectangle.
///
/// A [`RectangleLight`] is a light by `into()`; [`Self::polygon`] makes one of corners in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    rectangle: RectangleLight,
    outline: Option<Outline>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Outline {
    /// The first `count` are corners, the others 0.
    corners: [[f64; 2]; MOST],
    count: usize,
}

impl From<RectangleLight> for Light {
    fn from(rectangle: RectangleLight) -> Self {
        Self { rectangle, outline: None }
    }
}

impl Light {
    /// A polygon light: 3 to 16 corners of one plane in world space, in metres, in order. The polygon need not be
    /// convex; it shines to the side from which the corners run counter-clockwise.
    ///
    /// # Errors
    /// As [`RectangleLight::around`].
    pub fn polygon(corners: &[impl Into<Vector> + Copy]) -> Result<Self, Error> {
        let corners: Vec<DVec3> = corners.iter().map(|&corner| corner.into().0).collect();
        let (rectangle, outline) = RectangleLight::around(&corners)?;
        Self::with_outline(rectangle, &outline)
    }

    /// The part of a rectangle within an outline: 3 to 16 corners in light space, as x and y in metres from the
    /// rectangle's centre, within the rectangle, counter-clockwise as seen from the side that the light shines to. The
    /// outline need not be convex, and neither touches nor crosses itself.
    ///
    /// # Errors
    /// [`Error::Light`] for an outline that is not that, and for a line, which has none.
    pub fn with_outline(rectangle: RectangleLight, corners: &[[f64; 2]]) -> Result<Self, Error> {
        if rectangle.is_line() {
            return Err(Error::Light("it is a line, which has no outline".into()));
        }
        if let Some(problem) = outline::problem(corners, rectangle.half_extents()) {
            return Err(Error::Light(format!("of its outline, {problem}")));
        }
        let mut outline = Outline { corners: [[0.0; 2]; MOST], count: corners.len() };
        outline.corners[..corners.len()].copy_from_slice(corners);
        Ok(Self { rectangle, outline: Some(outline) })
    }

    /// The rectangle that the light is, or that is around its outline.
    pub fn rectangle(&self) -> &RectangleLight {
        &self.rectangle
    }

    /// The corners of the outline, in light space; none where the light is the whole rectangle.
    pub fn outline(&self) -> Option<&[[f64; 2]]> {
        self.outline.as_ref().map(|outline| &outline.corners[..outline.count])
    }

    /// The direction in which the light shines, a unit vector in world space.
    pub fn emission(&self) -> DVec3 {
        self.rectangle.emission()
    }

    /// The light with the axes of its space turned by a quarter: x where y was.
    pub(crate) fn quarter_turned(&self) -> Self {
        let mut turned = *self;
        turned.rectangle = self.rectangle.quarter_turned();
        for [x, y] in turned.outline.iter_mut().flat_map(|outline| &mut outline.corners) {
            (*x, *y) = (*y, -*x);
        }
        turned
    }
}
