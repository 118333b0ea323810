//! The trait that each technique implements on its settings.
//!
//! Each room implements [`Room`] on its own settings; frames, effects, `auto` and the device's checks query that value
//! and never match on a technique's name.

use crate::frame::Space;
use crate::graph::{Graph, Need, ResourceId};
use crate::knob::Tune;
use crate::lent::MeshBounds;
use crate::light::{Light, RectangleLight, Shape};
use crate::stages::depth_layers::{self, DepthLayers, LightLayers, MapView, Projection, Wanted};
use crate::stages::hierarchy::{Hierarchy, Sizes};
use crate::stages::views::{Served, Views};
use crate::stages::visibility::GBuffer;
use crate::{Error, graph};
use glam::DMat4;

/// The inputs that a technique accepts with these settings, beyond a rectangle and meshes in buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Takes {
    /// The shapes that the light may have.
    pub shapes: Shapes,
    /// Which meshes the host may draw with its own pipelines.
    pub host_draws: HostDraws,
    /// Whether the host may lend its own depth images of the occluders; the error is the reason why not.
    pub lent_maps: Result<(), &'static str>,
    /// Whether the light's emission may be a texture.
    pub texture: bool,
}

impl Takes {
    /// The capabilities of a technique for rectangles, suns and points that shine to one side alone, with any occluders that the host has.
    pub const RECTANGLES: Self = Self {
        shapes: Shapes::RECTANGLES,
        host_draws: HostDraws::Any,
        lent_maps: Ok(()),
        texture: false,
    };
}

/// A set of shapes of lights. Rectangles, suns and points that shine to one side are in each, for every technique takes
/// these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shapes(u8);

impl Shapes {
    /// Rectangles, suns and points that shine to one side alone.
    pub const RECTANGLES: Self = Self(0);
    /// Lines, beside those, as in all of the following.
    pub const LINES: Self = Self(1);
    /// Polygons.
    pub const POLYGONS: Self = Self(1 << 1);
    /// Discs.
    pub const DISCS: Self = Self(1 << 2);
    /// Spheres.
    pub const SPHERES: Self = Self(1 << 3);
    /// Capsules.
    pub const CAPSULES: Self = Self(1 << 4);
    /// Points that shine to all sides.
    pub const POINTS: Self = Self(1 << 5);
    /// Every shape.
    pub const ALL: Self = Self((1 << 6) - 1);

    /// The shapes of both sets.
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether a light's shape is in the set.
    pub fn hold(self, light: &Light) -> bool {
        let one = match light.shape() {
            Shape::Rectangle | Shape::Sun { .. } => Self::RECTANGLES,
            Shape::Point if light.is_one_sided() => Self::RECTANGLES,
            Shape::Line => Self::LINES,
            Shape::Polygon(_) => Self::POLYGONS,
            Shape::Disc { .. } => Self::DISCS,
            Shape::Sphere { .. } => Self::SPHERES,
            Shape::Capsule { .. } => Self::CAPSULES,
            Shape::Point => Self::POINTS,
        };
        self.and(one) == self
    }
}

/// Which of a host's own draws a technique can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostDraws {
    /// The technique can use all of them.
    Any,
    /// The technique can use draws of receivers alone; the text ends a sentence that begins with "mesh n is drawn by
    /// the host, which".
    Receivers(&'static str),
    /// The technique can use none; the text ends that sentence.
    None(&'static str),
}

/// Which effects a technique shows with these settings; see [`crate::effects::Effect`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shows {
    /// Whether shadows have a penumbra; without one every shadow is hard.
    pub penumbra: bool,
    /// Whether the occluders' back faces cast shadows.
    pub back_side: bool,
    /// Whether occluders behind other occluders cast shadows.
    pub fusion: bool,
    /// Whether meshes cast shadows on themselves.
    pub self_shadowing: bool,
    /// None without slices of the occluders; with slices, whether an occluder that ends within one is also seen by the
    /// next.
    pub slices: Option<bool>,
    /// Whether the rays read a third depth map, of what the eye sees.
    pub eye_layer: bool,
    /// Whether meshes that let a part of the light through cast the shadow of that part.
    pub translucent: bool,
    /// The technique's treatment of noise.
    pub noise: Noise,
}

/// How a technique treats noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// The technique makes no noise.
    None,
    /// The technique makes noise, and its filter is switched off.
    Unfiltered,
    /// The technique's filter acts on penumbrae wider than this, in pixels.
    FilteredFrom(f64),
}

