//! A Vulkan device without a window, with the little around it that examples, tests and benches
//! share: buffers, images, one-shot submits and read-back.
//!
//! A host with an engine of its own needs none of this. Nothing here is fast: every call submits
//! and waits. What is here is careful: an instance of Vulkan 1.1, no optional feature and no device
//! extension, so that whatever runs on this device runs on any that antumbra accepts, and every
//! message of the validation layer is kept for a test to look at.

mod buffer;
mod choose;
mod compute;
mod costs;
mod device;
mod forward;
mod gbuffer;
mod image;
mod instance;
mod messages;
mod painter;
mod raster;
mod readback;
mod scene;
mod stage;
mod statistics;
mod submit;
mod view;

pub use buffer::HostBuffer;
pub use compute::{ComputeProgram, run_compute};
pub use costs::{measure_costs, probe};
pub use device::{HeadlessDevice, HeadlessOptions, Tables};
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
