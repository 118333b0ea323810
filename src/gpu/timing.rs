//! Times of passes, by timestamps; read only when the host asks, never waited for.

use super::host::Host;
use crate::Error;
use ash::vk;
use std::sync::atomic::{AtomicBool, Ordering};

/// One pool of timestamps a frame slot: one before the first pass, one behind each.
pub(crate) struct Timing {
    pools: Vec<vk::QueryPool>,
    /// Nanoseconds a tick.
    period: f64,
    /// The bits of a timestamp that count.
    mask: u64,
    /// Queries a pool.
    queries: u32,
    /// Which rows each slot recorded last; rows are recorded in their order.
    recorded: Vec<Vec<AtomicBool>>,
}

impl Timing {
    /// Makes pools for `rows` rows, or none where the queue family has no timestamps.
    pub fn new(host: &Host, slots: u32, rows: usize) -> Result<Option<Self>, Error> {
        let (instance, physical) = (&host.instance, host.physical_device);
        // SAFETY: Host::borrow's promise: the handles are valid and belong together.
        let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
        // SAFETY: as above.
        let limits = unsafe { instance.get_physical_device_properties(physical) }.limits;
        let bits = families.get(host.queue_family as usize).map_or(0, |f| f.timestamp_valid_bits);
        if bits == 0 || limits.timestamp_period <= 0.0 {
            return Ok(None);
        }
        let mut timing = Self {
            pools: Vec::new(),
            period: f64::from(limits.timestamp_period),
            mask: if bits >= 64 { u64::MAX } else { (1 << bits) - 1 },
            queries: rows as u32 + 1,
            recorded: (0..slots)
                .map(|_| (0..rows).map(|_| AtomicBool::new(false)).collect())
                .collect(),
        };
        for _ in 0..slots {
            let create = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::TIMESTAMP)
                .query_count(timing.queries);
            // SAFETY: the device is valid (Host::borrow).
            match unsafe { host.device.create_query_pool(&create, None) } {
                Ok(pool) => timing.pools.push(pool),
                Err(e) => {
                    timing.destroy(host);
                    return Err(Error::vulkan("creating the timestamps")(e));
                }
            }
        }
        Ok(Some(timing))
    }

    /// Starts a slot anew: resets its pool and takes the first timestamp.
    pub fn begin(&self, host: &Host, cmd: vk::CommandBuffer, slot: u32) {
        let pool = self.pools[slot as usize];
        self.recorded[slot as usize].iter().for_each(|row| row.store(false, Ordering::Relaxed));
        // SAFETY: Host::borrow's promise: cmd is recording outside a render pass, and the slot's
        // earlier commands are done.
        unsafe { host.device.cmd_reset_query_pool(cmd, pool, 0, self.queries) };
        // SAFETY: as above; query 0 was just reset.
        unsafe {
            host.device.cmd_write_timestamp(cmd, vk::PipelineStageFlags::BOTTOM_OF_PIPE, pool, 0);
        };
    }

    /// Takes the timestamp behind a row, the `nth` of the slot from 0.
    pub fn end_row(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        slot: u32,
        (nth, row): (usize, usize),
    ) {
        self.recorded[slot as usize][row].store(true, Ordering::Relaxed);
        let (pool, query) = (self.pools[slot as usize], nth as u32 + 1);
        // SAFETY: as in `begin`; each row takes the next query, and there is one for every row.
        unsafe {
            let bottom = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
            host.device.cmd_write_timestamp(cmd, bottom, pool, query);
        };
    }

    /// Milliseconds of each row that the slot recorded last; none until its commands are done.
    pub fn read(&self, host: &Host, slot: u32) -> Option<Vec<(usize, f64)>> {
        let recorded = self.recorded.get(slot as usize)?.iter().enumerate();
        let rows: Vec<usize> =
            recorded.filter(|(_, r)| r.load(Ordering::Relaxed)).map(|(row, _)| row).collect();
        let mut ticks = vec![0u64; rows.len() + 1];
        if rows.is_empty() {
            return None;
        }
        // SAFETY: the pool holds as many queries as were recorded; without WAIT the call returns
        // NOT_READY instead of blocking.
        unsafe {
            host.device.get_query_pool_results(
                self.pools[slot as usize],
                0,
                &mut ticks,
                vk::QueryResultFlags::TYPE_64,
            )
        }
        .ok()?;
        let ms =
            |pair: &[u64]| (pair[1].wrapping_sub(pair[0]) & self.mask) as f64 * self.period * 1e-6;
        Some(rows.iter().copied().zip(ticks.windows(2).map(ms)).collect())
    }

    /// Destroys the pools; no command may use them any more.
    pub fn destroy(self, host: &Host) {
        for pool in self.pools {
            // SAFETY: made by this device; Host::borrow's promise: no command uses it any more.
            unsafe { host.device.destroy_query_pool(pool, None) };
        }
    }
}
