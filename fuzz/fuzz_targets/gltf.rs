//! Any bytes as a glTF file; ../README.md says how to run it.
//!
//! tests/files/untrusted.rs calls [`whole::open`] too, on files of its own, so that what one of the two looks for
//! the other does.
#![cfg_attr(fuzzing, no_main)]

use antumbra_harness::whole;

#[cfg(fuzzing)]
libfuzzer_sys::fuzz_target!(|file: &[u8]| {
    // Either outcome is right; what is wrong panics.
    let _ = whole::open(file);
});

/// Opens the files that it is given: those that the fuzzer found, for which no fuzzer is needed.
#[cfg(not(fuzzing))]
fn main() {
    for path in std::env::args_os().skip(1) {
        let name = std::path::Path::new(&path).display();
        match std::fs::read(&path) {
            Ok(file) => match whole::open(&file) {
                Ok(scene) => println!("{name}: {} triangles", scene.triangles()),
                Err(sentence) => println!("{name}: {sentence}"),
            },
            Err(problem) => println!("{name} cannot be read: {problem}"),
        }
    }
}
