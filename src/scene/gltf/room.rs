//! What the compressed parts of a file may decode to.
//!
//! What comes out of a stream is as long as the stream says, and a constant takes next to no bytes of it: a ratio that no
//! file that somebody made has would be none that bounds the memory.

use super::Problem;
use std::cell::Cell;

/// What compressed parts may decode to together: so many bytes, and as many for each byte of the file and its buffers.
const ROOM: [u64; 2] = [16 << 20, 64];

/// The bytes that a file's compressed parts decoded to.
#[derive(Default)]
pub(super) struct Room(Cell<u64>);

impl Room {
    pub fn taken(&self) -> u64 {
        self.0.get()
    }

    /// The bytes that are left for a file of so many.
    #[cfg(feature = "draco")]
    pub fn left(&self, bytes: u64) -> u64 {
        of(bytes).saturating_sub(self.taken())
    }

    /// Takes so many for a file of `bytes` bytes.
    pub fn take(&self, more: u64, bytes: u64) -> Result<(), Problem> {
        let (all, room) = (self.taken().saturating_add(more), of(bytes));
        if all > room {
            return Err(format!(
                "with it the file's compressed parts hold more than {room} bytes, 16 MiB and 64 for each byte of the file"
            ));
        }
        self.0.set(all);
        Ok(())
    }
}

fn of(bytes: u64) -> u64 {
    bytes.saturating_mul(ROOM[1]).saturating_add(ROOM[0])
}
