//! What a frame calls for: which effects matter in it by more than an error, and what leaving one out costs at most.
//!
//! ```text
//!   Frame: boxes, light, camera ──► Situation ──► Verdicts    what `ShadowNode::plan` leaves out by,
//!                                                             and `FramePlan::explain` prints
//! ```
//! Everything here is pure: no Vulkan calls, microseconds. `docs/planner.md` derives the bounds.

mod omit;
mod rules;
mod situation;
mod verdicts;

pub use omit::Omit;
pub use rules::{COUNT, Effect, RULES, Rule};
pub use situation::Situation;
pub(crate) use situation::{Camera, Seen};
pub use verdicts::{HARD_PIXELS, Outcome, Verdict, Verdicts};