impl Shows {
    /// Soft shadows of the nearest faces, which also fall on the casting mesh.
    pub const SOFT: Self = Self {
        penumbra: true,
        back_side: false,
        fusion: false,
        self_shadowing: true,
        slices: None,
        eye_layer: false,
        translucent: true,
        noise: Noise::None,
    };
}

/// The usual side of the maps of several views, texels.
const VIEWED: u32 = 512;

/// The maps that a technique needs with these settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maps {
    /// The side of the technique's maps, texels.
    pub side: u32,
    /// Their side where several views share the receivers, texels.
    pub several: u32,
    /// The depth layers to draw, and their sides.
    pub layers: Wanted,
    /// Where the occluders are seen from, unless the host lends maps.
    pub eye: Projection,
    /// Whether the front layer shows the nearest faces at full size, so that a hard shadow can be drawn with it.
    pub front_is_whole: bool,
    /// Whether the back layer shows the occluders' back sides and nothing else, so that it can be left out with them.
    pub back_can_be_dropped: bool,
    /// Whether receivers are drawn in every view of the occluders.
    pub receivers_in_views: bool,
}

impl Maps {
    /// The nearest faces from the light's centre, in a map of `side` texels.
    pub fn front(side: u32) -> Self {
        Self {
            side,
            several: side,
            layers: Wanted { back: false, inner: false, middle: false, receiver_map: None },
            eye: Projection::Centre,
            front_is_whole: true,
            back_can_be_dropped: false,
            receivers_in_views: false,
        }
    }

    /// The nearest faces from the light's centre, in maps of `map` texels. Where that is 0 they have `usual` texels, and
    /// `VIEWED` where several of up to `views` views share the receivers: what one view does not show finely enough.
    pub fn by_views(map: u32, usual: u32, views: u32) -> Self {
        match map {
            0 if views > 1 => Self { several: usual.max(VIEWED), ..Self::front(usual) },
            0 => Self::front(usual),
            _ => Self::front(map),
        }
    }

    /// The sides of the maps of one view and of several, texels.
    pub fn sides(&self) -> [u32; 2] {
        [self.side, self.several]
    }

    /// The side of the images that hold the maps of any frame, texels.
    pub fn largest(&self) -> u32 {
        self.side.max(self.several)
    }

    /// The maps of a technique that has views of its own, of `side` texels, instead of a map from the light's centre.
    pub fn own_views(side: u32) -> Self {
        Self { front_is_whole: false, ..Self::front(side) }
    }
}

/// The scene as a technique's views are fitted to it.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The light's rectangle.
    pub light: &'a RectangleLight,
    /// The light's shape.
    pub shape: Shape<'a>,
    /// The occluders' boxes with their transforms to world space.
    pub occluders: &'a [(MeshBounds, DMat4)],
    /// The receivers' boxes with their transforms to world space.
    pub receivers: &'a [(MeshBounds, DMat4)],
    /// The view of the occluders from the light's centre.
    pub centre: &'a MapView,
    /// The views that share the pixels where the light is parallel, the finest first; none for a lamp.
    pub(crate) parallel: &'a [Served],
    /// The w of the furthest receiver that may be shadowed, 1/m.
    pub w_far: f64,
}

/// The inputs with which a technique declares a frame's passes.
#[derive(Clone, Copy)]
pub struct PassInputs<'a> {
    /// The light.
    pub light: &'a RectangleLight,
    /// The occluder map's view.
    pub occluders: &'a MapView,
    /// The furthest distance at which an occluder may shadow a receiver that the view serves, metres, counted as `near`
    /// and `far` of the view.
    pub deepest: f64,
    /// The number of that view, of those that share the pixels.
    pub view: u32,
    /// How many views share the pixels.
    pub served: u32,
    /// The receiver map's view.
    pub receivers: &'a MapView,
    /// The technique's own views.
    pub views: &'a Views,
    /// The sources and needs of the depth layers.
    pub layers: &'a LightLayers<'a>,
    /// The host's G-buffer.
    pub gbuffer: &'a GBuffer,
    /// The image that receives the visible fraction.
    pub visibility: ResourceId,
    /// Light space to the G-buffer's NDC, by column.
    pub ndc_from_light: [f32; 16],
    /// A number that changes the noise from frame to frame.
    pub noise: u32,
    /// The texture of the light's emission; without one the light emits evenly.
    pub light_texture: Option<ResourceId>,
    /// Whether the visible fraction has red, green and blue each.
    pub color: bool,
    /// 2^−(sub-pixel bits): how far the device's rasters move a vertex, in texels.
    pub snap: f32,
    /// Whether the device is a processor: see [`Limits`](crate::frame::Limits).
    pub processor: bool,
    /// The error of an occluder's w beyond its rounding, 1/m.
    pub depth_error: f64,
    /// Whether anything can be shadowed.
    pub need: &'a Need,
    /// Whether the noise filter is needed.
    pub filter: &'a Need,
    /// The sizes of the hierarchy of blocking triangles, and how the pixels see its space.
    pub tree: &'a (Sizes, Space),
    /// That hierarchy, where the technique works with the triangles.
    pub hierarchy: Option<Hierarchy>,
}

