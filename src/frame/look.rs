//! What a frame's boxes tell: the maps' windows, and what of the technique is needed.

use super::plan::has_triangles;
use super::rows::{Needs, PLACEHOLDER, Views, wanted};
use super::{Description, Frame, MeshInstance};
use crate::Error;
use crate::baseline::many_lights;
use crate::depth_layers::{self, HostMapView};
use crate::graph::Need;
use crate::linear_light;
use crate::planner::{Seen, Situation, Verdicts};
use crate::ray_march::{self, Projection};
use crate::scene::Role;
use crate::settings::{Settings, Technique};

/// Fits the maps and says what is needed; keeps of `occluders` what the node draws.
pub(super) fn look(
    description: &Description,
    frame: &Frame,
    occluders: &mut Vec<MeshInstance>,
    receivers: &[MeshInstance],
) -> Result<(Views, Verdicts), Error> {
    let light = &frame.light;
    let settings = &description.settings;
    let boxes = |meshes: &[MeshInstance]| {
        meshes.iter().map(|m| (m.bounds, m.world_from_mesh)).collect::<Vec<_>>()
    };
    let receiver_boxes = boxes(receivers);
    let host_maps = match (&frame.occluder_maps, description.occluder_maps) {
        (Some(maps), Some(format)) => {
            Some(HostMapView::new(light, &maps.clip_from_world, settings.map, format)?)
        }
        _ => None,
    };
    let given = occluders.len();
    let fit = if let Some(maps) = &host_maps {
        occluders.clear();
        Some(maps.view)
    } else {
        occluders.retain(|m| {
            !depth_layers::is_aside(light, &(m.bounds, m.world_from_mesh), &receiver_boxes)
        });
        depth_layers::fit_occluders(light, &boxes(occluders), frame.window, settings.map)
    };
    let receiver_fit = fit.as_ref().and_then(|view| {
        let side = wanted(settings).receiver_map.unwrap_or(settings.map);
        depth_layers::fit_receivers(light, &receiver_boxes, view, side)
    });
    let need = match (&fit, &receiver_fit) {
        (None, _) if given == 0 => Need::No("there are no occluders".into()),
        (None, _) if occluders.is_empty() => {
            Need::No("every occluder is flat, with light and receivers on one side of it".into())
        }
        (None, _) => Need::No("every occluder lies behind the light".into()),
        (_, None) => Need::No("no receiver lies where an occluder could shadow it".into()),
        _ if host_maps.is_some() => Need::Yes(
            format!("the host's maps may shadow some of {} receiver meshes", receivers.len())
                .into(),
        ),
        _ => Need::Yes(
            format!(
                "{} of {given} occluder meshes can shadow some of {} receiver meshes",
                occluders.len(),
                receivers.len()
            )
            .into(),
        ),
    };
    // Ray marching and slices look from behind the light.
    let behind = match settings.technique {
        Technique::RayMarch
            if host_maps.is_none() && settings.ray_march.projection != Projection::Centre =>
        {
            ray_march::view(light, &boxes(occluders), settings.ray_march.projection, settings.map)
        }
        Technique::OcclusionTextures => {
            ray_march::view(light, &boxes(occluders), Projection::Behind, settings.map)
        }
        _ => None,
    };
    let situation = match (&need, &fit, &receiver_fit) {
        (Need::Yes(_), Some(fit), Some(shadowed)) => Some(Situation::of(&Seen {
            light,
            occluders,
            given,
            receivers,
            shadowed,
            map: behind.as_ref().unwrap_or(fit),
            world_from_ndc: &frame.world_from_ndc,
            extent: description.extent,
        })),
        _ => None,
    };
    let texture = description.light_texture.is_some();
    let verdicts = Verdicts::judge(situation, settings, description.max_error, texture);
    let needs = Needs::of(description, need, &verdicts);
    let is_soft = matches!(needs.technique, Need::Yes(_));
    let points = match settings.technique {
        Technique::ManyLights if is_soft => {
            let centre = fit.as_ref().unwrap_or(&PLACEHOLDER);
            let boxes = boxes(occluders);
            many_lights::points(light, frame.outline, &boxes, &settings.baseline, centre)
        }
        _ => Vec::new(),
    };
    let lines = match (settings.technique, &receiver_fit) {
        (Technique::LinearLight, Some(receivers)) if is_soft => {
            let seen = linear_light::Seen {
                light,
                outline: frame.outline,
                occluders: &boxes(occluders),
                receivers: &receiver_boxes,
                side: settings.map,
                w_far: 1.0 / receivers.far,
            };
            linear_light::lines(&settings.linear_light, &seen)?
        }
        _ => Vec::new(),
    };
    let light_from_ndc = light.light_from_world() * frame.world_from_ndc;
    let views = Views {
        points,
        lines,
        occluders: behind.filter(|_| is_soft).or(fit).unwrap_or(PLACEHOLDER),
        host_maps,
        receivers: Some(receiver_fit.unwrap_or(PLACEHOLDER)),
        needs,
        light_from_ndc: light_from_ndc.as_mat4().to_cols_array(),
        noise: frame.noise,
        ndc_from_light: light_from_ndc.inverse().as_mat4().to_cols_array(),
        background: frame.background,
    };
    Ok((views, verdicts))
}

/// What a frame's boxes tell of it, as a soft shadow map would see it; none where nothing can be shadowed.
///
/// # Errors
/// As [`super::plan`], for what no technique takes.
pub(crate) fn situation(
    description: &Description,
    frame: &Frame,
) -> Result<Option<Situation>, Error> {
    // Every technique's own refusals are its own affair: hard takes any light.
    let settings = Settings { technique: Technique::Hard, ..Settings::default() };
    let map = description.settings.map;
    let settings = Settings {
        map: if frame.occluder_maps.is_some() { map } else { settings.map },
        ..settings
    };
    let description = Description { settings, light_texture: None, ..description.clone() };
    let frame = Frame { outline: None, light_texture: None, settings_index: 0, ..*frame };
    frame.check(&description)?;
    let of_role = |keep: fn(Role) -> bool| {
        let kept = frame.meshes.iter().filter(move |m| keep(m.role) && has_triangles(m));
        kept.copied().collect::<Vec<_>>()
    };
    let receivers = of_role(Role::receives);
    let mut occluders = of_role(Role::blocks);
    let (_, verdicts) = look(&description, &frame, &mut occluders, &receivers)?;
    Ok(verdicts.situation().copied())
}
