//! Which program it is that measures.

use crate::options::Options;
use fnv::FnvHasher;
use std::hash::Hasher;
use std::process::Command;

/// git's commit, and a hash of this program where it is not that commit's.
pub fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output =
            Command::new("git").current_dir(Options::root()).args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_string())
    };
    let Some(commit) = git(&["rev-parse", "--short=10", "HEAD"]) else {
        return format!("unknown, {}", program());
    };
    let clean =
        git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|s| s.is_empty());
    if clean { commit } else { format!("{commit}-dirty, {}", program()) }
}

fn program() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read).unwrap_or_default();
    let mut hash = FnvHasher::default();
    hash.write(&bytes);
    format!("program {:08x}", hash.finish() >> 32)
}
