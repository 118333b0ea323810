//! What the host says each frame, and the plan that follows from it. No Vulkan calls.

mod plan;
#[cfg(test)]
mod tests;

pub use plan::{Faces, FramePlan, Limits, MeshDraw, full_graph, plan};
pub(crate) use plan::{FrameGraph, nominal};

use crate::depth_layers::Bounds;
use crate::graph::{self, Scope};
use crate::settings::Settings;
use crate::{Error, RectangleLight, scene::Role};
use ash::vk;
use glam::DMat4;

/// What stays the same from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// The G-buffer's width and height in pixels, 1 to 16384.
    pub extent: [u32; 2],
    /// The technique and its knobs.
    pub settings: Settings,
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
}

impl Description {
    /// The default settings for a D32_SFLOAT G-buffer without a mask, two frames in flight and
    /// tightly packed positions.
    pub fn new(extent: [u32; 2]) -> Self {
        Self {
            extent,
            settings: Settings::default(),
            frames_in_flight: 2,
            depth_format: vk::Format::D32_SFLOAT,
            mask_format: None,
            inspect: false,
            position_strides: vec![12],
        }
    }

    /// # Errors
    /// [`Error::Setting`] or [`Error::Frame`] for the first thing out of its range.
    pub fn check(&self) -> Result<(), Error> {
        self.settings.check()?;
        if self.extent.iter().any(|e| !(1..=16384).contains(e)) {
            let [w, h] = self.extent;
            return Err(Error::Frame(format!(
                "a G-buffer of {w}×{h} pixels is outside 1×1 to 16384×16384"
            )));
        }
        if !(1..=8).contains(&self.frames_in_flight) {
            return Err(Error::Frame("frames_in_flight must be 1 to 8".into()));
        }
        if !graph::is_depth_format(self.depth_format) {
            return Err(Error::Frame(format!(
                "the G-buffer's depth format {:?} holds no depth",
                self.depth_format
            )));
        }
        match self.position_strides.iter().find(|&&s| s < 12 || s % 4 != 0 || s > 2048) {
            Some(s) => Err(Error::Frame(format!(
                "a position stride of {s} bytes does not work; three floats take 12, and strides \
                 are multiples of 4 up to 2048"
            ))),
            None => Ok(()),
        }
    }
}

/// One of the host's images, how it was left and how it is wanted back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostImage {
    /// The image; may be null where the host places barriers itself.
    pub image: vk::Image,
    /// A 2D view of it, of the depth aspect for depth.
    pub view: vk::ImageView,
    /// Stage, access and layout of the host's last use before the node.
    pub before: Scope,
    /// Stage, access and layout of the host's first use after it.
    pub after: Scope,
}

/// A mesh as the host keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshInstance {
    /// Positions: three 32-bit floats each, in a buffer with `VERTEX_BUFFER` usage.
    pub positions: vk::Buffer,
    /// Where the first position is, in bytes.
    pub positions_offset: u64,
    /// Bytes from one position to the next; one of [`Description::position_strides`].
    pub positions_stride: u32,
    /// Indices: buffer, offset in bytes, type; none for a list of triangles without.
    pub indices: Option<(vk::Buffer, u64, vk::IndexType)>,
    /// How many indices, or vertices where there are none.
    pub count: u32,
    /// Mesh space to world space.
    pub world_from_mesh: DMat4,
    /// A box around the positions, in mesh space.
    pub bounds: Bounds,
    /// Occluder, receiver or both.
    pub role: Role,
    /// Both sides of each triangle are front faces.
    pub double_sided: bool,
}

/// Who places the barriers at the node's border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BorderBarriers {
    /// The node, from what the host says of its images.
    #[default]
    Node,
    /// The host, from [`FramePlan::accesses`].
    Host,
}

/// One frame, as the host sees it.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The light.
    pub light: RectangleLight,
    /// Normalized device coordinates and depth to world space: the inverse of view and projection.
    pub world_from_ndc: DMat4,
    /// The depth of pixels that show no surface: 0 with reversed depth, else 1.
    pub background: f32,
    /// Everything that blocks light or shows shadows.
    pub meshes: &'a [MeshInstance],
    /// The G-buffer's depth.
    pub depth: HostImage,
    /// Roles by pixel: red 1 blocks and receives, ½ receives only, 0 receives nothing.
    pub mask: Option<HostImage>,
    /// How the visibility image was last used, and how it will be used next.
    pub visibility_before: Scope,
    /// See [`Self::visibility_before`].
    pub visibility_after: Scope,
    /// Least and largest tangent (u, v) of the occluder map; none fits it to the occluders.
    pub window: Option<[[f64; 2]; 2]>,
    /// Which of the frames in flight this is, 0 and up. The frame that last had the same number
    /// must be done before this one is recorded.
    pub slot: u32,
    /// Who places the barriers at the border.
    pub border_barriers: BorderBarriers,
}
