//! What the host says each frame, and the plan that follows from it. No Vulkan calls.

mod accesses;
mod boxes;
mod cache;
mod camera;
mod check;
mod doubts;
mod draws;
mod fit;
mod hull;
mod images;
mod inputs;
mod make;
mod odd;
mod passes;
mod plan;
mod plans;
mod reuse;
#[cfg(test)]
mod tests;

pub use accesses::{BufferAccess, HostAccess, ImageBarrier, NodeUse};
pub(crate) use boxes::MeshBoxes;
pub(crate) use cache::{Cache, CacheKey};
pub use doubts::Doubt;
pub use draws::{Faces, MeshDraw};
pub(crate) use inputs::SituationCache;
#[cfg(test)]
pub(crate) use inputs::situation;
pub(crate) use make::{Memory, Workspace, plan_into};
pub use make::{plan, plan_all};
pub(crate) use passes::all_passes;
pub use passes::{Limits, full_graph};
pub use plan::FramePlan;
pub(crate) use plan::Stamp;
pub use plans::FramePlans;

use crate::Error;
use crate::effects::Omit;
use crate::graph::{self, Scope};
use crate::lent::{
    BorderBarriers, HostImage, LightIndex, MeshInstance, OccluderMaps, Slot, TechniqueIndex,
    Visibility,
};
use crate::light::Light;
use crate::plain::Matrix;
use crate::technique::Technique;
use crate::techniques::room;
use ash::vk;
use glam::DMat4;
use std::borrow::Cow;

/// The most techniques that a node may have: [`Description::technique`] and the others.
pub(crate) const MOST_TECHNIQUES: usize = 8;

/// What stays the same from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// The G-buffer's width and height in pixels, 1 to 16384.
    pub extent: [u32; 2],
    /// The technique and its settings.
    pub technique: Technique,
    /// Which effects may be left out where they hardly matter; those that add less than 1/256 by default.
    pub omit: Omit,
    /// Further techniques that a frame may choose ([`Frame::technique_index`]), up to 7: for some of the lights another
    /// one, or the same with other settings. Each has pipelines, maps and buffers of its own, which its lights share.
    pub other_techniques: Vec<Technique>,
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

    /// All techniques that a frame may choose, [`Self::technique`] first.
    pub fn all_techniques(&self) -> impl Iterator<Item = &Technique> {
        std::iter::once(&self.technique).chain(&self.other_techniques)
    }

    /// The description with one of its techniques alone.
    pub(crate) fn choosing(
        &self,
        TechniqueIndex(index): TechniqueIndex,
    ) -> Result<Cow<'_, Self>, Error> {
        if index == 0 {
            return Ok(Cow::Borrowed(self));
        }
        let technique = *self.all_techniques().nth(index as usize).ok_or_else(|| {
            Error::Frame(format!(
                "technique {index} does not exist; the description has {}, counted from 0",
                1 + self.other_techniques.len()
            ))
        })?;
        Ok(Cow::Owned(Self { technique, other_techniques: Vec::new(), ..self.clone() }))
    }

    /// The default technique for one light, a D32_SFLOAT G-buffer without a mask, two frames in flight
    /// and tightly packed positions.
    pub fn new(extent: [u32; 2]) -> Self {
        Self {
            extent,
            technique: Technique::default(),
            omit: Omit::default(),
            other_techniques: Vec::new(),
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
        if self.other_techniques.len() >= MOST_TECHNIQUES {
            return Err(Error::Frame(format!(
                "{} other techniques are more than the 7 that a node may have",
                self.other_techniques.len()
            )));
        }
        if !(1..=64).contains(&self.lights) {
            return Err(Error::Frame(format!(
                "a node is for 1 to 64 lights, not for {}; more take another node",
                self.lights
            )));
        }
        self.all_techniques().try_for_each(|technique| self.check_technique(technique))?;
        if self.extent.iter().any(|e| !(1..=16384).contains(e)) {
            let [w, h] = self.extent;
            return Err(Error::Frame(format!(
                "a G-buffer of {w}×{h} pixels is outside 1×1 to 16384×16384"
            )));
        }
        if let Some(most) = self.omit.most().filter(|most| !(0.0..=1.0).contains(most)) {
            return Err(Error::Frame(format!(
                "omit is Below({most}), and must be below 0 to 1: a mean of visible fractions"
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

    /// Whether one of the techniques works, alone and with the rest.
    fn check_technique(&self, technique: &Technique) -> Result<(), Error> {
        technique.check()?;
        let (room, name) = (technique.room(), technique.name());
        let takes = room.takes();
        if let (Some(_), Err(why)) = (self.occluder_maps, takes.lent_maps) {
            return Err(Error::Frame(format!(
                "{name} {why}; lend meshes, or choose another technique"
            )));
        }
        room::check_extent(room, self.extent)?;
        if self.light_texture.is_some() && !takes.texture {
            return Err(Error::Frame(format!(
                "{name} does not weigh what the light emits where; choose ray-march, or leave \
                 light_texture out"
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
    pub light: Light,
    /// Which of the description's lights it is, 0 and up. Each has frames of its own, recorded in the
    /// order in which they were planned; where a light casts no shadow in them they cost nothing.
    pub light_index: LightIndex,
    /// Which of the description's techniques this frame uses: 0 is [`Description::technique`], n the nth of
    /// [`Description::other_techniques`].
    pub technique_index: TechniqueIndex,
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
    pub slot: Slot,
    /// Who places the barriers at the border.
    pub border_barriers: BorderBarriers,
}

impl<'a> Frame<'a> {
    /// A frame of light 0 with the first technique, the far depth that the matrix has, no mask, the
    /// node's own visibility image sampled by fragment and compute shaders, a fitted window, and barriers placed by the
    /// node. `slot` is the frame in flight whose commands the host has waited for.
    pub fn new(
        slot: Slot,
        light: impl Into<Light>,
        world_from_ndc: impl Into<Matrix>,
        meshes: &'a [MeshInstance],
        depth: HostImage,
    ) -> Self {
        let sampled = Scope {
            stage: vk::PipelineStageFlags::FRAGMENT_SHADER | vk::PipelineStageFlags::COMPUTE_SHADER,
            ..Scope::FRAGMENT_SAMPLED
        };
        Self {
            light: light.into(),
            light_index: LightIndex(0),
            technique_index: TechniqueIndex(0),
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
            slot,
            border_barriers: BorderBarriers::Node,
        }
    }
}
