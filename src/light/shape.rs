//! A light as one value: where it is, where it shines, and its shape.

use super::outline::{self, CORNERS};
use super::{LENGTHS, RectangleLight};
use crate::Error;
use crate::plain::Vector;
use glam::{DMat3, DVec3};

/// As many corners as an outline may have.
const MOST: usize = *CORNERS.end();

/// A light: a rectangle, line, polygon or disc, which shine to one side; a sphere or capsule, which shine to all sides; a
/// point, which does either; or a sun, which shines along a direction.
///
/// A [`RectangleLight`] is a light by `into()`; the other shapes have constructors here. Positions are world space in
/// f64, lengths are metres. [`Self::shape`] says what a light is, and [`Self::rectangle`] has its light space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    rectangle: RectangleLight,
    form: Form,
}

/// The form of a light within its rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a light is a plain value, which is copied a few times a frame"
)]
enum Form {
    /// The rectangle itself, or its line where it has no height, or its point where it has no sides.
    Rectangle,
    Polygon(Outline),
    /// Half the rectangle's width is the radius of these two.
    Disc,
    Sphere,
    Capsule {
        half_length: f64,
        radius: f64,
    },
    Point,
    Sun {
        angular_size: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Outline {
    /// The first `count` are corners, the others 0.
    corners: [[f64; 2]; MOST],
    count: usize,
}

/// The shape of a light, in its light space, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape<'a> {
    /// The whole of [`Light::rectangle`].
    Rectangle,
    /// A segment: [`Light::rectangle`] without a height, along its x.
    Line,
    /// A polygon of 3 to 16 corners as x and y from the light's centre, counter-clockwise as seen from the side that
    /// the light shines to.
    Polygon(&'a [[f64; 2]]),
    /// A disc about the light's centre, in the plane of [`Light::rectangle`].
    Disc {
        /// The radius, above 0.
        radius: f64,
    },
    /// A sphere about the light's centre.
    Sphere {
        /// The radius, above 0.
        radius: f64,
    },
    /// All points within a radius of a segment, which lies along x of light space about the light's centre.
    Capsule {
        /// Half the segment's length, from 0 up.
        half_length: f64,
        /// The radius, above 0.
        radius: f64,
    },
    /// The light's centre, which shines to one side ([`RectangleLight::point`]) or to all ([`Light::point`]):
    /// [`Light::is_one_sided`] says which.
    Point,
    /// A disc of an angular size, infinitely far away.
    Sun {
        /// The full width of the disc, in radians above 0 and at most 1.
        angular_size: f64,
    },
}

impl Shape<'_> {
    /// The shape's name for a sentence that begins with "the light is a".
    pub fn name(&self) -> &'static str {
        match self {
            Self::Rectangle => "rectangle",
            Self::Line => "line",
            Self::Polygon(_) => "polygon",
            Self::Disc { .. } => "disc",
            Self::Sphere { .. } => "sphere",
            Self::Capsule { .. } => "capsule",
            Self::Point => "point",
            Self::Sun { .. } => "sun",
        }
    }
}

impl From<RectangleLight> for Light {
    fn from(rectangle: RectangleLight) -> Self {
        Self { rectangle, form: Form::Rectangle }
    }
}

impl From<&RectangleLight> for Light {
    fn from(rectangle: &RectangleLight) -> Self {
        (*rectangle).into()
    }
}

