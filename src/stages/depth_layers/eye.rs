//! Where a map of the occluders is seen from.

use super::{Eye, LightBox, MapView, fit_boxes, fit_boxes_from};
use crate::RectangleLight;
use crate::knob::choices;
use crate::lent::MeshBounds;
use glam::DMat4;

/// Where the layers are seen from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// A point behind the light (eq. 3.1).
    #[default]
    Behind,
    /// The light's centre.
    Centre,
    /// Infinitely far (section 5.1).
    Orthographic,
}

choices! { Projection: "behind" => Behind, "centre" => Centre, "orthographic" => Orthographic }

/// How far behind the light the projection point lies at most, over the distance of the furthest occluder.
/// From there on rays of the map are parallel to within 1/64, and a height's rounding, 6e-8 of it, is that of
/// a distance 65 times as large: 4e-6 of the furthest occluder's, a thousandth of a texel where 256 cover it.
const MOST_BEHIND: f64 = 64.0;

/// How the layers look at the occluders; none where there are none in front of the light.
///
/// The projection point lies so far behind the light that the light fills the angle under which its centre
/// sees the occluders (Curtis 2009 eq. 3.1). Rays need no more than that: they are cut to what lies over
/// the map, and beyond the map there are no occluders. For a light so large that this would be further away
/// than 64 times the furthest occluder the point lies there; rays to its rim leave the map through its sides.
pub fn view(
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    projection: Projection,
    side: u32,
) -> Option<MapView> {
    view_from(light.half_extents(), &LightBox::of_all(light, occluders), projection, side)
}

/// How a map of `side` texels looks at boxes of occluders, for a light of these half-extents; see [`view`].
pub(crate) fn view_from(
    half: [f64; 2],
    occluders: &[LightBox],
    projection: Projection,
    side: u32,
) -> Option<MapView> {
    let eye = match projection {
        Projection::Centre => Eye::Behind(0.0),
        Projection::Orthographic => Eye::Infinity,
        Projection::Behind => {
            let from_centre = fit_boxes(occluders, None, side)?;
            let tangent = |i: usize| from_centre.max[i].abs().max(from_centre.min[i].abs());
            let behind = [0, 1].map(|i| half[i] / tangent(i)).into_iter().fold(0.0, f64::max);
            Eye::Behind(behind.min(MOST_BEHIND * from_centre.far))
        }
    };
    fit_boxes_from(eye, occluders, side)
}
