//! The visible fraction by rays on the processor, as fast as a well-made ray tracer finds it: techniques are judged
//! against it. Its answers are those of `antumbra::truth::Tracer`, which is f64 and made to be right, not fast.
//!
//! A pixel's rays begin at one point and end on one light, so they are traced at once. obvhs's binary tree is made
//! eight wide. A node's eight boxes are held against the pyramid from the point to the light, and those that it meets
//! against the rays that are left; a leaf is a block of eight triangles, in f32 relative to the scene's centre. What a
//! block's triangles have to do with the pyramid comes before what they have to do with rays: most are beside it, and
//! one that hides the whole light ends the pixel. That is how a surface that is turned away from the light becomes
//! dark, by its own triangle and for the price of one block, whatever its normals and its role say. Nothing is
//! assumed of surfaces that only receive. The block that was hit last is the first one of the next pixel of a tile.
//!
//! # What was tried
//!
//! Milliseconds for the rays of 480×360 pixels, 16 and 64 a pixel, on two cores with AVX2 (a virtual EPYC), median of
//! nine in turns, the tree not counted. Kitchen, yard and hall are not in this repository; every mesh of theirs blocks
//! and receives. The lights are the first of each scene; the yard's sun is 400 m away and not 200 km, where the
//! truth's offset, which grows with the light's distance, would be larger than what casts shadows.
//!
//! | | bunny | suzanne | kitchen | yard | hall |
//! |---|---|---|---|---|---|
//! | triangles that block, in thousands | 5.6 | 14.8 | 2.0 | 23.3 | 82.3 |
//! | the truth's tracer: f64, binary tree | 87, 304 | 61, 227 | 89, 336 | 105, 419 | 49, 174 |
//! | `Bvh2` of obvhs, f32 | 52, 180 | 31, 111 | 65, 253 | 81, 322 | 31, 113 |
//! | `CwBvh` of obvhs, its traversal, f32 | 73, 268 | 50, 193 | 104, 382 | 98, 392 | 46, 173 |
//! | eight wide, AVX2, one ray at a time | 28, 104 | 18, 69 | 19, 74 | 31, 123 | 13, 48 |
//! | as packets, first version | 26, 69 | 19, 60 | 10, 24 | 11, 22 | 8, 17 |
//! | **this one**: packets, made when a box is met | 20, 38 | 16, 46 | 5.8, 8.9 | 7.0, 10 | 5.0, 7.6 |
//! | its millions of rays a second | 129, 265 | 151, 210 | 476, 1249 | 311, 864 | 552, 1449 |
//! | its tree in ms; the truth's | 2.4; 2.3 | 3.8; 3.4 | 1.1; 1.0 | 6.9; 6.2 | 26; 21 |
//!
//! One ray a pixel takes 2 to 4 ms alone, twice that as a packet; four take 4 to 10 ms as a packet, 5 to 9 alone.
//! The first version took 1.0 to 1.8 times as long without the pyramid; 0.9 to 2.8 times with the pyramid and no rays
//! against boxes; 1.3 to 2.1 times over arrays, with the compiler's vectors for AVX2, and 1.3 to 2.8 times for SSE2.
//! Leaves of up to four triangles cost a tenth more on the bunny; a better tree (six times as much reinsertion) gains
//! at most a sixth for two to four times the build; the largest child first gains a fifth on the bunny with 64 rays and
//! nothing elsewhere.
//!
//! Mean error in percent over the pixels in shadow or penumbra, 4, 16 and 64 rays, against 2,048 of the truth's:
//!
//! | points on the light | bunny | suzanne | kitchen | hall |
//! |---|---|---|---|---|
//! | jittered, as the truth's | 6.3, 2.3, 0.83 | 8.1, 3.0, 1.07 | 4.1, 1.5, 0.53 | 1.2, 0.45, 0.16 |
//! | R2, shifted in each pixel | 5.8, 2.6, 0.88 | 7.8, 3.2, 1.07 | 3.8, 1.8, 0.55 | 1.2, 0.51, 0.18 |
//! | Sobol, Owen-scrambled in each pixel | 5.5, 1.9, 0.68 | 7.1, 2.4, 0.89 | 3.3, 1.0, 0.29 | 1.1, 0.39, 0.14 |
//! | lattice, shifted in each pixel | 5.6, 1.9, 0.58 | 7.5, 2.4, 0.75 | 3.4, 1.0, 0.30 | 1.2, 0.37, 0.12 |
//! | square grid, the same in all | 4.5, 1.6, 0.60 | 6.0, 2.1, 0.72 | 4.0, 1.9, 0.89 | 0.9, 0.28, 0.09 |
//! | **lattice, the same in all** | 4.7, 1.7, 0.54 | 6.4, 2.1, 0.70 | 2.7, 0.8, 0.26 | 1.0, 0.31, 0.11 |
//!
//! A square grid fails where edges are along it, as in the kitchen. Points that are the same in all pixels make steps
//! where others make noise, and err less: one ray is a hard shadow, at 13.2, 16.8, 8.5 and 2.4 % where a random one
//! errs by 17.2, 21.4, 11.4 and 3.3. In the yard, 16 rays err by 0.26 % and the truth's jittered ones by 0.18: twelve
//! pixels there are dark from 0.38 mm over their surface, the truth's offset, and lit from 0.46 mm, this one's.

