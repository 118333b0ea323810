//! The crate's Vulkan calls, and so its only unsafe code.

// Vulkan through ash is unsafe call by call. Everything outside this folder is denied it, and each
// unsafe block inside has its own SAFETY line (the workspace's lints hold both).
#![allow(unsafe_code)]

#[cfg(feature = "headless")]
pub mod headless;
