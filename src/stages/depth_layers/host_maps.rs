//! Occluder maps that the host drew: their window and distances, from the camera's matrix.

use super::{Eye, MapView};
use crate::{Error, RectangleLight};
use ash::vk;
use glam::{DMat4, DVec4};

/// How far the host's camera may turn from the light's axes, as a tangent, and how far it may stand from the light's
/// centre, in near planes: a fifth of a texel of the finest map, and far above the rounding of a matrix of 32-bit
/// floats.
const OFF_AXIS: f64 = 1e-4;

/// A host's occluder maps as their camera sees the occluders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HostMapView {
    /// The window and near plane of the layers.
    pub view: MapView,
    /// Whether u and v run against the image's x and y.
    pub flip: [bool; 2],
    /// w = scale · stored + offset, 1/m.
    pub scale: f64,
    pub offset: f64,
    /// The value that is stored at the far plane, where there is no occluder; and the value at the near plane.
    pub far_value: f32,
    pub near_value: f32,
    /// The error of a stored w beyond its own rounding, 1/m.
    pub error: f64,
}

impl HostMapView {
    /// Derives the window and the distances from a camera's matrix.
    ///
    /// # Errors
    /// [`Error::Frame`] where the camera is no perspective from the light's centre along its axes.
    pub fn new(
        light: &RectangleLight,
        clip_from_world: &DMat4,
        side: u32,
        format: vk::Format,
    ) -> Result<Self, Error> {
        let bad = |what: &str| {
            Err(Error::Frame(format!(
                "the occluder maps' clip_from_world {what}; it must be a perspective from the \
                 light's centre, along its emission, with x and y along its half-axes"
            )))
        };
        if !clip_from_world.is_finite() {
            return bad("holds numbers that are not finite");
        }
        let clip_from_light = *clip_from_world * light.light_from_world().inverse();
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_light.row(i));
        if w.z <= 0.0 || !w.z.is_finite() {
            return bad("looks away from what the light shines on");
        }
        let [x, y, z, w] = [x, y, z, w].map(|row| row / w.z);
        let (a, b) = (z.z, z.w);
        let reversed = b > 0.0;
        // The stored depth is a + b·w.
        let w_at = |stored: f64| (stored - a) / b;
        let (w_near, w_far) =
            if reversed { (w_at(1.0), w_at(0.0)) } else { (w_at(0.0), w_at(1.0)) };
        let depth_works = b.is_finite() && w_near.is_finite() && w_near > 0.0 && w_far < w_near;
        if !depth_works || w_far < -OFF_AXIS * w_near {
            return bad("has no near plane before the light");
        }
        let near = 1.0 / w_near;
        let turned = |row: DVec4, scale: f64| row.x.hypot(row.y) > OFF_AXIS * scale;
        if turned(w, 1.0) || turned(z.with_z(0.0), b.abs() * w_near) {
            return bad("is not parallel to the light");
        }
        if x.y.abs() > OFF_AXIS * x.x.abs() || y.x.abs() > OFF_AXIS * y.y.abs() {
            return bad("is turned round the light's normal");
        }
        let off = |row: DVec4, scale: f64| row.w.abs() > OFF_AXIS * scale.abs() * near;
        if x.x == 0.0 || y.y == 0.0 || off(x, x.x) || off(y, y.y) || off(w, 1.0) {
            return bad("does not stand at the light's centre");
        }
        let tangent = |row: DVec4, scale: f64, ndc: f64| (ndc - row.z) / scale;
        let axes = [(x, x.x), (y, y.y)];
        let ends = axes.map(|(row, s)| [tangent(row, s, -1.0), tangent(row, s, 1.0)]);
        Ok(Self {
            view: MapView {
                eye: Eye::Behind(0.0),
                min: ends.map(|[a, b]| a.min(b)),
                max: ends.map(|[a, b]| a.max(b)),
                near,
                far: if w_far > 0.0 { 1.0 / w_far } else { f64::INFINITY },
                side,
            },
            flip: ends.map(|[a, b]| a > b),
            scale: 1.0 / b,
            offset: -a / b,
            far_value: if reversed { 0.0 } else { 1.0 },
            near_value: if reversed { 1.0 } else { 0.0 },
            error: step_of(format, a.abs() > OFF_AXIS) / b.abs(),
        })
    }
}

