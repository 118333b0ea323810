//! What accuracy costs in time.
//!
//! `cargo bench --bench accuracy_cost` (`-- --help` for its options). Exit status 0 where every row
//! was measured, 1 where one failed, and 2 with one line for what stops the run.

use antumbra_bench::options::Options;
use antumbra_bench::run::run;
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match run(&Options::parse().resolved()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(problem) => {
            eprintln!("{}", problem.0.replace('\n', " "));
            ExitCode::from(2)
        }
    }
}