use antumbra::scene::Scene;
use antumbra::truth::Receiver;
use antumbra::{Error, RectangleLight};
use glam::DVec3;
use lanes::{Lanes, Portable};
use packet::{Points, Pyramid, Scratch};
use rayon::prelude::*;
use std::time::{Duration, Instant};
use tree::{ROUNDING, Tree};

mod cost;
mod lanes;
mod packet;
mod tree;

pub use cost::{CostNode, surface_area_cost};

/// The side of a tile in pixels: its rays are near each other, and one thread traces them.
const TILE: usize = 8;

/// The error of a receiver's position, in roundings of the largest coordinate: eight of a vertex transform and its
/// interpolation in f32, as the truth's offset has them; four of the tracer's own, to round the position and a corner
/// and to find the height over a plane.
const POSITION_ROUNDINGS: f64 = 8.0 + 4.0;

/// Offset over position error, as the truth's: a normal that leans 75° from the geometric one still moves the
/// point off its surface by a quarter.
const OFFSET_PER_ERROR: f64 = 4.0;

/// The counts of rays a pixel, and the step of the lattice of each. Of all steps tried it is the one with the least
/// mean error over the scenes of the table above.
const LATTICES: [(u32, u32); 4] = [(1, 1), (4, 3), (16, 7), (64, 19)];

/// The triangles of a scene that block light, for rays by the processor.
pub struct RayTracer {
    tree: Tree,
    build: Duration,
}

