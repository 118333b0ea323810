//! A node's description, the host's input for each frame, and the plan made from both. No Vulkan calls.

mod accesses;
mod boxes;
mod cache;
mod camera;
mod check;
mod cut_outs;
mod doubts;
mod draws;
mod fit;
mod hull;
mod images;
mod inputs;
mod limits;
mod make;
mod odd;
mod parallel;
mod passes;
mod placed;
mod plan;
mod plans;
mod request;
mod reuse;
mod seen;
#[cfg(test)]
mod tests;
mod triangles;
mod views;

pub use accesses::{BufferAccess, HostAccess, ImageBarrier, NodeUse};
pub(crate) use boxes::MeshBoxes;
pub(crate) use cache::{Cache, CacheKey};
pub(crate) use cut_outs::{CutOutList, CutOutSet};
pub use cut_outs::{CutOutRecord, CutOuts};
pub use doubts::Doubt;
pub use draws::{Faces, MeshDraw};
pub(crate) use inputs::SituationCache;
#[cfg(test)]
pub(crate) use inputs::situation;
pub use limits::Limits;
pub(crate) use make::{Memory, Workspace, plan_into};
pub use make::{plan, plan_all};
pub(crate) use passes::{all_graphs, all_passes};
pub use passes::{full_graph, full_graph_on};
pub(crate) use plan::Stamp;
pub use plan::{FramePlan, Part};
pub use plans::FramePlans;
pub use triangles::{Capacity, Space};
pub(crate) use triangles::{TriangleList, kept_out};
pub use views::PlannedView;

use crate::Error;
use crate::effects::Omit;
use crate::graph::{self, Scope};
use crate::lent::{
    BorderBarriers, HostImage, LightIndex, MeshInstance, Normals, OccluderMaps, Slot,
    TechniqueIndex, Visibility,
};
use crate::light::Light;
use crate::plain::Matrix;
use crate::technique::Technique;
use crate::techniques::room;
use ash::vk;
use glam::{DMat3, DMat4};
use std::borrow::Cow;

/// The most techniques that a node may have: [`Description::technique`] and the others.
pub(crate) const MOST_TECHNIQUES: usize = 16;

/// What a node is made for: everything that stays the same from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// The G-buffer's width and height in pixels, 1 to 16384.
    pub extent: [u32; 2],
    /// The technique and its settings.
    pub technique: Technique,
    /// Which effects may be left out where they hardly matter; those that add less than 1/256 by default.
    pub omit: Omit,
    /// Up to 15 further techniques that a frame may choose ([`Frame::technique_index`]), for lights that need another
    /// one or other settings. Each has its own pipelines, maps and buffers, which the lights that choose it share.
    pub other_techniques: Vec<Technique>,
    /// The number of lights, 1 to 64. Each light has its own frames ([`Frame::light_index`]) and its own layer of the
    /// node's visibility image, which is an array image where there are several lights.
    pub lights: u32,
    /// How many frames may be recorded before the device has completed the first of them, 1 to 8.
    pub frames_in_flight: u32,
    /// The format of the G-buffer's depth image.
    pub depth_format: vk::Format,
    /// The format of the mask ([`Frame::mask`]); `None` where the host lends no mask.
    pub mask_format: Option<vk::Format>,
    /// The G-buffer's normals, which the host lends each frame ([`Frame::normals`]); `None` where it lends none, and each
    /// pixel's plane comes from the depths around it.
    pub normals: Option<Normals>,
    /// Whether the node's own images can be copied out, for tests and debuggers; off by default.
    pub inspect: bool,
    /// The strides of vertex positions, in bytes, that the meshes have: multiples of 4 from 12, tightly packed, to
    /// 2048.
    pub position_strides: Vec<u32>,
    /// Whether the host lends the visibility image each frame ([`Visibility::Lent`]); otherwise the node owns one.
    pub lent_visibility: bool,
    /// The format of the occluder maps that the host draws itself and lends each frame ([`Frame::occluder_maps`]);
    /// `None` where the node draws meshes.
    pub occluder_maps: Option<vk::Format>,
    /// The texture of the light's emission, which the host lends each frame ([`Frame::light_texture`]); `None` for a
    /// light of uniform emission. `ray-march` and `traced` accept a texture.
    pub light_texture: Option<LightTexture>,
    /// The most triangles and meshes that block light, where a technique works with the triangles themselves.
    pub capacity: Capacity,
    /// How many meshes textures cut out at most ([`MeshInstance::opacity`]); none by default.
    pub cut_outs: CutOuts,
    /// How many pixels a frame are traced through the blocking triangles to measure the error of what the technique
    /// wrote ([`crate::audit`]): 0 for no audit, the default, or 16 to 65,536. The image is the same with it and without.
    pub audit: u32,
}

