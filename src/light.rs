//! Lights of every shape, and the light space that every technique works in.

use crate::Error;
use crate::plain::Vector;
use glam::{DMat3, DMat4, DVec2, DVec3};

pub(crate) mod outline;
mod shape;

pub use shape::{Light, Shape};

/// The largest cosine of the angle between two half-axes that count as perpendicular.
const MAX_SKEW: f64 = 1e-4;

/// The distance of a sun, in radii of the sphere that it lights.
const SUN_DISTANCE: f64 = 1000.0;

/// The lengths in metres whose squares, and the ratios of these, single precision holds.
pub(crate) const LENGTHS: std::ops::RangeInclusive<f64> = 1e-15..=1e15;

/// The largest angular size of a sun, radians.
const MAX_ANGULAR_SIZE: f64 = 1.0;

/// A rectangle that emits from one side; one of no height is a line ([`Self::line`]), and one without sides a point
/// ([`Self::point`]).
///
/// Light space has its origin at the light's centre, +z along the emission, and x and y along the
/// half-axes; it is right-handed and its unit is the metre. Positions and axes are world space in
/// f64: all that reaches the GPU is relative to the light, so a light far from the world's origin
/// is as exact as one near it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectangleLight {
    center: DVec3,
    /// Columns: the light's x, y and z axes in world space, orthonormal.
    axes: DMat3,
    half_extents: [f64; 2],
}

impl RectangleLight {
    /// A light that shines along `half_v × half_u` (not `u × v`), from its centre and two half-axes in world space.
    ///
    /// `half_u` and `half_v` reach from the centre to the middle of two neighbouring edges, in metres; they must be
    /// perpendicular. Seen as the light shines, `half_u` points to the right where `half_v` points up, as for a glTF
    /// node whose X and Y axes they are and which shines along its −Z. [`Self::facing`] takes the direction instead.
    ///
    /// # Errors
    /// [`Error::Light`] for values that are not finite, a side of no length (the soft shadow
    /// techniques need an area), or half-axes that are not perpendicular.
    pub fn new(
        center: impl Into<Vector>,
        half_u: impl Into<Vector>,
        half_v: impl Into<Vector>,
    ) -> Result<Self, Error> {
        let [Vector(center), Vector(half_u), Vector(half_v)] =
            [center.into(), half_u.into(), half_v.into()];
        let (width, height) = (half_u.length(), half_v.length());
        if !(center.is_finite() && width.is_finite() && height.is_finite()) {
            return Err(Error::Light("its position and axes must be finite numbers".into()));
        }
        if width <= 0.0 || height <= 0.0 {
            return Err(Error::Light("its width and height must be above 0".into()));
        }
        let x = half_u / width;
        let skew = x.dot(half_v / height);
        if skew.abs() > MAX_SKEW {
            return Err(Error::Light(format!(
                "its two axes must be perpendicular (the cosine of their angle is {skew:.3e})"
            )));
        }
        // Emission is −(u × v); +y completes the right-handed frame.
        let z = -half_u.cross(half_v).normalize();
        let axes = DMat3::from_cols(x, z.cross(x), z);
        Ok(Self { center, axes, half_extents: [width, height] })
    }

