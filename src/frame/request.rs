//! What a technique asks of a fit.

use crate::technique::Technique;
use crate::techniques::room::{Maps, Takes};

/// What a technique needs from a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FitRequest {
    /// The technique whose views are made; `None` before one is chosen, when there are none.
    pub technique: Option<Technique>,
    /// Which lights and meshes the technique accepts.
    pub takes: Takes,
    /// The maps that the technique draws.
    pub maps: Maps,
    /// The most views that may share the pixels.
    pub most_served: u32,
    /// Whether the technique takes a sun's light as parallel.
    pub parallel: bool,
    /// Whether several views may share the pixels of a lamp.
    pub nests: bool,
}

impl FitRequest {
    /// The request of a technique.
    pub fn of(technique: &Technique) -> Self {
        let room = technique.room();
        Self {
            technique: Some(*technique),
            takes: room.takes(),
            maps: room.maps(),
            most_served: room.most_served(),
            parallel: room.takes_parallel(),
            nests: room.nests(),
        }
    }
}
