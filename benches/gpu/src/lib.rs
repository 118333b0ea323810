//! What a GPU's compiler makes of the shaders, without a GPU: Mesa's RADV compiles each pipeline for GPUs that need not be
//! there, and tells registers, waves, spills and code.
//!
//! A process of its own compiles for each family ([`compile`], on a [`device`] without hardware), since the driver reads its
//! family once. [`compiled`] runs them and reads what they print.

// Vulkan through ash is unsafe call by call; each unsafe block has its own SAFETY line.
#![allow(unsafe_code)]

pub mod compile;
pub mod compiled;
mod device;
pub mod families;
pub mod frame;
pub mod gate;
pub mod page;
pub mod table;
