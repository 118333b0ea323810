//! How a frame accesses images and buffers of the host: the barriers and scopes at the node's border.

use super::CutOutSet;
use super::MeshDraw;
use super::triangles::TriangleMesh;
use crate::graph::Scope;
use crate::lent::Geometry;
use ash::vk;

/// How the node uses an image that it shares with the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeUse {
    /// The scope of the node's first use, or of all its uses where it only reads, with the layout that the image must
    /// be in then.
    pub entry: Scope,
    /// The scope of the node's last use, with the layout that the image is left in.
    pub exit: Scope,
    /// Whether the node writes the image.
    pub writes: bool,
}

/// The accesses to one image that node and host share, before, in and after the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostAccess {
    /// The image's name: `gbuffer.depth`, `gbuffer.mask`, `gbuffer.normal`, `occluder_maps.front`, `occluder_maps.back`,
    /// `light.texture` or `visibility`.
    pub name: &'static str,
    /// The image; a null handle for the node's own image in a plan that was made without a node.
    pub image: vk::Image,
    /// The array layer: the light's index in the node's own visibility image, otherwise 0.
    pub layer: u32,
    /// All aspects of the image's format.
    pub aspect: vk::ImageAspectFlags,
    /// The host's last use before the node, as the frame says.
    pub before: Scope,
    /// How the node uses the image; `None` where no pass of this frame does.
    pub node: Option<NodeUse>,
    /// The host's first use after the node, as the frame says.
    pub after: Scope,
}

/// A dependency between two uses of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageBarrier {
    /// The image.
    pub image: vk::Image,
    /// The array layer.
    pub layer: u32,
    /// The image's aspects.
    pub aspect: vk::ImageAspectFlags,
    /// The use that must be complete.
    pub before: Scope,
    /// The use that waits.
    pub after: Scope,
}

impl ImageBarrier {
    /// The barrier as a Vulkan struct, for one layer and the image's only mip level. Its stages, `before.stage` and
    /// `after.stage`, are arguments of `vkCmdPipelineBarrier`.
    pub fn vk(&self) -> vk::ImageMemoryBarrier<'static> {
        vk::ImageMemoryBarrier::default()
            .src_access_mask(self.before.access)
            .dst_access_mask(self.after.access)
            .old_layout(self.before.layout)
            .new_layout(self.after.layout)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(self.image)
            .subresource_range(
                vk::ImageSubresourceRange::default()
                    .aspect_mask(self.aspect)
                    .level_count(1)
                    .base_array_layer(self.layer)
                    .layer_count(1),
            )
    }

    /// As synchronization2 takes it, stages included, for `vkCmdPipelineBarrier2`.
    pub fn vk2(&self) -> vk::ImageMemoryBarrier2<'static> {
        let one = self.vk();
        vk::ImageMemoryBarrier2::default()
            .src_stage_mask(self.before.stage2())
            .src_access_mask(self.before.access2())
            .dst_stage_mask(self.after.stage2())
            .dst_access_mask(self.after.access2())
            .old_layout(one.old_layout)
            .new_layout(one.new_layout)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(self.image)
            .subresource_range(one.subresource_range)
    }
}

impl HostAccess {
    /// The barrier that a host which places them itself records before the node; `None` where the node does not use the
    /// image.
    pub fn entry_barrier(&self) -> Option<ImageBarrier> {
        let used = self.node?;
        // The node overwrites the whole image: the old content may be discarded.
        let before = if used.writes { self.before.forgotten() } else { self.before };
        Some(self.barrier(before, used.entry))
    }

    /// The barrier that a host which places them itself records after the node; `None` where there is nothing to wait
    /// for. For an image that the node does not use, it leads straight from the host's last use to its next.
    pub fn exit_barrier(&self) -> Option<ImageBarrier> {
        let before = self.node.map_or(self.before, |used| used.exit);
        let layout = match self.after.layout {
            vk::ImageLayout::UNDEFINED => before.layout,
            layout => layout,
        };
        // The entry barrier has already made it visible to what the node's own reads cover.
        let covered = self.node.is_some_and(|used| !used.writes)
            && before.stage.contains(self.after.stage)
            && before.access.contains(self.after.access);
        if covered && layout == before.layout {
            return None;
        }
        Some(self.barrier(before, self.after.in_layout(layout)))
    }

    fn barrier(&self, before: Scope, after: Scope) -> ImageBarrier {
        let Self { image, layer, aspect, .. } = *self;
        ImageBarrier { image, layer, aspect, before, after }
    }
}

/// A vertex or index buffer of the host that the node reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferAccess {
    /// The buffer.
    pub buffer: vk::Buffer,
    /// The stages and accesses of the node's reads; the layout is `UNDEFINED`.
    pub scope: Scope,
}

/// The buffers that these draws read and that these meshes' triangles are read from, each once, with all accesses to it.
pub(super) fn of_buffers<'a>(
    draws: impl Iterator<Item = &'a MeshDraw> + Clone,
    triangles: &[TriangleMesh],
    cut_outs: &[CutOutSet],
) -> Vec<BufferAccess> {
    use vk::{AccessFlags as A, PipelineStageFlags as S};
    let (draws, again) = (draws.clone(), draws);
    let cut = again.filter_map(|d| cut_outs.get(d.cut_out? as usize));
    let cut = cut.map(|set| (set.coordinates, S::VERTEX_SHADER, A::SHADER_READ));
    let traced = triangles.iter().filter_map(|mesh| cut_outs.get(mesh.cut_out? as usize));
    let traced = traced.map(|set| (set.coordinates, S::COMPUTE_SHADER, A::SHADER_READ));
    let drawn = draws
        .filter_map(|d| match d.mesh.geometry {
            Geometry::Buffers(b) => Some(b),
            Geometry::HostDrawn(_) => None,
        })
        .flat_map(|b| {
            let positions = (b.positions, A::VERTEX_ATTRIBUTE_READ);
            let indices = b.indices.map(|(buffer, ..)| (buffer, A::INDEX_READ));
            std::iter::once(positions).chain(indices)
        })
        .map(|(buffer, access)| (buffer, S::VERTEX_INPUT, access));
    let read = triangles.iter().flat_map(|mesh| [mesh.positions, mesh.indices]);
    let read = read.map(|buffer| (buffer, S::COMPUTE_SHADER, A::SHADER_READ));
    let scope = |stage, access| Scope { stage, access, layout: vk::ImageLayout::UNDEFINED };
    let mut found: Vec<BufferAccess> = drawn
        .chain(read)
        .chain(cut)
        .chain(traced)
        .map(|(buffer, stage, access)| BufferAccess { buffer, scope: scope(stage, access) })
        .collect();
    found.sort_by_key(|a| (a.buffer, a.scope.access.as_raw()));
    found.dedup_by(|next, kept| {
        let same = next.buffer == kept.buffer;
        if same {
            kept.scope.stage |= next.scope.stage;
            kept.scope.access |= next.scope.access;
        }
        same
    });
    found
}
