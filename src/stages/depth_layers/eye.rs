//! The point from which a map of the occluders is seen.

use super::{Eye, LightBox, MapView, fit_boxes, fit_boxes_from};
use crate::RectangleLight;
use crate::knob::choices;
use crate::lent::MeshBounds;
use glam::DMat4;

/// The projection of the depth layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// From a point behind the light (Curtis 2009 eq. 3.1).
    #[default]
    Behind,
    /// From the light's centre.
    Centre,
    /// From infinitely far away, orthographic (Curtis 2009 section 5.1).
    Orthographic,
}

choices! { Projection: "behind" => Behind, "centre" => Centre, "orthographic" => Orthographic }

/// The most that the projection point lies behind the light, over the distance of the furthest occluder. At that
/// distance rays of the map are parallel to within 1/64, and a height's rounding, 6e-8 of it, is that of a distance 65
/// times as large: 4e-6 of the furthest occluder's, a thousandth of a texel where 256 cover it.
const MOST_BEHIND: f64 = 64.0;

/// The layers' view of the occluders; none where none lies in front of the light.
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

/// The view that a map of `side` texels has of boxes of occluders, for a light of these half-extents; see [`view`].
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
