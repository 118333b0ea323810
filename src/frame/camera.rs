//! A frame's matrix shows where its camera's eye is, which end of depth is far, and whether pixels are mirrored.
//!
//! A pixel's point at depth z is (M₀ + z M₁) / (d + c z), with M₁ and M₀ the last two columns of the matrix at the
//! image's centre and (c, d) what their last row holds. All of these lines meet at the eye, M₁ / c, and a point is
//! the further from it the smaller |d + c z| is: so the end of z at which that is smaller is the far one. Where c is
//! 0 the camera is orthographic, and nothing in its matrix says from which end it looks.

use super::Frame;
use super::check::bad;
use crate::Error;
use crate::stages::depth_layers::LightBox;
use glam::{DMat4, DVec3, DVec4};
use std::fmt;

/// Numbers of the last row count as 0 below this share of the largest, because hosts round them in single precision. A
/// far plane a million times as far away as the near one counts as infinitely far.
const NOTHING: f64 = 1e-6;

/// How far a last row may lean towards x and y, as a share of the rest.
const LEAN: f64 = 1e-4;

/// How many receivers are looked at; further ones only until one is seen.
const LOOKED_AT: usize = 32;

/// A camera, as its matrix shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Camera {
    /// The eye's place, which an orthographic camera does not have.
    pub eye: Option<DVec3>,
    /// The direction in which it looks; for an orthographic camera, that in which depth grows.
    pub direction: DVec3,
    /// Whether depth 0 is the far end; none for an orthographic camera.
    pub is_reversed: Option<bool>,
    /// Whether the far plane is infinitely far.
    pub is_infinite: bool,
    /// Whether near and far plane lie on two sides of the eye, as those of no camera do.
    pub is_between: bool,
    /// Whether planes of one depth lie obliquely to the view.
    pub is_aslant: bool,
    /// Whether the matrix mirrors.
    is_negative: bool,
    /// The sign of clip space's w before the camera.
    sign: f64,
}

impl Camera {
    /// The camera of a matrix from normalized device coordinates to the world, which is finite and invertible.
    pub fn of(world_from_ndc: &DMat4) -> Self {
        let row = world_from_ndc.row(3);
        let (c, d) = (row.z, row.w);
        let ends = [d, c + d];
        let size = c.abs().max(d.abs());
        let [toward, from] = [world_from_ndc.z_axis, world_from_ndc.w_axis].map(DVec4::truncate);
        let is_aslant = row.x.abs().max(row.y.abs()) > LEAN * size;
        let is_negative = world_from_ndc.determinant() < 0.0;
        let sign = if d + 0.5 * c < 0.0 { -1.0 } else { 1.0 };
        if c.abs() <= NOTHING * size {
            return Self {
                eye: None,
                direction: (sign * toward).normalize_or_zero(),
                is_reversed: None,
                is_infinite: false,
                is_between: false,
                is_aslant,
                is_negative,
                sign,
            };
        }
        let is_reversed = ends[0].abs() < ends[1].abs();
        let [far, near] = if is_reversed { ends } else { [ends[1], ends[0]] };
        let is_infinite = far.abs() <= NOTHING * near.abs();
        Self {
            eye: Some(toward / c),
            direction: ((from - d / c * toward) / near).normalize_or_zero(),
            is_reversed: Some(is_reversed),
            is_infinite,
            is_between: !is_infinite && far * near < 0.0,
            is_aslant,
            is_negative,
            sign,
        }
    }

    /// The depth that the matrix gives to what lies furthest away; none for an orthographic camera.
    pub fn background(&self) -> Option<f32> {
        self.is_reversed.map(|reversed| if reversed { 0.0 } else { 1.0 })
    }

    /// Whether pixels show the world in a mirror, if this is the depth of what lies furthest away.
    pub fn is_mirrored(&self, background: f32) -> bool {
        self.is_negative != (background == 0.0)
    }

    /// The sign that clip space's w has before the camera, by the inverse of its matrix.
    pub fn sign(&self) -> f64 {
        self.sign
    }

