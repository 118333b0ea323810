//! A pass is data: its name, the resources that it uses and how, its push constants, and its work.

use super::{Access, ResourceId};
use crate::shaders::Module;
use ash::vk;
use smallvec::SmallVec;

/// The most bytes of push constants that Vulkan guarantees.
pub const PUSH_BYTES: usize = 128;

/// The most invocations that a workgroup has on every device (maxComputeWorkGroupInvocations).
pub const INVOCATIONS: u32 = 128;

/// The largest storage buffer that every device binds (maxStorageBufferRange), in bytes.
pub const STORAGE_BYTES: u64 = 1 << 27;

/// The most color attachments that every device draws into at once (maxColorAttachments).
pub const COLOR_ATTACHMENTS: usize = 4;

/// The binding at which passes that draw meshes read those that textures cut out (`cut_outs/vertex.glsl`).
pub(super) const CUT_OUTS_BINDING: u8 = 15;

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

/// A resource that a pass uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    /// The resource.
    pub resource: ResourceId,
    /// How the pass accesses it.
    pub access: Access,
    /// The binding in the shader's set 0; `None` for attachments and indirect arguments.
    pub binding: Option<u8>,
}

impl Use {
    /// The use of a resource that the shader sees at a binding.
    pub fn bound(binding: u8, resource: ResourceId, access: Access) -> Self {
        Self { resource, access, binding: Some(binding) }
    }

    /// The use of an attachment, or of the arguments of an indirect command.
    pub fn fixed(resource: ResourceId, access: Access) -> Self {
        Self { resource, access, binding: None }
    }
}

/// The attachments of a raster pass, and how fragments combine with their content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// One depth attachment, cleared to `clear`; a fragment is written where it passes `compare`.
    Depth {
        /// The cleared value.
        clear: f32,
        /// The comparison of a fragment's depth with the stored depth.
        compare: vk::CompareOp,
    },
    /// Up to [`COLOR_ATTACHMENTS`] color attachments of one size, cleared to 0, each fragment added to them.
    Add,
}

/// The draw of a raster pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draw {
    /// Draws the meshes of a depth layer, with positions at location 0 and a pushed matrix and origin for each mesh.
    Layer {
        /// The layer.
        layer: Layer,
        /// The index among the views of the layer's meshes: 0 where there is one view.
        view: u32,
    },
    /// Draws vertices without a vertex buffer; a `VkDrawIndirectCommand` holds their count.
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
    /// The occluders' nearest faces.
    Front,
    /// The occluders' furthest back faces.
    Back,
    /// The occluders' nearest back faces.
    NearBack,
    /// The occluders' furthest front faces.
    FarFront,
    /// The occluders' nearest front faces beyond those of [`Self::NearBack`].
    MiddleFront,
    /// The occluders' nearest back faces beyond those of [`Self::MiddleFront`].
    MiddleBack,
    /// The receivers' nearest faces.
    Receivers,
    /// All faces of the occluders, each in its slice.
    Slices,
    /// The occluders' faces that face the projection point, each in its slice.
    FrontSlices,
    /// The occluders' faces that face away from the projection point, each in its slice.
    BackSlices,
}

impl Layer {
    /// The list of meshes that the layer shows.
    pub fn meshes(self) -> MeshList {
        match self {
            Self::Front
            | Self::Back
            | Self::NearBack
            | Self::FarFront
            | Self::MiddleFront
            | Self::MiddleBack
            | Self::Slices
            | Self::FrontSlices
            | Self::BackSlices => MeshList::Occluders,
            Self::Receivers => MeshList::Receivers,
        }
    }
}

/// The list of the frame's meshes that a pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshList {
    /// The meshes that block light.
    Occluders,
    /// The meshes that show shadows.
    Receivers,
}

/// The command of a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// A compute dispatch.
    Dispatch {
        /// The compute shader.
        shader: Module,
        /// The number of workgroups in x, y and z.
        groups: [u32; 3],
    },
    /// A compute dispatch whose number of workgroups an earlier pass wrote into a buffer.
    Indirect {
        /// The compute shader.
        shader: Module,
        /// The buffer that holds a `VkDispatchIndirectCommand`.
        arguments: ResourceId,
        /// Where in it, in bytes: a multiple of 4.
        offset: u64,
    },
    /// A compute dispatch for each blocking mesh that has its triangles in buffers: set 1 has the host's positions at
    /// binding 0 and its indices at binding 1, and a [`MeshPush`](crate::stages::hierarchy::MeshPush) is pushed for each mesh.
    EachMesh {
        /// The compute shader.
        shader: Module,
    },
    /// Writes the pass's push constants into the one buffer that it uses.
    Constants {
        /// Where in the buffer, in bytes: a multiple of 4.
        offset: u64,
    },
    /// Writes the frame's meshes that textures cut out into the one buffer that the pass uses:
    /// [`CutOutRecord`](crate::frame::CutOutRecord)s.
    CutOuts,
    /// A compute dispatch for each opacity texture, or for each blocking mesh that one cuts out: set 1 is that of the mesh,
    /// and a [`CutOutPush`](crate::stages::hierarchy::CutOutPush) is pushed.
    EachCutOut {
        /// The compute shader.
        shader: Module,
        /// Whether it runs for each texture; else for each mesh.
        textures: bool,
    },
    /// Writes which frame it is into the one buffer that the pass uses: the number of the light's recorded frames, from
    /// 1 up, and the light's index, 32 bits each.
    FrameNumber,
    /// A draw into attachments.
    Raster {
        /// The vertex shader.
        vertex: Module,
        /// The fragment shader; `None` where only depth is written.
        fragment: Option<Module>,
        /// The vertex and the fragment shader for meshes that textures cut out; `None` where no meshes are drawn. Set 1
        /// has the mesh's texture coordinates at binding 0 and its opacity texture at binding 1.
        cut: Option<[Module; 2]>,
        /// The faces that are culled.
        cull: vk::CullModeFlags,
        /// The attachments.
        target: Target,
        /// The draw of a raster pass.
        draw: Draw,
    },
}

