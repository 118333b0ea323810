//! The plans of all lights of a frame, in memory that is kept.

use super::FramePlan;
use super::make::{Memory, Workspace};
use crate::Error;

/// The plans of a frame's lights. A host keeps this value from frame to frame, so that planning allocates no memory and
/// visits the meshes only of frames whose revision has changed.
///
/// [`ShadowNode::plan_all`](crate::ShadowNode::plan_all) fills them.
#[derive(Debug, Default)]
pub struct FramePlans {
    plans: Vec<FramePlan>,
    /// The memory of each plan's light.
    memories: Vec<Memory>,
    workspace: Workspace,
    /// How many of the plans are this frame's.
    count: usize,
}

impl FramePlans {
    /// No plans yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The plans, in the order of their frames.
    pub fn all(&self) -> &[FramePlan] {
        &self.plans[..self.count]
    }

    /// Drops the last frame's plans and keeps their memory.
    pub(crate) fn begin(&mut self) {
        self.count = 0;
        self.workspace.mesh_boxes.forget();
    }

    /// Adds a plan that `make` fills; after an error it is not added.
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