    /// How many of a light's receivers have boxes that meet what the camera sees.
    pub fn sees(&self, ndc_from_light: &DMat4, receivers: &[LightBox]) -> Seen {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| self.sign * ndc_from_light.row(i));
        // A box is on the right side of a plane if its corner furthest along the plane's normal is.
        let planes = [w + x, w - x, w + y, w - y, z, w - z]
            .map(|plane| (plane.truncate(), plane.truncate().abs(), plane.w));
        let is_seen = |of: &&LightBox| {
            let (middle, half) = (0.5 * (of.min + of.max), 0.5 * (of.max - of.min));
            planes.iter().all(|(normal, steep, w)| normal.dot(middle) + steep.dot(half) + w >= 0.0)
        };
        let (first, rest) = receivers.split_at(receivers.len().min(LOOKED_AT));
        let seen = first.iter().filter(is_seen).count();
        let later = seen == 0 && rest.iter().any(|of| is_seen(&of));
        Seen { seen: seen + usize::from(later), receivers: receivers.len() }
    }
}

/// How many receivers a camera sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seen {
    pub seen: usize,
    /// How many receivers there are.
    pub receivers: usize,
}

impl fmt::Display for Seen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let least = if self.receivers > LOOKED_AT { "at least " } else { "" };
        write!(f, "sees {least}{} of {} receivers", self.seen, self.receivers)
    }
}

impl fmt::Display for Camera {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.direction;
        match self.eye {
            Some(eye) => {
                write!(f, "eye ({:.2}, {:.2}, {:.2}), looks along", eye.x, eye.y, eye.z)?;
            }
            None => f.write_str("orthographic, depth grows along")?,
        }
        write!(f, " ({x:.2}, {y:.2}, {z:.2})")?;
        match self.is_reversed {
            Some(true) => f.write_str(", reversed depth")?,
            Some(false) => f.write_str(", depth not reversed")?,
            None => {}
        }
        f.write_str(if self.is_infinite { ", far plane infinitely far" } else { "" })
    }
}

