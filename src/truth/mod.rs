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
//! The visible fraction of a light is the share of a figure's points, all alike, that a receiver r sees: those from which
//! no blocker crosses the segment to r. D is the distance from r to the centre; for a capsule, to the segment.
//!
//! | shape | figure | a segment ends at | v is 1 |
//! |---|---|---|---|
//! | rectangle, polygon, disc | its area | the light | at and behind its plane |
//! | line | its length | the light | at and behind the plane across its emission |
//! | sphere, radius R | the disc across the direction from r to the centre, through the centre, of radius R · D / √(D² − R²): it fills the cone that touches the sphere | the disc | inside: D ≤ R |
//! | capsule, radius R, half-length h | the stadium about the segment in the plane that contains it and faces r: a rectangle of 2h by 2R and two half discs; without a length the disc of radius R that faces r | the stadium | inside: D ≤ R |
//! | point | the point | the point | where r is the point; at and behind its plane, where it shines to one side |
//! | sun, angular size α | the directions r + t, where t is in the disc of radius tan(α/2) of the plane across the sun's direction at unit distance | nowhere: all that blocks counts | nowhere |
//!
//! What lies within a sphere or capsule but nearer to r than the figure blocks, as a lamp's glass does: such a mesh is best
//! a receiver alone.
//!
//! - [`closed_form`]: one convex polygon before a rectangle light, exact to rounding.
//! - [`exact`]: whole scenes and any polygonal light, exact to rounding.
//! - [`segment`]: the same of a line light: the share of its length.
//! - [`trace`]: whole scenes under any light by stratified rays, with an estimate of its own noise.
//! - [`metrics`]: the error of an image as Atty 2006 section 5.2.1 counts it, what that hides, and the error as an eye
//!   sees it.
//!
//! Three conventions hold for all of these methods, so that they agree with each other and with what a
//! rasterizing technique can reproduce:
//!
//! - A receiver at or behind the plane of a light that has one is not lit by it; there is nothing to shadow and
//!   v is 1.
//! - Only what lies strictly between receiver and light blocks: a lamp's own housing behind
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
pub use metrics::{ErrorSummary, seen_error};
pub use polygon_light::PolygonLight;
pub use segment::ExactLine;
pub use trace::{Estimate, Receiver, Sampling, Traced, Tracer};

#[cfg(test)]
mod random;
