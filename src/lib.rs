//! Soft shadows from area lights, as one node of a Vulkan engine's render graph.

pub mod error;
pub mod gpu;
pub mod light;
mod numbers;
pub mod scene;
#[cfg(feature = "truth")]
pub mod truth;

pub use error::Error;
pub use light::RectangleLight;

/// The shaders' functions in Rust, for the tests that hold both against each other. Not part of
/// the crate's interface: what is here changes without notice.
#[doc(hidden)]
pub mod twin {
    pub mod numbers {
        pub use crate::numbers::*;
    }
}
