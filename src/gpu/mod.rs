//! All Vulkan calls of the crate, and so its only unsafe code.

// Vulkan through ash is unsafe call by call. Everything outside this folder is denied it, and each
// unsafe block inside has its own SAFETY line (the workspace's lints hold both).
#![allow(unsafe_code)]

mod descriptors;
mod graph_objects;
mod host;
mod layouts;
mod maker;
mod measured;
mod memory;
mod mesh_sets;
mod node_objects;
mod objects;
mod owner;
mod pipeline;
mod pipelines;
mod record;
mod result;
mod retired;
mod timing;

pub use host::{Host, Requirements};
pub use layouts::SharedLayouts;
pub use memory::{Allocator, Mapped, MemoryBlock, MemoryRequest, ResourceBytes};
pub(crate) use node_objects::NodeObjects;
pub(crate) use objects::Object;
pub use pipelines::{PassPipeline, Pipelines};
pub use record::HostDraw;
pub use retired::{RetireQueue, Retired};
