//! Stages that techniques share: depth layers, N-buffers, tiles of pixels, and the visibility image.

pub mod depth_layers;
pub mod nbuffer;
pub(crate) mod nearest;
pub(crate) mod tiles;
pub mod visibility;
