//! The planner: what a frame needs, what it can do without, and at what price.
//!
//! ```text
//!   Frame: boxes, light, camera
//!     │
//!     ▼
//!   Situation ──► Verdicts     which effects matter by more than an error, and the bound where one is left out:
//!     │                        what `ShadowNode::plan` leaves out by, and `FramePlan::explain` prints
//!     ▼
//!   Likeness ──► Table         what every candidate did in the views of the report that are most alike
//!     │
//!     ▼
//!   Auto ──► Choice            by a Budget of error and time, and what passes cost here (Costs)
//! ```
//! Everything here is pure: no Vulkan calls, microseconds. `docs/planner.md` derives the bounds and tells how often
//! promises are kept.

mod auto;
mod budget;
mod candidates;
mod choice;
mod costs;
mod effects;
mod expected;
mod likeness;
mod rules;
mod situation;
mod table;

pub use auto::Auto;
pub use budget::Budget;
pub use candidates::{CANDIDATES, Candidate};
pub use choice::Choice;
pub(crate) use choice::distinct;
pub use costs::Costs;
pub use effects::{HARD_PIXELS, Outcome, Verdict, Verdicts};
pub use likeness::{Likeness, PARTS};
pub use rules::{COUNT, Effect, RULES, Rule};
pub use situation::Situation;
pub(crate) use situation::{Camera, Seen};
pub use table::{COLUMNS, Measured, PIXELS, PROBE, Table, View};

#[cfg(test)]
mod tests;
