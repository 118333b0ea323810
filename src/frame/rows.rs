//! Every row that a description calls for, with one frame's numbers in them.

use super::Description;
use crate::RectangleLight;
use crate::effects::{Effect, Verdicts};
use crate::graph::{Graph, Need, Owner, ResourceId, Why};
use crate::settings::{Settings, Technique};
use crate::stages::depth_layers::{self, Eye, HostMapView, MapView};
use crate::stages::visibility::{self, GBuffer};
use crate::techniques::common as baseline;
use crate::techniques::hard::{self, Filter};
use crate::techniques::many_lights::{self, LightPoint};
use crate::techniques::{back_projection, pcss};
use crate::techniques::{linear_light, occlusion_textures, ray_march, soft_shadow_map};
use glam::DMat4;
use smallvec::{SmallVec, smallvec};

/// What a device's limits mean to a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// 2^−(sub-pixel bits): how far rasters move a vertex, in texels.
    pub snap: f32,
}

impl Default for Limits {
    /// The least that Vulkan guarantees: 4 sub-pixel bits.
    fn default() -> Self {
        Self { snap: 1.0 / 16.0 }
    }
}

/// The resources of a frame's graph that the host needs to find again.
pub(super) struct Ids {
    pub depth: ResourceId,
    pub mask: Option<ResourceId>,
    pub occluder_maps: [Option<ResourceId>; 2],
    pub light_texture: Option<ResourceId>,
    pub visibility: ResourceId,
}

impl Ids {
    /// What the camera sees.
    pub fn pixels(&self) -> impl Iterator<Item = ResourceId> {
        std::iter::once(self.depth).chain(self.mask)
    }
}

/// A view for rows that do not run.
pub(super) const PLACEHOLDER: MapView =
    MapView { eye: Eye::Behind(0.0), min: [-1.0; 2], max: [1.0; 2], near: 1.0, far: 2.0, side: 16 };

/// What the rows depend on, beyond the description.
pub(super) struct Views<'a> {
    pub occluders: MapView,
    /// Those of many lights; empty for other techniques, and where nothing can be shadowed.
    pub points: &'a [LightPoint],
    /// Those of linear lights, as `points`.
    pub lines: &'a [linear_light::Line],
    pub host_maps: Option<HostMapView>,
    pub receivers: Option<MapView>,
    pub needs: Needs,
    pub light_from_ndc: [f32; 16],
    pub ndc_from_light: [f32; 16],
    pub noise: u32,
    pub background: f32,
}

/// Which rows a frame needs.
#[derive(Clone, Debug)]
pub(super) struct Needs {
    /// Those of the technique.
    pub technique: Need<Why>,
    /// A hard shadow in its place.
    pub hard: Need<Why>,
    /// The occluders' nearest faces, as the light's centre sees them.
    pub front: Need<Why>,
    /// Their furthest back faces.
    pub back: Need<Why>,
    /// Their nearest back faces and their furthest front faces.
    pub inner: Need<Why>,
    /// The noise filter.
    pub filter: Need<Why>,
}

/// Whether a hard shadow can stand for what a technique makes: its image holds one visible fraction a pixel.
fn hardens(description: &Description) -> bool {
    description.settings.technique != Technique::Hard && !description.has_color()
}

/// Whether the technique has a map of its own that shows the occluders' nearest faces from the light's centre.
fn has_front(technique: Technique) -> bool {
    match technique {
        Technique::SoftShadowMap
        | Technique::RayMarch
        | Technique::Pcss
        | Technique::BackProjection
        | Technique::Hard => true,
        Technique::OcclusionTextures | Technique::LinearLight | Technique::ManyLights => false,
    }
}

/// Whether the back layer is there for the occluders' back sides alone: slices are placed by it too, and a soft shadow
/// map of its own has rows for each side.
fn back_is_for_its_own_sake(settings: &Settings) -> bool {
    match settings.technique {
        Technique::SoftShadowMap => {
            settings.soft_shadow_map.receivers == soft_shadow_map::Receivers::Pixels
        }
        technique => technique == Technique::RayMarch,
    }
}

impl Needs {
    /// Everything but what stands for something else.
    fn all(need: &Need<Why>) -> Self {
        let need = *need;
        Self { technique: need, hard: need, front: need, back: need, inner: need, filter: need }
    }

    /// Each of them, in the order of the fields.
    fn each(&self) -> [&Need<Why>; 6] {
        [&self.technique, &self.hard, &self.front, &self.back, &self.inner, &self.filter]
    }

    /// A bit for each that is needed.
    pub fn bits(&self) -> u8 {
        let each = self.each().into_iter().enumerate();
        each.fold(0, |bits, (i, need)| bits | u8::from(need.is_yes()) << i)
    }

