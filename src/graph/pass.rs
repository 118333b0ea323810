//! A pass is a row of data: its name, what it touches and how, its push constants, its work.

use super::{Access, ResourceId};
use crate::shaders::Module;
use ash::vk;
use smallvec::SmallVec;

/// The most that Vulkan guarantees for push constants.
pub const PUSH_BYTES: usize = 128;

/// The most invocations that a workgroup has on every device (maxComputeWorkGroupInvocations).
pub const INVOCATIONS: u32 = 128;

/// The largest storage buffer that every device binds (maxStorageBufferRange), in bytes.
pub const STORAGE_BYTES: u64 = 1 << 27;

/// The color attachments that every device draws into at once (maxColorAttachments).
pub const COLOR_ATTACHMENTS: usize = 4;

/// The push constants of a pass, as bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Push {
    bytes: [u8; PUSH_BYTES],
    len: usize,
}

impl Push {
    /// No push constants.
    pub const NONE: Self = Self { bytes: [0; PUSH_BYTES], len: 0 };

    /// The bytes of a push struct.
    pub fn new<T: bytemuck::Pod>(value: &T) -> Self {
        const { assert!(size_of::<T>() <= PUSH_BYTES && size_of::<T>().is_multiple_of(4)) };
        let mut push = Self { bytes: [0; PUSH_BYTES], len: size_of::<T>() };
        push.bytes[..push.len].copy_from_slice(bytemuck::bytes_of(value));
        push
    }

    /// The bytes to push.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.len]
    }
}

/// One resource that a pass touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    /// The resource.
    pub resource: ResourceId,
    /// How it is touched.
    pub access: Access,
    /// The shader's binding (set 0); none for attachments and indirect arguments.
    pub binding: Option<u8>,
}

impl Use {
    /// A resource that the shader sees at a binding.
    pub fn bound(binding: u8, resource: ResourceId, access: Access) -> Self {
        Self { resource, access, binding: Some(binding) }
    }

    /// An attachment, or the arguments of an indirect draw.
    pub fn fixed(resource: ResourceId, access: Access) -> Self {
        Self { resource, access, binding: None }
    }
}

/// How fragments meet what the target holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// One depth attachment: cleared to `clear`, kept where `compare` holds.
    Depth {
        /// The cleared value.
        clear: f32,
        /// New `compare` old keeps the new value.
        compare: vk::CompareOp,
    },
    /// Up to [`COLOR_ATTACHMENTS`] color attachments of one size, cleared to 0, each fragment added to them.
    Add,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draw {
    /// The meshes of a depth layer, positions at location 0, one matrix pushed each.
    Layer {
        /// The layer.
        layer: Layer,
        /// Which of the frame's views of its meshes: 0 where there is one.
        view: u32,
    },
    /// Vertices without a vertex buffer, their count read from a `VkDrawIndirectCommand`.
    Indirect {
        /// The buffer that holds the command.
        arguments: ResourceId,
        /// Where in it, in bytes: a multiple of 4.
        offset: u64,
    },
}

/// A depth layer that meshes are drawn into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layer {
    /// Occluders' nearest faces.
    Front,
    /// Occluders' furthest back faces.
    Back,
    /// Occluders' nearest back faces.
    NearBack,
    /// Occluders' furthest front faces.
    FarFront,
    /// Receivers' nearest faces.
    Receivers,
    /// Every face of the occluders, counted in its slice.
    Slices,
    /// Those that look at the projection point.
    FrontSlices,
    /// Those that look away from it.
    BackSlices,
}

impl Layer {
    /// The meshes that it shows.
    pub fn meshes(self) -> MeshList {
        match self {
            Self::Front
            | Self::Back
            | Self::NearBack
            | Self::FarFront
            | Self::Slices
            | Self::FrontSlices
            | Self::BackSlices => MeshList::Occluders,
            Self::Receivers => MeshList::Receivers,
        }
    }
}

