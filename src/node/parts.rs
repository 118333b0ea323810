//! Recording a plan: whole, or in two parts.

use super::ShadowNode;
use crate::Error;
use crate::frame::{FramePlan, Part};
use crate::gpu::HostDraw;
use ash::vk;

impl ShadowNode {
    /// Records one part of a plan, as [`Self::record_with`] records the whole of it: [`Part::Light`] first, which needs no
    /// G-buffer and may run while the host draws it, then [`Part::Pixels`]. `draw` is called for meshes that the host draws,
    /// and not where there are none.
    ///
    /// Into command buffers of one queue the second part's barriers are all that is needed. On another queue of the same
    /// family the host owes two semaphores: the second part waits for the first, and the first part of the technique's next
    /// plan, of whatever light and frame, waits for this second part, which reads the maps that it draws over; both at
    /// `ALL_COMMANDS`, since the barriers that follow change layouts. The first part uses no image of the host's: all of
    /// [`FramePlan::accesses`] is the second part's, and [`FramePlan::buffer_accesses`] is both parts'.
    ///
    /// # Errors
    /// As [`Self::record_with`]. The second part is refused with [`Error::StalePlan`] where the plan's first part is not the
    /// last that was recorded of the plan's technique.
    pub fn record_part(
        &self,
        cmd: vk::CommandBuffer,
        plan: &FramePlan,
        part: Part,
        draw: &mut dyn FnMut(&HostDraw),
    ) -> Result<(), Error> {
        self.record_parts(cmd, plan, Some(part), draw)
    }

    pub(super) fn record_parts(
        &self,
        cmd: vk::CommandBuffer,
        plan: &FramePlan,
        part: Option<Part>,
        draw: &mut dyn FnMut(&HostDraw),
    ) -> Result<(), Error> {
        if plan.stamp != self.stamp {
            return Err(Error::StalePlan("was made by another node, or before a resize"));
        }
        if cmd == vk::CommandBuffer::null() {
            return Err(Error::Frame("the command buffer to record into is a null handle".into()));
        }
        let mut cache = self.cache();
        let (key, slot) = (plan.cache_key(), plan.slot());
        if part == Some(Part::Pixels) {
            if !cache.has_begun(key, slot) {
                let why = "has its first part not recorded, or another plan of its technique has been recorded since";
                return Err(Error::StalePlan(why));
            }
        } else if !cache.agrees(key, &plan.reuse) {
            cache.forget_planned();
            let why = "counts on maps or pixels that a frame recorded since has replaced";
            return Err(Error::StalePlan(why));
        }
        match part {
            Some(Part::Light) => cache.begun(key, slot, &plan.reuse),
            _ => cache.recorded(key, &plan.reuse),
        }
        drop(cache);
        self.objects.record(&self.host, cmd, (plan, part), draw);
        Ok(())
    }
}
