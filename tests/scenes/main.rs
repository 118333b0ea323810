//! What does a file's scene hold, and what share of a light is visible in it? The glTF reader, and the truth that
//! images are compared with. No test here opens a device, so the program runs once and not once a driver.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

mod generate;
mod gltf;
mod light;
mod rays;
mod scene;
mod truth;
