//! What soft shadow maps cost, and what that buys.
//!
//! `cargo bench --bench soft_shadow_map` (`-- --quick` for fewer rounds, `--out DIR` for the rows as
//! CSV, and names of tables for those alone). Everything is measured in one process, the things that
//! are compared in turns, and told as medians with the quartiles beside them.

// A bench tells what goes wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod model;
mod study;
mod table;

use antumbra_harness::{HeadlessDevice, HeadlessOptions};
use std::path::PathBuf;
use table::Table;

/// How much is measured, and where it goes.
pub struct Options {
    /// Rounds of each comparison.
    pub rounds: usize,
    /// Leaves out what takes minutes on a CPU.
    pub quick: bool,
    /// Where the CSV goes.
    out: PathBuf,
    /// The tables that are made; empty for all.
    tables: Vec<String>,
}

/// A table and what makes it.
type Study = (&'static str, fn(&HeadlessDevice, &Options) -> Table);

const STUDIES: [Study; 6] = [
    ("gather_and_blend", study::gather_and_blend),
    ("gather_and_readback", study::gather_and_readback),
    ("sides", study::sides),
    ("pixels_and_map", study::pixels_and_map),
    ("tolerance", study::tolerance),
    ("triangles", study::triangles),
];

fn options() -> Options {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let out = root.join("out/bench");
    let mut options = Options { rounds: 5, quick: false, out, tables: Vec::new() };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--quick" => {
                options.quick = true;
                options.rounds = 3;
            }
            "--out" => options.out = arguments.next().expect("--out DIR").into(),
            // What cargo itself passes.
            "--bench" => {}
            table if STUDIES.iter().any(|(name, _)| *name == table) => {
                options.tables.push(argument);
            }
            other => {
                let names = STUDIES.map(|(name, _)| name).join(", ");
                panic!("{other}: the options are --quick, --out DIR and tables: {names}")
            }
        }
    }
    options
}

fn main() {
    let options = options();
    let device = HeadlessDevice::new(&HeadlessOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    println!("{}\n", device.name());
    let asked = |name: &str| options.tables.is_empty() || options.tables.iter().any(|t| t == name);
    let studies = STUDIES.iter().filter(|(name, _)| asked(name));
    let tables: Vec<Table> = studies.map(|(_, make)| make(&device, &options)).collect();
    std::fs::create_dir_all(&options.out).unwrap();
    for table in tables {
        let path = options.out.join(format!("{}.csv", table.name));
        std::fs::write(&path, table.csv(device.name())).unwrap();
        println!("{}", path.display());
    }
}