impl Work {
    /// The compute shader; `None` for a draw or a write of constants.
    pub fn compute_shader(&self) -> Option<Module> {
        match *self {
            Self::Dispatch { shader, .. }
            | Self::Indirect { shader, .. }
            | Self::EachMesh { shader }
            | Self::EachCutOut { shader, .. } => Some(shader),
            Self::Raster { .. } | Self::Constants { .. } | Self::FrameNumber | Self::CutOuts => {
                None
            }
        }
    }
}

/// Refers to a reason of one [`Graph`](super::Graph), which passes may share; [`Graph::why`](super::Graph::why) returns
/// it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reason(pub(super) u16);

/// Whether the frame needs a pass, and why or why not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Need<W = Reason> {
    /// The pass runs, unless nobody reads its output.
    Yes(W),
    /// The pass does not run.
    No(W),
}

impl<W> Need<W> {
    /// Whether the pass is needed.
    pub fn is_yes(&self) -> bool {
        matches!(self, Self::Yes(_))
    }
}

/// The resources that a pass uses, stored in the pass itself for as many as passes have.
pub type Uses = SmallVec<[Use; 20]>;

/// One pass of the graph.
///
/// Passes of one name are of one **kind**: they do the same work on the same resources with other push constants and
/// another view of the meshes. They share a pipeline and a descriptor set.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// The pass's name, as `room.pass`; its debug label is `antumbra.room.pass`.
    pub name: &'static str,
    /// The resources that it uses.
    pub uses: Uses,
    /// The push constants of the pass, without the matrix and origin that each mesh draw pushes before them.
    pub push: Push,
    /// The command of the pass.
    pub work: Work,
    /// Whether this frame needs it, and why.
    pub need: Need,
}

impl Pass {
    /// A pass that dispatches a compute shader over `groups` workgroups.
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

    /// A pass that writes `bytes` into a buffer, from `offset` on.
    pub fn constants<T: bytemuck::Pod>(
        name: &'static str,
        buffer: ResourceId,
        offset: u64,
        bytes: &T,
        need: &Need,
    ) -> Self {
        let uses = smallvec::smallvec![Use::fixed(buffer, Access::TransferWrite)];
        let work = Work::Constants { offset };
        Self { name, uses, push: Push::new(bytes), work, need: *need }
    }

    /// A pass that writes which frame it is into a buffer.
    pub fn frame_number(name: &'static str, buffer: ResourceId, need: &Need) -> Self {
        let uses = smallvec::smallvec![Use::fixed(buffer, Access::TransferWrite)];
        Self { name, uses, push: Push::NONE, work: Work::FrameNumber, need: *need }
    }

    /// Whether `other`, a pass of the same name, can be recorded with the objects that were made for this one.
    pub fn is_kind_of(&self, other: &Self) -> bool {
        self.does_work_of(other) && self.push.bytes().len() == other.push.bytes().len()
    }

    /// Whether two passes differ in numbers alone: push constants, workgroups, view of the meshes.
    pub(super) fn does_work_of(&self, other: &Self) -> bool {
        let same_work = match (self.work, other.work) {
            (Work::Dispatch { shader: a, .. }, Work::Dispatch { shader: b, .. }) => a == b,
            (
                Work::Raster { draw: Draw::Layer { layer: a, .. }, .. },
                Work::Raster { draw: Draw::Layer { layer: b, .. }, .. },
            ) => a == b,
            (Work::Constants { .. }, Work::Constants { .. }) => true,
            (a, b) => a == b,
        };
        self.name == other.name && self.uses == other.uses && same_work
    }

    /// Whether the pass draws meshes, and those that textures cut out by pipelines of their own.
    pub(crate) fn draws_cut_outs(&self) -> bool {
        matches!(self.work, Work::Raster { cut: Some(_), .. })
            && self.uses.iter().any(|u| u.binding == Some(CUT_OUTS_BINDING))
    }

    /// The resources that the pass writes.
    pub fn writes(&self) -> impl Iterator<Item = ResourceId> + '_ {
        self.uses.iter().filter(|u| u.access.writes()).map(|u| u.resource)
    }

    /// The resources that the pass reads.
    pub fn reads(&self) -> impl Iterator<Item = ResourceId> + '_ {
        self.uses.iter().filter(|u| u.access.reads()).map(|u| u.resource)
    }
}
