//! Soft shadows from area lights, as one node of a Vulkan engine's render graph.

pub mod error;
pub mod gpu;
pub mod light;
pub mod scene;
#[cfg(feature = "truth")]
pub mod truth;

pub use error::Error;
pub use light::RectangleLight;
