//! What the passes of one line share.

use super::settings::Settings;
use crate::graph::ResourceId;
use crate::stages::views::Line;
use crate::techniques::room::PassInputs;

/// What a line's maps and channels are made in, and what is made of all of them.
pub(super) struct LineResources {
    pub layers: Layers,
    pub left: SkinSide,
    pub right: SkinSide,
    /// What of the segment that is being made its rows must know.
    pub segment: ResourceId,
    /// How large the grids of its rows are.
    pub groups: ResourceId,
    /// The arguments of the draws of its skins.
    pub draws: ResourceId,
    /// A layer a sample, line by line: what pixels ask for.
    pub maps: ResourceId,
    /// A row a line.
    pub places: ResourceId,
}

/// What the rows of one line are made of.
pub(super) struct LineContext<'a> {
    pub resources: &'a LineResources,
    pub settings: &'a Settings,
    pub inputs: &'a PassInputs<'a>,
    pub line: &'a Line,
    /// Which line it is: its row of places, its view of the meshes.
    pub row: u32,
}

/// What samples see.
pub(super) struct Layers {
    /// Where they are.
    pub samples: ResourceId,
    /// The nearest occluders and receivers as one of them sees them: drawn into, and taken from.
    pub occluders: ResourceId,
    pub receivers: ResourceId,
    /// Two that lie side by side.
    pub seen: ResourceId,
    /// What receivers see of the line.
    pub masks: ResourceId,
}

/// What one sample of a segment makes of the other's occluders.
pub(super) struct SkinSide {
    pub edges: &'static str,
    pub draw: &'static str,
    /// Which ends of occluders are seen past: -1, those towards −x.
    pub side: i32,
    pub skins: ResourceId,
    /// Of the draw's arguments in [`super::passes::LineResources::draws`].
    pub offset: u64,
    pub channel: ResourceId,
}
