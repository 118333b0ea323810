//! The times of passes on a device, measured at its first use and stored by its name.

use antumbra::Error;
use antumbra::auto::{Costs, Table};
use antumbra_harness::{HeadlessDevice, measure_costs};
use std::path::PathBuf;

/// Reads the costs of an earlier run, or measures them now where there are none or the file cannot be read. Costs that
/// cannot be stored are measured again next time.
///
/// # Errors
/// Any error of the device.
pub fn of(device: &HeadlessDevice) -> Result<Costs, Error> {
    let path = path(device.name());
    let kept = path.as_ref().and_then(|p| std::fs::read(p).ok());
    if let Some(costs) = kept.and_then(|json| serde_json::from_slice(&json).ok()) {
        return Ok(costs);
    }
    let costs = measure_costs(device)?;
    if let (Some(path), Ok(json)) = (path, serde_json::to_vec_pretty(&costs)) {
        let _ = path.parent().map(std::fs::create_dir_all);
        let _ = std::fs::write(path, json);
    }
    Ok(costs)
}

/// A file for each device name, in the user's cache, and for each table that costs are factors of.
fn path(device: &str) -> Option<PathBuf> {
    let from = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let cache = from("XDG_CACHE_HOME").or_else(|| Some(from("HOME")?.join(".cache")))?;
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let name: String = device.chars().map(plain).collect();
    let probe = Table::own().probe;
    let table = format!("{:.3}-{:.3}", probe.maps_ms, probe.pixels_ms);
    Some(cache.join("antumbra").join(format!("costs-{table}-{name}.json")))
}