impl From<&Light> for Light {
    fn from(light: &Light) -> Self {
        *light
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
    /// [`Error::Light`] for an outline that is not that, and for a line or a point, which have none.
    pub fn with_outline(rectangle: RectangleLight, corners: &[[f64; 2]]) -> Result<Self, Error> {
        if rectangle.half_extents()[1] == 0.0 {
            let what = if rectangle.is_point() { "point" } else { "line" };
            return Err(Error::Light(format!("it is a {what}, which has no outline")));
        }
        if let Some(problem) = outline::problem(corners, rectangle.half_extents()) {
            return Err(Error::Light(format!("of its outline, {problem}")));
        }
        let mut outline = Outline { corners: [[0.0; 2]; MOST], count: corners.len() };
        outline.corners[..corners.len()].copy_from_slice(corners);
        Ok(Self { rectangle, form: Form::Polygon(outline) })
    }

    /// A disc that shines along `emission`, of any length, from its centre in world space; its radius is in metres.
    ///
    /// # Errors
    /// [`Error::Light`] for values that are not finite, no emission, or a diameter that is not from 10⁻¹⁵ to 10¹⁵ m.
    pub fn disc(
        center: impl Into<Vector>,
        emission: impl Into<Vector>,
        radius: f64,
    ) -> Result<Self, Error> {
        let [Vector(center), Vector(emission)] = [center.into(), emission.into()];
        check_place(center)?;
        check_radius(radius)?;
        let z = emission.normalize_or_zero();
        if z == DVec3::ZERO {
            return refuse("its emission must be finite numbers and have a length");
        }
        Ok(Self::framed(center, z, [radius; 2], Form::Disc))
    }

    /// A sphere that shines to all sides, from its centre in world space; its radius is in metres.
    ///
    /// # Errors
    /// [`Error::Light`] for a centre that is not finite, or a diameter that is not from 10⁻¹⁵ to 10¹⁵ m.
    pub fn sphere(center: impl Into<Vector>, radius: f64) -> Result<Self, Error> {
        let Vector(center) = center.into();
        check_place(center)?;
        check_radius(radius)?;
        Ok(Self::framed(center, DVec3::Z, [radius; 2], Form::Sphere))
    }

    /// A capsule that shines to all sides, as tubes do: all that lies within `radius` metres of a segment.
    ///
    /// `half_axis` reaches from the centre to the centre of one end cap, in world space, in metres; of no length it
    /// makes a sphere, which is computed as a capsule.
    ///
    /// # Errors
    /// [`Error::Light`] for values that are not finite, or a width or a length, its caps included, that is not from
    /// 10⁻¹⁵ to 10¹⁵ m.
    pub fn capsule(
        center: impl Into<Vector>,
        half_axis: impl Into<Vector>,
        radius: f64,
    ) -> Result<Self, Error> {
        let [Vector(center), Vector(half_axis)] = [center.into(), half_axis.into()];
        check_place(center)?;
        check_radius(radius)?;
        let half_length = half_axis.length();
        if !half_length.is_finite() {
            return refuse("its axis must be finite numbers");
        }
        let half = half_length + radius;
        if 2.0 * half > *LENGTHS.end() {
            return refuse("its length must be at most 1e15 m");
        }
        let x = half_axis.normalize_or(DVec3::X);
        let z = x.any_orthonormal_vector();
        let rectangle = RectangleLight {
            center,
            axes: DMat3::from_cols(x, z.cross(x), z),
            half_extents: [half, radius],
        };
        Ok(Self { rectangle, form: Form::Capsule { half_length, radius } })
    }

    /// A point that shines to all sides, in world space: its shadows have no penumbra. [`RectangleLight::point`] makes one
    /// that shines to one side, which more techniques take.
    ///
    /// # Errors
    /// [`Error::Light`] for a centre that is not finite.
    pub fn point(center: impl Into<Vector>) -> Result<Self, Error> {
        let Vector(center) = center.into();
        check_place(center)?;
        Ok(Self::framed(center, DVec3::Z, [0.0; 2], Form::Point))
    }

    /// A sun: a disc of `angular_size` radians, infinitely far away, whose light goes along `emission`.
    ///
    /// `center` and `radius` bound what it shines on. Techniques that know rectangles alone take the light for
    /// [`RectangleLight::sun`] of these values, which [`Self::rectangle`] is: a square as wide as the disc, very far
    /// away.
    ///
    /// # Errors
    /// As [`RectangleLight::sun`].
    pub fn sun(
        emission: impl Into<Vector>,
        angular_size: f64,
        center: impl Into<Vector>,
        radius: f64,
    ) -> Result<Self, Error> {
        let rectangle = RectangleLight::sun(emission, angular_size, center, radius)?;
        Ok(Self { rectangle, form: Form::Sun { angular_size } })
    }

    /// A light whose x and y axes are any.
    fn framed(center: DVec3, z: DVec3, half_extents: [f64; 2], form: Form) -> Self {
        let x = z.any_orthonormal_vector();
        let axes = DMat3::from_cols(x, z.cross(x), z);
        Self { rectangle: RectangleLight { center, axes, half_extents }, form }
    }

    /// The light's shape.
    pub fn shape(&self) -> Shape<'_> {
        let [radius, _] = self.rectangle.half_extents();
        match &self.form {
            Form::Rectangle if self.rectangle.is_line() => Shape::Line,
            Form::Rectangle if self.rectangle.is_point() => Shape::Point,
            Form::Rectangle => Shape::Rectangle,
            Form::Polygon(outline) => Shape::Polygon(&outline.corners[..outline.count]),
            Form::Disc => Shape::Disc { radius },
            Form::Sphere => Shape::Sphere { radius },
            &Form::Capsule { half_length, radius } => Shape::Capsule { half_length, radius },
            Form::Point => Shape::Point,
            &Form::Sun { angular_size } => Shape::Sun { angular_size },
        }
    }