/// The error of a stored depth beyond the rounding of w itself. Floats that hold near · w have none; other floats are
/// as coarse as they are next to 1, where far things lie, and get two more bits for the raster's own arithmetic.
fn step_of(format: vk::Format, offset: bool) -> f64 {
    match format {
        vk::Format::D16_UNORM | vk::Format::D16_UNORM_S8_UINT => 2f64.powi(-16),
        vk::Format::X8_D24_UNORM_PACK32 | vk::Format::D24_UNORM_S8_UINT => 2f64.powi(-22),
        _ if offset => 2f64.powi(-22),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

    use super::*;
    use glam::DVec3;

    fn light() -> RectangleLight {
        let (u, v) = (DVec3::new(0.3, 0.0, 0.4), DVec3::new(0.0, 0.2, 0.0));
        RectangleLight::new(DVec3::new(5.0, -2.0, 1.0), u, v).unwrap()
    }

    /// A camera like a host's: x and y scaled, with an offset, and depth a + b·w.
    fn camera(x: [f64; 2], y: [f64; 2], a: f64, b: f64) -> DMat4 {
        DMat4::from_cols(
            DVec4::new(x[0], 0.0, 0.0, 0.0),
            DVec4::new(0.0, y[0], 0.0, 0.0),
            DVec4::new(x[1], y[1], a, 1.0),
            DVec4::new(0.0, 0.0, b, 0.0),
        ) * light().light_from_world()
    }

    fn read(matrix: &DMat4) -> Result<HostMapView, String> {
        HostMapView::new(&light(), matrix, 64, vk::Format::D32_SFLOAT).map_err(|e| e.to_string())
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} for {b}");
    }

    /// The node's own projection comes back as the view it was made from.
    #[test]
    fn a_map_views_own_matrix_gives_the_view_back() {
        let view = MapView {
            eye: Eye::Behind(0.0),
            min: [-0.5, -0.25],
            max: [0.75, 0.5],
            near: 0.3,
            far: f64::INFINITY,
            side: 64,
        };
        let found = read(&(view.clip_from_light() * light().light_from_world())).unwrap();
        for i in 0..2 {
            close(found.view.min[i], view.min[i]);
            close(found.view.max[i], view.max[i]);
        }
        close(found.view.near, view.near);
        assert_eq!((found.flip, found.far_value, found.near_value), ([false; 2], 0.0, 1.0));
        assert_eq!(found.error, 0.0);
    }

    /// Standard and reversed depth, finite and infinite far planes: all give w back.
    #[test]
    fn every_kind_of_depth_gives_the_distance_back() {
        let (near, far) = (0.5, 20.0);
        let finite = far / (far - near);
        for (a, b) in [
            (finite, -near * finite),      // standard, finite
            (1.0, -near),                  // standard, infinite
            (1.0 - finite, near * finite), // reversed, finite
            (0.0, near),                   // reversed, infinite
        ] {
            let found = read(&camera([2.0, 0.1], [-3.0, 0.0], a, b)).unwrap();
            close(found.view.near, near);
            for distance in [near, 1.0, 7.0, far] {
                let stored = a + b / distance;
                close(found.scale * stored + found.offset, 1.0 / distance);
            }
            assert_eq!(found.flip, [false, true]);
            // x = 2u + 0.1
            close(found.view.min[0], -0.55);
            close(found.view.max[0], 0.45);
            close(found.view.max[1], 1.0 / 3.0);
            let away = |value: f32| (found.scale * f64::from(value) + found.offset).max(0.0);
            assert!(away(found.far_value) < away(found.near_value));
        }
    }

    #[test]
    fn every_camera_that_is_not_the_lights_is_refused() {
        let good = camera([2.0, 0.0], [2.0, 0.0], 0.0, 0.1);
        read(&good).unwrap();
        let refuse = |m: DMat4, word: &str| {
            let sentence = read(&m).unwrap_err();
            assert!(sentence.contains(word), "{word}: {sentence}");
        };
        let world_from_light = light().light_from_world().inverse();
        let moved = |m: DMat4| good * world_from_light * m * light().light_from_world();
        refuse(moved(DMat4::from_rotation_x(std::f64::consts::PI)), "looks away");
        refuse(moved(DMat4::from_rotation_x(0.1)), "parallel");
        refuse(moved(DMat4::from_rotation_z(0.1)), "turned round");
        refuse(moved(DMat4::from_translation(DVec3::X * 0.1)), "light's centre");
        refuse(moved(DMat4::from_translation(DVec3::Z * 0.1)), "light's centre");
        refuse(good * f64::NAN, "not finite");
        refuse(camera([2.0, 0.0], [2.0, 0.0], 0.0, 0.0), "near plane");
        refuse(camera([2.0, 0.0], [2.0, 0.0], 3.0, 0.1), "near plane");
        refuse(camera([0.0, 0.0], [2.0, 0.0], 0.0, 0.1), "");
    }

    /// A matrix that a host rounds to 32-bit floats is accepted.
    #[test]
    fn a_matrix_of_floats_is_good_enough() {
        let good = camera([2.0, 0.1], [-3.0, 0.0], 0.0, 0.1);
        read(&good.as_mat4().as_dmat4()).unwrap();
    }
}
