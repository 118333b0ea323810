#!/usr/bin/env bash
# The library's unit tests and those of the glTF reader and the truth (tests/scenes) under AddressSanitizer, and
# LeakSanitizer with it, which nightly Rust alone has.
# Objects go to target/sanitize/. What is said behind the name goes to the tests, as in
#   tests/sanitize.sh scene::
set -euo pipefail
cd "$(dirname "$0")/.."

if ! cargo +nightly --version >/dev/null 2>&1; then
    echo "There is no nightly Rust here, which alone has sanitizers. Run" >&2
    echo "    rustup toolchain install nightly" >&2
    echo "and this again." >&2
    exit 1
fi
# A target is named so that build scripts and macros, which run on the way, are left as they are.
host=$(cargo +nightly --version --verbose | sed -n 's/^host: //p')
export CARGO_TARGET_DIR=target/sanitize RUSTFLAGS=-Zsanitizer=address
cargo +nightly test -p antumbra --lib --all-features --target "$host" -- "$@"
cargo +nightly test -p antumbra-tests --test scenes --target "$host" -- "$@"