    /// By whether anything can be shadowed, and what of it matters.
    pub fn of(description: &Description, need: Need<Why>, verdicts: &Verdicts) -> Self {
        let mut needs = Self::all(&need);
        let Need::Yes(_) = &need else { return needs };
        let left_out = |effect: Effect| {
            let why =
                Why::from(effect.rule().name).and(", ≤ ").number(verdicts.of(effect).bound, 4);
            Need::No(why.and(": ").because(&verdicts.why(effect)))
        };
        let soft = verdicts.needs(Effect::Penumbra) || !hardens(description);
        if soft {
            needs.hard = Need::No("the penumbra is needed".into());
        } else {
            let why = left_out(Effect::Penumbra);
            return Self { hard: need, front: need, ..Self::all(&why) };
        }
        if !verdicts.needs(Effect::BackSide) && back_is_for_its_own_sake(&description.settings) {
            needs.back = left_out(Effect::BackSide);
        }
        if !verdicts.needs(Effect::Fusion) {
            needs.inner = left_out(Effect::Fusion);
        }
        if !verdicts.needs(Effect::Noise) {
            needs.filter = left_out(Effect::Noise);
        }
        needs
    }
}

impl Views<'_> {
    /// Light space to the clip space of each view of the occluders.
    pub fn occluder_clips(&self) -> SmallVec<[DMat4; 1]> {
        if !self.lines.is_empty() {
            self.lines.iter().map(linear_light::Line::line_from_light).collect()
        } else if !self.points.is_empty() {
            self.points.iter().map(LightPoint::clip_from_light).collect()
        } else {
            smallvec![self.occluders.clip_from_light()]
        }
    }
}

/// The layers that are drawn from the light's centre.
pub(super) fn wanted(settings: &Settings) -> depth_layers::Wanted {
    let map = settings.map;
    match settings.technique {
        Technique::SoftShadowMap => soft_shadow_map::wanted(&settings.soft_shadow_map, map),
        Technique::RayMarch => ray_march::wanted(&settings.ray_march, map),
        Technique::OcclusionTextures => {
            occlusion_textures::wanted(&settings.occlusion_textures, map)
        }
        Technique::Hard
        | Technique::Pcss
        | Technique::ManyLights
        | Technique::BackProjection
        | Technique::LinearLight => {
            depth_layers::Wanted { map, back: false, inner: false, receiver_map: None }
        }
    }
}

/// Every row that any frame of this description could run; what a node makes its objects from.
pub(crate) fn nominal(description: &Description, limits: Limits) -> Graph {
    let settings = &description.settings;
    let side = settings.map;
    let view = MapView { side, ..PLACEHOLDER };
    let points = match settings.technique {
        Technique::ManyLights => settings.baseline.samples,
        _ => 0,
    };
    let lines = match settings.technique {
        Technique::LinearLight => settings.linear_light.lines,
        _ => 0,
    };
    let points = vec![LightPoint { at: [0.0; 2], view }; points as usize];
    let lines = vec![linear_light::Line::NONE; lines as usize];
    let views = Views {
        occluders: view,
        points: &points,
        lines: &lines,
        host_maps: description.occluder_maps.map(|_| HostMapView {
            view,
            flip: [false; 2],
            scale: 1.0,
            offset: 0.0,
            far_value: 0.0,
            near_value: 1.0,
            error: 0.0,
        }),
        receivers: Some(view),
        needs: Needs::all(&Need::Yes("nominal".into())),
        light_from_ndc: DMat4::IDENTITY.as_mat4().to_cols_array(),
        ndc_from_light: DMat4::IDENTITY.as_mat4().to_cols_array(),
        noise: 0,
        background: 0.0,
    };
    let mut graph = Graph::new();
    build(&mut graph, description, limits, &RectangleLight::unit(), &views);
    graph
}

/// The graph of a description with every row that any of its frames could run; the numbers in its
/// push constants mean nothing.
pub fn full_graph(description: &Description) -> Graph {
    nominal(description, Limits::default())
}

