//! Tests that cannot run where something is missing.

use std::io::Write;

/// Says why a test ends here without testing, or fails it where `ANTUMBRA_NO_SKIPS` is 1: `make test` sees to
/// everything that a test may lack, so that a test which finds nothing to test there is a fault.
///
/// # Panics
/// Where nothing may be skipped.
pub fn skip(why: &str) {
    assert!(!is_set("ANTUMBRA_NO_SKIPS"), "{why}; with ANTUMBRA_NO_SKIPS=1 no test is skipped");
    say(&format!("skipped: {why}"));
}

/// Whether tests run under the validation layer, which `ANTUMBRA_VALIDATE=1` asks for.
///
/// # Panics
/// Where nothing may be skipped, and the layer's checks would be.
pub fn validating() -> bool {
    let validating = is_set("ANTUMBRA_VALIDATE");
    assert!(
        validating || !is_set("ANTUMBRA_NO_SKIPS"),
        "without ANTUMBRA_VALIDATE=1 no test runs under the validation layer; with ANTUMBRA_NO_SKIPS=1 all must"
    );
    validating
}

fn is_set(variable: &str) -> bool {
    std::env::var(variable).is_ok_and(|value| value == "1")
}

/// Writes past the harness, which shows what is printed only where a test fails.
pub fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
