//! Occlusion textures (Eisemann and Décoret 2008).

mod passes;
pub mod push;
mod settings;
pub mod twin;

pub use passes::{Inputs, declare, wanted};
pub use settings::{Combine, Placement, Prefilter, Settings};
