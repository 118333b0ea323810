//! Technique and settings by a budget of error and time.
//!
//! ```text
//!   Situation (effects) ──► Likeness ──► Table     what every candidate did in the views of the report that are
//!                                          │       most alike
//!                                          ▼
//!                              Budget ──► Auto ──► Choice     by a Budget of error and time, and what passes
//!                                                             cost here (Costs)
//! ```
//! Everything here is pure: no Vulkan calls, microseconds. `docs/planner.md` tells how often promises are kept.

mod budget;
mod candidates;
mod choice;
mod choose;
mod costs;
mod expected;
mod likeness;
mod table;

pub use budget::Budget;
pub use candidates::{CANDIDATES, Candidate};
pub use choice::Choice;
pub(crate) use choice::distinct;
pub use choose::Auto;
pub use costs::Costs;
pub use likeness::{Likeness, PARTS};
pub use table::{COLUMNS, Measured, PIXELS, PROBE, Table, View};

#[cfg(test)]
mod tests;
