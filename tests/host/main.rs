//! How does the node behave inside an engine, also where the engine, its memory or its driver fails?

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod device;
mod embed;
mod faults;
mod host_maps;
mod hosts;
mod lies;
mod memory_faults;
mod mistakes;
mod parts;
mod pipelines;
mod poorer_devices;
mod render_cli;
