//! The figures of audits, in memory that the host sees: a small buffer for each light of each frame slot.

use super::maker::Maker;
use super::memory::{Mapped, ResourceBytes};
use super::objects::{Object, new_buffer};
use crate::Error;
use crate::audit::{FIGURE_BYTES, Figures, MeasuredError};
use crate::frame::Description;
use crate::graph::{Graph, Owner};
use crate::lent::LightIndex;
use ash::vk;
use std::sync::atomic::{AtomicU32, Ordering};

/// The buffers of all places; a place is a light of a frame slot.
pub(crate) struct Measured {
    places: Vec<Place>,
    /// How many frames of each light were recorded.
    frames: Vec<AtomicU32>,
    bytes: u64,
}

struct Place {
    buffer: vk::Buffer,
    figures: Mapped,
    /// The number of the frame that was recorded last; 0 where it ran no audit.
    recorded: AtomicU32,
}

impl Measured {
    /// Creates the buffers where a graph has any.
    pub fn new(
        maker: &mut Maker,
        graphs: &[Graph],
        description: &Description,
    ) -> Result<Option<Self>, Error> {
        let mut resources = graphs.iter().flat_map(Graph::resources);
        let Some(resource) = resources.find(|r| r.owner == Owner::HostRead) else {
            return Ok(None);
        };
        let mut all = 0;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let places = (0..description.frames_in_flight * description.lights).map(|_| {
            let (buffer, bytes, figures) =
                new_buffer(maker, resource.name, FIGURE_BYTES, usage, true)?;
            all += bytes;
            let figures = figures.ok_or_else(|| Error::Memory {
                resource: resource.name.into(),
                bytes,
                problem: "the allocator has not mapped it, as MemoryRequest::mapped wants".into(),
            })?;
            Ok(Place { buffer, figures, recorded: AtomicU32::new(0) })
        });
        let places = places.collect::<Result<_, Error>>()?;
        let frames = (0..description.lights).map(|_| AtomicU32::new(0)).collect();
        Ok(Some(Self { places, frames, bytes: all }))
    }

    /// Notes that a frame of a light is recorded at a place; returns the frame's number, from 1 up, or 0 where it runs no
    /// audit.
    pub fn begin(&self, place: usize, light: LightIndex, audited: bool) -> u32 {
        let number = match self.frames.get(light.0 as usize).filter(|_| audited) {
            // After 2³² frames the numbers begin anew.
            Some(frames) => frames.fetch_add(1, Ordering::Relaxed).wrapping_add(1).max(1),
            None => 0,
        };
        if let Some(place) = self.places.get(place) {
            place.recorded.store(number, Ordering::Relaxed);
        }
        number
    }

    /// The buffer of a place.
    pub fn object(&self, place: usize) -> Object {
        self.places.get(place).map_or(Object::None, |place| Object::Buffer(place.buffer))
    }

    /// The error of the frame that was recorded last at a place; `None` until the device has completed it.
    pub fn read(&self, place: usize) -> Option<MeasuredError> {
        let place = self.places.get(place)?;
        let number = place.recorded.load(Ordering::Relaxed);
        // The words may be those of an earlier frame, or of two frames: their own number and sum say so.
        Figures::of(&place.figures.read()).filter(|f| number > 0 && f.frame == number)?.error()
    }

    /// The name of the buffers, and the bytes of their memory.
    pub fn memory(&self) -> ResourceBytes {
        ResourceBytes { name: "audit.figures", bytes: self.bytes }
    }
}
