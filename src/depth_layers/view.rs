//! The window that a light-space map looks through, fitted to what it must show.

use crate::RectangleLight;
use glam::{DMat4, DVec3, DVec4};

/// An axis-aligned box in mesh space: least and largest corner, metres before the transform.
pub type MeshBounds = [[f32; 3]; 2];

/// A map looks no further aside than this tangent (84°); occluders beyond it are not seen.
const MAX_TANGENT: f64 = 10.0;

/// The near plane is no nearer than this share of the furthest distance seen.
const MIN_NEAR: f64 = 1e-4;

/// The near plane stands this share of what is seen before the nearest point of it, so that what is stored
/// stays under 1.
const NEAR_MARGIN: f64 = 1e-3;

/// What is seen is at least this share of the furthest distance deep: floats tell a thousand steps of it apart.
const LEAST_SPAN: f64 = 1e-3;

/// And what the roundings of a vertex may come to: 64 of f32, as a share of what is added up.
const ROUNDING: f64 = 64.0 * 5.960_464_477_539_063e-8;

/// Where a map is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eye {
    /// A point this far behind the light's centre, metres; 0 is the centre.
    Behind(f64),
    /// Infinitely far behind it: the projection is orthographic.
    Infinity,
}

/// A map parallel to the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapView {
    /// Where it is seen from.
    pub eye: Eye,
    /// Least u and v: tangents, or metres where the projection is orthographic.
    pub min: [f64; 2],
    /// Largest u and v.
    pub max: [f64; 2],
    /// Distance of the near plane from the eye, or from the light's plane where the eye is infinitely
    /// far; metres.
    pub near: f64,
    /// Distance of the furthest point of what is seen, metres.
    pub far: f64,
    /// The map's side in texels.
    pub side: u32,
}

impl MapView {
    /// Light space to clip space, reversed: depth is near · w without a far plane, or falls from 1 at the
    /// near plane to 0 at the far one where the projection is orthographic.
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

    /// The height of the near plane: w = 1/distance, or metres above the far plane where the projection
    /// is orthographic. Heights are this times what is stored.
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

    /// (Δu/Lx, Δv/Ly): the size of a texel over the light's, per metre.
    pub fn scale(&self, light: &RectangleLight) -> [f64; 2] {
        let per = self.texels_per_uv();
        let half = light.half_extents();
        [0, 1].map(|i| 1.0 / (per[i] * 2.0 * half[i]))
    }
}

/// A box's corners in light space.
fn corners(bounds: &MeshBounds, light_from_mesh: &DMat4) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let pick = |axis: usize| f64::from(bounds[(i >> axis) & 1][axis]);
        light_from_mesh.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
    })
}

/// Distances from the light's plane that boxes reach, as (least, largest); none where all lie behind.
fn distances(boxes: &[[DVec3; 8]]) -> Option<(f64, f64)> {
    let all = || boxes.iter().flatten().map(|p| p.z);
    let largest = all().fold(f64::NEG_INFINITY, f64::max);
    (largest > 0.0).then(|| (all().fold(f64::INFINITY, f64::min), largest))
}

/// The tangents under which the light's centre sees the part of the boxes beyond `near`.
fn tangents(boxes: &[[DVec3; 8]], near: f64) -> Option<([f64; 2], [f64; 2])> {
    extents(boxes, near, |p| [p.x, p.y].map(|x| (x / p.z).clamp(-MAX_TANGENT, MAX_TANGENT)))
}

/// Least and largest u and v under which the light's centre sees what of some meshes is beyond `near`; none where
/// nothing is.
pub(crate) fn tangents_of(
    light: &RectangleLight,
    meshes: &[(MeshBounds, DMat4)],
    near: f64,
) -> Option<([f64; 2], [f64; 2])> {
    let light_from_world = light.light_from_world();
    let boxes: Vec<_> = meshes.iter().map(|(b, m)| corners(b, &(light_from_world * *m))).collect();
    tangents(&boxes, near)
}

