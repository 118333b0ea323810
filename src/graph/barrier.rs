//! The barriers between accesses, derived by a pure function.
//!
//! Each resource has a [`State`]: its last write, the stages that the write is visible to, the stages that have read
//! since, and an image's layout. [`State::touch`] advances the state by the next use and returns the barrier that this
//! use needs, if any. There are four cases:
//!
//! | next use | after | needs |
//! |---|---|---|
//! | read | a write that is not visible to it | execution and memory dependency on the write |
//! | read | a write already made visible to that stage and access | nothing |
//! | write | reads | execution dependency on the reads |
//! | write | a write | execution and memory dependency on the write |
//!
//! A change of layout needs a barrier whatever the use.

use super::access::{Scope, WRITES};
use ash::vk;

/// One dependency for one resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Barrier {
    /// The stages that must be complete.
    pub src_stage: vk::PipelineStageFlags,
    /// The writes of these stages to make available.
    pub src_access: vk::AccessFlags,
    /// The stages that wait.
    pub dst_stage: vk::PipelineStageFlags,
    /// The accesses of the waiting stages that the writes are made visible to.
    pub dst_access: vk::AccessFlags,
    /// The image's layout before; `UNDEFINED` discards the content.
    pub old_layout: vk::ImageLayout,
    /// The image's layout after; equal to `old_layout` where it does not change.
    pub new_layout: vk::ImageLayout,
}

/// The accesses to a resource that later ones may have to wait for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// The stages and accesses of the last write.
    write: (vk::PipelineStageFlags, vk::AccessFlags),
    /// The stages and accesses that the last write was made visible to.
    seen_by: (vk::PipelineStageFlags, vk::AccessFlags),
    /// The stages that have read since the last write.
    readers: vk::PipelineStageFlags,
    /// The image's layout.
    layout: vk::ImageLayout,
}

impl State {
    /// The state of a resource whose last use, outside the plan, has the scope `scope`.
    pub fn left_in(scope: Scope) -> Self {
        let none = (vk::PipelineStageFlags::empty(), vk::AccessFlags::empty());
        let writes = scope.access & WRITES;
        if writes.is_empty() {
            let seen_by = (scope.stage, scope.access);
            Self { write: none, seen_by, readers: scope.stage, layout: scope.layout }
        } else {
            let readers = vk::PipelineStageFlags::empty();
            Self { write: (scope.stage, writes), seen_by: none, readers, layout: scope.layout }
        }
    }

    /// The state of a resource whose content may be discarded and whose last uses are within `scope`.
    pub fn forgotten(scope: Scope) -> Self {
        Self {
            // Earlier reads and writes must be complete before the first write of the frame.
            write: (scope.stage, scope.access & WRITES),
            seen_by: (vk::PipelineStageFlags::empty(), vk::AccessFlags::empty()),
            readers: vk::PipelineStageFlags::empty(),
            layout: vk::ImageLayout::UNDEFINED,
        }
    }

    /// The image's present layout.
    pub fn layout(&self) -> vk::ImageLayout {
        self.layout
    }

    /// The scope of the last uses, which the next use has to wait for.
    pub fn scope(&self) -> Scope {
        let (stage, access) =
            if self.readers.is_empty() { self.write } else { (self.readers, self.seen_by.1) };
        Scope { stage, access, layout: self.layout }
    }

    /// Advances the state by the next use, and returns the barrier that this use needs, if any.
    pub fn touch(&mut self, next: Scope, writes: bool) -> Option<Barrier> {
        let new_layout =
            if next.layout == vk::ImageLayout::UNDEFINED { self.layout } else { next.layout };
        let relayout = new_layout != self.layout;
        let was_written = !self.write.0.is_empty();
        // A resource left by readers outside the plan was written before them, visible to them alone.
        let unseen = (was_written || !self.readers.is_empty())
            && !(self.seen_by.0.contains(next.stage) && self.seen_by.1.contains(next.access));
        let must_wait = if writes { was_written || !self.readers.is_empty() } else { unseen };
        let barrier = (must_wait || relayout).then(|| {
            // Reads since the write have waited for it: a new write needs to wait for them alone, but a new read still
            // depends on the write itself.
            let after_readers = (writes || relayout || !was_written) && !self.readers.is_empty();
            let (src_stage, src_access) = if after_readers {
                (self.readers | self.write.0, self.write.1)
            } else {
                self.write
            };
            Barrier {
                src_stage: or_top(src_stage),
                src_access,
                dst_stage: next.stage,
                dst_access: next.access,
                old_layout: self.layout,
                new_layout,
            }
        });
        if writes {
            *self = Self {
                write: (next.stage, next.access & WRITES),
                seen_by: (vk::PipelineStageFlags::empty(), vk::AccessFlags::empty()),
                readers: vk::PipelineStageFlags::empty(),
                layout: new_layout,
            };
        } else {
            if relayout {
                // A layout transition counts as a write that is visible to this use alone.
                self.write = (next.stage, vk::AccessFlags::empty());
                self.seen_by = (next.stage, next.access);
                self.readers = next.stage;
            } else {
                if barrier.is_some() {
                    self.seen_by = (self.seen_by.0 | next.stage, self.seen_by.1 | next.access);
                }
                self.readers |= next.stage;
            }
            self.layout = new_layout;
        }
        barrier
    }
}

