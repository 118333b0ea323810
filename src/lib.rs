//! Soft shadows from area lights, as one node of a Vulkan engine's render graph.
//!
//! The result is one image: for each pixel of the host's G-buffer the **visible fraction** of a light, 0 in umbra to 1
//! in the light.
//!
//! ```text
//!  the host: meshes, a light, the G-buffer's depth
//!    │
//!    ├─ depth_layers     maps as the light sees: occluders' nearest and furthest faces
//!    │    ├─ hard                 compared with each pixel, 3×3 filtered
//!    │    ├─ pcss                 the same, filtered as widely as the blockers' distance asks for
//!    │    ├─ back_projection      texels projected back onto the light, gaps filled
//!    │    ├─ soft_shadow_map      texels as micro-patches; what they hide of the light, added up
//!    │    └─ nbuffer ─ ray_march  rays from pixels to the light through the layers
//!    ├─ occlusion_textures        all faces in slices, prefiltered; what the slices hide, combined
//!    ├─ linear_light              maps from points of a line; skins between them say what penumbrae see
//!    └─ many_lights               a map for each of many points of the light; the mean of all
//!         │
//!         ▼   one of them, chosen by the description or by auto
//!  visibility            the visible fraction at each pixel
//!    │
//!    ▼
//!  the host: visibility × unshadowed irradiance
//! ```
//! Each technique is a folder of [`techniques`]; what they share is in [`stages`]. A [`Technique`] is one of them with
//! its settings, and reads from text: `"pcss taps=32".parse()`.
//!
//! Data flows down the picture and never back up. Each of these modules declares its passes as data in a [`graph`];
//! [`ShadowNode::plan`] keeps the passes that a frame needs and derives their barriers; [`ShadowNode::record`] turns
//! the plan into commands.
//!
//! ```no_run
//! # use antumbra::{Allocator, Description, Error, Frame, Host, Requirements, ShadowNode};
//! # fn host_frame(
//! #     host: Host, memory: &mut dyn Allocator, cmd: ash::vk::CommandBuffer, frame: &Frame,
//! # ) -> Result<(), Error> {
//! // Once: lend a device (Host::borrow), check that it has what the node needs, make the node.
//! Requirements::of(&host).met()?;
//! let mut node = ShadowNode::new(host.clone(), memory, Description::new([1920, 1080]))?;
//!
//! // Each frame: describe it (Frame::new), plan, record between the G-buffer and the shading.
//! let plan = node.plan(frame)?;
//! println!("{}", plan.explain()); // what runs, what does not, and why
//! node.record(cmd, &plan)?;
//! let result = node.visibility(); // sample this where you shade; None where you lend the image
//!
//! // Another size. Keep the replaced objects until the device has completed the frames recorded before.
//! let retired = node.resize(memory, [1280, 720])?;
//! retired.destroy(memory);
//!
//! // At the end, once the device is idle.
//! node.destroy(memory);
//! # Ok(())
//! # }
//! ```
//! `examples/embed`, `examples/embed_vk_graph` and `examples/embed_wgpu` do this in whole engines.
//!
//! | to … | read |
//! |---|---|
//! | host the node | [`embedding`], then [`node`], [`frame`], [`gpu::Host`], [`gpu::Allocator`], [`light`] |
//! | choose a technique and its settings | [`Technique`], [`Description`], [`Omit`] |
//! | ask for an error or a time instead | [`auto`], [`effects`] |
//! | follow a technique | its module: the idea, the paper's sections, where it departs, its limits |
//! | see what a frame does | [`FramePlan::explain`], [`FramePlan::doubts`], [`graph::Plan::table`], [`graph::Plan::graphviz`] |
//! | load or make scenes | [`scene`] |
//! | measure a frame's error while it runs | [`audit`], [`ShadowNode::measured_error`] |
//! | measure error | `truth` (feature `truth`) |

pub mod audit;
pub mod auto;
pub mod effects;
#[doc = include_str!("../docs/embedding.md")]
pub mod embedding {}
pub mod error;
pub mod frame;
pub mod gpu;
pub mod graph;
pub mod knob;
pub mod lent;
pub mod light;
pub mod node;
mod plain;
pub mod scene;
#[doc(hidden)]
pub mod shaders;
#[doc(hidden)]
pub mod stages;
pub mod technique;
#[doc(hidden)]
pub mod techniques;
#[cfg(feature = "truth")]
pub mod truth;

pub use ash;
pub use audit::{ErrorWindow, MeasuredError};
pub use effects::Omit;
pub use error::Error;
pub use frame::{Description, Doubt, Frame, FramePlan, FramePlans, LightTexture};
pub use glam;
pub use gpu::{Allocator, Host, HostDraw, Requirements, ResourceBytes, RetireQueue, Retired};
pub use graph::{Layer, Scope};
pub use lent::{
    BorderBarriers, Geometry, HostImage, LightIndex, MeshBounds, MeshBuffers, MeshInstance,
    NormalEncoding, Normals, OccluderMaps, Role, Slot, TechniqueIndex, Visibility,
};
pub use light::{Light, RectangleLight, Shape};
pub use node::{LayerPass, PassTime, ShadowNode, VisibilityImage};
pub use plain::{Matrix, Vector};
pub use technique::{Technique, settings};

/// The README's example is compiled with the doctests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