/// The description of an image of a light's emission over its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightTexture {
    /// The image's format: a color format that a shader reads as floats of 0 and more. Red, green and blue are linear.
    pub format: vk::Format,
    /// Whether the result has a visible fraction for each of red, green and blue, in an image of R32G32B32A32_SFLOAT;
    /// otherwise it has one, of luminance.
    pub color: bool,
}

impl Description {
    /// Whether the result has a visible fraction for each color.
    pub(crate) fn has_color(&self) -> bool {
        self.light_texture.is_some_and(|t| t.color)
    }

    /// All techniques that a frame may choose, [`Self::technique`] first.
    pub fn all_techniques(&self) -> impl Iterator<Item = &Technique> {
        std::iter::once(&self.technique).chain(&self.other_techniques)
    }

    /// The description with only one of its techniques.
    ///
    /// # Errors
    /// [`Error::Frame`] for an index beyond the last technique.
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

    /// A description with the default technique, one light, a D32_SFLOAT G-buffer of `extent` pixels without mask or
    /// normals, two frames in flight and tightly packed positions.
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
            normals: None,
            inspect: false,
            position_strides: vec![12],
            lent_visibility: false,
            occluder_maps: None,
            light_texture: None,
            capacity: Capacity::default(),
            cut_outs: CutOuts::default(),
            audit: 0,
        }
    }

    /// Checks that a node can be made for the description.
    ///
    /// # Errors
    /// [`Error::Setting`] or [`Error::Frame`] for the first value out of its range.
    pub fn check(&self) -> Result<(), Error> {
        if self.other_techniques.len() >= MOST_TECHNIQUES {
            return Err(Error::Frame(format!(
                "{} other techniques are more than the 15 that a node may have",
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
        self.capacity.check()?;
        self.cut_outs.check()?;
        self.check_audit()?;
        self.normals.map_or(Ok(()), |normals| normals.check())?;
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

    /// Whether frames have the hierarchy of the blocking triangles.
    pub(crate) fn has_hierarchy(&self) -> bool {
        self.audit > 0 || self.technique.room().reads_triangles()
    }

    /// Checks one of the techniques, by itself and with the rest of the description.
    ///
    /// # Errors
    /// See [`Self::check`].
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
                "{name} does not weigh what the light emits where; choose ray-march or traced, or \
                 leave light_texture out"
            )));
        }
        Ok(())
    }
}

