//! The window that a light-space map looks through, fitted to what it must show.

use super::boxes::LightBox;
use crate::RectangleLight;
use crate::lent::MeshBounds;
use glam::{DMat4, DVec3, DVec4};

/// The largest tangent of a map's window (84°); occluders further aside are not drawn.
const MAX_TANGENT: f64 = 10.0;

/// The least distance of the near plane, as a share of the furthest distance in the view.
const MIN_NEAR: f64 = 1e-4;

/// The margin before the nearest point, as a share of the range of distances, that keeps stored depths under 1.
const NEAR_MARGIN: f64 = 1e-3;

/// The least range of distances in a view, as a share of the furthest: floats distinguish a thousand steps of it.
const LEAST_SPAN: f64 = 1e-3;

/// The rounding of a vertex's distance, 64 roundings of f32, as a share of its largest summand.
const ROUNDING: f64 = 64.0 * 5.960_464_477_539_063e-8;

/// The point that a map is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eye {
    /// A point this far behind the light's centre, metres; 0 is the centre.
    Behind(f64),
    /// A point infinitely far behind the light: the projection is orthographic.
    Infinity,
}

/// The view of a map that is parallel to the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapView {
    /// The point that the map is seen from.
    pub eye: Eye,
    /// Least u and v: tangents, or metres where the projection is orthographic.
    pub min: [f64; 2],
    /// Largest u and v.
    pub max: [f64; 2],
    /// Distance of the near plane, metres; from the eye, or from the light's plane for an eye at infinity.
    pub near: f64,
    /// Distance of the furthest point in the view, metres, counted like `near`.
    pub far: f64,
    /// The map's side in texels.
    pub side: u32,
}

impl MapView {
    /// How far behind the light the eye is, metres; 0 for an eye at infinity.
    pub fn behind(&self) -> f64 {
        match self.eye {
            Eye::Behind(behind) => behind,
            Eye::Infinity => 0.0,
        }
    }

    /// The matrix from light space to clip space, with reversed depth: near · w without a far plane; for an
    /// orthographic projection it falls from 1 at the near plane to 0 at the far one.
    pub fn clip_from_light(&self) -> DMat4 {
        let [sx, sy] = [0, 1].map(|i| 2.0 / (self.max[i] - self.min[i]));
        let [cx, cy] = [0, 1].map(|i| -(self.max[i] + self.min[i]) / (self.max[i] - self.min[i]));
        match self.eye {
            Eye::Behind(behind) => DMat4::from_cols(
                DVec4::new(sx, 0.0, 0.0, 0.0),
                DVec4::new(0.0, sy, 0.0, 0.0),
                DVec4::new(cx, cy, 0.0, 1.0),
                DVec4::new(cx * behind, cy * behind, self.near, behind),
            ),
            Eye::Infinity => {
                let range = self.far - self.near;
                DMat4::from_cols(
                    DVec4::new(sx, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, sy, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, -1.0 / range, 0.0),
                    DVec4::new(cx, cy, self.far / range, 1.0),
                )
            }
        }
    }

    /// The height of the near plane: w = 1/distance, or metres above the far plane where the projection is
    /// orthographic. A height is this times the stored depth.
    pub fn top(&self) -> f64 {
        match self.eye {
            Eye::Behind(_) => 1.0 / self.near,
            Eye::Infinity => self.far - self.near,
        }
    }

    /// Texels a unit of u and of v.
    pub fn texels_per_uv(&self) -> [f64; 2] {
        [0, 1].map(|i| f64::from(self.side) / (self.max[i] - self.min[i]))
    }

    /// The texel coordinates of u = v = 0.
    pub fn first(&self) -> [f64; 2] {
        let per = self.texels_per_uv();
        [0, 1].map(|i| -self.min[i] * per[i])
    }

    /// The size of a texel over the light's, (Δu/Lx, Δv/Ly), per metre.
    pub fn scale(&self, light: &RectangleLight) -> [f64; 2] {
        let per = self.texels_per_uv();
        let half = light.half_extents();
        [0, 1].map(|i| 1.0 / (per[i] * 2.0 * half[i]))
    }
}

/// The tangents, up to `most`, under which the light's centre sees the part of the boxes beyond `near`.
fn tangents(boxes: &[LightBox], near: f64, most: f64) -> Option<([f64; 2], [f64; 2])> {
    extents(boxes, near, |p| [p.x, p.y].map(|x| (x / p.z).clamp(-most, most)))
}

/// The least and largest u and v, up to `most`, under which the light's centre sees boxes; none where all lie behind it.
pub(crate) fn tangents_within(boxes: &[LightBox], most: f64) -> Option<([f64; 2], [f64; 2])> {
    tangents(boxes, planes_of(boxes)?.0, most)
}

