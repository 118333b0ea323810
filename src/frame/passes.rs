//! The passes of a description, with one frame's numbers in them.

use super::{Description, Limits, Space};
use crate::Error;
use crate::RectangleLight;
use crate::audit::passes::{self as audit, Audited};
use crate::effects::{Effect, Verdicts};
use crate::graph::{Graph, Need, Owner, ResourceId, Why};
use crate::knob::MOST_VIEWS;
use crate::lent::TechniqueIndex;
use crate::stages::depth_layers::{self, Eye, HostMapView, LightLayers, MapView, Projection};
use crate::stages::hierarchy::{self, Sizes};
use crate::stages::views::inner::{self, Inner};
use crate::stages::views::{Served, Views};
use crate::stages::visibility::{self, Constants, GBuffer, NormalConstants};
use crate::techniques::hard::{self, Filter};
use crate::techniques::room::PassInputs;
use bytemuck::Zeroable;
use glam::DMat4;
use smallvec::SmallVec;

/// The resources of a frame's graph that the host needs to find again.
pub(super) struct Ids {
    pub depth: ResourceId,
    pub mask: Option<ResourceId>,
    pub normal: Option<ResourceId>,
    /// The buffer of the numbers that passes over the pixels read.
    pub constants: ResourceId,
    pub occluder_maps: [Option<ResourceId>; 2],
    pub light_texture: Option<ResourceId>,
    pub visibility: ResourceId,
}

impl Ids {
    /// The G-buffer's images and constants, which depend on the camera.
    pub fn pixels(&self) -> impl Iterator<Item = ResourceId> {
        [self.depth, self.constants].into_iter().chain(self.mask).chain(self.normal)
    }
}

/// A view for passes that do not run.
pub(super) const PLACEHOLDER: MapView =
    MapView { eye: Eye::Behind(0.0), min: [-1.0; 2], max: [1.0; 2], near: 1.0, far: 2.0, side: 16 };

/// One frame's numbers for its passes.
pub(super) struct FrameInputs<'a> {
    /// The light, by its half-extents in the space of its maps.
    pub light: &'a RectangleLight,
    /// The views of the occluder maps, one at least, which share the pixels; the finest first.
    pub occluders: &'a [Served],
    /// The technique's own views; there are none where nothing can be shadowed.
    pub views: &'a Views,
    pub host_maps: Option<HostMapView>,
    /// Whether the host draws some of the occluders.
    pub host_draws: bool,
    pub receivers: MapView,
    pub needs: Needs,
    pub constants: Constants,
    pub normals: Option<NormalConstants>,
    pub light_from_ndc: DMat4,
    pub ndc_from_light: DMat4,
    pub noise: u32,
    /// How far the light reaches, m.
    pub reach: Option<f64>,
    /// How many meshes textures cut out.
    pub cut_outs: u32,
    /// The sizes of the hierarchy, and how the pixels see its space.
    pub tree: (Sizes, Space),
}

/// Matrices from light space to the clip space of views.
pub(super) type Clips = SmallVec<[DMat4; MOST_VIEWS as usize]>;

/// Which passes a frame needs.
#[derive(Clone, Debug)]
pub(super) struct Needs {
    /// The technique's passes.
    pub technique: Need<Why>,
    /// The passes of a hard shadow in its place.
    pub hard: Need<Why>,
    /// The depth layer of the occluders' nearest faces, as the light's centre sees them.
    pub front: Need<Why>,
    /// The depth layer of their furthest back faces.
    pub back: Need<Why>,
    /// The depth layers of their nearest back faces and their furthest front faces.
    pub inner: Need<Why>,
    /// The noise filter.
    pub filter: Need<Why>,
}

/// Whether a hard shadow may replace the technique's penumbra. It cannot where the image holds a fraction for each
/// color, and need not where the technique works with the triangles, whose narrow shafts cost less than a map.
fn hardens(description: &Description) -> bool {
    let room = description.technique.room();
    room.shows().penumbra && !description.has_color() && !room.reads_triangles()
}

impl Needs {
    /// One need for all passes.
    fn all(need: &Need<Why>) -> Self {
        let need = *need;
        Self { technique: need, hard: need, front: need, back: need, inner: need, filter: need }
    }

    /// All needs, in the order of the fields.
    fn each(&self) -> [&Need<Why>; 6] {
        [&self.technique, &self.hard, &self.front, &self.back, &self.inner, &self.filter]
    }

    /// A bit for each field that is needed, the first field in bit 0.
    pub fn bits(&self) -> u8 {
        let each = self.each().into_iter().enumerate();
        each.fold(0, |bits, (i, need)| bits | u8::from(need.is_yes()) << i)
    }

    /// Why every pixel is lit; `None` where a technique or a hard shadow writes the pixels.
    pub fn unshadowed(&self) -> Option<&Why> {
        match (&self.technique, &self.hard) {
            (Need::No(why), Need::No(_)) => Some(why),
            _ => None,
        }
    }