/// The host's input for one frame of one light; [`Frame::new`] fills in the usual values.
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
/// | light | shines along `half_v × half_u`; [`RectangleLight::facing`](crate::RectangleLight::facing) takes the direction |
///
/// What contradicts them is refused by [`plan`], or is one of [`FramePlan::doubts`].
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The light.
    pub light: Light,
    /// Which of the description's lights it is. Frames of several lights are recorded in the order in which they were
    /// planned; a frame in which the light casts no shadow costs nothing.
    pub light_index: LightIndex,
    /// Which of the description's techniques the frame uses.
    pub technique_index: TechniqueIndex,
    /// How far the light reaches from its centre, in metres above 0: the host lights nothing further away. Receivers
    /// and occluders beyond it are left out. `None` for a light without limit.
    pub reach: Option<f64>,
    /// Normalized device coordinates and depth to world space, for column vectors: `inverse(projection * view)`.
    ///
    /// The first row of pixels lies at y = −1, as Vulkan has it; where a host's y runs up (wgpu, or a viewport of
    /// negative height), it is `inverse(projection * view) * scale(1, -1, 1)`. "World" is whatever space the light and
    /// the meshes' transforms are in: a host that keeps its numbers relative to the camera gives all of them so.
    pub world_from_ndc: DMat4,
    /// The depth of pixels that show no surface: 0 with reversed depth, 1 otherwise. `None` derives it from
    /// [`Self::world_from_ndc`]: the end of depth that lies further from the eye. An orthographic camera has no eye, so
    /// that it must be given there.
    pub background: Option<f32>,
    /// The meshes that block light or show shadows.
    pub meshes: &'a [MeshInstance],
    /// The G-buffer's depth image, with SAMPLED usage.
    pub depth: HostImage,
    /// The role of each pixel's mesh, with SAMPLED usage: red 1 blocks and receives, ½ receives only, 0 receives
    /// nothing.
    pub mask: Option<HostImage>,
    /// The triangles' normals, of the G-buffer's extent and with SAMPLED usage, exactly where [`Description::normals`]
    /// says how they are stored. A pixel whose normal has no length or is no number counts as if it had none.
    pub normals: Option<HostImage>,
    /// Turns the normals to world space, for column vectors: the identity where they are in world space, the rotation
    /// of `world_from_view` where they are in view space.
    pub world_from_normal: DMat3,
    /// The image that the result is written to.
    pub visibility: Visibility,
    /// The host's own depth images of the occluders, exactly where [`Description::occluder_maps`] has a format for
    /// them. [`Self::meshes`] then only says where receivers are.
    pub occluder_maps: Option<OccluderMaps>,
    /// The light's emission over its surface, exactly where [`Description::light_texture`] is given: an image of any
    /// size with SAMPLED usage. The light's first half-axis points to its last column, the second half-axis to its
    /// first row.
    pub light_texture: Option<HostImage>,
    /// The occluder map's window: its least and largest tangents (u, v). `None` fits the map to the occluders.
    /// `many-lights` always fits its maps, and so does `ray-march` unless `projection=centre`.
    pub window: Option<[[f64; 2]; 2]>,
    /// Is added to the seed of `ray-march`'s noise. A number that changes each frame lets later passes average the
    /// noise over frames; 0 keeps the noise as it is.
    pub noise: u32,
    /// The revision of light and meshes relative to each other: geometry, transforms, roles, lent occluder maps,
    /// [`Self::reach`] and [`Self::window`]. While the host gives the same number, the node reuses the maps that it has
    /// drawn. `None` where anything may have changed. A recorded frame counts as drawn: submit it, and before the
    /// frames recorded after it.
    pub revision: Option<u64>,
    /// The revision of the blocking meshes alone: the list, their transforms, roles and vertices. While the host gives
    /// the same number, the hierarchy of their triangles is kept for the frames of all lights. Without it the hierarchy
    /// is kept as maps are, by [`Self::revision`].
    pub mesh_revision: Option<u64>,
    /// The revision of what the pixels show: camera, G-buffer, [`Self::noise`], and how the host uses the result. Where
    /// both revisions are those of the last frame, the node's own visibility image stays as it is and no pass runs.
    pub view_revision: Option<u64>,
    /// Which of the frames in flight this is. The device must have completed the last frame of the same slot before
    /// this one is recorded.
    pub slot: Slot,
    /// Whether node or host records the barriers before and after the node.
    pub border_barriers: BorderBarriers,
}

impl<'a> Frame<'a> {
    /// A frame of light 0 with the first technique, the far depth that the matrix has, no mask and no normals, the
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
            normals: None,
            world_from_normal: DMat3::IDENTITY,
            visibility: Visibility::Own { before: sampled, after: sampled },
            occluder_maps: None,
            light_texture: None,
            window: None,
            noise: 0,
            revision: None,
            mesh_revision: None,
            view_revision: None,
            slot,
            border_barriers: BorderBarriers::Node,
        }
    }
}
