//! What devices did, kept beside the report.

use super::judge::{Row, Tables};
use super::table;
use super::{cases, run};
use crate::Problem;
use crate::report::write_files;
use antumbra_harness::HeadlessDevice;
use std::path::Path;

const FILE: &str = "hard_cases.json";

/// The tables that a folder has; none where it has no file of them.
pub fn read(out: &Path) -> Result<Tables, Problem> {
    let path = out.join(FILE);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Tables::new()),
        Err(e) => return Err(Problem::of(path.display())(e)),
    };
    serde_json::from_str(&text).map_err(|e| format!("{}: {e}; remove it", path.display()).into())
}

/// Runs the table on a device, and keeps it with those of others; whether nothing is broken.
pub fn measure(device: &HeadlessDevice, out: &Path) -> Result<bool, Problem> {
    let rows = run::run(device, &cases::all())?;
    println!("{}: {}", device.name(), table::counts(&rows));
    let good = rows.iter().all(Row::is_good);
    let mut tables = read(out)?;
    tables.insert(device.name().into(), rows);
    let json = serde_json::to_string_pretty(&tables).map_err(Problem::of(FILE))?;
    write_files(out, [(FILE, json), ("hard_cases.md", table::markdown(&tables))])?;
    Ok(good)
}