/// Least and largest u and v under which an eye behind the light sees what of a mesh is beyond `near`, which is
/// counted from the eye as in [`MapView::near`]; none where nothing is.
pub(crate) fn window_of(
    eye: Eye,
    light: &RectangleLight,
    (bounds, world_from_mesh): &(MeshBounds, DMat4),
    near: f64,
) -> Option<([f64; 2], [f64; 2])> {
    let boxes = [corners(bounds, &(light.light_from_world() * *world_from_mesh))];
    match eye {
        Eye::Behind(behind) => extents(&boxes, near - behind, |p| {
            [p.x, p.y].map(|x| (x / (p.z + behind)).clamp(-MAX_TANGENT, MAX_TANGENT))
        }),
        Eye::Infinity => extents(&boxes, near, |p| [p.x, p.y]),
    }
}

/// The least and the largest of what `of` says of the part of the boxes beyond `near`.
fn extents(
    boxes: &[[DVec3; 8]],
    near: f64,
    of: impl Fn(DVec3) -> [f64; 2],
) -> Option<([f64; 2], [f64; 2])> {
    let mut min = [f64::INFINITY; 2];
    let mut max = [f64::NEG_INFINITY; 2];
    let mut add = |p: DVec3| {
        for (i, x) in of(p).into_iter().enumerate() {
            min[i] = min[i].min(x);
            max[i] = max[i].max(x);
        }
    };
    for corners in boxes {
        for (i, &a) in corners.iter().enumerate() {
            if a.z >= near {
                add(a);
            }
            // The three edges to the neighbours above, where they cross the near plane.
            for b in (0..3).filter(|axis| i >> axis & 1 == 0).map(|axis| corners[i | 1 << axis]) {
                if (a.z < near) != (b.z < near) {
                    let t = (near - a.z) / (b.z - a.z);
                    add((a + (b - a) * t).with_z(near));
                }
            }
        }
    }
    (min[0] <= max[0]).then_some((min, max))
}

/// Widens a window by one texel on each side, and a window of no width to one that has some.
fn pad(min: &mut [f64; 2], max: &mut [f64; 2], side: u32) {
    for i in 0..2 {
        let middle = 0.5 * (min[i] + max[i]);
        let least = 1e-6 * (1.0 + middle.abs());
        let half = (0.5 * (max[i] - min[i])).max(least);
        let half = half * f64::from(side) / (f64::from(side) - 2.0);
        min[i] = middle - half;
        max[i] = middle + half;
    }
}

/// Flat is an extent of no more than this share of a box's largest.
const FLAT: f64 = 1e-6;

/// The axis along which a box has no extent: what it holds is a flat sheet; none where it is thick.
pub(crate) fn thin_axis(bounds: &MeshBounds) -> Option<usize> {
    let extent = |axis: usize| f64::from(bounds[1][axis]) - f64::from(bounds[0][axis]);
    let largest = (0..3).map(extent).fold(0.0, f64::max);
    (0..3).find(|&axis| extent(axis) <= FLAT * largest)
}

