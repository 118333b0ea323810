//! Doubts: what a frame says that can be meant, and seldom is. They are no errors. All follow from numbers that
//! planning has looked at already, so that they cost microseconds and no memory.

use super::camera::{Camera, Seen};
use super::fit::Fit;
use super::{Description, Frame};
use crate::effects::Situation;
use glam::DVec4;
use smallvec::SmallVec;
use std::fmt;

/// Something in a frame that looks like a mistake of the host's, and may be meant; see [`FramePlan::doubts`].
///
/// A doubt is displayed as one sentence: what the matter is, and the likely remedy.
///
/// [`FramePlan::doubts`]: super::FramePlan::doubts
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// The camera shows the world in a mirror: the y of normalized device coordinates is flipped once too few or once
    /// too often.
    Mirrored,
    /// The last row of [`Frame::world_from_ndc`] is that of no camera whose near plane faces it: the matrix is not
    /// inverted, or transposed.
    Aslant {
        /// The last row.
        row: [f64; 4],
    },
    /// The camera's eye lies between its near and its far plane.
    EyeAmongDepths,
    /// The camera sees none of the receivers before the light.
    SeesNoReceiver {
        /// How many there are.
        receivers: usize,
        /// The place of the eye, which an orthographic camera does not have.
        eye: Option<[f64; 3]>,
    },
    /// All that may be shadowed lies behind the camera, so that penumbrae span infinitely many pixels.
    EndlessPenumbra,
    /// [`Frame::background`] is not the end of depth that the matrix shows to be the far one.
    Background {
        /// What is given.
        given: f32,
    },
    /// Every occluder within the light's reach lies behind it.
    OccludersBehindLight {
        /// Where the light shines.
        emission: [f64; 3],
    },
    /// Every receiver within the light's reach lies behind it.
    ReceiversBehindLight {
        /// Where the light shines.
        emission: [f64; 3],
    },
    /// There are occluders, and no mesh that receives.
    NothingReceives,
    /// A mesh blocks and does not receive, and there is no mask to tell its pixels by.
    OccluderWithoutMask {
        /// The place of the mesh in [`Frame::meshes`].
        mesh: usize,
    },
}

/// How many doubts a frame can have at most, one of each kind.
const MOST: usize = 10;

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Mirrored => f.write_str(
                "the camera shows the world mirrored: world_from_ndc lacks a flip of y, or has one too many; where the \
                 host's y runs up in ndc, it is inverse(projection * view) * scale(1, -1, 1) (in a left-handed world \
                 this is as it should be)",
            ),
            Self::Aslant { row: [x, y, z, w] } => write!(
                f,
                "world_from_ndc's last row is ({x:.3}, {y:.3}, {z:.3}, {w:.3}), and that of a camera begins with 0, 0 \
                 unless its near plane is oblique; give the inverse of projection * view, not transposed"
            ),
            Self::EyeAmongDepths => f.write_str(
                "the camera's eye lies between its near and its far plane; give the inverse of projection * view, whose \
                 depth runs from 0 to 1",
            ),
            Self::SeesNoReceiver { receivers, eye } => {
                write!(f, "the camera sees none of {receivers} receivers before the light")?;
                if let Some([x, y, z]) = eye {
                    write!(f, ", from its eye at ({x:.2}, {y:.2}, {z:.2})")?;
                }
                f.write_str(
                    "; unless it looks elsewhere, check that world_from_ndc is inverted, not transposed, and of the \
                     world that meshes and light are in",
                )
            }
            Self::EndlessPenumbra => f.write_str(
                "all that may be shadowed lies behind the camera, where penumbrae span infinitely many pixels; unless it \
                 looks elsewhere, check world_from_ndc",
            ),
            Self::Background { given } => write!(
                f,
                "background is {given}, and by world_from_ndc depth {} is the far end; leave background None, or check \
                 the projection that world_from_ndc is made of",
                1.0 - given
            ),
            Self::OccludersBehindLight { emission } => behind(f, "occluder", emission),
            Self::ReceiversBehindLight { emission } => behind(f, "receiver", emission),
            Self::NothingReceives => f.write_str(
                "there are occluders and no receivers: every mesh is Role::Occluder; what shows shadows is \
                 Role::Receiver or Role::Both",
            ),
            Self::OccluderWithoutMask { mesh } => write!(
                f,
                "mesh {mesh} is Role::Occluder, and without a mask its pixels are shadowed like all others; give \
                 Description::mask_format and Frame::mask, or Role::Both"
            ),
        }
    }
}

