//! The three hosts: the node inside engines with habits of their own, on the same scene.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra_tests::example::{build_example, folder, root};
use antumbra_tests::layer::{Run, run, validating};
use std::path::{Path, PathBuf};

struct Host {
    name: &'static str,
    program: PathBuf,
}

impl Host {
    fn new(name: &'static str) -> Self {
        Self { name, program: build_example(name) }
    }

    /// The bunny, under the layer; the folder holds what was written.
    fn bunny(&self, options: &[&str]) -> PathBuf {
        let out = folder(&format!("{}-{}", self.name, options.join("")));
        let Run { ok, said, complained, messages } = self.run(&out, options);
        assert!(ok, "{}: {said}{complained}", self.name);
        assert!(messages.is_empty(), "{} {options:?}: {messages}", self.name);
        println!("{} {options:?}: {}", self.name, said.lines().last().unwrap_or_default());
        out
    }

    fn run(&self, out: &Path, options: &[&str]) -> Run {
        let scene = root().join("scenes/bunny.glb");
        let (scene, out) = (scene.to_string_lossy(), out.to_string_lossy());
        let mut arguments = vec!["--scene", &scene, "--out", &out, "--size", SIZE];
        arguments.extend(options);
        run(&self.program, &arguments, validating())
    }
}

const SIZE: &str = "320x240";

/// wgpu wants a driver that says more of itself than SwiftShader does.
fn hosts() -> Vec<Host> {
    let mut names = vec!["embed", "embed_vk_graph"];
    let driver = std::env::var("ANTUMBRA_DRIVER").unwrap_or_default();
    if driver.to_lowercase().contains("swiftshader") {
        println!("without embed_wgpu, which is tried on lavapipe alone");
    } else {
        names.push("embed_wgpu");
    }
    names.into_iter().map(Host::new).collect()
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Each host draws the bunny with its own pipelines, and lends, synchronizes and takes back in its own
/// way: depth and visibility are the same bits, and those of the render example.
#[test]
fn every_host_gets_the_same_bits() {
    let reference = folder("hosts-render");
    let scene = root().join("scenes/bunny.glb");
    let (scene, out) = (scene.to_string_lossy(), reference.to_string_lossy());
    let arguments = [scene.as_ref(), "--out", &out, "--size", SIZE];
    let rendered = run(&build_example("render"), &arguments, validating());
    assert!(rendered.ok && rendered.messages.is_empty(), "{rendered:?}");
    let visibility = bytes(&reference, "visibility.exr");
    let mut depth: Option<Vec<u8>> = None;
    for host in hosts() {
        let out = host.bunny(&["--frames", "3", "--resizes", "0"]);
        assert!(bytes(&out, "visibility.exr") == visibility, "{}: visibility differs", host.name);
        let own = bytes(&out, "depth.exr");
        assert!(*depth.get_or_insert_with(|| own.clone()) == own, "{}: depth differs", host.name);
        std::fs::remove_dir_all(out).unwrap();
    }
    std::fs::remove_dir_all(reference).unwrap();
}

/// A hundred resizes with frames in flight: the host ends with no byte of the node's left, the layer
/// sees no object that outlives its device, and the last frame is what it is without them.
#[test]
fn a_hundred_resizes_leave_nothing_behind() {
    for host in hosts() {
        let still = host.bunny(&["--frames", "1", "--resizes", "0"]);
        let resized = host.bunny(&["--frames", "5", "--resizes", "100"]);
        let same = bytes(&still, "visibility.exr") == bytes(&resized, "visibility.exr");
        assert!(same, "{}: visibility differs behind the resizes", host.name);
        for folder in [still, resized] {
            std::fs::remove_dir_all(folder).unwrap();
        }
    }
}

/// vk-graph's host says on request that the node only reads what it writes. The picture stays the
/// same here; that the layer complains is what makes its silence elsewhere worth something.
#[test]
fn a_host_that_lies_about_one_access_is_caught() {
    let host = Host::new("embed_vk_graph");
    let out = folder("hosts-lie");
    let scene = root().join("scenes/bunny.glb");
    let (scene, to) = (scene.to_string_lossy(), out.to_string_lossy());
    let arguments = ["--scene", &scene, "--out", &to, "--size", SIZE, "--lie"];
    let told = run(&host.program, &arguments, true);
    assert!(told.messages.contains("SYNC-HAZARD-WRITE-AFTER-WRITE"), "{told:?}");
    std::fs::remove_dir_all(out).unwrap();
}