impl RayTracer {
    /// Builds the tree over the instances that block light (`Role::blocks`), on all cores.
    ///
    /// # Errors
    /// [`Error::Scene`] where an instance names a mesh or vertex that does not exist, or puts a vertex at a position
    /// that is not finite or beyond 10¹² m.
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        let started = Instant::now();
        let tree = Tree::new(scene)?;
        Ok(Self { tree, build: started.elapsed() })
    }

    /// The time that the tree took to build, from the scene's meshes on.
    pub fn build_time(&self) -> Duration {
        self.build
    }

    /// The number of triangles that block light; those without an area do not.
    pub fn triangles(&self) -> usize {
        self.tree.triangles
    }

    /// The distance in metres that a receiver is moved off its surface along its normal before its rays start; rays
    /// also end this far before the light's plane.
    ///
    /// It is derived as the truth's is (`antumbra::truth::Tracer::offset`), with the roundings of this tracer besides:
    /// about 3 µm a metre of the scene's extent. Where the light is has no part in it, since a triangle's place does
    /// not depend on it: a sun's rectangle may be 200 km away. `position_error` is how far in metres `position` may be
    /// off beyond what f32 arithmetic explains.
    pub fn offset(&self, position: DVec3, position_error: f64) -> f64 {
        let reach = self.tree.extent.max((position - self.tree.origin).abs().max_element());
        OFFSET_PER_ERROR * (POSITION_ROUNDINGS * ROUNDING * reach + position_error)
    }

    /// Whether a triangle crosses the segment between two points in world space, from either side.
    ///
    /// The segment and the triangles are rounded to f32 relative to the scene's centre. A segment in a triangle's plane
    /// sees it edge-on, and so does not cross it; nor does one with an end that is not finite.
    pub fn hit(&self, from: DVec3, to: DVec3) -> bool {
        if self.tree.nodes.is_empty() {
            return false;
        }
        let (from, along) = ((from - self.tree.origin).as_vec3(), (to - from).as_vec3());
        let mut scratch = Scratch::new(&self.tree);
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            // SAFETY: the processor has AVX2 and FMA.
            return unsafe { avx2::single(&self.tree, from, along, &mut scratch) };
        }
        packet::single::<Portable>(&self.tree, from, along, &mut scratch)
    }

    /// The visible fraction, 0..1, of each receiver of an image that is `width` pixels wide, on all cores: the share of
    /// `rays` points on the light, the same ones for all pixels, from which no triangle crosses the segment to the
    /// receiver.
    ///
    /// It is 1 without a normal, and at or behind the light's plane. `position_error` is as in [`Self::offset`].
    /// Equal inputs give equal bits, whatever the number of cores; processors with and without AVX2 round differently.
    ///
    /// # Errors
    /// [`Error::Setting`] where `rays` is not 1, 4, 16 or 64, or `position_error` is negative or not finite;
    /// [`Error::Frame`] where the receivers are not a multiple of `width`, or one's position or normal is not finite.
    pub fn visible_fractions(
        &self,
        light: &RectangleLight,
        receivers: &[Receiver],
        width: usize,
        rays: u32,
        position_error: f64,
    ) -> Result<Vec<f32>, Error> {
        check(receivers, width, position_error)?;
        let Some((_, step)) = LATTICES.into_iter().find(|lattice| lattice.0 == rays) else {
            let problem = format!("it must be 1, 4, 16 or 64 (it is {rays})");
            return Err(Error::Setting { key: "rays".into(), problem });
        };
        let image = Image {
            tracer: self,
            light: Light::of(light, self.tree.origin),
            receivers,
            width,
            position_error,
        };
        let mut visible = vec![1.0; receivers.len()];
        if self.tree.nodes.is_empty() {
            return Ok(visible);
        }
        // Each thread has a band of tiles, whose pixels are contiguous.
        let bands = visible.par_chunks_mut(TILE * width).enumerate();
        bands.for_each(|(band, out)| match rays {
            1 => image.band::<1, true>(&lattice(rays, step), band, out),
            4 => image.band::<1, false>(&lattice(rays, step), band, out),
            16 => image.band::<2, false>(&lattice(rays, step), band, out),
            _ => image.band::<8, false>(&lattice(rays, step), band, out),
        });
        Ok(visible)
    }

    /// The surface-area cost of the binary tree that the wide one was made of, whose leaves have up to eight triangles:
    /// what [`surface_area_cost`] says of it. 0 without triangles.
    pub fn tree_cost(&self) -> f64 {
        self.tree.binary.as_ref().map_or(0.0, cost::of_binary)
    }
}

fn check(receivers: &[Receiver], width: usize, position_error: f64) -> Result<(), Error> {
    if !(position_error >= 0.0 && position_error.is_finite()) {
        let problem = format!("it must be finite and at least 0 m (it is {position_error})");
        return Err(Error::Setting { key: "position_error".into(), problem });
    }
    if width == 0 || !receivers.len().is_multiple_of(width) {
        let count = receivers.len();
        return Err(Error::Frame(format!(
            "{count} receivers are no image of a width of {width} pixels"
        )));
    }
    let wrong = |r: &Receiver| !(r.position.is_finite() && r.normal.is_finite());
    match receivers.iter().position(wrong) {
        None => Ok(()),
        Some(i) => Err(Error::Frame(format!(
            "receiver {i} must have a finite position and normal (they are {} and {})",
            receivers[i].position, receivers[i].normal
        ))),
    }
}

/// The points (i + ½)/n, (i·step mod n + ½)/n of a light, as a rank-1 lattice: every one has a line and a column of n
/// to itself.
fn lattice<const K: usize>(n: u32, step: u32) -> Points<K> {
    let mut points = Points { at: [[[0.0; 8]; 2]; K], there: [0; K] };
    for i in 0..n {
        let (k, lane) = (i as usize / 8, i as usize % 8);
        let at = [i, i * step % n].map(|i| (2 * i + 1) as f32 / n as f32 - 1.0);
        points.at[k][0][lane] = at[0];
        points.at[k][1][lane] = at[1];
        points.there[k] |= 1 << lane;
    }
    points
}

