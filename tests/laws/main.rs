//! What holds of every frame, technique and scene?

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

mod device_kinds;
mod frames;
mod kept;
mod line_truth;
mod random_laws;
mod same_images;
mod several_lights;
