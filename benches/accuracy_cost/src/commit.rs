//! Which program it is that measures.

use crate::options::Options;
use fnv::FnvHasher;
use std::hash::Hasher;
use std::process::Command;

/// git's commit, and a hash of this program where it is not that commit's.
pub fn commit() -> String {
    let describe = ["describe", "--always", "--dirty", "--abbrev=10", "--exclude=*"];
    let output = Command::new("git").current_dir(Options::root()).args(describe).output();
    let output = output.ok().filter(|output| output.status.success());
    match output.and_then(|output| String::from_utf8(output.stdout).ok()) {
        Some(commit) if !commit.trim().ends_with("-dirty") => commit.trim().into(),
        changed => format!("{}, {}", changed.as_deref().unwrap_or("unknown").trim(), program()),
    }
}

fn program() -> String {
    let bytes = std::env::current_exe().and_then(std::fs::read).unwrap_or_default();
    let mut hash = FnvHasher::default();
    hash.write(&bytes);
    format!("program {:08x}", hash.finish() >> 32)
}
