//! A light of any polygonal outline, for the truth alone: the techniques have their own.

use super::pyramid::Frame;
use super::union::{LightOutline, to_grid};
use crate::{Error, RectangleLight};
use glam::{DVec2, DVec3};

/// The largest distance of corners from their common plane, relative to the light's size: f32 corners
/// are off by less within a hundred times the light's size from the origin.
const MAX_WARP: f64 = 1e-5;

/// The most corners: each edge is held against each other once.
const MAX_CORNERS: usize = 4096;

/// A simple polygon that emits from one side.
///
/// It need not be convex. It emits towards the side from which its corners run counter-clockwise,
/// as a glTF triangle faces.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonLight {
    /// The polygon's bounding rectangle fills the square −1..1.
    frame: Frame,
    outline: LightOutline,
}

impl PolygonLight {
    /// A light from its corners in world space, in metres.
    ///
    /// # Errors
    /// [`Error::Light`] for fewer than 3 corners (or more than 4096), corners that are not finite,
    /// do not lie in one plane (within 10⁻⁵ of the light's size), or enclose no area, and for an
    /// outline that touches or crosses itself.
    pub fn new(corners: &[DVec3]) -> Result<Self, Error> {
        let refuse = |problem: &str| Err(Error::Light(problem.into()));
        if !(3..=MAX_CORNERS).contains(&corners.len()) {
            return refuse(&format!("it must have from 3 to {MAX_CORNERS} corners"));
        }
        let from_first: Vec<DVec3> = corners.iter().map(|&corner| corner - corners[0]).collect();
        let size = from_first.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
        if !(corners.iter().all(|corner| corner.is_finite()) && size.is_finite()) {
            return refuse("its corners must be finite numbers");
        }
        // Divided by the size so that no product overflows or vanishes.
        let unit: Vec<DVec3> = from_first.iter().map(|&v| v / size).collect();
        let normal: DVec3 = unit.windows(2).map(|edge| edge[0].cross(edge[1])).sum();
        let Some(z) = normal.try_normalize() else {
            return refuse("its corners must enclose an area");
        };
        let warp = unit.iter().map(|v| v.dot(z).abs()).fold(0.0, f64::max);
        if warp > MAX_WARP {
            return refuse(&format!(
                "its corners must lie in one plane (they are {warp:.1e} of its size off)"
            ));
        }
        let longest = unit.iter().copied().fold(DVec3::ZERO, |longest, v| {
            if v.length_squared() > longest.length_squared() { v } else { longest }
        });
        let x = longest.reject_from_normalized(z).normalize_or(z.any_orthonormal_vector());
        let axes = [x, z.cross(x)];
        let flat = |v: &DVec3| DVec2::from_array(axes.map(|axis| axis.dot(*v)));
        let (low, high) = unit
            .iter()
            .map(flat)
            .fold((DVec2::MAX, DVec2::MIN), |(low, high), p| (low.min(p), high.max(p)));
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let center = corners[0] + (axes[0] * middle.x + axes[1] * middle.y) * size;
        let rows = [axes[0] / (half.x * size), axes[1] / (half.y * size), z];
        let grid = unit.iter().map(|v| to_grid((flat(v) - middle) / half)).collect();
        match LightOutline::new(grid) {
            Some(outline) => Ok(Self { frame: Frame { center, rows }, outline }),
            None => refuse("its outline must neither touch nor cross itself"),
        }
    }

    pub(super) fn frame(&self) -> &Frame {
        &self.frame
    }

    pub(super) fn outline(&self) -> &LightOutline {
        &self.outline
    }
}

impl From<&RectangleLight> for PolygonLight {
    fn from(light: &RectangleLight) -> Self {
        Self { frame: Frame::of(light), outline: LightOutline::square() }
    }
}

#[cfg(test)]
#[path = "polygon_light_tests.rs"]
mod tests;
