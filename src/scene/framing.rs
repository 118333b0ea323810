//! The camera of a scene that brings none.

use super::{Bounds, Camera, Instance, Lens, Scene};
use glam::{DMat3, DMat4, DVec3};

/// The vertical field of view, about 40°: little distortion at the rim.
const YFOV: f64 = 0.7;

/// The camera's direction, in radians from +Z towards +X, and upwards: from the front left it shows three sides of an
/// object, and the object's shadow on the ground.
const AZIMUTH: f64 = -0.6;
const ELEVATION: f64 = 0.55;

/// Empty space left at the rim of the image, as a fraction of it.
const MARGIN: f64 = 0.05;

/// The assumed length of shadows beyond their occluders, in the occluders' largest extent.
const SHADOW_REACH: f64 = 0.75;

/// The near plane's distance over the distance to the nearest framed point: things in front of the
/// frame, such as more of the ground, stay visible.
const NEAR: f64 = 0.02;

impl Camera {
    /// A camera that frames a scene: a three-quarter view from above on whatever blocks light and
    /// the place where its shadow falls.
    ///
    /// `aspect` is the image's width over its height; a value that is not a positive number counts
    /// as 1. A scene without a vertex gives a view of the unit box round the origin.
    pub fn framing(scene: &Scene, aspect: f64) -> Self {
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        let focus = focus(scene);
        // View space's axes in the world: +z points from the target to the camera.
        let (sin_a, cos_a) = AZIMUTH.sin_cos();
        let (sin_e, cos_e) = ELEVATION.sin_cos();
        let z = DVec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
        let x = DVec3::Y.cross(z).normalize();
        let axes = DMat3::from_cols(x, z.cross(x), z);
        let tan = DVec3::new((0.5 * YFOV).tan() * aspect, (0.5 * YFOV).tan(), 1.0) * (1.0 - MARGIN);

        // Back away until the corner that needs the greatest distance is inside the image.
        let target = focus.center();
        let corners = focus.corners().map(|c| axes.transpose() * (c - target));
        let distance = corners
            .iter()
            .map(|c| c.z + (c.x.abs() / tan.x).max(c.y.abs() / tan.y))
            .fold(0.0, f64::max);
        let nearest = corners.iter().map(|c| distance - c.z).fold(distance, f64::min);

        let mut world_from_view = DMat4::from_mat3(axes);
        world_from_view.w_axis = (target + z * distance).extend(1.0);
        Self { world_from_view, lens: Lens::Perspective { yfov: YFOV }, near: nearest * NEAR }
    }
}

/// The box that the camera frames: the occluders, down to the lowest ground and out to where shadows fall, within the
/// scene.
fn focus(scene: &Scene) -> Bounds {
    let unit = Bounds { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) };
    let whole = scene.bounds(|_| true).unwrap_or(unit);
    let blocks = |i: &Instance| i.role.blocks();
    let Some(occluders) = scene.bounds(blocks) else { return solid(whole) };
    let reach = SHADOW_REACH * occluders.size().max_element();
    let out = DVec3::new(reach, 0.0, reach);
    solid(Bounds {
        min: (occluders.min - out).max(whole.min).with_y(whole.min.y),
        max: (occluders.max + out).min(whole.max),
    })
}

/// The box itself, grown to a size at which a camera can stand off from it if it has next to none.
fn solid(bounds: Bounds) -> Bounds {
    // Far from the origin, f64 positions are this coarse; closer than that nothing can be framed.
    let coarse = bounds.min.abs().max(bounds.max.abs()).max_element() * 1e-9;
    let half = DVec3::splat(coarse.max(1e-6));
    if bounds.size().max_element() > half.x {
        bounds
    } else {
        Bounds { min: bounds.min - half, max: bounds.max + half }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

    use super::*;
    use crate::scene::generate::{spheres, square_light, stage};

    /// All of the frame is in the image, and one corner of it at the margin.
    #[test]
    fn the_frame_fits_exactly() {
        let light = square_light(1.0).unwrap();
        for scene in [spheres(light), stage(light), Scene::default()] {
            for aspect in [0.4, 1.0, 2.5] {
                let camera = Camera::framing(&scene, aspect);
                let view_from_world = camera.world_from_view.inverse();
                let tan = (0.5 * YFOV).tan();
                let reach = focus(&scene).corners().map(|c| {
                    let v = view_from_world.transform_point3(c);
                    assert!(-v.z > camera.near, "behind the near plane");
                    (v.x.abs() / (tan * aspect)).max(v.y.abs() / tan) / -v.z
                });
                let widest = reach.into_iter().fold(0.0, f64::max);
                assert!((widest - (1.0 - MARGIN)).abs() < 1e-9, "{aspect}: {widest}");
            }
        }
    }

    /// The frame holds the occluder, its shadow's place on the ground, and no more ground than that.
    #[test]
    fn the_frame_is_what_casts_and_where_the_shadow_falls() {
        let mut scene = stage(square_light(1.0).unwrap());
        let cube = crate::scene::generate::cuboid(DVec3::ONE);
        let above = DMat4::from_translation(DVec3::Y * 2.0);
        scene.add("cube", cube, above, crate::scene::Role::Occluder);
        let frame = focus(&scene);
        let reach = 0.5 + SHADOW_REACH;
        assert_eq!(frame.min, DVec3::new(-reach, 0.0, -reach));
        assert_eq!(frame.max, DVec3::new(reach, 2.5, reach));
    }
}
