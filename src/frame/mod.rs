//! What the host says each frame, and the plan that follows from it. No Vulkan calls.

mod accesses;
mod boxes;
mod camera;
mod check;
mod doubts;
mod draws;
mod fit;
mod hull;
mod images;
mod keep;
mod left;
mod look;
mod make;
mod plan;
mod plans;
mod rows;
#[cfg(test)]
mod tests;

pub use accesses::{BufferAccess, HostAccess, ImageBarrier, NodeUse};
pub(crate) use boxes::Surroundings;
pub use doubts::Doubt;
pub use draws::{Faces, MeshDraw};
pub(crate) use left::{Left, Whose};
pub(crate) use look::Looker;
#[cfg(test)]
pub(crate) use look::situation;
pub(crate) use make::{Memory, Workspace, plan_into};
pub use make::{plan, plan_all};
pub use plan::FramePlan;
pub(crate) use plan::Stamp;
pub use plans::FramePlans;
pub(crate) use rows::nominal;
pub use rows::{Limits, full_graph};

use crate::graph::{self, Scope};
use crate::lent::{BorderBarriers, HostImage, MeshInstance, OccluderMaps, Visibility};
use crate::plain::Matrix;
use crate::settings::{Settings, Technique};
use crate::techniques::ray_march;
use crate::{Error, RectangleLight};
use ash::vk;
use glam::DMat4;
use std::borrow::Cow;

/// The most settings that a node may have: [`Description::settings`] and its others.
pub(crate) const MOST_SETTINGS: usize = 8;

/// What stays the same from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// The G-buffer's width and height in pixels, 1 to 16384.
    pub extent: [u32; 2],
    /// The technique and its knobs.
    pub settings: Settings,
    /// What leaving an effect out may add to the mean error at most, 0 to 1, as a mean of visible fractions over the
    /// pixels that shadow touches: see [`crate::effects::RULES`]. 1/256 by default, a step of an 8-bit image; 0 leaves
    /// out what cannot matter and nothing else; none leaves out nothing, for studying what it costs.
    pub max_error: Option<f64>,
    /// Further settings that a frame may choose ([`Frame::settings_index`]), up to 7: another technique
    /// or another resolution for some of the lights. Each has pipelines, maps and buffers of its own,
    /// which its lights share.
    pub other_settings: Vec<Settings>,
    /// How many lights there are, 1 to 64: each has its frames ([`Frame::light_index`]), and a layer of
    /// the node's own visibility image, which is an array where there are several.
    pub lights: u32,
    /// How many frames may be recorded before the first of them is done, 1 to 8.
    pub frames_in_flight: u32,
    /// The format of the G-buffer's depth image.
    pub depth_format: vk::Format,
    /// The format of the mask, where there is one.
    pub mask_format: Option<vk::Format>,
    /// Lets the node's own images be copied out, for tests and debuggers; off by default.
    pub inspect: bool,
    /// Every distance between positions, in bytes, that a mesh may have; 12 is tightly packed.
    pub position_strides: Vec<u32>,
    /// The host lends the visibility image each frame ([`Visibility::Lent`]); otherwise the node has
    /// one of its own.
    pub lent_visibility: bool,
    /// The format of the occluder maps that the host draws itself and lends each frame
    /// ([`Frame::occluder_maps`]); without, the node draws meshes.
    pub occluder_maps: Option<vk::Format>,
    /// What the light's emission looks like, lent each frame ([`Frame::light_texture`]); without, it is
    /// the same all over the light. `ray-march` alone weighs it.
    pub light_texture: Option<LightTexture>,
}

/// An image of what a light emits over its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightTexture {
    /// The image's format: one whose components a shader reads as numbers from 0 up. Red, green and blue
    /// are linear.
    pub format: vk::Format,
    /// Whether the visible fraction is one of red, green and blue each, in an image of
    /// R32G32B32A32_SFLOAT; otherwise it is one of luminance.
    pub color: bool,
}