    /// The light's rectangle, which is the frame of its light space.
    ///
    /// | shape | rectangle |
    /// |---|---|
    /// | rectangle, line, point that shines to one side | the light itself |
    /// | polygon | a rectangle around its outline |
    /// | disc | the square around it |
    /// | sphere, capsule, point that shines to all sides | the light's extent along axes of which only a capsule's x, its axis, means anything: the light shines to all sides, whatever the rectangle's emission |
    /// | sun | the square as wide as the sun's disc that [`RectangleLight::sun`] makes, very far away |
    pub fn rectangle(&self) -> &RectangleLight {
        &self.rectangle
    }

    /// The corners of the outline, in light space; none where the light is no polygon.
    pub fn outline(&self) -> Option<&[[f64; 2]]> {
        match self.shape() {
            Shape::Polygon(corners) => Some(corners),
            _ => None,
        }
    }

    /// The tangent of half a sun's angular size; `None` for a lamp.
    pub(crate) fn tangent(&self) -> Option<f64> {
        match self.shape() {
            Shape::Sun { angular_size } => Some((0.5 * angular_size).tan()),
            _ => None,
        }
    }

    /// Whether the light has a plane and shines to one side of it: what lies at or behind that plane is not lit by it.
    ///
    /// True of a rectangle, line, polygon, disc and [`RectangleLight::point`]. A sphere, a capsule and [`Light::point`] shine
    /// to all sides, and a sun has no position that anything could lie behind.
    pub fn is_one_sided(&self) -> bool {
        match self.form {
            Form::Rectangle | Form::Polygon(_) | Form::Disc => true,
            Form::Sphere | Form::Capsule { .. } | Form::Point | Form::Sun { .. } => false,
        }
    }

    /// Whether the light shines to all sides: a sphere, a capsule or [`Light::point`].
    pub fn is_round(&self) -> bool {
        matches!(self.form, Form::Sphere | Form::Capsule { .. } | Form::Point)
    }

    /// The centre in world space; a sun's is that of its rectangle.
    pub fn center(&self) -> DVec3 {
        self.rectangle.center()
    }

    /// The direction in which the light shines, a unit vector in world space; any, where it shines to all sides.
    pub fn emission(&self) -> DVec3 {
        self.rectangle.emission()
    }

    /// The light with the axes of its space turned by a quarter: x where y was.
    pub(crate) fn quarter_turned(&self) -> Self {
        let mut turned = *self;
        turned.rectangle = self.rectangle.quarter_turned();
        if let Form::Polygon(outline) = &mut turned.form {
            for [x, y] in &mut outline.corners {
                (*x, *y) = (*y, -*x);
            }
        }
        turned
    }
}

fn refuse<T>(problem: &str) -> Result<T, Error> {
    Err(Error::Light(problem.into()))
}

fn check_place(center: DVec3) -> Result<(), Error> {
    if center.is_finite() {
        return Ok(());
    }
    refuse("its position must be finite numbers")
}

fn check_radius(radius: f64) -> Result<(), Error> {
    if LENGTHS.contains(&(2.0 * radius)) {
        return Ok(());
    }
    Err(Error::Light(format!(
        "its radius is {radius} m; it must be above 0, and twice that from 1e-15 to 1e15 m"
    )))
}