    /// A light that shines along `emission`, of any length, from its centre, with its whole width and height in metres.
    ///
    /// The height of the light runs along `up`, of any length, as far as that lies across the emission, and its width
    /// to the right, seen as the light shines. All are in world space.
    ///
    /// # Errors
    /// [`Error::Light`] for values that are not finite, no emission, an `up` that is nothing or lies along the
    /// emission, or a side that is not above 0.
    pub fn facing(
        center: impl Into<Vector>,
        emission: impl Into<Vector>,
        up: impl Into<Vector>,
        [width, height]: [f64; 2],
    ) -> Result<Self, Error> {
        let refuse = |problem: &str| Err(Error::Light(problem.into()));
        let [Vector(center), Vector(emission), Vector(up)] =
            [center.into(), emission.into(), up.into()];
        let vectors = center.is_finite() && emission.is_finite() && up.is_finite();
        if !(vectors && width.is_finite() && height.is_finite()) {
            return refuse("its position, emission, up, width and height must be finite numbers");
        }
        if width <= 0.0 || height <= 0.0 {
            return refuse("its width and height must be above 0");
        }
        let z = emission.normalize_or_zero();
        if z == DVec3::ZERO {
            return refuse("it must shine into some direction, and its emission has no length");
        }
        let y = up.normalize_or_zero().reject_from_normalized(z);
        if y.length() <= MAX_SKEW {
            return refuse("its up must point across its emission, and not along it");
        }
        let y = y.normalize();
        Self::new(center, 0.5 * width * z.cross(y), 0.5 * height * y)
    }

    /// A line light: a segment of no height, as tubes and strips are (Heidrich, Brabec and Seidel 2000).
    ///
    /// `half_u` reaches from the centre to one end, in metres. `emission` is the middle of the half space that it
    /// shines into, of any length; what of it lies along the segment does not matter. Its height is 0 in
    /// [`Self::half_extents`], by which the techniques that need an area know it.
    ///
    /// # Errors
    /// [`Error::Light`] for values that are not finite, a segment of no length, or an emission along it.
    pub fn line(
        center: impl Into<Vector>,
        half_u: impl Into<Vector>,
        emission: impl Into<Vector>,
    ) -> Result<Self, Error> {
        let [Vector(center), Vector(half_u), Vector(emission)] =
            [center.into(), half_u.into(), emission.into()];
        let refuse = |problem: &str| Err(Error::Light(problem.into()));
        let length = half_u.length();
        if !(center.is_finite() && length.is_finite() && emission.is_finite()) {
            return refuse("its position, segment and emission must be finite numbers");
        }
        if length <= 0.0 {
            return refuse("a line must be longer than 0");
        }
        let x = half_u / length;
        let z = emission.normalize_or_zero().reject_from_normalized(x);
        if z.length() <= MAX_SKEW {
            return refuse("a line must shine into some direction across it");
        }
        let z = z.normalize();
        Ok(Self { center, axes: DMat3::from_cols(x, z.cross(x), z), half_extents: [length, 0.0] })
    }

    /// Whether the light is a segment without height.
    pub fn is_line(&self) -> bool {
        self.half_extents[1] == 0.0 && self.half_extents[0] > 0.0
    }

    /// A point light, which shines into the half space about `emission`, of any length: its shadows have no penumbra.
    ///
    /// The light has no width and no height. [`Light::point`] makes one that shines to all sides.
    ///
    /// # Errors
    /// [`Error::Light`] for values that are not finite, or no emission.
    pub fn point(center: impl Into<Vector>, emission: impl Into<Vector>) -> Result<Self, Error> {
        let [Vector(center), Vector(emission)] = [center.into(), emission.into()];
        let z = emission.normalize_or_zero();
        if !center.is_finite() || z == DVec3::ZERO {
            return Err(Error::Light(
                "its position and emission must be finite numbers, and it must shine into some direction".into(),
            ));
        }
        let x = z.any_orthonormal_vector();
        Ok(Self { center, axes: DMat3::from_cols(x, z.cross(x), z), half_extents: [0.0; 2] })
    }

    /// Whether the light is a point: without width and height.
    pub fn is_point(&self) -> bool {
        self.half_extents == [0.0; 2]
    }

