//! The planner: what a frame needs, what it can do without, and at what price.

mod auto;
mod budget;
mod candidates;
mod costs;
mod effects;
mod likeness;
mod situation;
mod table;

pub use auto::{Auto, Choice};
pub use budget::Budget;
pub use candidates::{CANDIDATES, Candidate};
pub use costs::Costs;
pub use effects::{COUNT, Effect, HARD_PIXELS, Outcome, RULES, Rule, Verdict, Verdicts};
pub use likeness::{Likeness, PARTS};
pub(crate) use situation::Seen;
pub use situation::Situation;
pub use table::{COLUMNS, Measured, PIXELS, PROBE, Table, View};

#[cfg(test)]
mod tests;
