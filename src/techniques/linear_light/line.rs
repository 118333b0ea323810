//! The resources that the passes of a line share, and the context that they are declared in.

use super::settings::Settings;
use crate::graph::ResourceId;
use crate::stages::views::Line;
use crate::techniques::room::PassInputs;

/// The resources of a line's passes. Those of the maps are reused for each sample; `maps` and `places` keep the
/// results.
pub(super) struct LineResources {
    pub layers: Layers,
    pub left: SkinSide,
    pub right: SkinSide,
    /// The state of the segment being built: the places and layers of its two samples.
    pub segment: ResourceId,
    /// The workgroups of the segment's passes, for indirect dispatches.
    pub groups: ResourceId,
    /// The arguments of the two draws of the segment's skins.
    pub draws: ResourceId,
    /// The samples' maps that pixels read: a layer a sample, line by line.
    pub maps: ResourceId,
    /// The image of lines and their samples' places: a row of texels a line.
    pub places: ResourceId,
}

/// The context in which the passes of one line are declared.
pub(super) struct LineContext<'a> {
    pub resources: &'a LineResources,
    pub settings: &'a Settings,
    pub inputs: &'a PassInputs<'a>,
    pub line: &'a Line,
    /// The line's number: its row of `places` and its view of the meshes.
    pub row: u32,
}

/// The samples of a line and the depth layers that they see.
pub(super) struct Layers {
    /// The number of samples and their places along the line.
    pub samples: ResourceId,
    /// The depth images of one sample's nearest occluders and receivers, drawn and then copied into `seen`.
    pub occluders: ResourceId,
    pub receivers: ResourceId,
    /// The w of occluders and receivers, in one layer for each of two neighbouring samples.
    pub seen: ResourceId,
    /// The visible parts of the line from a grid of receivers, 32 bits each.
    pub masks: ResourceId,
}

/// The skins of one side: edges in one sample's map, drawn into a channel of the other sample.
pub(super) struct SkinSide {
    pub edges: &'static str,
    pub draw: &'static str,
    /// Which ends of occluders have skins: −1 those towards −x, 1 those towards +x.
    pub side: i32,
    pub skins: ResourceId,
    /// The byte offset of the draw's arguments in [`LineResources::draws`].
    pub offset: u64,
    pub channel: ResourceId,
}