impl Description {
    /// Whether the visible fraction is one of each color.
    pub(crate) fn has_color(&self) -> bool {
        self.light_texture.is_some_and(|t| t.color)
    }

    /// All settings that a frame may choose, [`Self::settings`] first.
    pub fn all_settings(&self) -> impl Iterator<Item = &Settings> {
        std::iter::once(&self.settings).chain(&self.other_settings)
    }

    /// The same with one of its settings alone.
    pub(crate) fn choosing(&self, settings_index: u32) -> Result<Cow<'_, Self>, Error> {
        if settings_index == 0 {
            return Ok(Cow::Borrowed(self));
        }
        let settings = *self.all_settings().nth(settings_index as usize).ok_or_else(|| {
            Error::Frame(format!(
                "settings {settings_index} do not exist; the description has {}, counted from 0",
                1 + self.other_settings.len()
            ))
        })?;
        Ok(Cow::Owned(Self { settings, other_settings: Vec::new(), ..self.clone() }))
    }

    /// The default settings for one light, a D32_SFLOAT G-buffer without a mask, two frames in flight
    /// and tightly packed positions.
    pub fn new(extent: [u32; 2]) -> Self {
        Self {
            extent,
            settings: Settings::default(),
            max_error: Some(1.0 / 256.0),
            other_settings: Vec::new(),
            lights: 1,
            frames_in_flight: 2,
            depth_format: vk::Format::D32_SFLOAT,
            mask_format: None,
            inspect: false,
            position_strides: vec![12],
            lent_visibility: false,
            occluder_maps: None,
            light_texture: None,
        }
    }

    /// # Errors
    /// [`Error::Setting`] or [`Error::Frame`] for the first thing out of its range.
    pub fn check(&self) -> Result<(), Error> {
        if self.other_settings.len() >= MOST_SETTINGS {
            return Err(Error::Frame(format!(
                "{} other settings are more than the 7 that a node may have",
                self.other_settings.len()
            )));
        }
        if !(1..=64).contains(&self.lights) {
            return Err(Error::Frame(format!(
                "a node is for 1 to 64 lights, not for {}; more take another node",
                self.lights
            )));
        }
        self.all_settings().try_for_each(|settings| self.check_settings(settings))?;
        if self.extent.iter().any(|e| !(1..=16384).contains(e)) {
            let [w, h] = self.extent;
            return Err(Error::Frame(format!(
                "a G-buffer of {w}×{h} pixels is outside 1×1 to 16384×16384"
            )));
        }
        if let Some(most) = self.max_error.filter(|most| !(0.0..=1.0).contains(most)) {
            return Err(Error::Frame(format!(
                "max_error is {most}, and must be 0 to 1: a mean of visible fractions"
            )));
        }
        if !(1..=8).contains(&self.frames_in_flight) {
            return Err(Error::Frame(format!(
                "frames_in_flight is {}, and must be 1 to 8",
                self.frames_in_flight
            )));
        }
        let formats = [Some(self.depth_format), self.occluder_maps];
        for (format, whose) in
            formats.into_iter().zip(["the G-buffer's depth", "the occluder maps'"])
        {
            if let Some(format) = format.filter(|&f| !graph::is_depth_format(f)) {
                return Err(Error::Frame(format!("{whose} format {format:?} holds no depth")));
            }
        }
        let color = [self.mask_format, self.light_texture.map(|t| t.format)];
        for (format, whose) in color.into_iter().zip(["the mask's", "the light texture's"]) {
            if let Some(format) = format.filter(|&f| !graph::is_color_format(f)) {
                return Err(Error::Frame(format!(
                    "{whose} format {format:?} holds no color that a shader reads as floats"
                )));
            }
        }
        match self.position_strides.iter().find(|&&s| s < 12 || s % 4 != 0 || s > 2048) {
            Some(s) => Err(Error::Frame(format!(
                "a position stride of {s} bytes does not work; three floats take 12, and strides \
                 are multiples of 4 up to 2048"
            ))),
            None => Ok(()),
        }
    }

    /// Whether one of the settings works, alone and with the rest.
    fn check_settings(&self, settings: &Settings) -> Result<(), Error> {
        settings.check()?;
        if self.occluder_maps.is_some() && settings.technique == Technique::ManyLights {
            return Err(Error::Frame(
                "many-lights sees the occluders from points all over the light, and occluder maps \
                 from its centre alone; lend meshes, or choose another technique"
                    .into(),
            ));
        }
        if self.occluder_maps.is_some() && settings.technique == Technique::LinearLight {
            return Err(Error::Frame(
                "linear-light sees the occluders from points all along the light, and occluder maps from \
                 its centre alone; lend meshes, or choose another technique"
                    .into(),
            ));
        }
        if self.occluder_maps.is_some() && settings.technique == Technique::OcclusionTextures {
            return Err(Error::Frame(
                "occlusion-textures sorts every face of the occluders into slices, and occluder maps hold \
                 two of them; lend meshes, or choose another technique"
                    .into(),
            ));
        }
        if settings.technique == Technique::RayMarch
            && ray_march::list_bytes(self.extent) > graph::STORAGE_BYTES
        {
            let [w, h] = self.extent;
            return Err(Error::Frame(format!(
                "ray-march keeps a list of pixels that for {w}×{h} takes more than the 128 MiB that \
                 every device binds; up to 11 million pixels work"
            )));
        }
        if self.light_texture.is_some() && settings.technique != Technique::RayMarch {
            return Err(Error::Frame(format!(
                "{} does not weigh what the light emits where; choose ray-march, or leave \
                 light_texture out",
                settings.technique.name()
            )));
        }
        Ok(())
    }
}

