//! Soft shadows from area lights, as one node of a Vulkan engine's render graph.

pub mod depth_layers;
pub mod error;
pub mod frame;
pub mod gpu;
pub mod graph;
pub mod light;
pub mod node;
pub mod scene;
pub mod settings;
pub mod shaders;
pub mod soft_shadow_map;
#[cfg(feature = "truth")]
pub mod truth;
pub mod visibility;

pub use error::Error;
pub use frame::{BorderBarriers, Description, Frame, FramePlan, HostImage, MeshInstance};
pub use gpu::{Allocator, Host, Requirements, Retired};
pub use light::RectangleLight;
pub use node::{ShadowNode, VisibilityImage};
pub use scene::Role;
pub use settings::{Settings, Technique};