/// Whether a mesh is flat and has the whole light and every receiver on one side of its plane, as a
/// ground has: no ray from the one to the other crosses it, so it blocks nothing, and a map need not
/// spend its texels on it.
pub fn is_aside(
    light: &RectangleLight,
    (bounds, world_from_mesh): &(MeshBounds, DMat4),
    receivers: &[(MeshBounds, DMat4)],
) -> bool {
    let light_from_world = light.light_from_world();
    let Some(thin) = thin_axis(bounds) else { return false };
    let light_from_mesh = light_from_world * *world_from_mesh;
    let axis = |i: usize| light_from_mesh.col(i).truncate();
    let normal = axis((thin + 1) % 3).cross(axis((thin + 2) % 3)).normalize_or_zero();
    if normal == DVec3::ZERO {
        return false;
    }
    let own = corners(bounds, &light_from_mesh);
    let slack = FLAT * own.iter().map(|p| p.distance(own[0])).fold(0.0, f64::max);
    let [a, b] = light.half_extents();
    let lamp = [(a, b), (a, -b), (-a, b), (-a, -b)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let seen = receivers.iter().flat_map(|(b, m)| corners(b, &(light_from_world * *m)));
    let (mut above, mut below) = (true, true);
    for p in lamp.into_iter().chain(seen) {
        let height = normal.dot(p - own[0]);
        above &= height >= -slack;
        below &= height <= slack;
    }
    above || below
}

/// The view that just holds all occluders; none where there are none in front of the light.
///
/// `window` fixes the tangents (least and largest u, v) instead of fitting them, as a host does that
/// wants texels to stay where they are while occluders move.
pub fn fit_occluders(
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    window: Option<[[f64; 2]; 2]>,
    side: u32,
) -> Option<MapView> {
    let Some([min, max]) = window else {
        return fit_from(Eye::Behind(0.0), light, occluders, side);
    };
    let (_, near, far) = boxes_of(light, occluders)?;
    Some(MapView { eye: Eye::Behind(0.0), min, max, near, far, side })
}

/// The occluders' corners in light space, and the distances of the near plane and of the furthest of them;
/// none where all lie behind the light.
fn boxes_of(
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
) -> Option<(Vec<[DVec3; 8]>, f64, f64)> {
    let light_from_world = light.light_from_world();
    let (mut boxes, mut summed) = (Vec::new(), 0.0f64);
    for (bounds, world_from_mesh) in occluders {
        let light_from_mesh = light_from_world * *world_from_mesh;
        boxes.push(corners(bounds, &light_from_mesh));
        let most = [0, 1, 2].map(|i| f64::from(bounds[0][i].abs().max(bounds[1][i].abs())));
        let row = light_from_mesh.row(2).abs();
        summed = summed.max(row.dot(DVec3::from_array(most).extend(1.0)));
    }
    let (least, far) = distances(&boxes)?;
    let span = far - least;
    let margin = (NEAR_MARGIN * span + ROUNDING * summed).max(LEAST_SPAN * far - span);
    let near = (least - margin).max(far * MIN_NEAR);
    Some((boxes, near, far))
}

/// As [`fit_occluders`], from an eye behind the light; what is behind the light is not seen.
pub fn fit_from(
    eye: Eye,
    light: &RectangleLight,
    occluders: &[(MeshBounds, DMat4)],
    side: u32,
) -> Option<MapView> {
    let (boxes, near, far) = boxes_of(light, occluders)?;
    let (mut window, near, far) = match eye {
        Eye::Behind(behind) => {
            let of = |p: DVec3| {
                [p.x, p.y].map(|x| (x / (p.z + behind)).clamp(-MAX_TANGENT, MAX_TANGENT))
            };
            (extents(&boxes, near, of)?, near + behind, far + behind)
        }
        Eye::Infinity => {
            // What is furthest must not read as nothing.
            let far = far + NEAR_MARGIN * (far - near).max(far * MIN_NEAR);
            (extents(&boxes, near, |p| [p.x, p.y])?, near, far)
        }
    };
    pad(&mut window.0, &mut window.1, side);
    Some(MapView { eye, min: window.0, max: window.1, near, far, side })
}

/// The view that holds what of the receivers the occluders can shadow; none where that is nothing.
pub fn fit_receivers(
    light: &RectangleLight,
    receivers: &[(MeshBounds, DMat4)],
    occluders: &MapView,
    side: u32,
) -> Option<MapView> {
    let light_from_world = light.light_from_world();
    let boxes: Vec<_> =
        receivers.iter().map(|(b, m)| corners(b, &(light_from_world * *m))).collect();
    let (least, far) = distances(&boxes)?;
    // A receiver nearer than every occluder is lit, and must not hide one that is not.
    if far <= occluders.near {
        return None;
    }
    let near = least.max(occluders.near) * (1.0 - NEAR_MARGIN);
    let (mut min, mut max) = tangents(&boxes, near)?;
    // A penumbra reaches (L/2)(w_o − w_r) around its occluder in u (Atty 2006 section 3.3).
    let spread = 1.0 / occluders.near - 1.0 / far;
    for (i, half) in light.half_extents().into_iter().enumerate() {
        min[i] = min[i].max(occluders.min[i] - half * spread);
        max[i] = max[i].min(occluders.max[i] + half * spread);
        if min[i] >= max[i] {
            return None;
        }
    }
    pad(&mut min, &mut max, side);
    Some(MapView { eye: Eye::Behind(0.0), min, max, near, far, side })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4Swizzles as _;

    fn ceiling() -> RectangleLight {
        RectangleLight::new(DVec3::new(0.0, 4.0, 0.0), DVec3::X * 0.5, DVec3::NEG_Z * 0.5).unwrap()
    }

    const UNIT: MeshBounds = [[-0.5; 3], [0.5; 3]];

    #[test]
    fn the_window_holds_every_corner_and_little_more() {
        let at = DMat4::from_translation(DVec3::new(0.3, 2.0, -0.1));
        let view = fit_occluders(&ceiling(), &[(UNIT, at)], None, 64).unwrap();
        assert!(view.near < 1.5 && view.near > 1.49);
        let to_clip = view.clip_from_light() * ceiling().light_from_world() * at;
        let mut widest: f64 = 0.0;
        for i in 0..8 {
            let corner = DVec3::from_array(std::array::from_fn(|a| f64::from(i >> a & 1) - 0.5));
            let clip = to_clip * corner.extend(1.0);
            let ndc = clip.xyz() / clip.w;
            assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0 && ndc.z > 0.0 && ndc.z < 1.0);
            assert!((ndc.z - view.near / clip.w).abs() < 1e-12);
            widest = widest.max(ndc.x.abs());
        }
        assert!((widest - 62.0 / 64.0).abs() < 1e-9, "one texel of margin, not {widest}");
    }

    #[test]
    fn what_lies_behind_the_light_is_left_out() {
        let above = DMat4::from_translation(DVec3::new(0.0, 6.0, 0.0));
        assert_eq!(fit_occluders(&ceiling(), &[(UNIT, above)], None, 64), None);
        // Through the light's plane: clipped, finite.
        let across = DMat4::from_translation(DVec3::new(0.0, 4.0, 0.0));
        let view = fit_occluders(&ceiling(), &[(UNIT, across)], None, 64).unwrap();
        assert!(view.near > 0.0 && view.max[0].is_finite() && view.max[0] <= 11.0);
    }

    #[test]
    fn a_ground_under_everything_is_aside() {
        let light = ceiling();
        let ground = ([[-4.0, 0.0, -4.0], [4.0, 0.0, 4.0]], DMat4::IDENTITY);
        let standing = (UNIT, DMat4::from_translation(DVec3::new(0.0, 0.5, 0.0)));
        let sunk = (UNIT, DMat4::from_translation(DVec3::new(0.0, 0.4, 0.0)));
        assert!(is_aside(&light, &ground, &[ground, standing]));
        assert!(!is_aside(&light, &ground, &[ground, sunk]), "it shadows what lies beneath it");
        assert!(!is_aside(&light, &standing, &[ground]), "a box is not flat");
        // A wall that the light shines past on both sides.
        let wall = ([[0.0, 0.0, -4.0], [0.0, 4.0, 4.0]], DMat4::IDENTITY);
        assert!(!is_aside(&light, &wall, &[ground]));
    }

    #[test]
    fn receivers_are_cut_to_what_can_be_shadowed() {
        let light = ceiling();
        let card: MeshBounds = [[-0.5, 0.0, -0.5], [0.5, 0.0, 0.5]];
        let card_at = DMat4::from_translation(DVec3::new(0.0, 2.0, 0.0));
        let occluders = fit_occluders(&light, &[(card, card_at)], None, 64).unwrap();
        let ground: MeshBounds = [[-50.0, 0.0, -50.0], [50.0, 0.0, 50.0]];
        let view = fit_receivers(&light, &[(ground, DMat4::IDENTITY)], &occluders, 64).unwrap();
        // The penumbra's outer edge: the light's far edge through the card's edge, at x = 1.5.
        let edge = view.max[0] * 62.0 / 64.0 * 4.0;
        assert!((edge - 1.5).abs() < 0.05, "{edge}");
        // A shelf above the card receives nothing.
        let shelf = DMat4::from_translation(DVec3::new(0.0, 3.0, 0.0));
        assert_eq!(fit_receivers(&light, &[(card, shelf)], &occluders, 64), None);
    }
}