    /// A sun: a light of an angular size, so far away that its rays are all but parallel.
    ///
    /// It is a square as wide as the sun's disc, 1000 times `radius` from `center`, which together should hold
    /// what casts shadows. Within that sphere its direction changes by a thousandth of a radian at most, and a
    /// shadow lies no further from a true sun's than a thousandth of the distance to what casts it; a float's
    /// last digit is a 16,000th of the radius. Any technique takes it, for Eisemann and Décoret 2008 section
    /// 3.1's sunlight among them.
    ///
    /// `emission` is where the light goes, of any length; `angular_size` is the disc's full width in radians:
    /// 0.0093 for the Sun from the Earth.
    ///
    /// # Errors
    /// [`Error::Light`] for values that are not finite, no direction, a radius that is not above 0, or an
    /// angular size that is not above 0 and at most 1 rad (57°).
    pub fn sun(
        emission: impl Into<Vector>,
        angular_size: f64,
        center: impl Into<Vector>,
        radius: f64,
    ) -> Result<Self, Error> {
        let [Vector(emission), Vector(center)] = [emission.into(), center.into()];
        let refuse = |problem: &str| Err(Error::Light(problem.into()));
        let z = emission.normalize_or_zero();
        if z == DVec3::ZERO || !(center.is_finite() && radius.is_finite()) {
            return refuse(
                "its direction, centre and radius must be finite numbers, and it must go somewhere",
            );
        }
        if radius <= 0.0 {
            return refuse("the radius of what it shines on must be above 0");
        }
        if !(angular_size > 0.0 && angular_size <= MAX_ANGULAR_SIZE) {
            return refuse("its angular size must be above 0 and at most 1 rad");
        }
        let away = SUN_DISTANCE * radius;
        let half = away * (0.5 * angular_size).tan();
        let (u, v) = z.any_orthonormal_pair();
        // Light leaves along half_v × half_u.
        Self::new(center - away * z, half * v, half * u)
    }

    /// One metre square at the origin, emitting along +z.
    pub(crate) fn unit() -> Self {
        Self { center: DVec3::ZERO, axes: DMat3::IDENTITY, half_extents: [0.5; 2] }
    }

    /// The light with its centre moved within its plane, by metres along its x and y.
    pub(crate) fn moved(&self, [x, y]: [f64; 2]) -> Self {
        Self { center: self.center + self.axes * DVec3::new(x, y, 0.0), ..*self }
    }

    /// The light with its x axis turned to a unit vector of its plane.
    pub(crate) fn turned(&self, along: DVec2) -> Self {
        let [x, y, z] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis];
        let turned = along.x * x + along.y * y;
        Self { axes: DMat3::from_cols(turned, z.cross(turned), z), ..*self }
    }

    /// The light turned by a quarter, so that its x axis lies where its y axis was.
    pub(crate) fn quarter_turned(&self) -> Self {
        let [x, y, z] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis];
        let [a, b] = self.half_extents;
        Self { axes: DMat3::from_cols(y, -x, z), half_extents: [b, a], ..*self }
    }

    /// The light with other half-extents.
    pub(crate) fn with_half_extents(&self, half_extents: [f64; 2]) -> Self {
        Self { half_extents, ..*self }
    }

    /// Half the light's width and height, in metres.
    pub fn half_extents(&self) -> [f64; 2] {
        self.half_extents
    }

    /// The centre in world space.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The direction of emission in world space, a unit vector.
    pub fn emission(&self) -> DVec3 {
        self.axes.z_axis
    }

    /// Light space to world space: a rotation and a translation.
    pub fn world_from_light(&self) -> DMat4 {
        DMat4::from_mat3(self.axes).with_translation(self.center)
    }

    /// World space to light space: the inverse of [`Self::world_from_light`].
    pub fn light_from_world(&self) -> DMat4 {
        let rotation = self.axes.transpose();
        DMat4::from_mat3(rotation).with_translation(-(rotation * self.center))
    }
}

/// `DMat4` with its translation column replaced.
trait WithTranslation {
    fn with_translation(self, t: DVec3) -> Self;
}

impl WithTranslation for DMat4 {
    fn with_translation(mut self, t: DVec3) -> Self {
        self.w_axis = t.extend(1.0);
        self
    }
}