/// One frame, as the host sees it; [`Frame::new`] fills in what most frames leave out.
///
/// | convention | |
/// |---|---|
/// | matrices | for column vectors: a point is `matrix * (x, y, z, 1)`; arrays hold column behind column |
/// | world | right-handed, metres; any space that light, meshes and camera share |
/// | pixels | ndc y runs down, −1 at the first row; a host's that runs up: `inverse(projection * view) * scale(1, -1, 1)` |
/// | depth | 0 to 1 either way, perspective or orthographic, far plane finite or infinite |
/// | camera | the matrix that the G-buffer was drawn with, its jitter included |
/// | front faces | their corners run counter-clockwise |
/// | bounds | `[least, largest]` corners, f32, before the transform; transforms are f64 |
/// | light | shines along `half_v × half_u`; [`RectangleLight::facing`] takes the direction |
///
/// What contradicts them is refused by [`plan`], or is one of [`FramePlan::doubts`].
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The light.
    pub light: RectangleLight,
    /// Which of the description's lights it is, 0 and up. Each has frames of its own, recorded in the
    /// order in which they were planned; where a light casts no shadow in them they cost nothing.
    pub light_index: u32,
    /// Which of the description's settings this frame uses: 0 is [`Description::settings`], n the nth of
    /// [`Description::other_settings`].
    pub settings_index: u32,
    /// The polygon that the light has instead of its rectangle: 3 to 16 corners in light space, as x and y in
    /// metres from the rectangle's centre, within it, counter-clockwise as seen from the side that the light
    /// shines to. It need not be convex, and neither touches nor crosses itself.
    /// [`RectangleLight::around`] makes both of a polygon in the world. None: the whole rectangle.
    /// `linear-light` and `many-lights` take one.
    pub outline: Option<&'a [[f64; 2]]>,
    /// How far the light reaches from its centre, metres above 0: the host takes nothing of it for what is further away.
    /// Receivers beyond that need no shadow and occluders beyond cast none, so that neither is looked at. None:
    /// everywhere.
    pub reach: Option<f64>,
    /// Normalized device coordinates and depth to world space, for column vectors: `inverse(projection * view)`.
    ///
    /// The first row of pixels lies at y = −1, as Vulkan has it; where a host's y runs up (wgpu, or a
    /// viewport of negative height), it is `inverse(projection * view) * scale(1, -1, 1)`. "World" is whatever space the light
    /// and the meshes' transforms are in: a host that keeps its numbers relative to the camera gives
    /// all of them so.
    pub world_from_ndc: DMat4,
    /// The depth of pixels that show no surface: 0 with reversed depth, else 1. None: the end of depth that lies further
    /// from the eye, as [`Self::world_from_ndc`] has it. An orthographic camera has no eye, so it must be given there.
    pub background: Option<f32>,
    /// Everything that blocks light or shows shadows.
    pub meshes: &'a [MeshInstance],
    /// The G-buffer's depth, with SAMPLED usage.
    pub depth: HostImage,
    /// Roles by pixel: red 1 blocks and receives, ½ receives only, 0 receives nothing. With SAMPLED
    /// usage.
    pub mask: Option<HostImage>,
    /// Where the result goes.
    pub visibility: Visibility,
    /// The host's own depth images of the occluders, exactly where the description has a format for
    /// them. [`Self::meshes`] then only says where receivers are.
    pub occluder_maps: Option<OccluderMaps>,
    /// What the light emits over its surface, exactly where the description has a texture: of any size,
    /// its first row where the light's second half-axis points, its last column where the first one does.
    /// With SAMPLED usage.
    pub light_texture: Option<HostImage>,
    /// Least and largest tangent (u, v) of the occluder map; none fits it to the occluders. The
    /// technique `many-lights` fits each of its maps, and `ray-march` its map unless `projection=centre`,
    /// whatever this says.
    pub window: Option<[[f64; 2]; 2]>,
    /// Moves the noise of `ray-march`: added to the technique's seed. A number that is another one each
    /// frame lets what is behind average over frames; 0 keeps the noise where it is.
    pub noise: u32,
    /// The host's number for the light and the meshes as they stand to each other: geometry, transforms, roles, what
    /// it lends of them, [`Self::reach`] and [`Self::window`]. As long as it gives the same one, what the node has made
    /// of them is kept. None: everything may have changed. What a frame makes counts as made once it is recorded: it
    /// must be submitted, and before what is recorded after it.
    pub revision: Option<u64>,
    /// The same for what the pixels show: camera and G-buffer, [`Self::noise`], and who uses the result how. With both
    /// numbers as they were in the frame before, a visibility image of the node's own stays as it is and no pass runs.
    pub view_revision: Option<u64>,
    /// Which of the frames in flight this is, 0 and up. The frame that last had the same number
    /// must be done before this one is recorded.
    pub slot: u32,
    /// Who places the barriers at the border.
    pub border_barriers: BorderBarriers,
}

impl<'a> Frame<'a> {
    /// A frame of light 0 with the first settings, the whole rectangle, the far depth that the matrix has, no mask, the node's own
    /// visibility image sampled by fragment and compute shaders, a fitted window, slot 0, and barriers placed by the node.
    pub fn new(
        light: RectangleLight,
        world_from_ndc: impl Into<Matrix>,
        meshes: &'a [MeshInstance],
        depth: HostImage,
    ) -> Self {
        let sampled = Scope {
            stage: vk::PipelineStageFlags::FRAGMENT_SHADER | vk::PipelineStageFlags::COMPUTE_SHADER,
            ..Scope::FRAGMENT_SAMPLED
        };
        Self {
            light,
            light_index: 0,
            settings_index: 0,
            outline: None,
            reach: None,
            world_from_ndc: world_from_ndc.into().0,
            background: None,
            meshes,
            depth,
            mask: None,
            visibility: Visibility::Own { before: sampled, after: sampled },
            occluder_maps: None,
            light_texture: None,
            window: None,
            noise: 0,
            revision: None,
            view_revision: None,
            slot: 0,
            border_barriers: BorderBarriers::Node,
        }
    }
}
