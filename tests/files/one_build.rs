//! One test runs with the dependencies that all tests were built with: `cargo test -p PACKAGE` asks for the same
//! features of each as `cargo test --workspace` does, so that neither builds anew what the other has built.

use antumbra_tests::example::root;
use std::collections::BTreeSet;
use std::process::Command;

/// The packages with tests or benches of their own.
const PACKAGES: [&str; 5] =
    ["antumbra", "antumbra-bench", "antumbra-gpu", "antumbra-harness", "antumbra-tests"];

/// A line for each dependency: name, version, features.
fn dependencies(choice: &[&str]) -> String {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let output = Command::new(cargo)
        .args(["tree", "--offline", "--locked", "--prefix=none", "--format={p} {f}"])
        .args(choice)
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The lines, each once; cargo marks those that it has shown before.
fn lines(dependencies: &str) -> BTreeSet<&str> {
    let line = |line: &str| !line.trim().is_empty();
    dependencies
        .lines()
        .filter(|l| line(l))
        .map(|l| l.trim_end_matches(" (*)").trim_end())
        .collect()
}

/// What some packages are built with that has other features where all packages are built.
fn built_anew<'a>(some: &'a str, all: &'a str) -> Vec<&'a str> {
    lines(some).difference(&lines(all)).copied().collect()
}

#[test]
fn a_package_alone_is_built_with_what_the_workspace_is_built_with() {
    let all = dependencies(&["--workspace"]);
    for package in PACKAGES {
        let alone = dependencies(&["--package", package]);
        assert!(lines(&alone).len() > 20, "{package} has {} dependencies", lines(&alone).len());
        let anew = built_anew(&alone, &all);
        assert!(
            anew.is_empty(),
            "`-p {package}` builds these anew, which have more features with --workspace; \
             harness/Cargo.toml or tests/Cargo.toml must ask for those:\n{}",
            anew.join("\n")
        );
    }
}

#[test]
fn a_missing_feature_is_noticed() {
    let all = "naga v30.0.1 spv-in,wgsl-out\nash v0.38.0 debug,std (*)\n\nash v0.38.0 debug,std\n";
    assert_eq!(built_anew("ash v0.38.0 debug,std\n", all), [""; 0]);
    assert_eq!(built_anew("naga v30.0.1 spv-in\n", all), ["naga v30.0.1 spv-in"]);
}
