//! Objects that a node has replaced, until no frame uses them.

use super::host::Host;
use super::memory::Allocator;
use super::owner::ObjectOwner;
use std::collections::VecDeque;

/// The objects that a resize or a reconfiguration replaced. They must live until the device has completed the frames
/// that use them.
#[must_use = "destroy it once the frames recorded before are done, or its memory is lost"]
pub struct Retired {
    host: Host,
    owner: ObjectOwner,
}

impl Retired {
    pub(crate) fn new(host: Host, owner: ObjectOwner) -> Self {
        Self { host, owner }
    }

    /// Destroys the objects. The device must have completed every frame recorded before the replacement.
    pub fn destroy(self, allocator: &mut dyn Allocator) {
        self.owner.destroy(&self.host.device, |block| allocator.free(block));
    }
}

/// A queue of replaced objects with the number of the last frame that may use each, for hosts that count their frames.
#[derive(Default)]
pub struct RetireQueue(VecDeque<(u64, Retired)>);

impl RetireQueue {
    /// Adds objects that the device may use up to frame `last_frame`, the last that was recorded.
    pub fn push(&mut self, last_frame: u64, retired: Retired) {
        self.0.push_back((last_frame, retired));
    }

    /// Destroys the objects that no frame after `done` uses. The device must have completed all frames up to `done`.
    pub fn done(&mut self, done: u64, allocator: &mut dyn Allocator) {
        while self.0.front().is_some_and(|(last_frame, _)| *last_frame <= done) {
            if let Some((_, retired)) = self.0.pop_front() {
                retired.destroy(allocator);
            }
        }
    }
}
