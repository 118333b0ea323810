//! Do the shaders compute what they should? GLSL functions and passes alone on the device, each beside its twin, and
//! sums beside the bounds that are derived for them.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

mod baseline_functions;
mod nbuffer;
mod occlusion_textures_functions;
mod ray_march_functions;
mod ray_search;
mod rounding;
mod shader_functions;
mod sums;