impl Frame<'_> {
    /// Whether the depth of pixels that show nothing is known.
    pub(super) fn check_background(&self) -> Result<(), Error> {
        match self.background {
            Some(0.0 | 1.0) => Ok(()),
            Some(background) => bad(format!(
                "background is {background}; a pixel that shows nothing has depth 0 where depth is reversed, else 1"
            )),
            None if Camera::of(&self.world_from_ndc).is_reversed.is_none() => bad(
                "world_from_ndc is orthographic, which does not tell which end of depth is far; give background: \
                 Some(0.0) where depth is reversed, else Some(1.0)",
            ),
            None => Ok(()),
        }
    }

    /// The depth of pixels that show nothing, once it is checked.
    pub(super) fn far_depth(&self) -> f32 {
        let of_matrix = || Camera::of(&self.world_from_ndc).background();
        self.background.or_else(of_matrix).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE: DVec3 = DVec3::new(3.5, 3.5, 5.0);

    /// A perspective from near 0.1, y down: reversed or not, and to a far plane, if any.
    fn projection(reversed: bool, far: Option<f64>) -> DMat4 {
        let near = 0.1;
        // Depth is a + b / distance.
        let (a, b) = match (reversed, far) {
            (false, None) => (1.0, -near),
            (true, None) => (0.0, near),
            (false, Some(far)) => (far / (far - near), -far * near / (far - near)),
            (true, Some(far)) => (-near / (far - near), far * near / (far - near)),
        };
        DMat4::from_cols(
            DVec4::new(1.2, 0.0, 0.0, 0.0),
            DVec4::new(0.0, -1.6, 0.0, 0.0),
            DVec4::new(0.0, 0.0, -a, -1.0),
            DVec4::new(0.0, 0.0, b, 0.0),
        )
    }

    /// From the eye to the origin, y up.
    fn view() -> DMat4 {
        let back = EYE.normalize();
        let right = DVec3::Y.cross(back).normalize();
        let axes = [right, back.cross(right), back].map(|axis| axis.extend(0.0));
        DMat4::from_cols(axes[0], axes[1], axes[2], EYE.extend(1.0)).inverse()
    }

    fn clip_from_world(reversed: bool, far: Option<f64>) -> DMat4 {
        projection(reversed, far) * view()
    }

    #[test]
    fn each_convention_of_depth_follows_from_its_matrix() {
        for reversed in [false, true] {
            for far in [None, Some(50.0), Some(0.11), Some(5e3)] {
                let matrix = clip_from_world(reversed, far).inverse();
                // As a host has it whose numbers are of 32 bits.
                let single = clip_from_world(reversed, far).as_mat4().inverse().as_dmat4();
                for (matrix, exact) in [(matrix, true), (single, false), (-2.0 * matrix, true)] {
                    let camera = Camera::of(&matrix);
                    let what = format!("{reversed} {far:?}: {camera}");
                    let off = (camera.eye.unwrap() - EYE).length();
                    assert!(off < if exact { 1e-9 } else { 1e-2 }, "{what}");
                    let looks = camera.direction.dot(-EYE.normalize());
                    assert!(looks > 1.0 - if exact { 1e-9 } else { 1e-3 }, "{what}");
                    assert_eq!(camera.is_reversed, Some(reversed), "{what}");
                    assert_eq!(camera.background(), Some(f32::from(!reversed)), "{what}");
                    assert_eq!(camera.is_infinite, far.is_none(), "{what}");
                    assert!(!camera.is_between && !camera.is_aslant, "{what}");
                    assert!(!camera.is_mirrored(f32::from(!reversed)), "{what}");
                }
                let flip = DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0));
                let mirrored = Camera::of(&(matrix * flip));
                assert!(mirrored.is_mirrored(mirrored.background().unwrap()));
            }
        }
    }

    #[test]
    fn orthographic_cameras_leave_the_far_end_open() {
        // 6 m wide and high, y down, and 40 m deep.
        let down = DMat4::from_scale(DVec3::new(1.0 / 3.0, -1.0 / 3.0, -1.0 / 40.0));
        let matrix = (down * view()).inverse();
        for matrix in [matrix, matrix.as_mat4().as_dmat4(), -3.0 * matrix] {
            let camera = Camera::of(&matrix);
            assert_eq!((camera.eye, camera.is_reversed, camera.background()), (None, None, None));
            assert!(camera.direction.dot(-EYE.normalize()) > 0.999);
            assert!(!camera.is_mirrored(1.0) && camera.is_mirrored(0.0));
            assert!(camera.to_string().starts_with("orthographic"), "{camera}");
        }
    }

    #[test]
    fn what_is_not_inverted_or_transposed_is_no_camera() {
        for (reversed, far) in [(true, None), (false, Some(50.0)), (true, Some(9.0))] {
            let clip_from_world = clip_from_world(reversed, far);
            assert!(Camera::of(&clip_from_world).is_aslant);
            assert!(Camera::of(&clip_from_world.inverse().transpose()).is_aslant);
        }
        // A plane of depth in the midst of what is seen: depth runs on beyond infinity.
        let matrix =
            DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(0.0, 0.0, 1.0, 2.0), -DVec4::W);
        assert!(Camera::of(&matrix).is_between);
    }

    #[test]
    fn receivers_before_the_camera_are_seen() {
        let cube = |at: DVec3| LightBox::new(&[[-0.5; 3], [0.5; 3]], &DMat4::from_translation(at));
        let (ahead, behind) = (cube(DVec3::ZERO), cube(2.0 * EYE));
        let aside = cube(DVec3::new(90.0, 0.0, -60.0));
        for matrix in [clip_from_world(true, None), clip_from_world(false, Some(50.0))] {
            for matrix in [matrix, -matrix] {
                let camera = Camera::of(&matrix.inverse());
                let seen = camera.sees(&matrix, &[ahead, behind, aside]);
                assert_eq!(seen, Seen { seen: 1, receivers: 3 });
                assert_eq!(seen.to_string(), "sees 1 of 3 receivers");
                // Beyond those that are counted, one is as good as many.
                let many: Vec<_> = (0..200).map(|i| if i < 70 { behind } else { ahead }).collect();
                let seen = camera.sees(&matrix, &many);
                assert_eq!(seen.to_string(), "sees at least 1 of 200 receivers");
                assert_eq!(camera.sees(&matrix, &[aside; 90]).seen, 0);
            }
        }
    }
}
