//! What a frame does at the node's border, resolved to the host's own handles.

use super::MeshDraw;
use crate::graph::Scope;
use crate::lent::Geometry;
use ash::vk;

/// How the node uses an image of the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeUse {
    /// Its first use, or all of them where it only reads, and the layout the image must then be in.
    pub entry: Scope,
    /// Its last use, and the layout the image is left in.
    pub exit: Scope,
    /// Whether it writes.
    pub writes: bool,
}

/// One image that crosses the node's border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostAccess {
    /// `gbuffer.depth`, `gbuffer.mask`, `occluder_maps.front`, `occluder_maps.back`, `visibility`.
    pub name: &'static str,
    /// The image; null for a node's own where the plan was made without its node.
    pub image: vk::Image,
    /// Which of its array layers: the light's, in a node's own visibility image; otherwise 0.
    pub layer: u32,
    /// Every aspect that it has.
    pub aspect: vk::ImageAspectFlags,
    /// The host's last use before the node, as the frame says.
    pub before: Scope,
    /// What the node does with it; none where this frame's passes leave it alone.
    pub node: Option<NodeUse>,
    /// The host's first use behind the node, as the frame says.
    pub after: Scope,
}

/// A dependency between two uses of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageBarrier {
    /// The image.
    pub image: vk::Image,
    /// Which of its array layers.
    pub layer: u32,
    /// Its aspects.
    pub aspect: vk::ImageAspectFlags,
    /// The use that must be done.
    pub before: Scope,
    /// The use that waits.
    pub after: Scope,
}

impl ImageBarrier {
    /// As Vulkan takes it, for one layer and the image's only level; the stages go beside it.
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
    /// The barrier before the node, for a host that places them; none where the node leaves the
    /// image alone.
    pub fn entry_barrier(&self) -> Option<ImageBarrier> {
        let used = self.node?;
        // What the node writes it writes whole: the old content may go.
        let before = if used.writes { self.before.forgotten() } else { self.before };
        Some(self.barrier(before, used.entry))
    }

    /// The barrier behind the node, for a host that places them; none where nothing need be waited
    /// for. An image that the node leaves alone goes straight from the host's one use to its next.
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

/// A buffer of the host's that the node reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferAccess {
    /// The buffer.
    pub buffer: vk::Buffer,
    /// Stages and accesses; the layout is `UNDEFINED`.
    pub scope: Scope,
}

/// Every buffer that these draws read, once.
pub(super) fn of_buffers<'a>(draws: impl Iterator<Item = &'a MeshDraw>) -> Vec<BufferAccess> {
    let scope = |access| Scope {
        stage: vk::PipelineStageFlags::VERTEX_INPUT,
        access,
        layout: vk::ImageLayout::UNDEFINED,
    };
    let mut found: Vec<BufferAccess> = draws
        .filter_map(|d| match d.mesh.geometry {
            Geometry::Buffers(b) => Some(b),
            Geometry::HostDrawn(_) => None,
        })
        .flat_map(|b| {
            let positions = (b.positions, vk::AccessFlags::VERTEX_ATTRIBUTE_READ);
            let indices = b.indices.map(|(buffer, ..)| (buffer, vk::AccessFlags::INDEX_READ));
            std::iter::once(positions).chain(indices)
        })
        .map(|(buffer, access)| BufferAccess { buffer, scope: scope(access) })
        .collect();
    found.sort_by_key(|a| (a.buffer, a.scope.access.as_raw()));
    found.dedup_by(|next, kept| {
        let same = next.buffer == kept.buffer;
        if same {
            kept.scope.access |= next.scope.access;
        }
        same
    });
    found
}
