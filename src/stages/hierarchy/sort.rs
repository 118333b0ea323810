//! The keys of the triangles, sorted: four passes of a radix sort, a digit of eight bits each.

use super::{Sizes, groups};
use crate::graph::{Access, Graph, Need, Pass, Push, ResourceId, Until, Use, Work};
use crate::shaders::module;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The keys of a run, and the digits (`hierarchy/sort.glsl`).
const RUN: u32 = 256;
/// The bits of a digit.
const DIGIT_BITS: u32 = 8;

/// The push constants of the sort (`hierarchy/sort.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SortPush {
    /// The number of keys.
    pub keys: u32,
    /// The number of runs that they make.
    pub runs: u32,
    /// The first bit of the digit.
    pub shift: u32,
}

/// Adds the passes that make the keys and sort them; returns the buffer of sorted keys, each with its triangle.
pub(super) fn keys(graph: &mut Graph, sizes: Sizes, need: &Need) -> ResourceId {
    let runs = u64::from(sizes.capacity.div_ceil(RUN));
    let mut listed = |name, bytes| {
        let id = graph.buffer(name, bytes);
        graph.keep_until(id, Until::Listed);
        id
    };
    let keys = [
        listed("hierarchy.keys", 8 * u64::from(sizes.capacity)),
        listed("hierarchy.keys_other", 8 * u64::from(sizes.capacity)),
    ];
    let counts = listed("hierarchy.counts", 4 * u64::from(RUN) * runs);
    let totals = listed("hierarchy.totals", 4 * runs);
    graph.push(Pass {
        name: "hierarchy.keys",
        uses: smallvec![Use::bound(0, keys[0], Access::BufferWriteCompute)],
        push: Push::NONE,
        work: Work::EachMesh { shader: module!("hierarchy/keys.comp") },
        need: *need,
    });
    const COUNT: [&str; 2] = ["hierarchy.count_even", "hierarchy.count_odd"];
    const SCATTER: [&str; 2] = ["hierarchy.scatter_even", "hierarchy.scatter_odd"];
    let read = |binding, id| Use::bound(binding, id, Access::BufferReadCompute);
    let write = |binding, id| Use::bound(binding, id, Access::BufferWriteCompute);
    let update = |binding, id| Use::bound(binding, id, Access::BufferUpdate);
    let runs = sizes.triangles.div_ceil(RUN);
    for digit in 0..u32::BITS / DIGIT_BITS {
        let odd = (digit % 2) as usize;
        let (from, to) = (keys[odd], keys[1 - odd]);
        let push = Push::new(&SortPush { keys: sizes.triangles, runs, shift: digit * DIGIT_BITS });
        graph.push(Pass::compute(
            COUNT[odd],
            module!("hierarchy/count.comp"),
            groups(runs),
            push,
            smallvec![read(0, from), write(1, counts)],
            need,
        ));
        graph.push(Pass::compute(
            "hierarchy.sums",
            module!("hierarchy/sums.comp"),
            groups(runs),
            push,
            smallvec![update(0, counts), write(1, totals)],
            need,
        ));
        graph.push(Pass::compute(
            "hierarchy.totals",
            module!("hierarchy/totals.comp"),
            [1, 1, 1],
            push,
            smallvec![update(0, totals)],
            need,
        ));
        graph.push(Pass::compute(
            SCATTER[odd],
            module!("hierarchy/scatter.comp"),
            groups(runs),
            push,
            smallvec![read(0, from), update(1, counts), read(2, totals), write(3, to)],
            need,
        ));
    }
    keys[0]
}
