//! The three hosts: the node inside engines with habits of their own, on the same scene.

use antumbra_tests::example::{build_example, folder, root};
use antumbra_tests::layer::{Checks, Run, run};
use antumbra_tests::say;
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
    fn bunny(&self, options: &[&str], checks: Checks) -> PathBuf {
        let out = folder(&format!("{}{}", self.name, options.join("")));
        let Run { ok, said, complained, messages } =
            self.run(&out, options, checks.if_validating());
        assert!(ok, "{}: {said}{complained}", self.name);
        assert!(messages.is_empty(), "{} {options:?}: {messages}", self.name);
        println!("{} {options:?}: {}", self.name, said.lines().last().unwrap_or_default());
        let objects = said.split(" Vulkan objects").next().and_then(|t| t.rsplit(' ').next());
        if !options.contains(&"--own-shadow-map") {
            assert_eq!(objects.unwrap(), documented(self.name)[3], "{}", self.name);
        }
        out
    }

    fn run(&self, out: &Path, options: &[&str], checks: Checks) -> Run {
        let scene = root().join("scenes/bunny.glb");
        let (scene, out) = (scene.to_string_lossy(), out.to_string_lossy());
        let mut arguments = vec!["--scene", &scene, "--out", &out, "--size", SIZE];
        arguments.extend(options);
        run(&self.program, &arguments, checks)
    }
}

const SIZE: &str = "320x240";

/// wgpu wants a driver that says more of itself than SwiftShader does.
fn hosts() -> Vec<Host> {
    let mut names = vec!["embed", "embed_vk_graph"];
    let driver = std::env::var("ANTUMBRA_DRIVER").unwrap_or_default();
    if driver.to_lowercase().contains("swiftshader") {
        say("hosts: embed_wgpu is left to lavapipe");
    } else {
        names.push("embed_wgpu");
    }
    names.into_iter().map(Host::new).collect()
}

/// A host's row in docs/embedding.md.
fn documented(host: &str) -> Vec<String> {
    let page = std::fs::read_to_string(root().join("docs/embedding.md")).unwrap();
    let row = page.lines().find(|l| l.starts_with(&format!("| `{host}`"))).unwrap();
    row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// The one channel of an EXR file.
fn values(folder: &Path, name: &str) -> Vec<f32> {
    let image = exr::prelude::read_first_flat_layer_from_file(folder.join(name)).unwrap();
    image.layer_data.channel_data.list[0].sample_data.values_as_f32().collect()
}

fn bits(folder: &Path, name: &str) -> Vec<u32> {
    values(folder, name).iter().map(|v| v.to_bits()).collect()
}

/// Each host draws the bunny with its own pipelines, and lends, synchronizes and takes back in its own
/// way: depth and visibility are the same bits, and those of the render example.
#[test]
fn every_host_gets_the_same_bits() {
    let reference = folder("hosts-render");
    let scene = root().join("scenes/bunny.glb");
    let (scene, out) = (scene.to_string_lossy(), reference.to_string_lossy());
    let arguments =
        [scene.as_ref(), "--out", &out, "--size", SIZE, "--technique", "soft-shadow-map"];
    let rendered = run(&build_example("render"), &arguments, Checks::Submits.if_validating());
    assert!(rendered.ok && rendered.messages.is_empty(), "{rendered:?}");
    let visibility = bits(&reference, "visibility.exr");
    let mut depth: Option<Vec<u32>> = None;
    for host in hosts() {
        let out = host.bunny(&["--frames", "3", "--resizes", "0"], Checks::Submits);
        let own = bits(&out, "visibility.exr");
        let differ = own.iter().zip(&visibility).filter(|(a, b)| a != b).count();
        assert!(own == visibility, "{}: visibility differs at {differ} pixels", host.name);
        let own = bits(&out, "depth.exr");
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
        let still = host.bunny(&["--frames", "1", "--resizes", "0"], Checks::Submits);
        let resized = host.bunny(&["--frames", "5", "--resizes", "100"], Checks::Commands);
        let same = bits(&still, "visibility.exr") == bits(&resized, "visibility.exr");
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
    let told = host.run(&out, &["--lie"], Checks::Commands);
    assert!(told.messages.contains("SYNC-HAZARD-WRITE-AFTER-WRITE"), "{told:?}");
    std::fs::remove_dir_all(out).unwrap();
}

/// wgpu's host draws occluder maps of its own, with standard depth and a finite far plane: what it
/// gets is what the node's own layers give, but for single micro-patches that lie as near to a pixel's
/// plane as the two conventions round.
#[test]
fn maps_that_the_host_draws_serve_as_well() {
    let Some(host) = hosts().into_iter().find(|h| h.name == "embed_wgpu") else { return };
    let meshes = host.bunny(&["--frames", "1"], Checks::Submits);
    let maps = host.bunny(&["--frames", "1", "--own-shadow-map"], Checks::Submits);
    let [a, b] = [&meshes, &maps].map(|folder| values(folder, "visibility.exr"));
    let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| f64::from((a - b).abs())).collect();
    let mean = differences.iter().sum::<f64>() / differences.len() as f64;
    let most = differences.iter().copied().fold(0.0, f64::max);
    println!("own maps: mean {mean:.1e}, most {most:.1e}");
    assert!(a.contains(&0.0), "nothing is in umbra");
    assert!(mean > 0.0, "the same bits: were the maps used?");
    // A patch of a 256² map hides at most some thousandths of this light.
    assert!(mean < 1e-6 && most < 1e-2, "mean {mean:e}, most {most:e}");
    for folder in [meshes, maps] {
        std::fs::remove_dir_all(folder).unwrap();
    }
}
