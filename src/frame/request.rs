//! What a fit follows from, and what a technique needs of it.

use super::Frame;
use crate::light::Light;
use crate::technique::Technique;
use crate::techniques::room::{Maps, Takes};
use glam::DMat4;

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

/// The inputs of a fit: frames with equal inputs have the same fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inputs {
    revision: u64,
    light: Light,
    reach: Option<f64>,
    window: Option<[[f64; 2]; 2]>,
    request: FitRequest,
    meshes: usize,
    /// The camera, which matters where the views follow it.
    camera: DMat4,
}

impl Inputs {
    /// The inputs of a frame's fit; `None` where the frame has no revision or lends occluder maps, whose camera may
    /// change: its fit is made anew.
    pub fn of(request: &FitRequest, frame: &Frame) -> Option<Self> {
        if frame.occluder_maps.is_some() {
            return None;
        }
        Some(Self {
            revision: frame.revision?,
            light: frame.light,
            reach: frame.reach,
            window: frame.window,
            request: *request,
            meshes: frame.meshes.len(),
            camera: frame.world_from_ndc,
        })
    }

    /// Whether the fit of these is that of others, for views that follow the camera or do not.
    pub fn are(&self, others: &Self, follow: bool) -> bool {
        let camera = if follow { self.camera } else { others.camera };
        *others == Self { camera, ..*self }
    }
}
