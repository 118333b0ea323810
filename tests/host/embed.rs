//! The embed example: an engine of its own, under the validation layer, resized half way.

use antumbra_tests::example::{build_example, folder};
use antumbra_tests::layer::{Checks, run};
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

/// A figure walks for sixty frames through a resize, posed on the device: the layer, which looks at hazards between the
/// frames in flight too, has nothing to say, and the pictures do not depend on who places the border's barriers.
#[test]
fn a_figure_walks_for_sixty_frames() {
    let program = build_example("embed");
    let walk = |name: &str, options: &[&str]| {
        let out = folder(name);
        let path = out.to_string_lossy();
        let arguments = [&["--walk", "--size", "200x150", "--out", &path], options].concat();
        let walked = run(&program, &arguments, Checks::Submits.if_validating());
        assert!(walked.ok && walked.messages.is_empty(), "{walked:?}");
        assert!(walked.said.contains("\n   59  "), "{}", walked.said);
        let last = std::fs::read(out.join("frame_59.png")).unwrap();
        let visibility = std::fs::read(out.join("visibility.exr")).unwrap();
        std::fs::remove_dir_all(out).unwrap();
        (last, visibility)
    };
    let node = walk("embed-walk", &[]);
    let host = walk("embed-walk-host", &["--host-barriers"]);
    assert!(node == host, "the pictures differ");
}

#[test]
fn a_walk_is_not_a_scene_of_a_file() {
    let program = build_example("embed");
    let output = Command::new(program).args(["--walk", "--scene", "a.glb"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.contains("--walk"), "{said}");
    assert!(said.contains("--scene"), "{said}");
}
