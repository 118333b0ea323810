//! What the tests share: a device that watches the validation layer, the GLSL compiler, SPIR-V
//! reflection, and the harness that runs one GLSL function beside its twin.

// A test says what went wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod bench;
pub mod compare;
pub mod compile;
pub mod cut_outs;
pub mod device;
pub mod draco;
pub mod example;
pub mod function;
pub mod headers;
pub mod layer;
pub mod measure;
pub mod permutations;
pub mod random;
pub mod reflect;
pub mod rig;
pub mod room;
mod signature;
pub mod situations;
mod skip;
pub mod tables;
pub mod textured_file;

pub use device::{TestDevice, device};
pub use function::{Case, Function};
pub use skip::{say, skip, validating};
