//! What is read and what is committed: glTF files, SPIR-V, documentation, licences, features. No test here opens a
//! device, so the program runs once and not once a driver.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

mod docs;
mod freshness;
mod house;
mod naga_translation;
mod one_build;
mod programs;
mod surface;
mod untrusted;
