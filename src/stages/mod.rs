//! Stages that techniques share: depth layers, N-buffers, the hierarchy of triangles, tiles of pixels, views, and the
//! visibility image.

pub mod depth_layers;
pub mod hierarchy;
pub mod nbuffer;
pub(crate) mod nearest;
pub mod tiles;
pub mod views;
pub mod visibility;
