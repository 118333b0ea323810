//! The visible fraction on the CPU, and how far an image is from it.
//!
//! ```text
//!        ▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔  the light: v is the share of its area that the
//!         \  │    /  / /   receiver sees, every part counted alike
//!          \ │ ▂▂▂▂▂▂▂/    (cosines, distances and colors left out)
//!           \│/ occluder
//!     ───────r────────────
//! ```
//!
//! Nothing here shares code with the techniques or their twins: agreement means something only
//! where two methods could have disagreed.
//!
//! - [`closed_form`]: one convex polygon before a rectangle light, exact to rounding.
//! - [`exact`]: whole scenes and any polygonal light, exact to rounding.
//! - [`segment`]: the same of a line light: the share of its length.
//! - [`trace`]: whole scenes by stratified rays, with an estimate of its own noise.
//! - [`metrics`]: the error of an image as Atty 2006 section 5.2.1 counts it, and what that hides.
//!
//! Three conventions hold for all of these methods, so that they agree with each other and with what a
//! rasterizing technique can reproduce:
//!
//! - A receiver at or behind the light's plane is not lit by it; there is nothing to shadow and
//!   v is 1.
//! - Only what lies strictly between receiver and light plane blocks: a lamp's own housing behind
//!   the light does not, nor does a panel that lies in the light's plane.
//! - Blockers are two-sided, whatever their winding.

pub mod closed_form;
pub mod exact;
pub mod metrics;
pub mod segment;
pub mod trace;

mod blockers;
mod polygon_light;
mod pyramid;
mod union;

pub use closed_form::{visible_fraction_of_polygon, visible_fraction_of_quad};
pub use exact::Exact;
pub use metrics::ErrorSummary;
pub use polygon_light::PolygonLight;
pub use segment::ExactLine;
pub use trace::{Estimate, Receiver, Sampling, Traced, Tracer};

#[cfg(test)]
mod random;
