//! Scenes made in code.