/// Adds the rows of a frame to an empty graph.
pub(super) fn build(
    graph: &mut Graph,
    description: &Description,
    limits: Limits,
    light: &RectangleLight,
    views: &Views,
) -> Ids {
    let depth =
        graph.image("gbuffer.depth", description.depth_format, description.extent, Owner::Imported);
    let mask = description
        .mask_format
        .map(|format| graph.image("gbuffer.mask", format, description.extent, Owner::Imported));
    let settings = &description.settings;
    let wanted = wanted(settings);
    let map = |graph: &mut Graph, name| {
        description
            .occluder_maps
            .map(|format| graph.image(name, format, [settings.map; 2], Owner::Imported))
    };
    let front = map(graph, "occluder_maps.front");
    let back = if wanted.back { map(graph, "occluder_maps.back") } else { None };
    // Its size is the frame's to say; nothing is made from it.
    let light_texture = description
        .light_texture
        .map(|t| graph.image("light.texture", t.format, [1, 1], Owner::Imported));
    let color = description.has_color();
    let visibility =
        visibility::declare(graph, description.extent, color, description.lent_visibility);
    let gbuffer = GBuffer {
        depth,
        mask,
        extent: description.extent,
        light_from_ndc: views.light_from_ndc,
        background: views.background,
    };
    let occluders = match (front, &views.host_maps) {
        (Some(front), Some(camera)) => depth_layers::Occluders::Maps { front, back, camera },
        _ => depth_layers::Occluders::Meshes,
    };
    let snap = limits.snap;
    let depth_error = views.host_maps.map_or(0.0, |m| m.error);
    let needs = &views.needs;
    let [need, hard, front_need, back_need, inner, filter] = &needs.each().map(|n| graph.need(n));
    let baseline = baseline::Inputs {
        light,
        occluders: &views.occluders,
        gbuffer: &gbuffer,
        snap,
        depth_error,
        need,
    };
    let layer_needs = depth_layers::Needs {
        front: if has_front(settings.technique) { front_need } else { need },
        back: back_need,
        inner,
        receivers: need,
    };
    let layers = |graph: &mut Graph| depth_layers::declare(graph, wanted, &occluders, &layer_needs);
    let mut nearest = None;
    match settings.technique {
        Technique::SoftShadowMap => {
            let layers = layers(graph);
            nearest = Some(layers.front);
            let settings = &settings.soft_shadow_map;
            let inputs = soft_shadow_map::Inputs {
                light,
                occluders: &views.occluders,
                receivers: views.receivers.as_ref(),
                gbuffer: &gbuffer,
                snap,
                depth_error,
                need,
            };
            soft_shadow_map::declare(graph, &layers, visibility, settings, &inputs);
        }
        Technique::RayMarch => {
            let layers = layers(graph);
            nearest = Some(layers.front);
            let inputs = ray_march::Inputs {
                light,
                view: &views.occluders,
                gbuffer: &gbuffer,
                ndc_from_light: views.ndc_from_light,
                noise: views.noise,
                light_texture,
                color,
                snap,
                depth_error,
                need,
                filter,
            };
            ray_march::declare(graph, &layers, visibility, &settings.ray_march, &inputs);
        }
        Technique::OcclusionTextures => {
            let layers = settings.occlusion_textures.is_fitted().then(|| layers(graph));
            let inputs = occlusion_textures::Inputs {
                light,
                view: &views.occluders,
                gbuffer: &gbuffer,
                need,
            };
            let settings = &settings.occlusion_textures;
            occlusion_textures::declare(graph, layers.as_ref(), visibility, settings, &inputs);
        }
        Technique::LinearLight => {
            let inputs = linear_light::Inputs {
                lines: views.lines,
                side: settings.map,
                w_far: views.receivers.map_or(0.0, |r| 1.0 / r.far),
                gbuffer: &gbuffer,
                snap,
                need,
            };
            linear_light::declare(graph, visibility, &settings.linear_light, &inputs);
        }
        Technique::Hard => {
            let front = layers(graph).front;
            hard::declare(graph, front, visibility, Filter::Three, &baseline);
        }
        Technique::Pcss => {
            let front = *nearest.insert(layers(graph).front);
            let settings = &settings.baseline;
            pcss::declare(graph, front, visibility, settings, &baseline);
        }
        Technique::BackProjection => {
            let front = *nearest.insert(layers(graph).front);
            back_projection::declare(graph, front, visibility, &baseline);
        }
        Technique::ManyLights => {
            many_lights::declare(graph, visibility, views.points, &baseline);
        }
    }
    if hardens(description) {
        let front = nearest.unwrap_or_else(|| depth_layers::hard(graph, settings.map, hard));
        let inputs = baseline::Inputs { need: hard, ..baseline };
        hard::declare(graph, front, visibility, Filter::One, &inputs);
    }
    let lit = match (&needs.technique, &needs.hard) {
        (Need::No(why), Need::No(_)) => Need::Yes(*why),
        _ => Need::No("something can be shadowed, and is written elsewhere".into()),
    };
    let lit = graph.need(&lit);
    visibility::lit(graph, visibility, description.extent, color, lit);
    Ids { depth, mask, occluder_maps: [front, back], light_texture, visibility }
}
