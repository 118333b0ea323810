//! Which effects a frame needs: those that change its image by more than an allowed error. The others are left out,
//! each with a bound on the error that this adds.
//!
//! ```text
//!   Frame: boxes, light, camera ──► Situation ──► Verdicts    `ShadowNode::plan` leaves passes out by them,
//!                                                             `FramePlan::explain` prints them
//! ```
//! Everything here is pure, without Vulkan calls, and takes microseconds. `docs/planner.md` derives the bounds.

mod omit;
mod rules;
mod situation;
mod verdicts;

pub use omit::Omit;
pub use rules::{COUNT, Effect, HARD_PIXELS, RULES, Rule};
pub use situation::Situation;
pub(crate) use situation::{Camera, Seen};
pub use verdicts::{Outcome, Verdict, Verdicts};
