//! Barriers, derived from accesses by a pure function.
//!
//! Each resource carries its [`State`]: who wrote it last, who has seen that write, who has read it
//! since, and an image's layout. [`State::touch`] takes the next use, says which barrier it needs,
//! if any, and moves the state on. The four cases:
//!
//! | next use | after | needs |
//! |---|---|---|
//! | read | a write it has not seen | execution and memory dependency on the write |
//! | read | a write already made visible to that stage and access | nothing |
//! | write | reads | execution dependency on the reads |
//! | write | a write | execution and memory dependency on the write |
//!
//! and any change of layout needs a barrier whatever the use.

use super::access::{Scope, WRITES};
use ash::vk;

/// One dependency for one resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Barrier {
    /// Stages that must be done.
    pub src_stage: vk::PipelineStageFlags,
    /// Writes of theirs to make available.
    pub src_access: vk::AccessFlags,
    /// Stages that wait.
    pub dst_stage: vk::PipelineStageFlags,
    /// Accesses of theirs to make it visible to.
    pub dst_access: vk::AccessFlags,
    /// The image's layout before; `UNDEFINED` forgets the content.
    pub old_layout: vk::ImageLayout,
    /// The image's layout after; as before where nothing changes.
    pub new_layout: vk::ImageLayout,
}

/// What has happened to a resource so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// The last write that is not yet followed by another.
    write: (vk::PipelineStageFlags, vk::AccessFlags),
    /// Stages and accesses that the last write was made visible to.
    seen_by: (vk::PipelineStageFlags, vk::AccessFlags),
    /// Stages that have read since the last write.
    readers: vk::PipelineStageFlags,
    /// The layout it is in.
    layout: vk::ImageLayout,
}

impl State {
    /// A resource that somebody else left behind in `scope`.
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

    /// A resource whose content nobody wants, last touched by any of `scope`'s stages.
    pub fn forgotten(scope: Scope) -> Self {
        Self {
            // Old readers and writers alike must be done before the first write of the frame.
            write: (scope.stage, scope.access & WRITES),
            seen_by: (vk::PipelineStageFlags::empty(), vk::AccessFlags::empty()),
            readers: vk::PipelineStageFlags::empty(),
            layout: vk::ImageLayout::UNDEFINED,
        }
    }

    /// The layout it is in now.
    pub fn layout(&self) -> vk::ImageLayout {
        self.layout
    }

    /// What touched it last, for whoever comes next.
    pub fn scope(&self) -> Scope {
        let (stage, access) =
            if self.readers.is_empty() { self.write } else { (self.readers, self.seen_by.1) };
        Scope { stage, access, layout: self.layout }
    }

    /// The barrier that the next use needs, if any; moves the state on.
    pub fn touch(&mut self, next: Scope, writes: bool) -> Option<Barrier> {
        let new_layout =
            if next.layout == vk::ImageLayout::UNDEFINED { self.layout } else { next.layout };
        let relayout = new_layout != self.layout;
        let was_written = !self.write.0.is_empty();
        // What somebody else left to its readers was written before them, and they alone have seen it.
        let unseen = (was_written || !self.readers.is_empty())
            && !(self.seen_by.0.contains(next.stage) && self.seen_by.1.contains(next.access));
        let must_wait = if writes { was_written || !self.readers.is_empty() } else { unseen };
        let barrier = (must_wait || relayout).then(|| {
            // Readers since the write already waited for it: waiting for them is enough to
            // overwrite, but a new reader still depends on the write itself.
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
                // A layout transition is a write of its own, made visible to this use alone.
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

    /// Plays `uses` on a fresh transient and returns, per use, (src stage, src access) of its
    /// barrier or None.
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
        // Left by a reader: reading on needs nothing.
        let mut read = State::left_in(scope);
        assert_eq!(read.touch(scope, false), None);
        assert_eq!(read.scope().stage, S::COMPUTE_SHADER);
        // But another stage has seen nothing yet: it waits for the readers, and so for what they saw.
        let mut read = State::left_in(Scope { stage: S::FRAGMENT_SHADER, ..scope });
        let barrier = read.touch(scope, false).unwrap();
        assert_eq!((barrier.src_stage, barrier.src_access), (S::FRAGMENT_SHADER, A::empty()));
        assert_eq!((barrier.dst_stage, barrier.dst_access), (S::COMPUTE_SHADER, A::SHADER_READ));
        assert_eq!(read.touch(scope, false), None);
        assert_eq!(read.scope().stage, S::FRAGMENT_SHADER | S::COMPUTE_SHADER);
    }
}
