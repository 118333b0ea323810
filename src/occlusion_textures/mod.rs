//! Occlusion textures (Eisemann and Décoret 2008).

mod passes;
pub mod push;
mod settings;

pub use passes::{Inputs, declare};
pub use settings::{Combine, Prefilter, Settings};
