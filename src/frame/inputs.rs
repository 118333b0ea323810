//! The numbers of a frame's passes and the effects it needs, made from a fit and the camera; and the situation of a
//! light before a technique is chosen.

use super::boxes::MeshBoxes;
use super::check::bad;
use super::fit::Fit;
use super::passes::{FrameInputs, Needs};
use super::request::FitRequest;
use super::triangles::TriangleList;
use super::{CutOutList, Description, Frame};
use crate::Error;
use crate::effects::{Camera, Situation, Verdicts};
use crate::lent::Normals;
use crate::stages::views::Views;
use crate::stages::visibility::{self, Constants, NormalConstants};
use crate::techniques::room::{Maps, Shapes, Takes};
use glam::DMat3;
use std::slice;

/// The inputs of a frame's passes, and the verdict on each effect.
///
/// # Errors
/// [`Error::Frame`] for a camera that 32-bit floats cannot hold in light space; [`Error::Setting`] where the technique
/// allows fewer views than the light takes.
pub(super) fn frame_inputs<'a>(
    description: &Description,
    frame: &Frame,
    fit: &'a mut Fit,
    triangles: &TriangleList,
    cut_outs: &CutOutList,
) -> Result<(FrameInputs<'a>, Verdicts), Error> {
    let room = description.technique.room();
    let texture = description.light_texture.is_some();
    let situation = situation_seen(fit, frame, description.extent);
    let verdicts = Verdicts::judge(situation, room, description.omit.most(), texture);
    let needs = Needs::of(description, fit.need, &verdicts);
    let is_soft = needs.technique.is_yes();
    let light_from_ndc = fit.space_from_world * frame.world_from_ndc;
    let ndc_from_light = light_from_ndc.inverse();
    let [from_ndc, from_light] = [light_from_ndc, ndc_from_light].map(|m| m.as_mat4());
    if !(from_ndc.is_finite() && from_light.is_finite()) {
        return bad(
            "world_from_ndc brings pixels further from the light, or nearer to each other, than \
             32-bit floats tell",
        );
    }
    let turned = DMat3::from_mat4(fit.space_from_world) * frame.world_from_normal;
    let from_normal = [turned.x_axis, turned.y_axis, turned.z_axis];
    if is_soft {
        fit.find_views(room, frame)?;
    }
    let fit = &*fit;
    let (host_maps, receivers) = (fit.host_maps, fit.receiver_view);
    let served = &fit.served[..];
    let views = if is_soft { fit.views() } else { &Views::Centre };
    // A hard shadow stands in for penumbrae that are too narrow to matter, and has one view. A point has no others, so that
    // its hard shadow is seen through the technique's views.
    let occluders = match served.is_empty() || !(is_soft || needs.hard.is_yes() && fit.is_point()) {
        true => slice::from_ref(&fit.alone),
        false => served,
    };
    let inputs = FrameInputs {
        light: &fit.light,
        views,
        occluders,
        host_maps,
        host_draws: fit.host_draws,
        receivers,
        needs,
        constants: Constants {
            light_from_ndc: from_ndc.to_cols_array(),
            plane_to_normal: visibility::plane_to_normal(
                &light_from_ndc,
                &ndc_from_light,
                description.extent,
                frame.far_depth(),
            ),
            extent: description.extent.map(|e| e as i32),
            background: frame.far_depth(),
            flags: i32::from(description.mask_format.is_some())
                | Normals::code(description.normals) << 1
                | i32::from(fit.parallel) << 4,
        },
        normals: description.normals.map(|_| NormalConstants {
            light_from_normal: from_normal.map(|c| c.as_vec3().extend(0.0).to_array()),
        }),
        noise: frame.noise,
        light_from_ndc,
        ndc_from_light,
        reach: frame.reach,
        cut_outs: cut_outs.records.len() as u32,
        tree: (triangles.sizes, triangles.space(frame, description)),
    };
    Ok((inputs, verdicts))
}

/// A fit's situation with the sizes of the frame's pixels added; `None` where nothing can be shadowed.
fn situation_seen(fit: &Fit, frame: &Frame, extent: [u32; 2]) -> Option<Situation> {
    let (Some(centre), Some(shadowed)) = (&fit.centre, &fit.shadowed) else { return None };
    let camera = Camera {
        light_from_world: fit.light_from_world,
        world_from_ndc: frame.world_from_ndc,
        extent,
    };
    let map = fit.served.last().map_or(centre, |served| &served.map);
    Some(fit.situation?.seen_by(&camera, shadowed, map))
}

/// The side of the map, in texels, for which a situation is described before a technique is chosen.
const SITUATION_MAP: u32 = 256;

/// The technique's name in errors while none is chosen.
const ANY: &str = "auto";

/// Describes the situation of a light's frames before a technique is chosen; keeps the fit of the meshes while their
/// revision stays.
#[derive(Clone, Debug, Default)]
pub(crate) struct SituationCache {
    fit: Fit,
}

impl SituationCache {
    /// The situation of a frame, seen from the light's centre; `None` where nothing can be shadowed.
    ///
    /// # Errors
    /// [`Error::Frame`] for a frame that every technique refuses; see [`super::plan`].
    pub fn situation(
        &mut self,
        description: &Description,
        frame: &Frame,
        mesh_boxes: &mut MeshBoxes,
    ) -> Result<Option<Situation>, Error> {
        // What the technique accepts is checked once it is chosen.
        let shapes = Shapes::LINES.and(Shapes::POLYGONS).and(Shapes::DISCS);
        let takes = Takes { shapes, ..Takes::RECTANGLES };
        frame.check_numbers(description, ANY, &takes)?;
        let side = match frame.occluder_maps {
            Some(_) => description.technique.map(),
            None => SITUATION_MAP,
        };
        let request = FitRequest {
            technique: None,
            takes,
            maps: Maps::front(side),
            most_served: 1,
            parallel: false,
            nests: false,
        };
        let frame = Frame { light: (*frame.light.rectangle()).into(), ..*frame };
        self.fit.update(description, &request, &frame, mesh_boxes)?;
        Ok(situation_seen(&self.fit, &frame, description.extent))
    }
}

/// The situation of a single frame; see [`SituationCache::situation`].
///
/// # Errors
/// See [`SituationCache::situation`].
#[cfg(test)]
pub(crate) fn situation(
    description: &Description,
    frame: &Frame,
) -> Result<Option<Situation>, Error> {
    SituationCache::default().situation(description, frame, &mut MeshBoxes::default())
}
