//! What may a host ask for? What is refused, what every device can do, and what a plan costs. No test here opens a
//! device, so the program runs once and not once a driver.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod planning;
mod reflection;
mod refusals;
mod row_limits;
mod rows;