fn or_top(stage: vk::PipelineStageFlags) -> vk::PipelineStageFlags {
    if stage.is_empty() { vk::PipelineStageFlags::TOP_OF_PIPE } else { stage }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Access;

    /// Applies `uses` to a new transient and returns (source stage, source access) of each use's barrier, or None.
    fn play(
        uses: &[Access],
    ) -> Vec<Option<(vk::PipelineStageFlags, vk::AccessFlags, vk::ImageLayout)>> {
        let mut state = State::forgotten(Scope {
            stage: vk::PipelineStageFlags::empty(),
            access: vk::AccessFlags::empty(),
            layout: vk::ImageLayout::UNDEFINED,
        });
        uses.iter()
            .map(|u| {
                let barrier = state.touch(u.scope(), u.writes());
                barrier.map(|b| (b.src_stage, b.src_access, b.new_layout))
            })
            .collect()
    }

    #[test]
    fn buffers_by_table() {
        use Access::{BufferReadCompute as R, BufferReadVertex as V, BufferWriteCompute as W};
        use vk::{AccessFlags as A, ImageLayout as L, PipelineStageFlags as S};
        let raw = Some((S::COMPUTE_SHADER, A::SHADER_WRITE, L::UNDEFINED));
        // first write: nothing to wait for
        assert_eq!(play(&[W]), [None]);
        // read after write, and a second read at the same stage
        assert_eq!(play(&[W, R, R]), [None, raw, None]);
        // a second stage must see the write for itself
        assert_eq!(play(&[W, R, V]), [None, raw, raw]);
        // write after write
        assert_eq!(play(&[W, W]), [None, raw]);
        // write after read waits for the reader too
        assert_eq!(
            play(&[W, V, W])[2],
            Some((S::VERTEX_SHADER | S::COMPUTE_SHADER, A::SHADER_WRITE, L::UNDEFINED))
        );
        // indirect arguments
        assert_eq!(play(&[W, Access::Indirect])[1], raw);
    }

    #[test]
    fn images_by_table() {
        use Access::{ColorTarget, DepthTarget, ImageWrite, SampledCompute, SampledFragment};
        use vk::{ImageLayout as L, PipelineStageFlags as S};
        // the first write transitions from UNDEFINED
        assert_eq!(play(&[DepthTarget])[0].unwrap().2, L::DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
        let depth = play(&[DepthTarget, SampledCompute, SampledFragment]);
        assert_eq!(depth[1].unwrap().0, S::EARLY_FRAGMENT_TESTS | S::LATE_FRAGMENT_TESTS);
        assert_eq!(depth[1].unwrap().2, L::SHADER_READ_ONLY_OPTIMAL);
        // the fragment stage waits on the transition, which the compute stage waited for
        assert_eq!(depth[2].unwrap().0, S::COMPUTE_SHADER);
        // back to writing: the readers must be done
        let again = play(&[ColorTarget, SampledCompute, ColorTarget]);
        assert!(again[2].unwrap().0.contains(S::COMPUTE_SHADER));
        assert_eq!(play(&[ImageWrite, SampledCompute])[1].unwrap().2, L::SHADER_READ_ONLY_OPTIMAL);
    }

    #[test]
    fn what_the_host_left_behind_is_waited_for() {
        use vk::{AccessFlags as A, ImageLayout as L, PipelineStageFlags as S};
        let drawn = Scope {
            stage: S::LATE_FRAGMENT_TESTS,
            access: A::DEPTH_STENCIL_ATTACHMENT_WRITE,
            layout: L::DEPTH_STENCIL_READ_ONLY_OPTIMAL,
        };
        let mut state = State::left_in(drawn);
        let scope = Scope { layout: drawn.layout, ..Access::SampledCompute.scope() };
        let barrier = state.touch(scope, false).unwrap();
        assert_eq!(barrier.src_stage, S::LATE_FRAGMENT_TESTS);
        assert_eq!(barrier.old_layout, barrier.new_layout);
        assert_eq!(state.touch(scope, false), None);
        // After a reader outside the plan, a read by the same stage needs no barrier.
        let mut read = State::left_in(scope);
        assert_eq!(read.touch(scope, false), None);
        assert_eq!(read.scope().stage, S::COMPUTE_SHADER);
        // To another stage nothing is visible yet: it waits for the readers, and so for the write before them.
        let mut read = State::left_in(Scope { stage: S::FRAGMENT_SHADER, ..scope });
        let barrier = read.touch(scope, false).unwrap();
        assert_eq!((barrier.src_stage, barrier.src_access), (S::FRAGMENT_SHADER, A::empty()));
        assert_eq!((barrier.dst_stage, barrier.dst_access), (S::COMPUTE_SHADER, A::SHADER_READ));
        assert_eq!(read.touch(scope, false), None);
        assert_eq!(read.scope().stage, S::FRAGMENT_SHADER | S::COMPUTE_SHADER);
    }
}
