//! The code that examples, tests and benches share and that no host needs: a Vulkan device without a window, a
//! scene and a G-buffer on it, a node that shades them, and read-back; beside them the made scenes and the
//! small readers and writers that more than one of those programs uses.
//!
//! Nothing here but [`rays`] is fast: every call submits and waits. What is here is careful: an instance of Vulkan
//! 1.1, no optional feature and no device extension, so that whatever runs on this device runs on any that antumbra
//! accepts, and every message of the validation layer is kept for a test to look at.
//!
//! | what | where |
//! |---|---|
//! | a device, its messages, submits | [`HeadlessDevice`], [`MessageLog`], [`Submitted`], [`Invocations`] |
//! | buffers and images that can be read back | [`HostBuffer`], [`OwnedImage`], [`read_image`] |
//! | a scene, its G-buffer and a node that shades it | [`Stage`], [`SceneBuffers`], [`GBuffer`], [`View`] |
//! | one compute shader, for a shader's unit test | [`ComputeProgram`], [`run_compute`] |
//! | what a technique is compared with | [`rays`], [`Forward`], [`ReadbackScheme`] |
//! | what passes cost on this device | [`measure_costs`], [`probe`] |
//! | the node's hierarchy of triangles, read back | [`DeviceTree`] |
//! | descriptions with every pass | [`descriptions`] |
//! | made scenes, and files read and pictures made | [`cases`], [`bumps`], [`ply`], [`shade`], [`levels`], [`whole`] |

// Vulkan through ash is unsafe call by call; each unsafe block has its own SAFETY line.
#![allow(unsafe_code)]

mod buffer;
pub mod bumps;
pub mod cases;
mod choose;
mod compute;
mod costs;
pub mod descriptions;
mod device;
mod device_tree;
mod forward;
mod gbuffer;
mod image;
mod instance;
pub mod levels;
mod messages;
mod module;
mod painter;
pub mod ply;
mod raster;
pub mod rays;
mod readback;
mod scene;
mod set;
pub mod shade;
mod shaders;
mod stage;
mod statistics;
mod submit;
mod view;
pub mod whole;
pub mod words;

pub use buffer::HostBuffer;
pub use compute::{ComputeProgram, run_compute};
pub use costs::{measure_costs, probe};
pub use device::{HeadlessDevice, HeadlessOptions, Tables};
pub use device_tree::{DeviceTree, Link};
pub use forward::Forward;
pub use gbuffer::{GBuffer, GBufferPainter};
pub use image::{ImageSource, OwnedImage, bytes_per_texel, read_image};
pub use messages::MessageLog;
pub use readback::{ReadbackScheme, ReadbackTimes};
pub use scene::SceneBuffers;
pub use stage::{FrameTimes, Stage};
pub use statistics::Invocations;
pub use submit::Submitted;
pub use view::View;
pub use words::{technique, technique_of};
