//! The visible fraction by rays through a bounding volume hierarchy.
//!
//! The triangles are f64 and so is the test against them. f32 would not do: the plane of a long
//! thin triangle is known only to 2⁻²⁴ × length² / width, and a floor made of such triangles would
//! shadow itself.

use super::blockers::{Blockers, Cut, F32_ROUNDING, PAD_ROUNDINGS};
use crate::scene::{OpacityMap, Scene};
use crate::{Error, Light, Shape};
use glam::DVec3;
use obvhs::ray::Ray;
use rayon::prelude::*;

mod sampling;
pub use sampling::Sampling;
use sampling::Stream;
pub(super) use sampling::check_position_error;
mod target;
use target::LightFrame;

/// A point whose visible fraction of the light is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// World space, metres.
    pub position: DVec3,
    /// The surface's normal in world space, towards the viewer; any length. The zero vector marks
    /// a pixel that shows no receiver (background, or a mesh that is only an occluder): v is 1.
    pub normal: DVec3,
}

/// The visible fraction of one receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The visible fraction v, 0..1.
    pub visible: f64,
    /// Half the difference between two independent estimates, whose mean is `visible`. Its square
    /// is an unbiased estimate of the variance of `visible`, but one of a single degree of
    /// freedom: average it over many receivers. NaN in the penumbra of a single grid
    /// ([`Sampling::one_grid`]), which has nothing to differ from.
    pub half_difference: f64,
}

/// The visible fractions of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// v of each receiver, 0..1, in the order they were given.
    pub visible: Vec<f32>,
    /// The standard error of one penumbra pixel: the root of the mean square of
    /// [`Estimate::half_difference`] over the receivers for which rays were both blocked and not.
    /// 0 where there are none, NaN where it cannot be estimated ([`Sampling::one_grid`]).
    pub noise: f64,
    /// The number of receivers that `noise` is the mean over.
    pub penumbra: usize,
    /// The number of rays of all receivers.
    pub rays: u64,
}

/// The blocking triangles of a scene, for visible fractions by tracing rays.
pub struct Tracer {
    blockers: Blockers<Triangle>,
    /// What cuts triangles out.
    opacity_maps: Vec<OpacityMap>,
}