/// Which of the frame's meshes a draw takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshList {
    /// Those that block light.
    Occluders,
    /// Those that show shadows.
    Receivers,
}

/// What a pass makes the device do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// A compute grid.
    Dispatch {
        /// The compute shader.
        shader: Module,
        /// Workgroups in x, y and z.
        groups: [u32; 3],
    },
    /// A compute grid of as many workgroups as an earlier pass found.
    Indirect {
        /// The compute shader.
        shader: Module,
        /// The buffer that holds a `VkDispatchIndirectCommand`.
        arguments: ResourceId,
        /// Where in it, in bytes: a multiple of 4.
        offset: u64,
    },
    /// A draw into one attachment.
    Raster {
        /// The vertex shader.
        vertex: Module,
        /// The fragment shader; none where only depth is written.
        fragment: Option<Module>,
        /// Faces left out.
        cull: vk::CullModeFlags,
        /// The attachment's rules.
        target: Target,
        /// What is drawn.
        draw: Draw,
    },
}

impl Work {
    /// The compute shader, where it is a grid.
    pub fn compute_shader(&self) -> Option<Module> {
        match *self {
            Self::Dispatch { shader, .. } | Self::Indirect { shader, .. } => Some(shader),
            Self::Raster { .. } => None,
        }
    }
}

/// A reason of one [`Graph`](super::Graph), which rows share: [`Graph::why`](super::Graph::why) tells it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reason(pub(super) u16);

/// Whether the frame needs a pass, and why or why not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Need<W = Reason> {
    /// It runs unless nobody reads what it writes.
    Yes(W),
    /// It does not run.
    No(W),
}

impl<W> Need<W> {
    /// Whether it is needed.
    pub fn is_yes(&self) -> bool {
        matches!(self, Self::Yes(_))
    }
}

/// What a pass touches: as many as passes have lie in the pass itself.
pub type Uses = SmallVec<[Use; 20]>;

/// One row of the graph.
///
/// Rows of one name are one **kind**: the same work on the same resources, again with other push
/// constants and another view of the meshes. They share a pipeline and a descriptor set.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// `room.pass`; the debug label is this behind `antumbra.`.
    pub name: &'static str,
    /// What it touches.
    pub uses: Uses,
    /// Its push constants; a mesh draw pushes its matrices itself.
    pub push: Push,
    /// What it does.
    pub work: Work,
    /// Whether this frame needs it.
    pub need: Need,
}

impl Pass {
    /// A row that runs a compute grid.
    pub fn compute(
        name: &'static str,
        shader: Module,
        groups: [u32; 3],
        push: Push,
        uses: Uses,
        need: &Need,
    ) -> Self {
        let work = Work::Dispatch { shader, groups };
        Self { name, uses, push, work, need: *need }
    }

    /// Whether a row of its name can be recorded with what was made for this one.
    pub fn is_kind_of(&self, other: &Self) -> bool {
        self.is_row_of(other) && self.push.bytes().len() == other.push.bytes().len()
    }

    /// Whether it does what another one does, with other numbers: push constants, workgroups, view of the meshes.
    pub(super) fn is_row_of(&self, other: &Self) -> bool {
        let same_work = match (self.work, other.work) {
            (Work::Dispatch { shader: a, .. }, Work::Dispatch { shader: b, .. }) => a == b,
            (
                Work::Raster { draw: Draw::Layer { layer: a, .. }, .. },
                Work::Raster { draw: Draw::Layer { layer: b, .. }, .. },
            ) => a == b,
            (a, b) => a == b,
        };
        self.name == other.name && self.uses == other.uses && same_work
    }

    /// The resources it writes.
    pub fn writes(&self) -> impl Iterator<Item = ResourceId> + '_ {
        self.uses.iter().filter(|u| u.access.writes()).map(|u| u.resource)
    }

    /// The resources it reads.
    pub fn reads(&self) -> impl Iterator<Item = ResourceId> + '_ {
        self.uses.iter().filter(|u| u.access.reads()).map(|u| u.resource)
    }
}