impl PassInputs<'_> {
    /// Adds the passes that make depth layers, of `side` texels a side.
    pub(crate) fn depth_layers(&self, graph: &mut Graph, wanted: Wanted, side: u32) -> DepthLayers {
        depth_layers::declare(graph, wanted, side, self.layers)
    }
}

/// A technique, by its settings.
pub trait Room: Tune + std::fmt::Debug {
    /// Which lights, draws, maps and textures a host may give.
    fn takes(&self) -> Takes;

    /// Which effects the technique shows.
    fn shows(&self) -> Shows;

    /// The maps that must be drawn.
    fn maps(&self) -> Maps;

    /// Adds the passes that write a frame's visible fraction. It returns the layer of the nearest faces, where
    /// [`Maps::front_is_whole`].
    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId>;

    /// The technique's own views, beyond those from the light's centre and from behind it.
    ///
    /// # Errors
    /// [`Error::Setting`] where a light needs more views than the settings allow.
    fn views(&self, _seen: &Seen) -> Result<Views, Error> {
        Ok(Views::Centre)
    }

    /// As many views as a frame may have; they size the node's objects.
    fn most_views(&self, _view: MapView) -> Views {
        Views::Centre
    }

    /// The most views from behind the light or from its centre that may share the pixels. The passes of
    /// [`Self::declare`] run for each of them, on the same resources.
    fn most_served(&self) -> u32 {
        1
    }

    /// Whether several views may share the pixels of a lamp too, and not of a sun alone.
    fn nests(&self) -> bool {
        true
    }

    /// Whether the technique's passes take a sun's light as parallel, through views of its own; otherwise a sun is a
    /// rectangle far away.
    fn takes_parallel(&self) -> bool {
        false
    }

    /// The light with its axes turned as the technique needs them.
    fn turned(&self, light: &Light) -> Light {
        *light
    }

    /// Checks the knobs that must agree with each other.
    ///
    /// # Errors
    /// [`Error::Setting`] for the first knob that does not agree.
    fn check_agreement(&self) -> Result<(), Error> {
        Ok(())
    }

    /// The bytes of the largest buffer for a G-buffer of this extent, and a name for its contents, which are checked
    /// against [`graph::STORAGE_BYTES`].
    fn pixel_list(&self, _extent: [u32; 2]) -> Option<(u64, &'static str)> {
        None
    }

    /// Whether the technique works with the blocking triangles themselves.
    fn reads_triangles(&self) -> bool {
        false
    }

    /// Whether the passes blend into 32-bit floats, which some devices cannot.
    fn blends_f32(&self) -> bool {
        false
    }
}

/// Checks a technique's ranges, and the knobs that must agree.
///
/// # Errors
/// [`Error::Setting`] for the first wrong knob.
pub(crate) fn check(room: &dyn Room) -> Result<(), Error> {
    room.check_ranges()?;
    room.check_agreement()
}

/// Checks that the largest list of a technique's pixels can be bound on every device.
///
/// # Errors
/// [`Error::Frame`] where it is too large.
pub(crate) fn check_extent(room: &dyn Room, extent: [u32; 2]) -> Result<(), Error> {
    match room.pixel_list(extent) {
        Some((bytes, most)) if bytes > graph::STORAGE_BYTES => {
            let [w, h] = extent;
            Err(Error::Frame(format!(
                "{} keeps a list of pixels that for {w}×{h} takes more than the 128 MiB that \
                 every device binds; {most}",
                room.name()
            )))
        }
        _ => Ok(()),
    }
}
