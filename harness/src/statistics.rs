//! Counts shader invocations, by pipeline statistics.

use crate::HeadlessDevice;
use antumbra::Error;
use ash::vk;

/// The numbers of shader invocations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Invocations {
    /// The invocations of vertex shaders.
    pub vertex: u64,
    /// The invocations of fragment shaders.
    pub fragment: u64,
    /// The invocations of compute shaders.
    pub compute: u64,
}

/// A query pool that goes away with its owner.
struct Pool<'d>(&'d ash::Device, vk::QueryPool);

impl Drop for Pool<'_> {
    fn drop(&mut self) {
        // SAFETY: made by this device, and every submit that used it was waited for.
        unsafe { self.0.destroy_query_pool(self.1, None) };
    }
}

impl HeadlessDevice {
    /// Records, submits and waits as [`Self::submit_and_wait`] does, and counts what shaders did; nothing is
    /// submitted, and the answer is none, where the device has no statistics or
    /// [`crate::HeadlessOptions::statistics`] did not ask for them.
    ///
    /// # Errors
    /// See [`Self::submit_and_wait`].
    pub fn count(
        &self,
        record: impl FnOnce(vk::CommandBuffer) -> Result<(), Error>,
    ) -> Result<Option<Invocations>, Error> {
        if !self.has_statistics() {
            return Ok(None);
        }
        use vk::QueryPipelineStatisticFlags as Flags;
        let device = self.device();
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::PIPELINE_STATISTICS)
            .query_count(1)
            .pipeline_statistics(
                Flags::VERTEX_SHADER_INVOCATIONS
                    | Flags::FRAGMENT_SHADER_INVOCATIONS
                    | Flags::COMPUTE_SHADER_INVOCATIONS,
            );
        // SAFETY: the feature was turned on when the device was made.
        let pool = unsafe { device.create_query_pool(&info, None) }
            .map_err(Error::vulkan("creating a pool of statistics"))?;
        let pool = Pool(device, pool);
        self.submit_and_wait(|cmd| {
            // SAFETY: recording outside a render pass; the pool has one query.
            unsafe { device.cmd_reset_query_pool(cmd, pool.1, 0, 1) };
            // SAFETY: as above; it was reset.
            unsafe { device.cmd_begin_query(cmd, pool.1, 0, vk::QueryControlFlags::empty()) };
            let done = record(cmd);
            // SAFETY: begun above in the same command buffer, and outside a render pass again.
            unsafe { device.cmd_end_query(cmd, pool.1, 0) };
            done
        })?;
        let mut counts = [[0u64; 3]];
        // SAFETY: the query was submitted and waited for; it has three numbers of 64 bits.
        unsafe {
            device.get_query_pool_results(
                pool.1,
                0,
                &mut counts,
                vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT,
            )
        }
        .map_err(Error::vulkan("reading statistics"))?;
        let [[vertex, fragment, compute]] = counts;
        Ok(Some(Invocations { vertex, fragment, compute }))
    }
}
