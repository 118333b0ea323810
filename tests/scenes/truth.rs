//! The truth against values worked out by hand, against itself by other means, and against laws.

mod closed_form;
mod exact;
mod metrics;
mod polygon_light;
pub mod random;
mod segment;
mod shapes;
mod trace;
