//! What the node no longer needs, until nobody does.

use super::host::Host;
use super::memory::Allocator;
use super::owner::ObjectOwner;
use std::collections::VecDeque;

/// What a resize or a reconfiguration replaced: alive until the frames that use it are done.
#[must_use = "destroy it once the frames recorded before are done, or its memory is lost"]
pub struct Retired {
    host: Host,
    owner: ObjectOwner,
}

impl Retired {
    pub(crate) fn new(host: Host, owner: ObjectOwner) -> Self {
        Self { host, owner }
    }

    /// Destroys it; the device must be done with every frame recorded before the replacement.
    pub fn destroy(self, allocator: &mut dyn Allocator) {
        self.owner.destroy(&self.host.device, |block| allocator.free(block));
    }
}

/// What resizes replaced, with the last frame that may use each, for hosts that count their frames.
#[derive(Default)]
pub struct RetireQueue(VecDeque<(u64, Retired)>);

impl RetireQueue {
    /// Keeps it until the frame of this number, the last that was recorded, is done.
    pub fn push(&mut self, last_frame: u64, retired: Retired) {
        self.0.push_back((last_frame, retired));
    }

    /// Destroys what no frame behind `done` uses, where all frames up to `done` are done.
    pub fn done(&mut self, done: u64, allocator: &mut dyn Allocator) {
        while self.0.front().is_some_and(|(last_frame, _)| *last_frame <= done) {
            if let Some((_, retired)) = self.0.pop_front() {
                retired.destroy(allocator);
            }
        }
    }
}
