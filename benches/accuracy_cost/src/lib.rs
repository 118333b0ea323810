//! What accuracy costs in time: the truth, the alternatives, and one report.
//!
//! ```text
//!   techniques ─┐                            ┌─► report   index.html, .json, .csv, headline.md
//!   scenes ─────┼─► groups ─► measure ─► store
//!   sweeps ─────┘      ▲          │          └─► what was measured, one line each, flushed
//!                      └── truth ◄┘
//! ```
//! A **group** is what is compared: several techniques on the same pixels of one scene under one
//! light, with one truth, timed in turns in one process. It is also what a stopped run resumes at.
//! Everything left of `measure` is data, and everything right of `store` is a pure function of the
//! stored rows: a report can be made of whatever a killed run left behind.

#![allow(
    missing_docs,
    reason = "the package is not published: a line stands where the name does not say it"
)]

pub mod choices;
pub mod commit;
pub mod curtis;
pub mod envelope;
pub mod findings;
pub mod groups;
pub mod hard_cases;
pub mod hills;
pub mod measure;
pub mod options;
pub mod pareto;
pub mod picture;
pub mod places;
pub mod plot;
pub mod problem;
pub mod progress;
pub mod report;
pub mod run;
pub mod runner;
pub mod scenes;
pub mod stability;
pub mod stats;
pub mod store;
pub mod studies;
pub mod sweeps;
pub mod techniques;
pub mod truth;
pub mod views;

pub use problem::Problem;