    /// What a frame needs, from whether anything can be shadowed and the verdict on each effect.
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
        if !verdicts.needs(Effect::BackSide)
            && description.technique.room().maps().back_can_be_dropped
        {
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

impl FrameInputs<'_> {
    /// Whether the passes of a view need lent normals in another space than those before them: the passes of the widest
    /// view are the first.
    fn turns_normals(&self, view: usize) -> bool {
        self.occluders.get(view + 1).is_none_or(|before| before.aside != self.occluders[view].aside)
    }

    /// Matrices from light space to the clip space of each view of the occluders.
    pub fn occluder_clips(&self) -> Clips {
        match self.views.count() {
            0 => self.occluders.iter().map(Served::clip_from_light).collect(),
            _ => self.views.clips(),
        }
    }
}

/// The graph of every pass that any frame of this description may run; a node makes its objects for them.
pub(crate) fn all_passes(description: &Description, limits: Limits) -> Graph {
    let room = description.technique.room();
    let maps = room.maps();
    // Lent maps are those of one view.
    let side = if description.occluder_maps.is_some() { maps.side } else { maps.largest() };
    let view = MapView { side, ..PLACEHOLDER };
    let served = vec![Served::all(view); room.most_served() as usize];
    let texels = description.cut_outs.all_texels();
    let frame = FrameInputs {
        light: &RectangleLight::unit(),
        occluders: &served,
        views: &room.most_views(view),
        host_maps: description.occluder_maps.map(|_| HostMapView {
            view,
            flip: [false; 2],
            scale: 1.0,
            offset: 0.0,
            far_value: 0.0,
            near_value: 1.0,
            error: 0.0,
        }),
        host_draws: false,
        receivers: view,
        needs: Needs::all(&Need::Yes("nominal".into())),
        constants: Constants::zeroed(),
        normals: description.normals.map(|_| NormalConstants::zeroed()),
        light_from_ndc: DMat4::IDENTITY,
        ndc_from_light: DMat4::IDENTITY,
        noise: 0,
        reach: None,
        cut_outs: 0,
        tree: (
            Sizes { texels, capacity: description.capacity.triangles, ..Sizes::default() },
            Space::default(),
        ),
    };
    let mut graph = Graph::new();
    build(&mut graph, description, limits, &frame);
    graph
}

/// The graph of every pass that any frame may run, for each of the description's techniques.
pub(crate) fn all_graphs(description: &Description, limits: Limits) -> Result<Vec<Graph>, Error> {
    let of = |index| Ok(all_passes(&*description.choosing(TechniqueIndex(index as u32))?, limits));
    (0..description.all_techniques().count()).map(of).collect()
}

/// The graph of every pass that any frame of this description may run, on a GPU with the least sub-pixel precision that
/// Vulkan guarantees. The numbers in its push constants are placeholders.
pub fn full_graph(description: &Description) -> Graph {
    all_passes(description, Limits::default())
}

/// [`full_graph`] for a device of these limits.
pub fn full_graph_on(description: &Description, limits: Limits) -> Graph {
    all_passes(description, limits)
}

/// Adds the passes of a frame to an empty graph.
pub(super) fn build(
    graph: &mut Graph,
    description: &Description,
    limits: Limits,
    frame: &FrameInputs,
) -> Ids {
    let room = description.technique.room();
    let maps = room.maps();
    let ids = declare_host_images(graph, description);
    let Ids { depth, mask, normal, constants, occluder_maps: [front, back], .. } = ids;
    let (light_texture, visibility) = (ids.light_texture, ids.visibility);
    let extent = description.extent;
    let background = frame.constants.background;
    let gbuffer = GBuffer { depth, mask, normal, constants, extent, background };
    let needs = &frame.needs;
    let [need, hard, front_need, back_need, inner_need, filter] =
        &needs.each().map(|n| graph.need(n));
    // A hard shadow may stand in for the technique.
    let shadowed = if hard.is_yes() { hard } else { need };
    description.cut_outs.declare(graph, frame.cut_outs, shadowed);
    let count = frame.occluders.len();
    let side = frame.occluders[0].map.side;
    let one = graph.because("one view serves every receiver");
    let several = if count > 1 { *shadowed } else { Need::No(one) };
    // The host's pipelines leave out no faces.
    let middle = match inner_need {
        Need::Yes(_) if count == 1 => Need::No(one),
        Need::Yes(_) if frame.host_draws => {
            Need::No(graph.because("the host draws some of the occluders"))
        }
        need => *need,
    };
    let layers = LightLayers {
        occluders: match (front, &frame.host_maps) {
            (Some(front), Some(camera)) => depth_layers::Occluders::Maps { front, back, camera },
            _ => depth_layers::Occluders::Meshes,
        },
        view: 0,
        inner: None,
        needs: depth_layers::Needs {
            front: if maps.front_is_whole { front_need } else { need },
            back: back_need,
            inner: inner_need,
            middle: &middle,
            receivers: need,
        },
    };
    let color = description.has_color();
    let of_technique = room.reads_triangles();
    let tree = of_technique.then(|| hierarchy::declare(graph, frame.tree.0, shadowed));
    let inputs = PassInputs {
        light: frame.light,
        occluders: &frame.occluders[0].map,
        deepest: frame.occluders[0].deepest,
        view: 0,
        served: count as u32,
        receivers: &frame.receivers,
        views: frame.views,
        layers: &layers,
        gbuffer: &gbuffer,
        visibility,
        ndc_from_light: frame.ndc_from_light.as_mat4().to_cols_array(),
        noise: frame.noise,
        light_texture,
        color,
        snap: limits.subpixel_step,
        processor: limits.processor,
        depth_error: frame.host_maps.map_or(0.0, |m| m.error),
        need,
        filter,
        tree: &frame.tree,
        hierarchy: tree,
    };
    let nodes = (maps.eye == Projection::Centre && room.most_served() > 1 && room.nests())
        .then(|| inner::declare(graph, side));
    let declared = graph.declared();
    let is_centred = |map: &MapView| map.eye == Eye::Behind(0.0);
    // The widest view's passes are first: its maps tell what lies before the receivers of the finer ones.
    for (nth, view) in (0..count).rev().enumerate() {
        let served = &frame.occluders[view];
        let map = &served.map;
        let normals = frame.normals.as_ref().filter(|_| frame.turns_normals(view));
        let normals = normals.map(|normals| normals.seen_aside(served.aside));
        let of_view = frame.constants.for_view(view, count);
        let of_view = of_view.seen_aside(&frame.light_from_ndc, served);
        of_view.write(normals.as_ref(), graph, constants, shadowed);
        if room.most_served() > 1 {
            Constants::write_regions(graph, constants, (view, frame.occluders), &several);
        }
        if nth > 0 {
            graph.again(declared);
        }
        let finer = view.checked_sub(1).filter(|_| is_centred(map));
        let found = if finer.is_some() { *shadowed } else { Need::No(one) };
        let layers = LightLayers {
            view: view as u32,
            // A frame without a finer view declares the passes once, for the plan to name them.
            inner: nodes.filter(|_| finer.is_some() || nth == 0).map(|nodes| Inner {
                view: finer.unwrap_or(0) as u32,
                views: finer.map(|finer| [&frame.occluders[finer], served]),
                map,
                half: frame.light.half_extents(),
                nodes,
                constants,
                need: found,
            }),
            ..layers
        };
        let inputs = PassInputs {
            occluders: map,
            deepest: served.deepest,
            view: view as u32,
            layers: &layers,
            ndc_from_light: (frame.ndc_from_light * served.light_from_view())
                .as_mat4()
                .to_cols_array(),
            ..inputs
        };
        let nearest = room.declare(graph, &inputs);
        // A frame declares the hard shadow once where it is not needed, for the plan to name it.
        if hardens(description) && (nth == 0 || hard.is_yes()) {
            let map = || depth_layers::hard(graph, side, view as u32, hard);
            let front = nearest.unwrap_or_else(map);
            hard::declare(graph, front, Filter::One, hard, &inputs);
        }
    }
    graph.declares_anew();
    let lit = match needs.unshadowed() {
        Some(why) => Need::Yes(*why),
        None => Need::No("something can be shadowed, and is written elsewhere".into()),
    };
    let lit = graph.need(&lit);
    visibility::lit(graph, visibility, extent, color, lit);
    if description.audit > 0 {
        let tree = tree.unwrap_or_else(|| hierarchy::declare(graph, frame.tree.0, shadowed));
        let audited = Audited { pixels: description.audit, reach: frame.reach };
        audit::declare(graph, audited, &tree, &inputs, shadowed);
    }
    ids
}

/// Declares the images that node and host share: those the host lends, and the visibility image.
fn declare_host_images(graph: &mut Graph, description: &Description) -> Ids {
    let Description { extent, .. } = *description;
    let lent = Owner::Imported;
    let depth = graph.image("gbuffer.depth", description.depth_format, extent, lent);
    let mask =
        description.mask_format.map(|format| graph.image("gbuffer.mask", format, extent, lent));
    let normal = description.normals.map(|n| graph.image("gbuffer.normal", n.format, extent, lent));
    let constants = Constants::declare(graph);
    let maps = description.technique.room().maps();
    let mut map = |name| {
        let format = description.occluder_maps?;
        Some(graph.image(name, format, [maps.side; 2], lent))
    };
    let front = map("occluder_maps.front");
    let back = if maps.layers.back { map("occluder_maps.back") } else { None };
    // Its size may change from frame to frame, and no object depends on it.
    let light_texture =
        description.light_texture.map(|t| graph.image("light.texture", t.format, [1, 1], lent));
    let visibility =
        visibility::declare(graph, extent, description.has_color(), description.lent_visibility);
    let occluder_maps = [front, back];
    Ids { depth, mask, normal, constants, occluder_maps, light_texture, visibility }
}