/// The least and largest u and v under which the light's centre sees meshes beyond `near`; none without any.
pub(crate) fn tangents_of(
    light: &RectangleLight,
    meshes: &[(MeshBounds, DMat4)],
    near: f64,
) -> Option<([f64; 2], [f64; 2])> {
    tangents(&LightBox::of_all(light, meshes), near, MAX_TANGENT)
}

/// The least and largest u and v under which an eye behind the light sees the part of a box beyond `near`, which is
/// counted from the eye as in [`MapView::near`]; none where no part is.
pub(crate) fn window_of(eye: Eye, occluder: &LightBox, near: f64) -> Option<([f64; 2], [f64; 2])> {
    let boxes = std::slice::from_ref(occluder);
    match eye {
        Eye::Behind(behind) => extents(boxes, near - behind, |p| {
            [p.x, p.y].map(|x| (x / (p.z + behind)).clamp(-MAX_TANGENT, MAX_TANGENT))
        }),
        Eye::Infinity => extents(boxes, near, |p| [p.x, p.y]),
    }
}

/// The least and the largest value of `uv_of` over the parts of the boxes beyond `near`.
fn extents(
    boxes: &[LightBox],
    near: f64,
    uv_of: impl Fn(DVec3) -> [f64; 2],
) -> Option<([f64; 2], [f64; 2])> {
    let mut window = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let add = |(min, max): &mut ([f64; 2], [f64; 2]), p: DVec3| {
        for (i, x) in uv_of(p).into_iter().enumerate() {
            min[i] = min[i].min(x);
            max[i] = max[i].max(x);
        }
    };
    let holds = |(min, max): &([f64; 2], [f64; 2]), p: DVec3| {
        let at = uv_of(p);
        (0..2).all(|i| min[i] <= at[i] && at[i] <= max[i])
    };
    for LightBox { corners, min: least, max: most, .. } in boxes {
        if least.z >= near {
            // The corners of the box around it hold the largest and least u and v: most boxes lie within the window of
            // others.
            let outermost = [*least, *most, least.with_z(most.z), most.with_z(least.z)];
            if !outermost.into_iter().all(|p| holds(&window, p)) {
                corners.iter().for_each(|&p| add(&mut window, p));
            }
            continue;
        }
        for (i, &a) in corners.iter().enumerate() {
            if a.z >= near {
                add(&mut window, a);
            }
            // The three edges to the corner's neighbours are cut at the near plane.
            for b in (0..3).filter(|axis| i >> axis & 1 == 0).map(|axis| corners[i | 1 << axis]) {
                if (a.z < near) != (b.z < near) {
                    let t = (near - a.z) / (b.z - a.z);
                    add(&mut window, (a + (b - a) * t).with_z(near));
                }
            }
        }
    }
    (window.0[0] <= window.1[0]).then_some(window)
}

/// Widens a window by one texel on each side, or by half where a map has under three; no width becomes some.
pub(crate) fn pad(min: &mut [f64; 2], max: &mut [f64; 2], side: u32) {
    let wider = if side > 2 { f64::from(side) / (f64::from(side) - 2.0) } else { 2.0 };
    for i in 0..2 {
        let middle = 0.5 * (min[i] + max[i]);
        let least = 1e-6 * (1.0 + middle.abs());
        let half = (0.5 * (max[i] - min[i])).max(least);
        let half = half * wider;
        min[i] = middle - half;
        max[i] = middle + half;
    }
}

/// Whether a mesh is flat and both the whole light and every receiver lie on one side of its plane, as for a ground:
/// no ray from the light to a receiver crosses it, so it blocks nothing, and a map need not spend its texels on it.
pub fn is_aside(
    light: &RectangleLight,
    mesh: &(MeshBounds, DMat4),
    receivers: &[(MeshBounds, DMat4)],
) -> bool {
    let own = LightBox::of_all(light, std::slice::from_ref(mesh));
    own[0].is_aside(light.half_extents(), || LightBox::of_all(light, receivers).into_iter())
}

/// The view from the light's centre that just holds all occluders; none where none lies in front of the light.
///
/// `window` fixes the tangents (least and largest u and v) instead of fitting them, for a host that wants texels to
/// stay where they are while occluders move.
pub fn fit_occluders(
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    window: Option<[[f64; 2]; 2]>,
    side: u32,
) -> Option<MapView> {
    fit_boxes(&LightBox::of_all(light, occluders), window, side)
}

/// The view of [`fit_occluders`] for boxes in light space.
pub(crate) fn fit_boxes(
    occluders: &[LightBox],
    window: Option<[[f64; 2]; 2]>,
    side: u32,
) -> Option<MapView> {
    let Some([min, max]) = window else {
        return fit_boxes_from(Eye::Behind(0.0), occluders, side);
    };
    let (near, far) = planes_of(occluders)?;
    Some(MapView { eye: Eye::Behind(0.0), min, max, near, far, side })
}

