# SPDX-License-Identifier: MIT OR Apache-2.0
# flags.sh -- flags of rustc for cargo, in which spaces may stand, and Rust's standard library for other systems.
# Sourced by tarball and windows, and by tests; does nothing itself.
# shellcheck shell=bash

# rustc_flags FLAGS...: exports them for cargo, behind those of CARGO_ENCODED_RUSTFLAGS or RUSTFLAGS. Cargo divides
# RUSTFLAGS at spaces, also at those in a folder's name.
rustc_flags() {
    local flags=() separator=$'\x1f'
    if [ -n "${CARGO_ENCODED_RUSTFLAGS:-}" ]; then
        flags=("$CARGO_ENCODED_RUSTFLAGS")
    else
        read -ra flags <<<"${RUSTFLAGS:-}"
    fi
    flags+=("$@")
    CARGO_ENCODED_RUSTFLAGS=$(printf "%s$separator" "${flags[@]}")
    export CARGO_ENCODED_RUSTFLAGS=${CARGO_ENCODED_RUSTFLAGS%"$separator"}
}

# find_standard_library TRIPLE: sets two variables. standard_library has the arguments by which cargo builds that of
# the target, and is empty where it is installed; sources_of_rust is the folder of Rust's sources. Where there are
# arguments, set RUSTC_BOOTSTRAP=1: stable compilers refuse -Z without it. Where there are no sources of the compiler's
# own version either, it says what to install, and fails. $root is the checkout, in which a file rust-toolchain would
# count.
find_standard_library() {
    standard_library=()
    sources_of_rust=$(cd -- "$root" && rustc --print sysroot)/lib/rustlib/src/rust
    [ ! -d "$(cd -- "$root" && rustc --print target-libdir --target "$1")" ] || return 0
    standard_library=(-Z build-std=std,panic_unwind)
    [ -f "$sources_of_rust/library/Cargo.lock" ] || {
        echo "Rust's standard library for $1 is missing, and so are its sources:"
        echo "    rustup target add $1, or: rustup component add rust-src, or the Debian package rust-src"
        return 1
    }
}
