//! What a frame's boxes and its camera tell: what of the technique is needed.

use super::boxes::Surroundings;
use super::check::bad;
use super::fit::Fit;
use super::rows::{Needs, PLACEHOLDER, Views};
use super::{Description, Frame};
use crate::Error;
use crate::effects::{Camera, Situation, Verdicts};
use crate::settings::{Settings, Technique};

/// What is needed of a frame whose meshes are fitted, and the views of the rows that run.
pub(super) fn look<'a>(
    description: &Description,
    frame: &Frame,
    fit: &'a mut Fit,
) -> Result<(Views<'a>, Verdicts), Error> {
    let settings = &description.settings;
    let texture = description.light_texture.is_some();
    let situation = seen(fit, frame, description.extent);
    let verdicts = Verdicts::judge(situation, settings, description.max_error, texture);
    let needs = Needs::of(description, fit.need, &verdicts);
    let is_soft = needs.technique.is_yes();
    let light_from_ndc = fit.light_from_world * frame.world_from_ndc;
    let ndc_from_light = light_from_ndc.inverse();
    let [from_ndc, from_light] = [light_from_ndc, ndc_from_light].map(|m| m.as_mat4());
    if !(from_ndc.is_finite() && from_light.is_finite()) {
        return bad(
            "world_from_ndc brings pixels further from the light, or nearer to each other, than \
             32-bit floats tell",
        );
    }
    let (behind, centre, host_maps) = (fit.behind, fit.centre, fit.host_maps);
    let receivers = Some(fit.shadowed.unwrap_or(PLACEHOLDER));
    let (points, lines) = match is_soft {
        true => fit.views(settings, frame)?,
        false => (&[][..], &[][..]),
    };
    let views = Views {
        points,
        lines,
        occluders: behind.filter(|_| is_soft).or(centre).unwrap_or(PLACEHOLDER),
        host_maps,
        receivers,
        needs,
        light_from_ndc: from_ndc.to_cols_array(),
        noise: frame.noise,
        ndc_from_light: from_light.to_cols_array(),
        background: frame.far_depth(),
    };
    Ok((views, verdicts))
}

/// A fit's situation with what the frame's pixels are to it; none where nothing can be shadowed.
fn seen(fit: &Fit, frame: &Frame, extent: [u32; 2]) -> Option<Situation> {
    let (Some(centre), Some(shadowed)) = (&fit.centre, &fit.shadowed) else { return None };
    let camera = Camera {
        light_from_world: fit.light_from_world,
        world_from_ndc: frame.world_from_ndc,
        extent,
    };
    let map = fit.behind.as_ref().unwrap_or(centre);
    Some(fit.situation?.seen_by(&camera, shadowed, map))
}

/// Looks at a light's frames for what no technique changes, in the same memory from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Looker {
    fit: Fit,
}

impl Looker {
    /// What a frame's boxes tell of it, as a soft shadow map would see it; none where nothing can be shadowed.
    ///
    /// # Errors
    /// As [`super::plan`], for what no technique takes.
    pub fn situation(
        &mut self,
        description: &Description,
        frame: &Frame,
        surroundings: &mut Surroundings,
    ) -> Result<Option<Situation>, Error> {
        // Every technique's own refusals are its own affair: hard takes any light.
        let settings = Settings { technique: Technique::Hard, ..Settings::default() };
        let map = description.settings.map;
        let settings = Settings {
            map: if frame.occluder_maps.is_some() { map } else { settings.map },
            ..settings
        };
        let frame = Frame { outline: None, ..*frame };
        frame.check_numbers(description, &settings)?;
        self.fit.update(description, &settings, &frame, surroundings)?;
        Ok(seen(&self.fit, &frame, description.extent))
    }
}

/// As [`Looker::situation`], of one frame alone.
///
/// # Errors
/// As that.
#[cfg(test)]
pub(crate) fn situation(
    description: &Description,
    frame: &Frame,
) -> Result<Option<Situation>, Error> {
    Looker::default().situation(description, frame, &mut Surroundings::default())
}
