//! The plans of all lights of a frame, in memory that stays.

use super::FramePlan;
use super::make::{Memory, Workspace};
use crate::Error;

/// The plans of a frame's lights: a host keeps them from frame to frame, so that planning needs no new memory, and
/// looks again only at what has changed.
///
/// [`ShadowNode::plan_all`](crate::ShadowNode::plan_all) fills them.
#[derive(Debug, Default)]
pub struct FramePlans {
    plans: Vec<FramePlan>,
    /// Of each plan.
    memories: Vec<Memory>,
    workspace: Workspace,
    /// How many of them are this frame's.
    count: usize,
}

impl FramePlans {
    /// Of no frame yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The plans, in the order of the frames that they were made of.
    pub fn all(&self) -> &[FramePlan] {
        &self.plans[..self.count]
    }

    /// Forgets the frame before, but not what was learnt from it.
    pub(crate) fn begin(&mut self) {
        self.count = 0;
        self.workspace.mesh_boxes.forget();
    }

    /// Adds a plan that `make` fills.
    pub(crate) fn add(
        &mut self,
        make: impl FnOnce(&mut Workspace, &mut Memory, &mut FramePlan) -> Result<(), Error>,
    ) -> Result<(), Error> {
        if self.plans.len() == self.count {
            self.plans.push(FramePlan::default());
            self.memories.push(Memory::default());
        }
        let (memory, plan) = (&mut self.memories[self.count], &mut self.plans[self.count]);
        make(&mut self.workspace, memory, plan)?;
        self.count += 1;
        Ok(())
    }
}

impl<'a> IntoIterator for &'a FramePlans {
    type Item = &'a FramePlan;
    type IntoIter = std::slice::Iter<'a, FramePlan>;

    fn into_iter(self) -> Self::IntoIter {
        self.all().iter()
    }
}
