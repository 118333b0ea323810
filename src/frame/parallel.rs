//! The views of a sun, whose light is parallel: they follow what the camera sees.

use super::boxes::around;
use super::fit::Fit;
use super::request::FitRequest;
use super::seen::{Bounds, Frustum};
use super::{Description, Frame};
use crate::graph::Why;
use crate::knob::MOST_VIEWS;
use crate::lent::MeshInstance;
use crate::stages::views::{Extent, UnderSun, fit_sun};
use glam::{DMat4, DVec3};
use std::f64::consts::PI;

impl Fit {
    /// Fits the views of parallel light.
    pub(super) fn fit_parallel(
        &mut self,
        description: &Description,
        request: &FitRequest,
        frame: &Frame,
        half: f64,
    ) {
        let rectangle = frame.light.rectangle();
        self.follows_camera = request.most_served > 1;
        // The rectangle of a sun is as far away as its size says.
        let away = rectangle.half_extents()[0] / half;
        let [occluders, receivers] = &mut self.under_sun;
        for (to, from) in [(&mut *occluders, &self.occluders), (&mut *receivers, &self.receivers)] {
            to.clear();
            to.extend(from.boxes.iter().map(|b| b.moved(-away)));
        }
        let sun_from_world =
            DMat4::from_translation(DVec3::new(0.0, 0.0, -away)) * self.light_from_world;
        self.parts.clear();
        self.why_served = match request.most_served {
            1 => "no more are allowed",
            _ => "the camera is orthographic, and sees as much of what is near as of what is far",
        }
        .into();
        if let Some(frustum) =
            Frustum::new(&frame.world_from_ndc).filter(|_| request.most_served > 1)
        {
            let mut all = Bounds::NONE;
            occluders.iter().for_each(|b| {
                all.add(b.min);
                all.add(b.max);
            });
            let looked = Looked {
                frustum,
                sun_from_world: &sun_from_world,
                occluders: all,
                sizes: [request.maps.side, description.extent[0]],
                most: request.most_served,
            };
            let receivers = self.receivers.meshes(frame.meshes);
            self.why_served = parts_seen(&looked, receivers, &mut self.parts);
        }
        let maps = &request.maps;
        let under = UnderSun {
            half,
            occluders,
            receivers,
            parts: &self.parts,
            side: if self.parts.len() > 1 { maps.several } else { maps.side },
            receiver_side: maps.layers.receiver_map.unwrap_or(maps.side),
        };
        if let Some(views) = fit_sun(&under, &mut self.served) {
            self.alone = views.alone;
            self.receiver_view = views.receivers;
            self.space_from_world = DMat4::from_translation(-views.origin) * sun_from_world;
            // A square of the disc's area.
            let square = half * (0.25 * PI).sqrt();
            self.light = rectangle.with_half_extents([square; 2]);
            self.parallel = true;
        }
    }
}

/// How many times further the furthest part of a sun's view is than its nearest.
const DEEPER: f64 = 2.0;

/// The texel, over the pixel that looks at the nearest receiver, that is small enough.
const FINE_TEXEL: f64 = 1.5;

/// What the parts that a camera sees are found from.
struct Looked<'a> {
    frustum: Frustum,
    sun_from_world: &'a DMat4,
    /// The bounds of all occluders in the sun's space.
    occluders: Bounds,
    /// The side of a map in texels, and the image's width in pixels.
    sizes: [u32; 2],
    most: u32,
}

/// Finds the parts of the receivers that a camera sees, from the nearest on, in the sun's space; none where one view of
/// all is fine enough. Returns why there are so many.
fn parts_seen<'a>(
    looked: &Looked,
    receivers: impl Iterator<Item = &'a MeshInstance> + Clone,
    parts: &mut Vec<Extent>,
) -> Why {
    let Looked { frustum, sun_from_world, occluders, sizes: [side, width], most } = looked;
    let bounds_of = |mesh: &MeshInstance| {
        let [center, half] = around(mesh);
        Bounds { min: center - half, max: center + half }
    };
    let mut all = Bounds::NONE;
    for mesh in receivers.clone() {
        let of = bounds_of(mesh);
        all.add(of.min);
        all.add(of.max);
    }
    let furthest = frustum.furthest(&all);
    let mut nearest = f64::INFINITY;
    for mesh in receivers.clone() {
        let of = bounds_of(mesh);
        if frustum.nearest(&of) < nearest
            && let Some(distance) = frustum.distance(&of)
        {
            nearest = nearest.min(distance);
        }
    }
    // The eye is in every box, or sees none: what is near is not known.
    let nearest = if nearest.is_finite() { nearest } else { 0.01 * furthest };
    let nearest = nearest.max(1e-3 * furthest);
    if nearest <= 0.0 {
        return "the camera sees no receiver".into();
    }
    let pixel = nearest * frustum.pixel(*width);
    let why = Why::from("the nearest receiver that is seen is ").number(nearest, 2);
    let why = why.and(" m away, where a pixel is ").number(pixel, 4).and(" m wide");
    let texel_of = |shown: DVec3| shown.truncate().max_element().max(0.0) / f64::from(*side);
    let fine = |texel: f64| why.and(", and a texel of one view ").number(texel, 4).and(" m");
    let texel = texel_of(occluders.max - occluders.min);
    if texel <= FINE_TEXEL * pixel {
        return fine(texel);
    }
    let whole = frustum.slice(&all, [0.0, furthest], sun_from_world);
    let texel = texel_of(whole.max.min(occluders.max) - whole.min.max(occluders.min));
    if texel <= FINE_TEXEL * pixel {
        return fine(texel);
    }
    let deeper = (furthest / nearest).ln() / DEEPER.ln();
    let count = (deeper.ceil() as u32).clamp(1, *most);
    let ratio = (furthest / nearest).powf(1.0 / f64::from(count));
    let mut seen = [Bounds::NONE; MOST_VIEWS as usize];
    let ends: [f64; MOST_VIEWS as usize + 1] = std::array::from_fn(|nth| match nth as u32 {
        0 => 0.0,
        nth if nth == count => furthest,
        nth => nearest * ratio.powi(nth as i32),
    });
    let (seen, ends) = (&mut seen[..count as usize], &ends[..=count as usize]);
    frustum.slices(receivers.map(bounds_of), ends, sun_from_world, seen);
    parts.extend(seen.iter().filter(|seen| seen.is_some()).map(|seen| [seen.min, seen.max]));
    why.and(", and the furthest ").number(furthest, 0).and(" m")
}
