# SPDX-License-Identifier: MIT OR Apache-2.0
# flags.sh -- flags of rustc for cargo, in which spaces may stand. Sourced by tarball and windows; does nothing itself.
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
