//! Nothing to do: with a build script, Cargo heeds the build dependencies' features (see Cargo.toml).

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
}
