//! The times of passes, from timestamps that are read on request and never waited for.

use super::host::Host;
use super::maker::Maker;
use crate::Error;
use ash::vk;
use std::sync::atomic::{AtomicU16, AtomicU32, Ordering};

/// A pool of timestamps for each place, which is a light of a frame slot: one before the first pass and one after each.
pub(crate) struct Timing {
    pools: Vec<vk::QueryPool>,
    /// The nanoseconds of a tick.
    period: f64,
    /// The mask of a timestamp's valid bits.
    mask: u64,
    /// The number of queries in a pool.
    queries: u32,
    /// The passes that were recorded last at each place.
    recorded: Vec<Recorded>,
    /// The number of kinds of pass.
    kinds: usize,
}

/// The number of recorded passes, and the kind of each.
struct Recorded {
    count: AtomicU32,
    kinds: Vec<AtomicU16>,
}

impl Timing {
    /// Creates pools for up to `passes` passes of `kinds` kinds in a frame; no pools where the queue family has no
    /// timestamps.
    pub fn new(
        maker: &mut Maker,
        places: u32,
        kinds: usize,
        passes: usize,
    ) -> Result<Option<Self>, Error> {
        let host = maker.host;
        let (instance, physical) = (&host.instance, host.physical_device);
        // SAFETY: Host::borrow's promise: the handles are valid and belong together.
        let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
        // SAFETY: as above.
        let limits = unsafe { instance.get_physical_device_properties(physical) }.limits;
        let bits = families.get(host.queue_family as usize).map_or(0, |f| f.timestamp_valid_bits);
        if bits == 0 || limits.timestamp_period <= 0.0 {
            return Ok(None);
        }
        let queries = passes as u32 + 1;
        let create = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(queries);
        let pools = (0..places).map(|_| {
            // SAFETY: the device is valid (Host::borrow).
            let pool = unsafe { host.device.create_query_pool(&create, None) }
                .map_err(Error::vulkan("creating the timestamps"))?;
            Ok(maker.keep(pool))
        });
        Ok(Some(Self {
            pools: pools.collect::<Result<_, _>>()?,
            period: f64::from(limits.timestamp_period),
            mask: if bits >= 64 { u64::MAX } else { (1 << bits) - 1 },
            queries,
            recorded: (0..places)
                .map(|_| Recorded {
                    count: AtomicU32::new(0),
                    kinds: (0..passes).map(|_| AtomicU16::new(0)).collect(),
                })
                .collect(),
            kinds,
        }))
    }

    /// Resets the pool of a place and writes the first timestamp.
    pub fn begin(&self, host: &Host, cmd: vk::CommandBuffer, place: usize) {
        let pool = self.pools[place];
        self.recorded[place].count.store(0, Ordering::Relaxed);
        // SAFETY: Host::borrow's promise: cmd is recording outside a render pass, and the slot's
        // earlier commands are done.
        unsafe { host.device.cmd_reset_query_pool(cmd, pool, 0, self.queries) };
        // SAFETY: as above; query 0 was just reset.
        unsafe {
            host.device.cmd_write_timestamp(cmd, vk::PipelineStageFlags::BOTTOM_OF_PIPE, pool, 0);
        };
    }

    /// Notes that no pass was recorded at a place.
    pub fn nothing(&self, place: usize) {
        self.recorded[place].count.store(0, Ordering::Relaxed);
    }

    /// Writes the timestamp after pass number `nth` of the frame, which is of kind `kind`.
    pub fn end_pass(
        &self,
        host: &Host,
        cmd: vk::CommandBuffer,
        place: usize,
        (nth, kind): (usize, usize),
    ) {
        let recorded = &self.recorded[place];
        recorded.kinds[nth].store(kind as u16, Ordering::Relaxed);
        recorded.count.store(nth as u32 + 1, Ordering::Relaxed);
        let (pool, query) = (self.pools[place], nth as u32 + 1);
        // SAFETY: as in `begin`; each pass takes the next query, and there is one for every pass.
        unsafe {
            let bottom = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
            host.device.cmd_write_timestamp(cmd, bottom, pool, query);
        };
    }

    /// The kinds of pass that were recorded last at a place, in the order of their first passes, each with the
    /// milliseconds of all of its passes; `None` until the device has completed them.
    pub fn read(&self, host: &Host, place: usize) -> Option<Vec<(usize, f64)>> {
        let recorded = self.recorded.get(place)?;
        let count = recorded.count.load(Ordering::Relaxed) as usize;
        if count == 0 {
            return None;
        }
        let mut ticks = vec![0u64; count + 1];
        // SAFETY: the pool holds as many queries as were recorded; without WAIT the call returns
        // NOT_READY instead of blocking.
        unsafe {
            host.device.get_query_pool_results(
                self.pools[place],
                0,
                &mut ticks,
                vk::QueryResultFlags::TYPE_64,
            )
        }
        .ok()?;
        let ms =
            |pair: &[u64]| (pair[1].wrapping_sub(pair[0]) & self.mask) as f64 * self.period * 1e-6;
        let mut of_kind = vec![None; self.kinds];
        let mut sums: Vec<(usize, f64)> = Vec::new();
        for (kind, pair) in recorded.kinds.iter().zip(ticks.windows(2)) {
            let kind = usize::from(kind.load(Ordering::Relaxed));
            let at = *of_kind.get_mut(kind)?.get_or_insert_with(|| {
                sums.push((kind, 0.0));
                sums.len() - 1
            });
            sums[at].1 += ms(pair);
        }
        Some(sums)
    }
}
