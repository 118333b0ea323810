//! Chooses a technique and its settings by a budget of error and time.
//!
//! ```text
//!   Situation (effects) ──► Features ──► Table     the errors and times of every candidate, measured in the views
//!                                          │       of the report; the nearest views count
//!                                          ▼
//!                              Budget ──► Auto ──► Choice     Costs bring the times to the device at hand
//! ```
//! Everything here is pure, without Vulkan calls, and takes microseconds. `docs/planner.md` says how often the promised
//! error is kept.

mod budget;
mod candidates;
mod choice;
mod choose;
mod costs;
mod expected;
mod features;
mod shafts;
mod table;

pub use budget::Budget;
pub use candidates::{CANDIDATES, Candidate};
pub use choice::Choice;
pub(crate) use choice::distinct;
pub use choose::Auto;
pub use costs::Costs;
pub use features::{FEATURES, Features};
pub use table::{COLUMNS, Measured, PIXELS, PROBE, Table, View};

#[cfg(test)]
mod tests;
#[cfg(test)]
mod traced_tests;