fn behind(f: &mut fmt::Formatter, what: &str, [x, y, z]: [f64; 3]) -> fmt::Result {
    write!(
        f,
        "every {what} within reach lies behind the light, which shines along ({x:.2}, {y:.2}, {z:.2}), that is half_v × \
         half_u; turn it round, or make it by RectangleLight::facing"
    )
}

/// How a frame's camera and the roles of its pixels are understood, and what is doubtful in the frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Sight {
    camera: Option<Camera>,
    is_mirrored: bool,
    seen: Seen,
    /// Whether the eye is so near to what may be shadowed that pixels there are infinitely small.
    at_eye: bool,
    has_mask: bool,
    doubts: SmallVec<[Doubt; MOST]>,
}

impl Sight {
    /// Looks at a frame whose meshes are fitted, and at what its pixels are to it.
    pub fn of(
        description: &Description,
        frame: &Frame,
        fit: &Fit,
        situation: Option<&Situation>,
    ) -> Self {
        let camera = Camera::of(&frame.world_from_ndc);
        let receivers = &fit.receivers.boxes;
        let ndc_from_light = (fit.light_from_world * frame.world_from_ndc).inverse();
        let seen = camera.sees(&ndc_from_light, receivers);
        let background = camera.background();
        let is_mirrored = camera.is_mirrored(background.unwrap_or_else(|| frame.far_depth()));
        let endless = situation.is_some_and(|s| s.penumbra_pixels.is_infinite());
        let is_behind = endless
            && fit.shadowed.is_some_and(|view| {
                // Which has its corners at the ends of its window, near and far.
                let row = camera.sign() * ndc_from_light.row(3);
                let ([a, b], [u, v]) = (view.min, view.max);
                let corners = [(a, b), (a, v), (u, b), (u, v)];
                let at = |x: f64, y: f64, d: f64| row.dot(DVec4::new(x * d, y * d, d, 1.0));
                corners
                    .iter()
                    .all(|&(x, y)| at(x, y, view.near) <= 0.0 && at(x, y, view.far) <= 0.0)
            });
        let emission = frame.light.emission().to_array();
        let has_mask = description.mask_format.is_some();
        let eye = camera.eye.map(|eye| eye.to_array());
        let row = frame.world_from_ndc.row(3).to_array();
        let odd = &fit.odd;
        let given = frame.background.filter(|given| background.is_some_and(|of| of != *given));
        // A matrix that is no camera's is not doubted twice.
        let doubts = [
            camera.is_aslant.then_some(Doubt::Aslant { row }),
            camera.is_between.then_some(Doubt::EyeAmongDepths),
            (is_mirrored && !camera.is_aslant).then_some(Doubt::Mirrored),
            given.map(|given| Doubt::Background { given }),
            (seen.seen == 0 && seen.receivers > 0)
                .then_some(Doubt::SeesNoReceiver { receivers: seen.receivers, eye }),
            is_behind.then_some(Doubt::EndlessPenumbra),
            odd.occluders_behind.then_some(Doubt::OccludersBehindLight { emission }),
            odd.receivers_behind.then_some(Doubt::ReceiversBehindLight { emission }),
            odd.nothing_receives.then_some(Doubt::NothingReceives),
            odd.occluder_alone
                .filter(|_| !has_mask)
                .map(|mesh| Doubt::OccluderWithoutMask { mesh }),
        ];
        Self {
            camera: Some(camera),
            is_mirrored,
            seen,
            at_eye: endless && !is_behind,
            has_mask,
            doubts: doubts.into_iter().flatten().collect(),
        }
    }

    pub fn doubts(&self) -> &[Doubt] {
        &self.doubts
    }
}

impl fmt::Display for Sight {
    /// The camera and the roles of pixels, a line each; nothing where no frame was looked at.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(camera) = &self.camera else { return Ok(()) };
        let mirrored = if self.is_mirrored { "mirrored" } else { "not mirrored" };
        write!(f, "camera: {camera}, {mirrored}, {}", self.seen)?;
        if self.at_eye {
            f.write_str(
                "; what may be shadowed reaches up to the eye, where penumbrae span inf pixels",
            )?;
        }
        f.write_str(match self.has_mask {
            true => "\nroles of pixels: by the mask\n",
            false => "\nroles of pixels: no mask, every pixel blocks and receives\n",
        })
    }
}