impl Tracer {
    /// Builds the hierarchy over the instances that block light ([`crate::scene::Role::blocks`]).
    ///
    /// # Errors
    /// [`Error::Scene`] where an instance names a mesh or vertex that does not exist, or puts a
    /// vertex at a position that is not finite (or beyond 10¹⁸ m).
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        let opacity_maps = scene.opacity_maps.clone();
        Ok(Self { blockers: Blockers::new(scene, Triangle::new)?, opacity_maps })
    }

    /// The distance that a receiver is moved off its surface along its normal, in metres, before its rays
    /// start; rays also end this far before the light.
    ///
    /// It is derived: four times the sum of the error that f32 gives a position whose coordinates
    /// are as large as the scene's and of what `sampling` says of these positions
    /// ([`Sampling::with_position_error`]); about 2 µm a metre of the scene's extent. Rays that
    /// leave below the surface then hit it: where the surface blocks light, the part of the light
    /// under its horizon is hidden, as it should be; where it is only a receiver, it is not.
    pub fn offset(&self, light: impl Into<Light>, position: DVec3, sampling: &Sampling) -> f64 {
        let light = light.into();
        // A sun has no position, which could be the largest coordinate.
        let is_sun = matches!(light.shape(), Shape::Sun { .. });
        let far = if is_sun { position } else { light.center() };
        self.blockers.offset(far, position, sampling.position_error())
    }

    /// The visible fraction from one receiver: the share of stratified points on the light from
    /// which no blocking triangle crosses the segment to the receiver. A triangle that an opacity map cuts out blocks
    /// where the map says so; what lets a part of the light through lets that part of the segment through, and several
    /// behind each other the product of their parts. The table in [`crate::truth`] says which points
    /// a light of any shape has.
    ///
    /// `stream` picks the random numbers, with the sampling's seed: receivers of one image take
    /// their index, so that their errors are independent.
    ///
    /// # Errors
    /// [`Error::Frame`] where the position or normal is not finite.
    pub fn visible_fraction(
        &self,
        light: impl Into<Light>,
        receiver: &Receiver,
        sampling: &Sampling,
        stream: u64,
    ) -> Result<Estimate, Error> {
        let light = light.into();
        self.of_receiver(&light, &self.frame(&light), receiver, sampling, stream)
    }

    fn frame(&self, light: &Light) -> LightFrame {
        LightFrame::of(light, self.blockers.origin, self.blockers.extent)
    }

    fn of_receiver(
        &self,
        light: &Light,
        frame: &LightFrame,
        receiver: &Receiver,
        sampling: &Sampling,
        stream: u64,
    ) -> Result<Estimate, Error> {
        if !(receiver.position.is_finite() && receiver.normal.is_finite()) {
            return Err(Error::Frame(format!(
                "receiver {stream} must have a finite position and normal (they are {} and {})",
                receiver.position, receiver.normal
            )));
        }
        let unshadowed = Estimate { visible: 1.0, half_difference: 0.0 };
        let Some(normal) = receiver.normal.try_normalize() else { return Ok(unshadowed) };
        let offset = self.offset(light, receiver.position, sampling);
        let from = receiver.position - self.blockers.origin + normal * offset;
        let Some(target) = frame.target(from, offset) else { return Ok(unshadowed) };
        let mut random = Stream::new(sampling.seed(), stream);
        let mut last_hit = None;
        let rays = target.rays(sampling.side());
        let mut grid = || {
            let seen: f64 = target
                .strata(sampling.side(), &mut random)
                .map(|to| self.passes(from, (to - from) * target.end, &mut last_hit))
                .sum();
            seen / f64::from(rays)
        };
        let a = grid();
        if light.shape() == Shape::Point {
            return Ok(Estimate { visible: a, half_difference: 0.0 });
        }
        if sampling.grids() == 1 {
            return Ok(Estimate { visible: a, half_difference: f64::NAN });
        }
        let b = grid();
        Ok(Estimate { visible: (a + b) / 2.0, half_difference: (a - b) / 2.0 })
    }

    /// The visible fraction from each receiver, on all cores.
    ///
    /// Equal inputs give equal bits, whatever the number of cores.
    ///
    /// # Errors
    /// [`Error::Frame`] where a position or normal is not finite.
    pub fn visible_fractions(
        &self,
        light: impl Into<Light>,
        receivers: &[Receiver],
        sampling: &Sampling,
    ) -> Result<Traced, Error> {
        let light = light.into();
        let frame = self.frame(&light);
        let is_point = light.shape() == Shape::Point;
        let estimates = receivers
            .par_iter()
            .enumerate()
            .map(|(i, receiver)| self.of_receiver(&light, &frame, receiver, sampling, i as u64))
            .collect::<Result<Vec<_>, _>>()?;
        // Summed in order: a parallel sum would depend on how the work was split.
        let (mut squares, mut penumbra) = (0.0, 0_u32);
        for estimate in estimates.iter().filter(|e| e.visible > 0.0 && e.visible < 1.0) {
            squares += estimate.half_difference.powi(2);
            penumbra += 1;
        }
        Ok(Traced {
            visible: estimates.iter().map(|e| e.visible as f32).collect(),
            noise: if sampling.grids() == 1 && !is_point {
                f64::NAN
            } else {
                (squares / f64::from(penumbra.max(1))).sqrt()
            },
            penumbra: penumbra as usize,
            rays: receivers.len() as u64 * if is_point { 1 } else { sampling.rays() },
        })
    }

    /// The part of the light that comes through along the segment from `from` to `from + along`: 0 where a whole triangle
    /// crosses it.
    ///
    /// The triangle that blocked the receiver's last ray is tested first: any blocker will do, and
    /// neighbouring rays mostly share theirs.
    fn passes(&self, from: DVec3, along: DVec3, last_hit: &mut Option<usize>) -> f64 {
        let Blockers { triangles, tree: Some(tree), .. } = &self.blockers else { return 1.0 };
        if last_hit.is_some_and(|i| triangles[i].crosses(from, along).is_some()) {
            return 0.0;
        }
        let length = along.length();
        // The tree's reciprocals have an absolute floor, made for unit directions.
        let ray = Ray::new(
            from.as_vec3a(),
            (along / length).as_vec3a(),
            0.0,
            (length * (1.0 + PAD_ROUNDINGS * F32_ROUNDING)) as f32,
        );
        let (mut hit, mut passes) = (None, 1.0);
        tree.ray_traverse_miss(ray, |_, leaf| {
            let i = tree.primitive_indices[leaf] as usize;
            if let Some(shares) = triangles[i].crosses(from, along) {
                match &triangles[i].cut {
                    None => hit = Some(i),
                    Some(cut) => passes *= 1.0 - self.opacity(cut, shares),
                }
            }
            if hit.is_some() || passes == 0.0 { 0.0 } else { f32::INFINITY }
        });
        *last_hit = hit.or(*last_hit);
        if hit.is_some() { 0.0 } else { passes }
    }

    /// The opacity of a triangle at these shares of its second and third corner.
    fn opacity(&self, cut: &Cut, [u, v]: [f64; 2]) -> f64 {
        let [a, b, c] = cut.places;
        let place = a * (1.0 - u - v) + b * u + c * v;
        self.opacity_maps.get(cut.map).map_or(1.0, |map| map.at(place.into()))
    }
}

/// A triangle in the form its crossing test wants (Möller and Trumbore 1997).
#[derive(Clone, Copy)]
struct Triangle {
    corner: DVec3,
    edges: [DVec3; 2],
    normal: DVec3,
    /// What says where it stops light; `None` where all of it does.
    cut: Option<Cut>,
}

impl Triangle {
    fn new([a, b, c]: [DVec3; 3], cut: Option<Cut>) -> Self {
        let edges = [b - a, c - a];
        Self { corner: a, edges, normal: edges[0].cross(edges[1]), cut }
    }

    /// Where the segment from `from` to `from + along` meets the triangle, from either side: the shares of its second and
    /// third corner.
    fn crosses(&self, from: DVec3, along: DVec3) -> Option<[f64; 2]> {
        let facing = self.normal.dot(along);
        let sign = if facing < 0.0 { -1.0 } else { 1.0 };
        let (facing, to_corner) = (facing.abs(), (self.corner - from) * sign);
        let moment = along.cross(to_corner);
        let u = -moment.dot(self.edges[1]);
        let v = moment.dot(self.edges[0]);
        let t = self.normal.dot(to_corner);
        // A segment in the triangle's plane sees it edge-on.
        (facing > 0.0 && u >= 0.0 && v >= 0.0 && u + v <= facing && t >= 0.0 && t <= facing)
            .then(|| [u / facing, v / facing])
    }
}

#[cfg(test)]
mod tests;