/// A light relative to the tree's origin.
struct Light {
    center: DVec3,
    halves: [DVec3; 2],
    emission: DVec3,
}

impl Light {
    fn of(light: &RectangleLight, origin: DVec3) -> Self {
        let (axes, [width, height]) = (light.world_from_light(), light.half_extents());
        let halves = [DVec3::X * width, DVec3::Y * height].map(|half| axes.transform_vector3(half));
        Self { center: light.center() - origin, halves, emission: light.emission() }
    }
}

/// An image to be traced.
struct Image<'a> {
    tracer: &'a RayTracer,
    light: Light,
    receivers: &'a [Receiver],
    width: usize,
    position_error: f64,
}

impl Image<'_> {
    /// The rays of a pixel; nothing where the light does not shine on it.
    #[inline(always)]
    fn pyramid(&self, receiver: &Receiver) -> Option<Pyramid> {
        let normal = receiver.normal.try_normalize()?;
        let offset = self.tracer.offset(receiver.position, self.position_error);
        let from = receiver.position - self.tracer.tree.origin + normal * offset;
        let Light { center, halves, emission } = self.light;
        let distance = (from - center).dot(emission);
        if distance <= offset {
            return None;
        }
        // The rays end where they come within `offset` of the light's plane.
        let end = 1.0 - offset / distance;
        let halves = halves.map(|half| (half * end).as_vec3());
        Some(Pyramid { apex: from.as_vec3(), center: ((center - from) * end).as_vec3(), halves })
    }

    /// One ray by itself is faster through the tree than as a packet of one.
    fn band<const K: usize, const SINGLE: bool>(
        &self,
        points: &Points<K>,
        band: usize,
        out: &mut [f32],
    ) {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            // SAFETY: the processor has AVX2 and FMA.
            return unsafe { avx2::band::<K, SINGLE>(self, points, band, out) };
        }
        self.band_by::<Portable, K, SINGLE>(points, band, out);
    }

    #[inline(always)]
    fn band_by<V: Lanes, const K: usize, const SINGLE: bool>(
        &self,
        points: &Points<K>,
        band: usize,
        out: &mut [f32],
    ) {
        let tree = &self.tracer.tree;
        let receivers = &self.receivers[band * TILE * self.width..][..out.len()];
        let all = points.there.iter().map(|there| there.count_ones()).sum::<u32>() as f32;
        for left in (0..self.width).step_by(TILE) {
            // What was hit last is forgotten between tiles, so that no image depends on how tiles are shared out.
            let mut scratch = Scratch::new(tree);
            for top in (0..out.len()).step_by(self.width) {
                for i in top + left..top + (left + TILE).min(self.width) {
                    let Some(pyramid) = self.pyramid(&receivers[i]) else { continue };
                    out[i] = if SINGLE {
                        let hit =
                            packet::single::<V>(tree, pyramid.apex, pyramid.center, &mut scratch);
                        f32::from(u8::from(!hit))
                    } else {
                        packet::packet::<V, K>(tree, &pyramid, points, &mut scratch) as f32 / all
                    };
                }
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

/// What is compiled for AVX2 and FMA, with all that is inlined into it.
#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::lanes::Avx2;
    use super::packet::{self, Points, Scratch};
    use super::{Image, Tree};
    use glam::Vec3;

    #[target_feature(enable = "avx2,fma")]
    pub(super) fn band<const K: usize, const SINGLE: bool>(
        image: &Image,
        points: &Points<K>,
        band: usize,
        out: &mut [f32],
    ) {
        image.band_by::<Avx2, K, SINGLE>(points, band, out);
    }

    #[target_feature(enable = "avx2,fma")]
    pub(super) fn single(tree: &Tree, from: Vec3, along: Vec3, scratch: &mut Scratch) -> bool {
        packet::single::<Avx2>(tree, from, along, scratch)
    }
}

#[cfg(test)]
mod tests;