/// The least and largest distance of boxes; none where all lie behind the light.
fn distances(boxes: &[LightBox]) -> Option<(f64, f64)> {
    let largest = boxes.iter().map(|b| b.max.z).fold(f64::NEG_INFINITY, f64::max);
    let least = boxes.iter().map(|b| b.min.z).fold(f64::INFINITY, f64::min);
    (largest > 0.0).then_some((least, largest))
}

/// The distances of the near plane and of the furthest occluder; none where all occluders lie behind the light.
fn planes_of(occluders: &[LightBox]) -> Option<(f64, f64)> {
    let summed = occluders.iter().map(|b| b.summed).fold(0.0, f64::max);
    let (least, far) = distances(occluders)?;
    let span = far - least;
    let margin = (NEAR_MARGIN * span + ROUNDING * summed).max(LEAST_SPAN * far - span);
    let near = (least - margin).max(far * MIN_NEAR);
    Some((near, far))
}

/// The distance from the light's plane beyond which boxes are drawn; none where all lie behind the light.
pub(crate) fn nearest_of(occluders: &[LightBox]) -> Option<f64> {
    Some(planes_of(occluders)?.0)
}

/// The view of [`fit_occluders`] from an eye behind the light; occluders behind the light are left out.
pub fn fit_from(
    eye: Eye,
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    side: u32,
) -> Option<MapView> {
    fit_boxes_from(eye, &LightBox::of_all(light, occluders), side)
}

/// The view of [`fit_from`] for boxes in light space.
pub(crate) fn fit_boxes_from(eye: Eye, occluders: &[LightBox], side: u32) -> Option<MapView> {
    fit_boxes_within(eye, occluders, [0.0; 2], [MAX_TANGENT; 2], side)
}

/// The view of [`fit_from`] for boxes in light space, with tangents up to `most` as its eye sees them. The view's x and y
/// are less than the boxes' by `aside` for each metre from the light's plane.
pub(crate) fn fit_boxes_within(
    eye: Eye,
    occluders: &[LightBox],
    aside: [f64; 2],
    most: [f64; 2],
    side: u32,
) -> Option<MapView> {
    let (near, far) = planes_of(occluders)?;
    let (mut window, near, far) = match eye {
        Eye::Behind(behind) => {
            let of = |p: DVec3| {
                [0, 1].map(|i| ((p[i] - aside[i] * p.z) / (p.z + behind)).clamp(-most[i], most[i]))
            };
            (extents(occluders, near, of)?, near + behind, far + behind)
        }
        Eye::Infinity => {
            // The furthest point must not read as an empty texel.
            let far = far + NEAR_MARGIN * (far - near).max(far * MIN_NEAR);
            (extents(occluders, near, |p| [p.x, p.y])?, near, far)
        }
    };
    pad(&mut window.0, &mut window.1, side);
    Some(MapView { eye, min: window.0, max: window.1, near, far, side })
}

/// The view that holds every receiver that an occluder can shadow; none where there is no such receiver.
pub fn fit_receivers(
    light: &RectangleLight,
    receivers: &[(MeshBounds, DMat4)],
    occluders: &MapView,
    side: u32,
) -> Option<MapView> {
    fit_receiver_boxes(light.half_extents(), &LightBox::of_all(light, receivers), occluders, side)
}

/// The view of [`fit_receivers`] for boxes in light space and a light of these half-extents.
pub(crate) fn fit_receiver_boxes(
    light: [f64; 2],
    receivers: &[LightBox],
    occluders: &MapView,
    side: u32,
) -> Option<MapView> {
    let (least, far) = distances(receivers)?;
    // A receiver nearer than every occluder is lit, and must not hide one that is not.
    if far <= occluders.near {
        return None;
    }
    let near = least.max(occluders.near) * (1.0 - NEAR_MARGIN);
    let (mut min, mut max) = tangents(receivers, near, MAX_TANGENT)?;
    // A penumbra reaches (L/2)(w_o − w_r) around its occluder in u (Atty 2006 section 3.3).
    let spread = 1.0 / occluders.near - 1.0 / far;
    for (i, half) in light.into_iter().enumerate() {
        min[i] = min[i].max(occluders.min[i] - half * spread);
        max[i] = max[i].min(occluders.max[i] + half * spread);
        // The bounds are equal for receivers whose plane holds the light's centre.
        if min[i] > max[i] {
            return None;
        }
    }
    pad(&mut min, &mut max, side);
    Some(MapView { eye: Eye::Behind(0.0), min, max, near, far, side })
}

#[cfg(test)]
#[path = "view_tests.rs"]
mod tests;
