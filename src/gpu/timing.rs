//! The times of passes, from timestamps that are read on request and never waited for.

use super::host::Host;
use super::maker::Maker;
use crate::Error;
use ash::vk;
use std::sync::atomic::{AtomicU16, AtomicU32, Ordering};

/// A pool of timestamps for each place, which is a light of a frame slot: one before the first pass, one after each, and one
/// before the first pass of a second part that is recorded apart.
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
    /// The number of the first pass of the second part; [`WHOLE`] where there was one part.
    resumed: AtomicU32,
    kinds: Vec<AtomicU16>,
}

/// No pass has this number.
const WHOLE: u32 = u32::MAX;

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
        let queries = passes as u32 + 2;
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
                    resumed: AtomicU32::new(WHOLE),
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
        self.recorded[place].resumed.store(WHOLE, Ordering::Relaxed);
        // SAFETY: Host::borrow's promise: cmd is recording outside a render pass, and the slot's
        // earlier commands are done.
        unsafe { host.device.cmd_reset_query_pool(cmd, pool, 0, self.queries) };
        // SAFETY: as above; query 0 was just reset.
        unsafe {
            host.device.cmd_write_timestamp(cmd, vk::PipelineStageFlags::BOTTOM_OF_PIPE, pool, 0);
        };
    }

    /// Writes the timestamp before pass number `nth` of the frame, which begins its second part.
    pub fn resume(&self, host: &Host, cmd: vk::CommandBuffer, place: usize, nth: usize) {
        self.recorded[place].resumed.store(nth as u32, Ordering::Relaxed);
        let (pool, query) = (self.pools[place], self.queries - 1);
        // SAFETY: as in `begin`; the last query is for this alone, and the first part has reset it.
        unsafe {
            let bottom = vk::PipelineStageFlags::BOTTOM_OF_PIPE;
            host.device.cmd_write_timestamp(cmd, bottom, pool, query);
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
        let results = |first, ticks: &mut [u64]| {
            let (pool, flags) = (self.pools[place], vk::QueryResultFlags::TYPE_64);
            // SAFETY: the pool holds as many queries as were recorded; without WAIT the call returns
            // NOT_READY instead of blocking.
            unsafe { host.device.get_query_pool_results(pool, first, ticks, flags) }.ok()
        };
        results(0, &mut ticks)?;
        let resumed = recorded.resumed.load(Ordering::Relaxed);
        let mut begin = [0u64];
        if resumed != WHOLE {
            results(self.queries - 1, &mut begin)?;
        }
        let ms =
            |from: u64, to: u64| (to.wrapping_sub(from) & self.mask) as f64 * self.period * 1e-6;
        let mut of_kind = vec![None; self.kinds];
        let mut sums: Vec<(usize, f64)> = Vec::new();
        for (nth, (kind, pair)) in (0..).zip(recorded.kinds.iter().zip(ticks.windows(2))) {
            // Between the parts the host may have done anything.
            let from = if nth == resumed { begin[0] } else { pair[0] };
            let kind = usize::from(kind.load(Ordering::Relaxed));
            let at = *of_kind.get_mut(kind)?.get_or_insert_with(|| {
                sums.push((kind, 0.0));
                sums.len() - 1
            });
            sums[at].1 += ms(from, pair[1]);
        }
        Some(sums)
    }
}
