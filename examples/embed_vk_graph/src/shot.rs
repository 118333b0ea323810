//! The inputs that every pass of a frame gets.

use crate::geometry::Model;
use crate::targets::Targets;
use antumbra::Slot;
use antumbra::scene::AreaLight;
use glam::DMat4;

/// One frame: its camera, its light, its models and its images.
pub struct Shot<'a> {
    /// Which of the frames in flight it is, counted from 0.
    pub slot: Slot,
    /// World space to clip space.
    pub clip_from_world: DMat4,
    /// The inverse.
    pub world_from_ndc: DMat4,
    pub light: &'a AreaLight,
    /// Light that the picture shows as white.
    pub exposure: f32,
    pub models: &'a [Model],
    pub targets: &'a Targets,
    /// `--lie`: the graph hears of the node's write as a read.
    pub lie: bool,
}
