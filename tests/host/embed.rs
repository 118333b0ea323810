//! The embed example: an engine of its own, under the validation layer, resized half way.

use antumbra_tests::example::{build_example, folder};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

fn pictures(program: &Path, name: &str, options: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let out = folder(name);
    let output = Command::new(program)
        .args(["--frames", "4", "--validate", "--out"])
        .arg(&out)
        .args(options)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    let problem = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {said}{problem}");
    assert!(said.contains("0 validation messages"), "{name}: {said}");
    let found = std::fs::read_dir(&out)
        .unwrap()
        .map(|e| e.unwrap().path())
        .map(|p| (p.file_name().unwrap().to_string_lossy().into(), std::fs::read(&p).unwrap()))
        .collect();
    std::fs::remove_dir_all(out).unwrap();
    found
}

/// Whoever places the barriers at the node's border, the pictures are the same and the validation
/// layer, synchronization checks included, has nothing to say, through a resize and the teardown.
#[test]
fn node_barriers_and_host_barriers_give_the_same_pictures() {
    let program = build_example("embed");
    let node = pictures(&program, "embed-node", &[]);
    let host = pictures(&program, "embed-host", &["--host-barriers"]);
    assert!(node.len() >= 2, "a picture before the resize and one behind it");
    assert!(node == host, "the pictures differ");
}
