//! Stages that techniques share: depth layers, N-buffers, tiles of pixels, views, and the visibility image.

pub mod depth_layers;
pub mod nbuffer;
pub(crate) mod nearest;
pub mod tiles;
pub mod views;
pub mod visibility;
