//! What a technique answers for itself.
//!
//! Each room implements [`Room`] on its own settings; frames, effects, `auto` and the device's checks query the value
//! and know no technique by name.

use crate::graph::{Graph, Need, ResourceId};
use crate::knob::Tune;
use crate::lent::MeshBounds;
use crate::light::{Light, RectangleLight};
use crate::stages::depth_layers::{self, DepthLayers, LightLayers, MapView, Projection, Wanted};
use crate::stages::views::Views;
use crate::stages::visibility::GBuffer;
use crate::{Error, graph};
use glam::DMat4;

/// What a host may give a light of these settings, beyond a rectangle and meshes in buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Takes {
    /// A light without a height.
    pub line: bool,
    /// A light whose outline is a polygon.
    pub outline: bool,
    /// Meshes that the host draws with its own pipelines.
    pub host_draws: HostDraws,
    /// Depth images of the occluders that the host drew, or why they are of no use.
    pub lent_maps: Result<(), &'static str>,
    /// A texture of the light's emission.
    pub texture: bool,
}

impl Takes {
    /// Rectangles, and whatever occluders the host has.
    pub const RECTANGLES: Self = Self {
        line: false,
        outline: false,
        host_draws: HostDraws::Any,
        lent_maps: Ok(()),
        texture: false,
    };
}

/// Which of a host's own draws a technique can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostDraws {
    /// All of them.
    Any,
    /// Receivers alone; the text ends a sentence that begins with "mesh n is drawn by the host, which".
    Receivers(&'static str),
    /// None; the text ends the same sentence.
    None(&'static str),
}

/// Which effects the settings have means for; see [`crate::effects::Effect`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shows {
    /// Soft shadows; without, every shadow is hard.
    pub penumbra: bool,
    /// The occluders' back faces.
    pub back_side: bool,
    /// Occluders behind other occluders.
    pub fusion: bool,
    /// Shadows of meshes on themselves.
    pub self_shadowing: bool,
    /// Slices of the occluders, and whether what ends within one is seen by the next; none without slices.
    pub slices: Option<bool>,
    /// A layer of what the eye sees, as a third depth map of the rays.
    pub eye_layer: bool,
    /// A filter of noise.
    pub noise: Noise,
}

/// What a technique does about noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// It makes none.
    None,
    /// Its filter is switched off.
    Unfiltered,
    /// Its filter acts on penumbrae wider than this, in pixels.
    FilteredFrom(f64),
}

impl Shows {
    /// A soft shadow of the nearest faces, which falls on what casts it too.
    pub const SOFT: Self = Self {
        penumbra: true,
        back_side: false,
        fusion: false,
        self_shadowing: true,
        slices: None,
        eye_layer: false,
        noise: Noise::None,
    };
}

/// The maps that settings have drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maps {
    /// The side of the technique's maps, texels.
    pub side: u32,
    /// The depth layers, and their sides.
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
            layers: Wanted { map: side, back: false, inner: false, receiver_map: None },
            eye: Projection::Centre,
            front_is_whole: true,
            back_can_be_dropped: false,
            receivers_in_views: false,
        }
    }

    /// No map from the light's centre: the technique has views of its own, of `side` texels.
    pub fn own_views(side: u32) -> Self {
        Self { front_is_whole: false, ..Self::front(side) }
    }
}

/// What views are fitted to.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The light.
    pub light: &'a RectangleLight,
    /// Its outline, where it is a polygon.
    pub outline: Option<&'a [[f64; 2]]>,
    /// The occluders' boxes.
    pub occluders: &'a [(MeshBounds, DMat4)],
    /// The receivers' boxes.
    pub receivers: &'a [(MeshBounds, DMat4)],
    /// How the light's centre sees the occluders.
    pub centre: &'a MapView,
    /// The w of the furthest receiver that may be shadowed, 1/m.
    pub w_far: f64,
}

/// What a frame gives a technique to declare its passes with.
#[derive(Clone, Copy)]
pub struct PassInputs<'a> {
    /// The light.
    pub light: &'a RectangleLight,
    /// How the occluder map looks at the scene.
    pub occluders: &'a MapView,
    /// How the receiver map does.
    pub receivers: &'a MapView,
    /// The technique's own views.
    pub views: &'a Views,
    /// How the depth layers are made.
    pub layers: &'a LightLayers<'a>,
    /// The host's pixels.
    pub gbuffer: &'a GBuffer,
    /// Where the result goes.
    pub visibility: ResourceId,
    /// Light space to the G-buffer's NDC, by column.
    pub ndc_from_light: [f32; 16],
    /// Moves noise from frame to frame.
    pub noise: u32,
    /// What the light emits over its surface; the same everywhere without.
    pub light_texture: Option<ResourceId>,
    /// Whether the visible fraction is one of red, green and blue each.
    pub color: bool,
    /// 2^−(sub-pixel bits): how far the device's rasters move a vertex, in texels.
    pub snap: f32,
    /// How far off the w of an occluder may be beyond its rounding, 1/m.
    pub depth_error: f64,
    /// Whether anything can be shadowed.
    pub need: &'a Need,
    /// Whether the noise filter is needed.
    pub filter: &'a Need,
}

impl PassInputs<'_> {
    /// Adds the passes that make depth layers.
    pub(crate) fn depth_layers(&self, graph: &mut Graph, wanted: Wanted) -> DepthLayers {
        depth_layers::declare(graph, wanted, self.layers)
    }
}

/// A technique by its settings.
pub trait Room: Tune + std::fmt::Debug {
    /// What a host may give a light.
    fn takes(&self) -> Takes;

    /// Which effects there are means for.
    fn shows(&self) -> Shows;

    /// The maps that are drawn.
    fn maps(&self) -> Maps;

    /// Adds the passes that write the visible fraction of a frame; the layer of the nearest faces, where
    /// [`Maps::front_is_whole`].
    fn declare(&self, graph: &mut Graph, inputs: &PassInputs) -> Option<ResourceId>;

    /// The views beyond those from the light's centre and from behind it.
    ///
    /// # Errors
    /// [`Error::Setting`] where a light takes more than there may be.
    fn views(&self, _seen: &Seen) -> Result<Views, Error> {
        Ok(Views::Centre)
    }

    /// As many views as a frame may have, for a node to make its objects by.
    fn most_views(&self, _view: MapView) -> Views {
        Views::Centre
    }

    /// The light with its axes as the technique wants them.
    fn turned(&self, light: &Light) -> Light {
        *light
    }

    /// Checks the knobs that must agree with each other.
    ///
    /// # Errors
    /// [`Error::Setting`] for the first that does not.
    fn check_agreement(&self) -> Result<(), Error> {
        Ok(())
    }

    /// Bytes of the largest buffer at a G-buffer of this extent, and what it holds, for the check against
    /// [`graph::STORAGE_BYTES`].
    fn pixel_list(&self, _extent: [u32; 2]) -> Option<(u64, &'static str)> {
        None
    }

    /// Whether the passes blend into 32-bit floats, which not every device can.
    fn blends_f32(&self) -> bool {
        false
    }
}

/// Checks a technique's ranges, and what must agree.
///
/// # Errors
/// [`Error::Setting`] for the first that is wrong.
pub(crate) fn check(room: &dyn Room) -> Result<(), Error> {
    room.check_ranges()?;
    room.check_agreement()
}

/// Whether what a technique lists of the pixels can be bound on every device.
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
